"""The corpus of structures whose answers are known; tests/structures/cases/README.md."""

import json
import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

CASES = Path(__file__).parent / "structures" / "cases"
BESIDES = {"expected", "label", "gravity_angle_deg"}
"""Keys of a scene that are not the structure's."""


def _read(name: str) -> dict[str, Any]:
    return json.loads((CASES / f"{name}.json").read_text(encoding="utf-8"))


case = cache(_read)
"""A case by the name of its file, to be read only."""


@cache
def names() -> list[str]:
    """All cases."""
    return sorted(path.stem for path in CASES.glob("*.json"))


def of_each_kind(found: Iterable[str]) -> list[Any]:
    """Cases of which those are long that have an earlier one's name but for numbers in it."""
    kinds = set[str]()
    params = list[Any]()
    for name in found:
        kind = re.sub(r"\d+", "", name)
        params.append(pytest.param(name, marks=[pytest.mark.long] if kind in kinds else []))
        kinds.add(kind)
    return params


def some_of(found: Iterable[Any], every: int = 3) -> list[Any]:
    """Cases of which one in so many is in the usual run, and the others are long."""
    return [
        pytest.param(name, marks=[pytest.mark.long] if at % every else [])
        for at, name in enumerate(found)
    ]


def scenes(name: str) -> list[dict[str, Any]]:
    """The structures of a case, as structure files have them."""
    read = _read(name)
    return [
        {key: value for key, value in scene.items() if key not in BESIDES}
        for scene in read.get("scenes") or [read["scene"]]
    ]


def first(name: str) -> dict[str, Any]:
    """The first structure of a case, to be read only."""
    read = case(name)
    return (read.get("scenes") or [read["scene"]])[0]
