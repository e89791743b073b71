"""The corpus of structures whose answers are known; tests/structures/cases/README.md."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

CASES = Path(__file__).parent / "structures" / "cases"
BESIDES = {"expected", "label", "gravity_angle_deg"}
"""Keys of a scene that are not the structure's."""


def case(name: str) -> dict[str, Any]:
    """A case by the name of its file."""
    return json.loads((CASES / f"{name}.json").read_text(encoding="utf-8"))


def names() -> list[str]:
    """All cases."""
    return sorted(path.stem for path in CASES.glob("*.json"))


def scenes(name: str) -> list[dict[str, Any]]:
    """The structures of a case, as structure files have them."""
    read = case(name)
    return [
        {key: value for key, value in scene.items() if key not in BESIDES}
        for scene in read.get("scenes") or [read["scene"]]
    ]


def tipped(name: str) -> dict[str, Any]:
    """The structure of a `rocking` case, its block turned about its lower right corner."""
    (scene,) = scenes(name)
    turned = case(name)["initial"]["rotation"]
    corners = np.array(scene["blocks"][1]["vertices"], dtype=float)
    pivot = np.array([corners[:, 0].max(), 0.0])
    cos, sin = math.cos(-turned), math.sin(-turned)
    corners = (corners - pivot) @ np.array([[cos, sin], [-sin, cos]]) + pivot
    scene["blocks"][1]["vertices"] = corners.tolist()
    return scene
