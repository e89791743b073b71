"""What a release needs: pages that can be made again, parts that are missing, a true lock."""

import ast
import re
import sys
import tomllib
from pathlib import Path

import pytest
from running import inside, refused

from blocksim import CircularArch, simulate

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
NAME = re.compile(r"[\w.-]+")
USED = ("dask", "dxf", "mesh", "mujoco", "pandas", "parquet")
"""Extras of those who use blocksim."""
NAMED = {
    "PIL": "pillow",
    "flint": "python-flint",
    "mujoco": "mujoco-core",
    "typing_extensions": "typing-extensions",
}
"""What is installed under another name than it is imported by."""


@pytest.mark.parametrize("name", ["a.html", "a.dxf"])
def test_pages_can_be_made_again(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    monkeypatch.chdir(tmp_path)
    pages = []
    for _ in range(2):
        assert inside("report", "oppenheim_7", "--out", name).returncode in {0, 1}
        pages.append(Path(name).read_bytes())
    assert pages[0] == pages[1]
    if name == "a.html":
        assert b"2023-11-14 22:13 UTC" in pages[0]
    else:
        # AutoCAD counts days from midnight: 31 December 1999, 9:58:35 PM is 2451544.91568287.
        dates = re.findall(rb"\$TDU?(?:CREATE|UPDATE)\n *40\n(.*)", pages[0])
        assert [float(each) for each in dates] == pytest.approx(
            [2440588 + 1.7e9 / 86400] * 4, abs=1e-5
        )


@pytest.mark.parametrize("given", ["", "now", "-1", "1e9", "9" * 30, "\N{SUPERSCRIPT TWO}"])
def test_a_wrong_date_is_one_line(
    given: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", given)
    done = refused("report", "oppenheim_7", "--out", tmp_path / "a.html")
    assert "seconds since 1970" in done
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("library", "words", "remedy"),
    [
        ("ezdxf", ("render", "oppenheim_7", "--out", "a.dxf"), "pip install 'blocksim[dxf]'"),
        ("ezdxf", ("check", "drawn.dxf", "--mu", "0.7"), "pip install 'blocksim[dxf]'"),
        ("av", ("render", "run.npz", "--out", "a.mp4"), "pip install av"),
    ],
)
def test_what_is_missing_is_named_with_its_remedy(
    library: str,
    words: tuple[str, ...],
    remedy: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (tmp_path / "drawn.dxf").write_text("0\nEOF\n")
    arch = CircularArch(half_angle_deg=86, eta=0.3, voussoirs=3, friction=0.7)
    simulate(arch, method="direct", duration=0.02).save(tmp_path / "run.npz")
    before = sorted(tmp_path.iterdir())
    monkeypatch.setitem(sys.modules, library, None)
    assert remedy in refused(*words, cwd=tmp_path)
    assert sorted(tmp_path.iterdir()) == before


def test_the_lock_has_all_that_is_declared() -> None:
    """Each with hashes, none from a place of its own."""
    lock = (ROOT / "requirements.lock").read_text()
    pinned = {each.lower() for each in re.findall(r"^([\w.-]+)==", lock, re.MULTILINE)}
    declared = [*PROJECT["dependencies"]]
    for each in PROJECT["optional-dependencies"].values():
        declared += each
    names = {NAME.match(each)[0].lower().replace("_", "-") for each in declared}
    assert names <= pinned
    assert "://" not in lock
    blocks = re.split(r"\n(?=\S)", lock[lock.index("\n", lock.index(".ci/lock")) :].strip())
    assert all("--hash=sha256:" in each for each in blocks)


def test_what_is_imported_is_declared() -> None:
    """What only the machine of a developer has is missing from everybody else's."""
    needed = set[str]()
    for path in (ROOT / "blocksim").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            match node:
                case ast.Import(names=names):
                    needed |= {each.name for each in names}
                case ast.ImportFrom(module=str(name), level=0):
                    needed.add(name)
                case ast.Call(func=ast.Name(id="Library"), args=[ast.Constant(value=name), *_]):
                    needed.add(str(name))
                case _:
                    pass
    needed = {each.partition(".")[0] for each in needed} - {"blocksim", "__future__"}
    extras = PROJECT["optional-dependencies"]
    used = [*PROJECT["dependencies"], *(each for name in USED for each in extras[name])]
    known = {NAME.match(each)[0] for each in used}
    assert {"numpy", "flint", "pybullet", "mujoco"} <= needed
    assert {NAMED.get(each, each) for each in needed - sys.stdlib_module_names} == known


def test_licences_name_what_is_installed() -> None:
    notice = (ROOT / "NOTICE.md").read_text()
    extras = PROJECT["optional-dependencies"]
    used = [*PROJECT["dependencies"], *(each for name in USED for each in extras[name])]
    for each in used:
        assert re.search(rf"\b{NAME.match(each)[0]}\b", notice), each
