"""The command line keeps its contract: exit codes, one line of error, JSON alone."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import click
import pytest
from running import PROGRAM
from running import inside as blocksim

from blocksim import load_recording
from blocksim.cli import main
from blocksim.cli.app import COMMANDS, app

ARCH = ("--alpha", "90", "--mu", "0.7", "--voussoirs", "27")


@pytest.mark.parametrize("method", ["auto", "theory", "limit", "direct", "pymunk"])
@pytest.mark.parametrize(
    ("eta", "verdict", "code"), [("0.12", "stands", 0), ("0.1", "collapses", 1)]
)
def test_check_answers_with_its_exit_code(
    method: str, eta: str, verdict: str, code: int
) -> None:
    done = blocksim("check", *ARCH, "--eta", eta, "--method", method, "--json")
    answer = json.loads(done.stdout)
    assert done.returncode == code
    assert done.stderr == ""
    assert answer["verdict"] == verdict
    assert answer["arch"]["mode"] == (None if code == 0 else "rrr")
    assert len(answer["joints"]) == 28
    promised = "method reason eta mu half_angle_deg voussoirs weight eta_limit eta_theory"
    assert {*promised.split(), "simulated_s", "state_hash", "wall_s"} <= {
        *answer,
        *answer["problem"],
        *answer["arch"],
    }


def test_check_exits_with_3_where_it_cannot_tell() -> None:
    arch = (*ARCH, "--eta", "0.11")
    done = blocksim("check", *arch, "--method", "pymunk", "--json", "--set", "hold_sweeps=20")
    assert done.returncode == 3
    assert json.loads(done.stdout)["verdict"] == "undecided"


def test_bracket_holds_the_contract() -> None:
    done = blocksim("bracket", *ARCH, "--method", "pymunk", "--tol", "0.005", "--json")
    answer = json.loads(done.stdout)
    assert done.returncode == 0
    arch = answer["arch"]
    assert arch["eta_high"] - arch["eta_low"] <= 0.005 * arch["eta_high"]
    assert arch["eta_low"] < arch["eta_limit"] < arch["eta_high"]
    assert arch["mode"] == arch["mode_theory"] == "rrr"
    assert answer["confirmed"] is True
    assert answer["undecided"] == 0
    assert arch["thrust"] is None


def test_bracket_where_nothing_stands() -> None:
    answer = json.loads(blocksim("bracket", "--alpha", "90", "--mu", "0.3", "--json").stdout)
    assert answer["arch"]["eta_high"] is None
    assert answer["arch"]["mode"] == "ss"


def test_unbounded_friction_is_valid_json() -> None:
    done = blocksim("bracket", "--alpha", "90", "--mu", "inf", "--json")
    assert json.loads(done.stdout, parse_constant=pytest.fail)["problem"]["mu"] == "inf"


def test_options_override_the_scenario() -> None:
    done = blocksim("bracket", "semicircle", "--alpha", "125", "--mu", "0.9", "--json")
    answer = json.loads(done.stdout)
    assert answer["arch"]["half_angle_deg"] == pytest.approx(125)
    assert answer["arch"]["mode_theory"] == "srr"


REPEATED = {
    *("--layer", "--level", "--group"),
    *("--with", "--point-load", "--patch-load", "--set", "--figure"),
    *("--fill-region", "--fill-layer"),
    *("cite --method", "bracket --out"),
}
"""Options that may be given twice, and are taken as often."""


def test_an_option_given_twice_is_taken_twice_or_refused() -> None:
    for name in COMMANDS:
        command = app.get_command(click.Context(app), name)
        assert command is not None
        for option in command.params:
            if not isinstance(option, click.Option):
                continue
            ways = [*option.opts, *option.secondary_opts]
            value = [] if option.is_flag else ["1"] * option.nargs
            done = blocksim(*name.split(), ways[0], *value, ways[-1], *value)
            if option.multiple:
                assert REPEATED & {ways[0], f"{name} {ways[0]}"}
                continue
            assert (done.returncode, done.stdout) == (2, ""), ways
            said = f"blocksim: {'/'.join(ways)} is given 2 times: must be given once\n"
            assert done.stderr == said


def test_options_that_may_be_given_twice_are_taken_twice(tmp_path: Path) -> None:
    # Axles and patches are in test_road, what `bracket --out` writes in test_crossing.
    wall = ("check", "wall", "--mu", "1", "--json")
    sizes = ("--with", "courses=2", "--with", "length=3")
    blocks = [
        json.loads(blocksim(*wall, *given).stdout)["problem"]["blocks"]
        for given in ((), sizes[:2], sizes[2:], sizes)
    ]
    assert len(set(blocks)) == 4
    steps = ("--set", "hold_sweeps=20", "--set", "step=0.02")
    asked = (*ARCH, "--eta", "0.12", "--method", "pymunk")
    reason = json.loads(blocksim("check", *asked, *steps, "--json").stdout)["reason"]
    assert "step 0.02 as given" in reason
    assert "hold_sweeps 20 as given" in reason
    assert "Pymunk" in (
        said := blocksim("cite", "--method", "pymunk", "--method", "mujoco").stdout
    )
    assert "MuJoCo" in said
    both = blocksim("paper", str(tmp_path), "--figure", "1", "--figure", "99")
    assert "99" in both.stderr


@pytest.mark.parametrize(
    ("given", "name"),
    [
        (("--with", "courses=2", "--with", "courses=3"), "courses"),
        (("--set", "step=0.1", "--set", "step=0.2"), "step"),
    ],
)
def test_one_parameter_given_twice_is_refused(given: tuple[str, ...], name: str) -> None:
    done = blocksim("check", "wall", "--mu", "1", "--method", "direct", *given)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"{given[0]} = {given[-1]!r}: must be given once for {name}\n" in done.stderr


WRONG = {
    "--eta 0": ("check", "--alpha", "90", "--mu", "1", "--eta", "0"),
    "--eta 2.5": ("check", "--alpha", "90", "--mu", "1", "--eta", "2.5"),
    "--alpha 180": ("check", "--alpha", "180", "--mu", "1", "--eta", "1"),
    "--mu -1": ("check", "--alpha", "90", "--mu", "-1", "--eta", "1"),
    "--mu nan": ("check", "--alpha", "90", "--mu", "nan", "--eta", "1"),
    "--voussoirs 2": ("check", "--alpha", "90", "--mu", "1", "--eta", "1", "--voussoirs", "2"),
    "--weight x": ("check", "--alpha", "90", "--mu", "1", "--eta", "1", "--weight", "x"),
    "--method x": ("check", "--alpha", "90", "--mu", "1", "--eta", "1", "--method", "x"),
    "--eta text": ("check", "--alpha", "90", "--mu", "1", "--eta", "thin"),
    "--tol 0": ("bracket", "--alpha", "90", "--mu", "1", "--tol", "0"),
    "--tol too fine": ("bracket", *ARCH, "--method", "pymunk", "--tol", "1e-9"),
    "no alpha": ("check", "--mu", "1", "--eta", "1"),
    "no eta": ("check", "--alpha", "90", "--mu", "1"),
    "missing file": ("check", "missing.toml"),
    "unknown scenario": ("check", "no_such_scenario"),
    "unknown option": ("check", "--nope"),
    "unknown command": ("nope",),
    "static simulate": (
        "simulate",
        *ARCH,
        "--eta",
        ".1",
        "--method",
        "limit",
        "--out",
        "x.npz",
    ),
    "--out in no folder": ("simulate", *ARCH, "--eta", ".1", "--out", "none/x.npz"),
    "--out no npz": ("simulate", *ARCH, "--eta", ".1", "--out", "x.mp4"),
    "map no picture": ("map", "--out", "map.docx"),
    "map no such zoom": ("map", "--out", "map.png", "--zoom", "central", "--lines"),
    "render nothing stands": ("render", "--alpha", "90", "--mu", "0.3", "--out", "x.png"),
    "picture of no height": ("render", "semicircle", "--out", "x.svg", "--height", "480"),
    "eta and ratio": ("check", *ARCH, "--eta", "0.1", "--ratio", "0.99"),
    "ratio of any": (
        "check",
        "--alpha",
        "60",
        "--mu",
        "0.9",
        "--voussoirs",
        "3",
        "--ratio",
        "1.5",
    ),
    "ratio of nothing": ("check", "--alpha", "90", "--mu", "0.3", "--ratio", "0.9"),
    "lean in the plane": (
        "simulate",
        *ARCH,
        "--eta",
        ".1",
        "--lean",
        "5",
        "--method",
        "direct",
        "--out",
        "x.npz",
    ),
    "validate by statics": ("validate", "--methods", "limit", "--out", "out"),
    "render no picture": ("render", "semicircle", "--out", "x.txt"),
    "map unwritable": ("map", "--out", "none/map.png"),
    "validate unwritable": ("validate", "--quick", "--out", "/proc/none"),
    "film unwritable": ("render", "semicircle", "--out", "none/film.mp4"),
    "film of a folder": ("render", "semicircle", "--out", "/proc/self"),
    "picture of no time": ("render", "semicircle", "--out", "x.png", "--time", "1"),
    "picture not slow": ("render", "semicircle", "--out", "x.png", "--slow", "9"),
    "picture by no engine": ("render", "semicircle", "--out", "x.png", "--method", "direct"),
    "film of a moment": ("render", "semicircle", "--out", "x.gif", "--time", "1"),
    "name too long": ("simulate", *ARCH, "--eta", ".1", "--out", f"{'x' * 300}/x.npz"),
}


@pytest.mark.parametrize("arguments", WRONG.values(), ids=WRONG.keys())
def test_wrong_input_is_one_line_and_leaves_nothing(
    arguments: tuple[str, ...], tmp_path: Path
) -> None:
    done = blocksim(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stdout == ""
    assert re.fullmatch(r"blocksim: [^\n]+\n", done.stderr)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("given", [("--voussoirs", "27.5"), ("--mu", "rough")])
def test_what_is_no_number_is_named(given: tuple[str, str]) -> None:
    done = blocksim("check", "--alpha", "90", "--eta", "0.1", *given)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert f"'{given[0]}'" in done.stderr
    assert f"'{given[1]}'" in done.stderr


QUESTION = ("check", *ARCH, "--eta", "0.12")


@pytest.mark.parametrize("asked", [QUESTION, pytest.param(("doctor",), marks=pytest.mark.long)])
def test_a_reader_that_has_gone_hears_no_verdict(asked: tuple[str, ...]) -> None:
    with subprocess.Popen([*PROGRAM, *asked], stdout=-1, stderr=-1) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 141


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device")
def test_a_full_disk_is_no_verdict() -> None:
    with Path("/dev/full").open("w") as full:
        # What is full for verdicts is in test_long_use.
        done = subprocess.run([*PROGRAM, "check", "nothing"], stderr=full, check=False)
        assert done.returncode == 2


def test_a_crash_is_no_verdict(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def crash(**_: object) -> None:
        message = "cannot happen"
        raise ZeroDivisionError(message)

    monkeypatch.setattr("blocksim.cli.run", crash)
    monkeypatch.setattr("blocksim.cli.interrupts.install", lambda: None)
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 70
    assert "ZeroDivisionError: cannot happen" in capsys.readouterr().err


def test_a_misspelt_key_is_named_with_its_file(tmp_path: Path) -> None:
    scene = tmp_path / "typo.toml"
    scene.write_text(
        'title = "t"\nsource = "s"\n[arch]\nhalf_angle_deg = 90\nvousoirs = 9\n'
        "[contact]\nmu = 1\n",
        encoding="utf-8",
    )
    done = blocksim("bracket", str(scene))
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "typo.toml: arch.vousoirs = 9" in done.stderr


def test_simulate_writes_a_recording_of_the_time_asked_for(tmp_path: Path) -> None:
    out = tmp_path / "run.npz"
    done = blocksim("simulate", *ARCH, "--eta", "0.1", "--seconds", "0.5", "--out", str(out))
    recording = load_recording(out)
    assert done.returncode == 0
    assert recording.state_hash in done.stdout
    assert recording.seconds(9.81)[-1] == pytest.approx(0.5, abs=0.02)
    assert recording.displacement[-1] > 0.1
    assert [path.name for path in tmp_path.iterdir()] == ["run.npz"]


def test_what_is_there_is_listed() -> None:
    assert "pymunk" in blocksim("doctor").stdout
    assert "fig18_triple_point" in blocksim("scenarios").stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ("map", "--zoom", "central"),
        pytest.param(("map", "--lines", "--zoom", "lower"), marks=pytest.mark.long),
        pytest.param(("render", "fig18_triple_point"), marks=pytest.mark.long),
    ],
)
def test_pictures_are_written_whole(arguments: tuple[str, ...], tmp_path: Path) -> None:
    out = tmp_path / "picture.png"
    assert blocksim(*arguments, "--out", str(out)).returncode == 0
    assert out.read_bytes().startswith(b"\x89PNG")
    assert [path.name for path in tmp_path.iterdir()] == ["picture.png"]


def test_settings_of_an_engine_can_be_given(tmp_path: Path) -> None:
    asked = ("check", *ARCH, "--eta", "0.1", "--method", "pymunk", "--json")
    # No engine of impulses has converged after so few sweeps.
    done = blocksim(*asked, "--set", "hold_sweeps=100")
    assert done.returncode == 3
    assert json.loads(done.stdout)["reason"].endswith("; hold_sweeps 100 as given")
    done = blocksim("bracket", *ARCH, "--method", "direct", "--set", "step=0.005", "--json")
    answer = json.loads(done.stdout)
    arch = answer["arch"]
    assert arch["eta_low"] < arch["eta_limit"] < arch["eta_high"]
    assert answer["reason"].endswith("; step 0.005 as given")
    out = tmp_path / "run.npz"
    blocksim(
        *("simulate", *ARCH, "--eta", "0.1", "--method", "direct", "--out", str(out)),
        *("--set", "step=0.005", "--set", "rest=1e-8"),
    )
    settings = load_recording(out).settings
    assert (settings.step, settings.rest, settings.sweeps) == (0.005, 1e-8, 1)


@pytest.mark.parametrize(
    ("method", "given", "said"),
    [
        (
            "pymunk",
            "step",
            "= 'step': must be name=value, with a number and one of step, sweeps",
        ),
        ("pymunk", "pace=3", "= 'pace=3': must be name=value"),
        ("pymunk", "step=fast", "= 'step=fast': must be name=value"),
        ("pymunk", "step=nan", "= 'step=nan': must be 1e-06 to 0.2"),
        ("pymunk", "sweeps=2.5", "= 'sweeps=2.5': must be a whole number from 1 to 1e+07"),
        ("direct", "sweeps=5", "= 'sweeps': must be one of step, still, rest for direct"),
        ("limit", "step=0.01", "= 'step': must be left out for limit"),
    ],
)
def test_a_wrong_setting_is_one_line(method: str, given: str, said: str) -> None:
    done = blocksim("check", *ARCH, "--eta", "0.1", "--method", method, "--set", given)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert f"--set {said}" in done.stderr


def test_direct_answers_and_brackets_finely() -> None:
    done = blocksim("bracket", *ARCH, "--method", "direct", "--tol", "1e-7", "--json")
    arch = json.loads(done.stdout)["arch"]
    assert arch["eta_low"] < arch["eta_limit"] < arch["eta_high"]
    assert arch["eta_high"] - arch["eta_low"] <= 1e-7 * arch["eta_high"]


def test_a_reduced_arch_answers_with_few_blocks() -> None:
    for given, blocks in (([], 3), (["--no-reduce"], 27)):
        asked = (*ARCH, "--eta", "0.1", "--method", "pymunk", *given, "--json")
        done = blocksim("check", *asked)
        answer = json.loads(done.stdout)
        assert done.returncode == 1
        assert (answer["blocks"], answer["splits"]) == (blocks, 0)
        assert len(answer["joints"]) == 28
    done = blocksim("bracket", *ARCH, "--reduce", "--json")
    assert done.returncode == 2
    assert done.stderr.startswith("blocksim: --reduce")
