"""The ways to say which circular arch is meant, and what one of them leaves of another."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from blocksim.common.checks import infinite

ASIDE = 0.99
"""Thickness where none is given, over its least: the arch collapses, in one mode."""
DENSITY = 20_000.0
"""Weight per volume where none is given [N/m^3]."""
SPRINGINGS = "left_deg", "right_deg"
THICK = {"thickness", "eta", "ratio"}
LINE = {"span", "rise", "at"}
ANGLES = {"half_angle", "half_angle_deg", "left_deg", "right_deg"}
"""Parameters each of which says how thick it is, which line was measured, or where it ends."""
FOLLOW = {
    ("span", "rise", "at"): ("radius", "half_angle", "half_angle_deg"),
    ("half_angle_deg",): ("half_angle",),
    ("half_angle",): SPRINGINGS,
    ("ratio",): ("eta", "thickness"),
    ("eta",): ("thickness",),
}
"""What follows from what else may be given."""


def left_by(
    changes: Mapping[str, object],
    table: Mapping[str, Any],
    radius_of: Callable[[dict[str, Any]], float],
) -> dict[str, Any]:
    """Return what a table of a file still says where other values replace some of it.

    `radius_of`: What says the radius of the centreline that a table gives [m].
    """
    left, more = set[str](), dict[str, Any]()
    if THICK & changes.keys():
        left |= THICK
    if LINE & changes.keys():
        left |= {*ANGLES, "radius"}
    elif "span" in table and ANGLES & changes.keys():
        # It is no longer the line that was measured; the centreline stays.
        sized = {*THICK, *LINE, "voussoirs", "weight", "friction"}
        known = {name: infinite(table[name]) for name in table.keys() & sized}
        left, more = left | LINE, {"radius": radius_of(known)}
    return {**{name: table[name] for name in table if name not in left}, **more}


def without_following(
    given: Mapping[str, Any], changes: Mapping[str, object]
) -> dict[str, Any]:
    """Return values of an arch without those that follow from others, which may change."""
    found = dict(given)
    for leading, following in FOLLOW.items():
        if given[leading[0]] is not None:
            left = leading if {*following} & {*changes} else following
            found = {name: value for name, value in found.items() if name not in left}
    return found
