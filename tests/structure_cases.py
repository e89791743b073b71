"""The corpus of structures whose answers are known; tests/structures/cases/README.md."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

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
