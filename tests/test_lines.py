"""Lines of answers in a pipe: none is longer than 80 characters, and none says less."""

import shlex
import sys
from pathlib import Path

import pytest
from running import inside

ROOT = Path(__file__).parent.parent
WIDEST = 80
EVERY = [
    "check {}",
    "bracket {}",
    "simulate {} --seconds 0.02 --out run.npz",
    "render {} --out x.svg",
    "report {} --out x.html",
]
OTHERS = [
    "kinds", "kinds portal", "kinds wall", "kinds arcade", "scenarios", "doctor",
    "check --help", "map --table",
    "check wall --mu 0.5 --push 0.1", "check column --mu 0.7 --with drums=2 --must-rest",
    "bracket ferris_tinloi_3 --over load", "bracket portal --mu 0.7 --over lean",
    "check --span 8 --rise 3 --thickness 0.45 --voussoirs 31 --mu 0.7 --unit-weight 22 "
    "--fill 0.5 --point-load 2 50 --fill-friction-angle 30 --fill-pressure active",
    "bracket --span 8 --rise 3 --thickness 0.45 --voussoirs 9 --mu 0.6 --fill 0.5 "
    "--vehicle 10@0,10@1.2 --along road",
]  # fmt: skip


def told(asked: str, folder: Path) -> str:
    done = inside(*shlex.split(asked), cwd=folder)
    # What cannot be asked of a structure is one line on standard error, however long.
    assert done.returncode in {0, 1, 2, 3}, done.stderr
    return done.stdout


@pytest.mark.parametrize("asked", OTHERS)
def test_no_line_of_a_command_is_too_long(asked: str, tmp_path: Path) -> None:
    lines = told(asked, tmp_path).splitlines()
    assert lines
    assert max(map(len, lines)) <= WIDEST
    assert all(line == line.rstrip() for line in lines)


@pytest.mark.long
@pytest.mark.parametrize(
    "name", [path.stem for path in sorted((ROOT / "scenarios" / "structures").glob("*.toml"))]
)
def test_no_line_about_a_shipped_structure_is_too_long(name: str, tmp_path: Path) -> None:
    lines = [line for each in EVERY for line in told(each.format(name), tmp_path).splitlines()]
    assert max(map(len, lines)) <= WIDEST


def test_folded_lines_say_what_whole_ones_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each begins as it did, what goes on hangs below its words, by no unit of a number."""
    asked = "check --span 8 --rise 3 --thickness 0.45 --voussoirs 31 --mu 0.7 --unit-weight 22"
    folded = told(asked, tmp_path)
    monkeypatch.setenv("COLUMNS", str(sys.maxsize))
    whole = told(asked, tmp_path).splitlines()
    assert max(map(len, whole)) > WIDEST
    again: list[str] = []
    for line in folded.splitlines():
        if line.startswith(10 * " "):
            assert not again[-1][-1].isdigit() or not line.strip()[0].isalpha()
            again[-1] += " " + line.strip()
        else:
            again.append(line)
    # Of the time that it took no two are alike.
    assert again[1:] == whole[1:]
    assert again[0].split(",")[0] == whole[0].split(",")[0] == "STANDS  (limit"
