"""The command line keeps its contract: exit codes, one line of error, JSON alone."""

import subprocess
from pathlib import Path

import click
import pytest
from running import COMMANDS, PROGRAM, answered, inside, parameters, ran

from blocksim import load_recording

ARCH = ("--alpha", "90", "--mu", "0.7", "--voussoirs", "27")


@pytest.mark.parametrize("method", ["auto", "theory", "limit", "direct", "pymunk"])
@pytest.mark.parametrize(
    ("eta", "verdict", "code"), [("0.12", "stands", 0), ("0.1", "collapses", 1)]
)
def test_check_answers_with_its_exit_code(
    method: str, eta: str, verdict: str, code: int
) -> None:
    answer = answered("check", *ARCH, "--eta", eta, "--method", method, code=code)
    assert answer["verdict"] == verdict
    assert answer["arch"]["mode"] == (None if code == 0 else "rrr")
    assert len(answer["joints"]) == 28
    promised = "method reason eta mu half_angle_deg voussoirs weight eta_limit eta_theory"
    assert {*promised.split(), "simulated_s", "state_hash", "wall_s"} <= {
        *answer,
        *answer["problem"],
        *answer["arch"],
    }


def test_options_override_the_file() -> None:
    answer = answered("bracket", "semicircle", "--alpha", "125", "--mu", "0.9")
    assert answer["arch"]["half_angle_deg"] == pytest.approx(125)
    assert answer["arch"]["mode_theory"] == "srr"


REPEATED = {
    *("--layer", "--level", "--group"),
    *("--with", "--point-load", "--patch-load", "--set", "--figure"),
    *("--fill-region", "--fill-layer"),
    *("cite --method", "bracket --out", "fragility --out", "--record"),
}
"""Options that may be given twice, and are taken as often."""


def test_an_option_given_twice_is_taken_twice_or_refused() -> None:
    for name in COMMANDS:
        for option in parameters(name):
            if not isinstance(option, click.Option):
                continue
            ways = [*option.opts, *option.secondary_opts]
            value = [] if option.is_flag else ["1"] * option.nargs
            done = inside(*name.split(), ways[0], *value, ways[-1], *value)
            if option.multiple:
                assert REPEATED & {ways[0], f"{name} {ways[0]}"}
                continue
            assert (done.returncode, done.stdout) == (2, ""), ways
            said = f"blocksim: {'/'.join(ways)} is given 2 times: must be given once\n"
            assert done.stderr == said


def test_options_that_may_be_given_twice_are_taken_twice() -> None:
    # Axles and patches are in test_road, what `bracket --out` writes in test_crossing.
    wall = ("check", "wall", "--mu", "1")
    sizes = ("--with", "courses=2", "--with", "length=3.")
    blocks = [
        answered(*wall, *given)["problem"]["blocks"]
        for given in ((), sizes[:2], sizes[2:], sizes)
    ]
    assert len(set(blocks)) == 4
    steps = ("--set", "hold_sweeps=20", "--set", "step=0.02")
    asked = (*ARCH, "--eta", "0.12", "--method", "pymunk")
    reason = answered("check", *asked, *steps, code=3)["reason"]
    assert "step 0.02 as given" in reason
    assert "hold_sweeps 20 as given" in reason
    assert "Pymunk" in (
        said := inside("cite", "--method", "pymunk", "--method", "mujoco").stdout
    )
    assert "MuJoCo" in said


QUESTION = ("check", *ARCH, "--eta", "0.12")


@pytest.mark.parametrize("asked", [QUESTION, pytest.param(("doctor",), marks=pytest.mark.long)])
def test_a_reader_that_has_gone_hears_no_verdict(asked: tuple[str, ...]) -> None:
    with subprocess.Popen([*PROGRAM, *asked], stdout=-1, stderr=-1) as process:
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 141


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device")
def test_a_full_disk_is_no_verdict() -> None:
    with Path("/dev/full").open("w") as full:
        # What is full for verdicts is in test_long_use.
        done = subprocess.run([*PROGRAM, "check", "nothing"], stderr=full, check=False)
        assert done.returncode == 2


def test_simulate_writes_a_recording_of_the_time_asked_for(tmp_path: Path) -> None:
    out = tmp_path / "run.npz"
    said = ran("simulate", *ARCH, "--eta", "0.1", "--seconds", "0.5", "--out", out)
    recording = load_recording(out)
    assert recording.state_hash in said
    assert recording.seconds(9.81)[-1] == pytest.approx(0.5, abs=0.02)
    assert recording.displacement[-1] > 0.1
    assert [path.name for path in tmp_path.iterdir()] == ["run.npz"]


def test_settings_of_an_engine_can_be_given(tmp_path: Path) -> None:
    asked = ("check", *ARCH, "--eta", "0.1", "--method", "pymunk")
    # No engine of impulses has converged after so few sweeps.
    reason = answered(*asked, "--set", "hold_sweeps=100", code=3)["reason"]
    assert reason.endswith("; hold_sweeps 100 as given")
    answer = answered("bracket", *ARCH, "--method", "direct", "--set", "step=0.005")
    arch = answer["arch"]
    assert arch["eta_low"] < arch["eta_limit"] < arch["eta_high"]
    assert answer["reason"].endswith("; step 0.005 as given")
    out = tmp_path / "run.npz"
    inside(
        *("simulate", *ARCH, "--eta", "0.1", "--method", "direct", "--out", str(out)),
        *("--set", "step=0.005", "--set", "rest=1e-8"),
    )
    settings = load_recording(out).settings
    assert (settings.step, settings.rest, settings.sweeps) == (0.005, 1e-8, 1)
