"""Structures of the corpus as kinds make them: parameters that give the same blocks."""

from __future__ import annotations

import math
from typing import Any

SIDEWAYS = [{"body": [1, 0]}]


def arch(
    kind: str, voussoirs: int, thickness: float | None = None, **more: Any
) -> dict[str, Any]:
    made = {"kind": f"{kind}-arch", "voussoirs": voussoirs, **more}
    return made if thickness is None else {**made, "thickness": thickness}


def chord(voussoirs: int, thickness: float) -> dict[str, Any]:
    return arch("circular", voussoirs, thickness, weight="chord")


def segment(left: float, voussoirs: int, thickness: float, **more: Any) -> dict[str, Any]:
    return arch("circular", voussoirs, thickness, left_deg=left, right_deg=left, **more)


LEAST = {
    "semicircle_27_centreline": arch("circular", 27, weight="centreline"),
    "semicircle_27_chord": arch("circular", 27, weight="chord"),
    "semicircle_27_sector": arch("circular", 27),
    "semicircle_60_sector": arch("circular", 60, joints="radial"),
    "semicircle_40_mu315": arch("circular", 40),
    "semicircle_40_mu35": arch("circular", 40),
    "semicircle_vertical_joints": arch("circular", 100, joints="vertical"),
    "rampant_100_60": arch("circular", 45, left_deg=100, right_deg=60),
    "rampant_75_20": arch("circular", 45, left_deg=75, right_deg=20),
    "rampant_90_45": arch("circular", 45, left_deg=90, right_deg=45),
    "pointed_e0_0": arch("pointed", 60, radius=1.0),
    "pointed_e0_1": arch("pointed", 60, radius=1.1),
    "pointed_e0_25": arch("pointed", 60, radius=1.25),
    "pointed_e0_5": arch("pointed", 60, radius=1.5),
    "pointed_e1_0": arch("pointed", 60, radius=2.0),
    "ellipse_b0_5": arch("elliptic", 60, rise=0.5),
    "ellipse_b0_75": arch("elliptic", 60, rise=0.75),
    "ellipse_b1_5": arch("elliptic", 60, rise=1.5),
    "ellipse_b2_0": arch("elliptic", 60, rise=2.0),
    "parabola_f0_5": arch("parabolic", 60, rise=0.5),
    "parabola_f1_0": arch("parabolic", 60, rise=1.0),
    "parabola_f2_0": arch("parabolic", 60, rise=2.0),
}
"""Of which the least thickness is known: all but the thickness."""

CATENARY = arch("catenary", 60, rise=(math.cosh(2.0) - 1) / 2)

PIERS = {
    "piers_h1_c1": {"kind": "portal", "arch": chord(20, 0.16), "pier_height": 1.0},
    "piers_h2_c1": {"kind": "portal", "arch": chord(20, 0.16), "pier_height": 2.0},
    "piers_h2_c8": {
        "kind": "portal",
        "arch": chord(20, 0.16),
        "pier_height": 2.0,
        "pier_courses": 8,
    },
    "jack_arch_piers": {
        "kind": "portal",
        "arch": arch("flat", 9, 0.4, skew_deg=math.degrees(math.atan(1 / 1.2))),
        "pier_height": 1.5,
    },
}
"""Of which the least width of the piers is known."""

TWO_SPANS = {"kind": "arcade", "arch": chord(16, 0.25)}


def wall(length: float, courses: int, first: float, *openings: tuple[float, ...]) -> Any:
    names = ("left", "right", "from_course", "to_course")
    return {
        "kind": "wall",
        "length": length,
        "courses": courses,
        "block_height": 0.175,
        "first": first,
        "openings": [dict(zip(names, gap, strict=True)) for gap in openings],
        "live": SIDEWAYS,
    }


def point(block: int, where: list[float] | None = None) -> list[dict[str, Any]]:
    """One newton down on a block, at a point or at its centre."""
    at = {} if where is None else {"point": where}
    return [{"block": str(block), "force": [0, -1], **at}]


FACTORS = {
    "oppenheim_7": segment(78.75, 7, 1.5, radius=10.0, live=SIDEWAYS, weight="centreline"),
    "oppenheim_28": segment(78.75, 28, 1.5, radius=10.0, live=SIDEWAYS),
    "oppenheim_56": segment(78.75, 56, 1.5, radius=10.0, live=SIDEWAYS),
    "semicircle_horizontal_15": segment(90, 36, 0.15, live=SIDEWAYS),
    "semicircle_horizontal_20": segment(90, 36, 0.2, live=SIDEWAYS),
    "segmental_horizontal": segment(60, 24, 0.1, live=SIDEWAYS),
    "segmental_horizontal_mu5": segment(60, 24, 0.2, live=SIDEWAYS),
    "rampant_horizontal_right": arch(
        "circular", 45, 0.2, left_deg=90, right_deg=45, live=SIDEWAYS
    ),
    "semicircle_point_crown": segment(90, 25, 0.2, live=point(13, [0, 1.1])),
    "semicircle_point_30": segment(
        90, 24, 0.2, live=point(9, [-0.48651755924090145, 0.9865600156859572])
    ),
    "semicircle_point_45": segment(
        90, 24, 0.2, live=point(7, [-0.7252803966100758, 0.8270237882268752])
    ),
    "segmental_point_quarter": segment(
        45, 30, 0.6, radius=10.0, live=point(8, [-3.941639353360425, 9.515959184866254])
    ),
    "pointed_point": arch("pointed", 24, 0.2, live=point(7)),
    "two_spans_load_b6": {
        **TWO_SPANS,
        "pier_width": 0.6,
        "live": [{"block": "1.13", "force": [0, -1]}],
    },
    "two_spans_load_b9": {
        **TWO_SPANS,
        "pier_width": 0.9,
        "live": [{"block": "1.13", "force": [0, -1]}],
    },
    "two_spans_horizontal_b9": {**TWO_SPANS, "pier_width": 0.9, "live": SIDEWAYS},
    "ferris_tinloi_1": wall(2.0, 6, 0.5),
    "ferris_tinloi_2": wall(2.0, 10, 0.5),
    "ferris_tinloi_3": wall(1.6, 11, 1.0, (0.6, 1.0, 4, 8)),
    "ferris_tinloi_4": wall(2.0, 11, 0.5, (0.4, 0.8, 4, 8), (1.2, 1.6, 4, 8)),
    "ferris_tinloi_5": wall(1.2, 19, 0.5, (0.4, 0.8, 4, 8), (0.4, 0.8, 12, 16)),
    "ferris_tinloi_6": wall(
        2.8,
        21,
        0.5,
        *((left, left + 0.4, low, low + 4) for left in (0.6, 1.8) for low in (5, 13)),
    ),
}
"""Of which a load factor is known, with their loads."""

STACKS = {
    **{
        f"harmonic_{rows}": {"kind": "stack", "rows": rows, "height": 0.25}
        for rows in (3, 5, 10, 20)
    },
    **{
        f"{name}_{rows}": {"kind": "stack", "rows": count, "height": 0.5, "pattern": pattern}
        for name, pattern, rows, count in (
            ("inverted_triangle", "inverted-triangle", 2, 2),
            ("inverted_triangle", "inverted-triangle", 3, 3),
            ("diamond", "diamond", 3, 5),
            ("diamond", "diamond", 4, 7),
            ("diamond", "diamond", 5, 9),
            ("diamond", "diamond", 6, 11),
        )
    },
}
"""That are known to stand or to fall."""
