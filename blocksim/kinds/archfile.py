"""Files of arches as they were once, with tables `arch` and `contact`, as structure files."""

from __future__ import annotations

import math
from typing import Any, cast

from blocksim.arch.dimensions import friction_of, require_unit_weight
from blocksim.common.checks import FRICTION_ANGLE, LEAN_DEG, require
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.ways import ASIDE, DENSITY, THICK

RENAMED = {"mu": "friction", "specific_weight": "density"}
"""Keys that have other names, besides those that ended in their unit, `_m`."""
PARTS = ("arch", "contact", "gravity", "expect")
"""Tables that there were."""


def as_structure(data: dict[str, Any]) -> dict[str, Any]:
    """Return what a file says as a structure file does, which most of them are already."""
    if not isinstance(data.get("arch"), dict) or {"kind", "blocks"} & data.keys():
        return data
    arch, contact, gravity, expect = (
        cast("dict[str, Any]", each) if isinstance(each := data.get(name), dict) else {}
        for name in PARTS
    )
    said = {**arch, **contact}
    table = {RENAMED.get(name, name.removesuffix("_m")): said[name] for name in said}
    if "unit_weight_kN_per_m3" in table:
        heavy = table.pop("unit_weight_kN_per_m3")
        require_unit_weight("unit_weight_kN_per_m3", heavy)
        allowed = "left out beside specific_weight"
        require("density" not in table, "unit_weight_kN_per_m3", heavy, allowed)
        table["density"] = 1000 * heavy
    if "friction_angle_deg" in table:
        angle = table.pop("friction_angle_deg")
        FRICTION_ANGLE.require("friction_angle_deg", angle)
        require("friction" not in table, "friction_angle_deg", angle, "left out beside mu")
        table["friction"] = friction_of(angle)
    if not THICK & table.keys():
        table["ratio"] = ASIDE
    if gravity:
        LEAN_DEG.require("lean_deg", lean := gravity.get("lean_deg"))
        turn = math.radians(cast("float", lean))
        table["dead"] = [{"body": [0.0, -math.cos(turn), math.sin(turn)]}]
    usual = {"weight": "sector" if "span" in table else "centreline", "density": DENSITY}
    others = {name: data[name] for name in data if name not in PARTS}
    expected = [expect] if expect else []
    return {"kind": CircularArch.name, **usual, **table, **others, "expect": expected}
