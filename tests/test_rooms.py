"""Rooms know none above them, and no modules import each other in a circle when they run."""

import ast
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

TOP = Path(__file__).parents[1]
LAYERS = tomllib.loads((TOP / "pyproject.toml").read_text(encoding="utf-8"))["tool"][
    "importlinter"
]["contracts"][0]["layers"]
FLOORS = [[room.strip() for room in floor.split("|")] for floor in LAYERS]
ROOMS = [room for floor in FLOORS for room in floor]
PLACES = {
    ".".join(path.relative_to(TOP).with_suffix("").parts).removesuffix(".__init__"): path
    for path in sorted((TOP / "blocksim").rglob("*.py"))
}


@cache
def tree_of(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def above(room: str) -> list[str]:
    """Rooms above one, and beside it."""
    at = next(k for k, floor in enumerate(FLOORS) if room in floor)
    return [each for floor in FLOORS[: at + 1] for each in floor if each != room]


@pytest.mark.parametrize(
    "room",
    [
        pytest.param(
            room, marks=[] if room in {"blocksim.blocks", "blocksim.ask"} else pytest.mark.long
        )
        for room in ROOMS
    ],
)
def test_a_room_loads_none_above_it(room: str) -> None:
    """All modules of a room, in a process of its own."""
    within = [name for name in PLACES if name == room or name.startswith(f"{room}.")]
    code = f"import importlib, sys\nfor name in {within}: importlib.import_module(name)\n"
    done = subprocess.run(
        [sys.executable, "-c", code + "print(*sys.modules)"],
        capture_output=True,
        text=True,
        check=True,
    )
    found = set(done.stdout.split())
    assert set(within) <= found
    assert not found & {*above(room), "blocksim.notebook"}


def test_no_room_names_one_above_it_in_a_text() -> None:
    """Documentation may; what runs does not."""
    told: list[tuple[str, str]] = []
    for name, path in PLACES.items():
        room = ".".join(name.split(".")[:2])
        if room in ROOMS:
            higher = {*above(room), "blocksim.notebook"}
            told += [
                (name, node.value)
                for node in ast.walk(tree_of(path))
                if isinstance(node, ast.Constant)
                and isinstance(node.value, str)
                and any(
                    node.value == each or node.value.startswith(f"{each}.") for each in higher
                )
            ]
    assert told == []


def imported(path: Path) -> Iterator[str]:
    """Modules of blocksim that a file imports when it runs, wherever in it."""
    waiting: list[ast.AST] = [tree_of(path)]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            waiting += node.orelse
            continue
        waiting += ast.iter_child_nodes(node)
        if isinstance(node, ast.Import):
            yield from (each.name for each in node.names if each.name in PLACES)
        elif isinstance(node, ast.ImportFrom) and node.module in PLACES:
            for each in node.names:
                whole = f"{node.module}.{each.name}"
                yield whole if whole in PLACES else node.module


def test_no_modules_import_each_other_in_a_circle() -> None:
    graph = {
        name: {each for each in imported(path) if each not in {name, "blocksim"}}
        for name, path in PLACES.items()
    }
    assert sum(map(len, graph.values())) > 1000
    assert len(list(TopologicalSorter(graph).static_order())) == len(PLACES)
