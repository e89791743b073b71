"""What a command loads: nothing that its answer does not need."""

import json
import os
import subprocess
import sys

import pytest
from running import COMMANDS, inside

SLOW = {
    "PIL", "av", "distributed", "ezdxf", "filelock", "highspy", "jinja2", "matplotlib",
    "pyarrow", "pydantic", "rich", "scipy", "shapely",
}  # fmt: skip
ARCH = "--alpha 90 --mu 0.7"
RUN = (
    "import atexit, sys; atexit.register(lambda: print(*sys.modules, file=sys.stderr));"
    "from blocksim.cli import main; main()"
)


def loaded(arguments: str, code: int = 0, **where: str) -> tuple[set[str], str]:
    """Modules of a process that has run a command, and what it said."""
    words = [sys.executable, "-c", RUN, *arguments.split()]
    given = os.environ | where
    done = subprocess.run(words, capture_output=True, text=True, check=False, env=given)
    assert done.returncode == code, done.stderr
    assert done.stdout
    return set(done.stderr.split()), done.stdout


@pytest.mark.parametrize(
    ("arguments", "besides"),
    [
        ("--help", {"numpy", "blocksim.arch", "blocksim.blocks"}),
        ("map --help", {"blocksim.view", "blocksim.studies"}),
        (f"check {ARCH} --eta 0.12 --method limit", {"blocksim.engines.direct"}),
        (f"check {ARCH} --eta 0.12 --method theory", {"blocksim.engines.direct"}),
        (f"bracket {ARCH} --method limit", {"blocksim.engines.direct", "blocksim.kinds.files"}),
    ],
)
def test_no_command_waits_for_what_it_does_not_need(arguments: str, besides: set[str]) -> None:
    assert not loaded(arguments)[0] & (SLOW | besides)


def test_pictures_and_recordings_wait_for_no_solver_before_they_are_asked() -> None:
    found, _ = loaded("render --help")
    assert "blocksim.simulation.motion" in found
    assert not found & {"scipy", "highspy", "clarabel", "matplotlib", "blocksim.engines.direct"}


def test_an_arch_that_falls_is_told_by_the_solver_alone() -> None:
    """HiGHS greets on standard output, by itself, from 1.16 on: nothing but the answer is."""
    found, said = loaded(f"check {ARCH} --eta 0.1 --method limit --json", code=1)
    assert "highspy" in found
    assert not found & (SLOW - {"highspy", "scipy"} | {"scipy.optimize", "pymunk"})
    assert json.loads(said)["verdict"] == "collapses"


def test_a_shell_completes_commands_and_options() -> None:
    for line, names in (
        ("blocksim c", {"check", "chart", "convert", "cite"}),
        ("blocksim --v", {"--version"}),
    ):
        asked = {"_BLOCKSIM_COMPLETE": "bash_complete", "COMP_WORDS": line, "COMP_CWORD": "1"}
        found, said = loaded("", **asked)
        assert {each.removeprefix("plain,") for each in said.split()} == names
        assert not found & (SLOW | {"numpy"})


def test_help_lists_every_command_with_the_first_line_of_its_own_help() -> None:
    told = " ".join(inside("--help").stdout.split())
    for name in COMMANDS:
        own = inside(*name.split(), "--help").stdout
        about = " ".join(own.split("\n\n")[1].split())
        assert f" {name} {about}" in told
