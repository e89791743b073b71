"""An engine and a maker from outside the package, asked by commands that know neither."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "docs" / "examples"
SPRINGS = "own_engine:ENGINE"
DEFECT = "raise RuntimeError('two\\nlines')\n"
TOWER = """
from dataclasses import dataclass
from blocksim import Stack

@dataclass(frozen=True, kw_only=True)
class Tower(Stack):
    '''Blocks of one size, one on the other, by another name.'''
    name = "campanile"
"""


def asked(*words: str, path: Path = EXAMPLES) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "blocksim", *words],
        capture_output=True,
        text=True,
        check=False,
        cwd=EXAMPLES,
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join([str(path), str(EXAMPLES.parents[1])]),
        },
    )


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A folder as a package is installed in: modules, and what they offer."""
    info = tmp_path / "strangers-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: strangers\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[blocksim.engines]\nsprings = own_engine:ENGINE\nbroken = defect:ENGINE\n"
        "[blocksim.kinds]\ncampanile = tower_kind:Tower\n"
    )
    (tmp_path / "own_engine.py").write_bytes((EXAMPLES / "own_engine.py").read_bytes())
    (tmp_path / "defect.py").write_text(DEFECT)
    (tmp_path / "tower_kind.py").write_text(TOWER)
    return tmp_path


def test_an_engine_of_ones_own_takes_a_hundred_lines() -> None:
    lines = (EXAMPLES / "own_engine.py").read_text(encoding="utf-8").splitlines()
    assert sum(bool(line.strip()) for line in lines) <= 100


@pytest.mark.parametrize(
    ("ratio", "verdict"),
    [(0.98, "collapses"), pytest.param(1.02, "stands", marks=pytest.mark.long)],
)
def test_it_agrees_with_limit_analysis_on_an_arch(ratio: float, verdict: str) -> None:
    of = "--alpha", "90", "--mu", "0.7", "--voussoirs", "7", "--ratio", str(ratio)
    done = asked("check", *of, "--method", SPRINGS, "--json")
    found = json.loads(done.stdout)
    assert (found["verdict"], found["method"]) == (verdict, "springs")
    assert done.returncode == (verdict == "collapses")


@pytest.mark.long
def test_it_brackets_the_angle_at_which_a_column_overturns() -> None:
    options = "--mu", "0.7", "--over", "tilt", "--tol", "0.05"
    done = asked("bracket", "column", *options, "--method", SPRINGS, "--json")
    found = json.loads(done.stdout)
    assert found["low"] < found["limit"] < found["high"]
    assert found["high"] - found["low"] <= 0.05 * found["high"]


def test_a_package_offers_engines_and_kinds(package: Path) -> None:
    done = asked(
        *("check", "campanile", "--with", "rows=2", "--mu", "0.7"),
        *("--method", "springs", "--json"),
        path=package,
    )
    assert json.loads(done.stdout)["method"] == "springs"
    assert "springs" in (told := asked("doctor", path=package).stdout)
    assert "broken" in told


@pytest.mark.parametrize(
    ("method", "why"),
    [
        ("broken", "RuntimeError: two lines"),
        pytest.param("os:system", "must be an Engine", marks=pytest.mark.long),
        pytest.param("spring", "one of auto, theory, limit", marks=pytest.mark.long),
    ],
)
def test_what_is_no_engine_is_refused_in_one_line(package: Path, method: str, why: str) -> None:
    done = asked("check", "column", "--mu", "0.7", "--method", method, path=package)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert why in done.stderr


def test_a_design_names_no_module(tmp_path: Path) -> None:
    """A file is data: that it names a module makes nobody import it."""
    (tmp_path / "trap.py").write_text("print('imported')\n")
    design = tmp_path / "design.toml"
    design.write_text('half_angle_deg = 90\nmu = 0.7\nmethod = ["trap:ENGINE"]\n')
    done = asked("sweep", str(design), "--out", str(tmp_path / "out"), path=tmp_path)
    assert done.returncode == 2, done.stderr
    assert "trap:ENGINE" in done.stderr
    assert "imported" not in done.stdout


def test_packages_are_not_looked_through_for_a_name_that_is_known() -> None:
    code = (
        "import sys; from importlib import metadata\n"
        "def refused(**_): raise AssertionError('looked')\n"
        "metadata.entry_points = refused\n"
        "from blocksim.cli import main; main()"
    )
    of = "--alpha", "90", "--mu", "0.7", "--eta", "0.12"
    words = ("check", *of, "--method", "pymunk")
    done = subprocess.run(
        [sys.executable, "-c", code, *words], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
