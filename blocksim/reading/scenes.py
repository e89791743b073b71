"""Scenes of the suite (`blocksim suite export`) as what a structure file says."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, cast

from blocksim.blocks.problem import STANDARD_GRAVITY
from blocksim.common.checks import is_number, require

FORMAT = "blocksim scene 1"
LARGEST = 1e12
"""Of masses [kg] and accelerations [m/s^2]."""
SHAPES = {2: "polygons", 3: "polyhedra"}


def is_scene(data: object) -> bool:
    """Tell a scene from a structure file."""
    return isinstance(data, dict) and cast("dict[str, object]", data).get("format") == FORMAT


def read_scene(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return a scene that asks whether blocks stand as a structure file."""
    asked = data.get("question")
    require(asked == "stands", "question", asked, "stands: of motion engines are asked")
    bodies, gravity, pushes = (_list(data, key) for key in ("bodies", "gravity", "pushes"))
    shapes = SHAPES.get(len(gravity), "")
    require(bool(shapes), "gravity", gravity, "two or three numbers")
    for each in gravity:
        require(is_number(each, -LARGEST, LARGEST), "gravity", gravity, "numbers [m/s^2]")
    return {
        "title": data.get("name", ""),
        "friction": data.get("friction"),
        "blocks": [_block(body, f"bodies[{at}]", shapes) for at, body in enumerate(bodies)],
        "dead": [
            {"body": [each / STANDARD_GRAVITY for each in gravity]},
            *(_load(push, f"pushes[{at}]") for at, push in enumerate(pushes)),
        ],
    }


def _list(data: Mapping[str, Any], key: str) -> list[Any]:
    given = data.get(key)
    require(isinstance(given, list), key, given, "a list")
    return cast("list[Any]", given)


def _table(given: object, where: str) -> dict[str, Any]:
    require(isinstance(given, dict), where, given, "a JSON object")
    return cast("dict[str, Any]", given)


def _load(given: object, where: str) -> dict[str, Any]:
    """Return a push as an entry of `dead`."""
    push = _table(given, where)
    return {"block": push.get("body"), "force": push.get("force"), "point": push.get("point")}


def _block(given: object, where: str, shapes: str) -> dict[str, Any]:
    """Return a body as an entry of `blocks`."""
    body = _table(given, where)
    block = {"id": body.get("name"), shapes: body.get(shapes), "fixed": body.get("fixed")}
    if body.get("fixed") is True:
        return block
    mass: Any = body.get("mass")
    require(is_number(mass, 0.0, LARGEST), f"{where}.mass", mass, "a number above 0 [kg]")
    return block | {"weight": mass * STANDARD_GRAVITY, "centre": body.get("centre")}
