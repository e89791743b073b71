"""The map in numbers: as JSON, CSV and text."""

from __future__ import annotations

import math
from collections.abc import Iterator

from blocksim.arch.circular import Weight
from blocksim.arch.maptable import (
    LINES,
    NAMES,
    RATES,
    SPECIAL,
    landmark_points,
    line_points,
    rates_of,
    special_points,
)
from blocksim.arch.modes import Mode
from blocksim.arch.theory import Landmark
from blocksim.common.sheets import sheet_of
from blocksim.common.version import __version__

COLUMNS = ("crown turns", "inner turns", "inner slides", "shoulder turns", "shoulder slides")
"""Words for `RATES`, in their order."""


def map_record(weight: Weight) -> dict[str, object]:
    """Return the map as `map --json` prints it: points, special angles and lines."""
    return {
        "version": __version__,
        "weight": weight,
        "landmarks": [_record(each, weight) for each in landmark_points(weight)],
        "special_angles": [_record(each, weight) for each in special_points(weight)],
        "lines": {
            name: [_record(each, weight) for each in line_points(name, weight)]
            for name in LINES
        },
    }


def _record(point: Landmark, weight: Weight) -> dict[str, object]:
    rates = {str(mode): rates_of(point, mode, weight) for mode in point.modes}
    return {**_numbers(point), "modes": list(point.modes), "rates": rates}


def _numbers(point: Landmark) -> dict[str, object]:
    beta_s = None if point.beta_s is None else math.degrees(point.beta_s)
    return {
        "name": point.name,
        "eta": point.eta,
        "mu": point.mu,
        "friction_angle_deg": math.degrees(math.atan(point.mu)),
        "half_angle_deg": math.degrees(point.half_angle),
        "thrust": point.thrust,
        "beta_r_deg": math.degrees(point.beta_r),
        "beta_s_deg": beta_s,
    }


def map_sheet(weight: Weight) -> bytes:
    """Return the map as CSV: a row for each mode at each point."""
    rows = [
        {
            **_numbers(point),
            "weight": weight,
            "mode": str(mode),
            **rates_of(point, mode, weight),
        }
        for point in _points(weight)
        for mode in point.modes
    ]
    return sheet_of(list(rows[0]), (list(row.values()) for row in rows))


def _points(weight: Weight) -> Iterator[Landmark]:
    yield from landmark_points(weight)
    yield from special_points(weight)
    for name in LINES:
        yield from line_points(name, weight)


def map_lines(weight: Weight) -> list[str]:
    """Return Table 1, the special angles and the rates of modes as text; angles in radians."""
    marks, special = landmark_points(weight), special_points(weight)
    lines = [
        f"TABLE 1  (weight {weight})",
        _row("", [NAMES[each.name] for each in marks], 9, 18),
    ]
    for symbol, values in (
        ("eta", [each.eta for each in marks]),
        ("mu", [each.mu for each in marks]),
        ("alpha", [each.half_angle for each in marks]),
        ("h", [each.thrust for each in marks]),
        ("beta_r", [each.beta_r for each in marks]),
        ("beta_s", [each.beta_s or 0.0 for each in marks]),
    ):
        lines.append(_row(symbol, [f"{value:.14g}" for value in values], 9, 18))
    lines.append(_row("modes", [" ".join(each.modes) for each in marks], 9, 18))
    lines += ["", "SPECIAL ANGLES  (unbounded friction)"]
    lines += [
        f"  {each.name:17}{each.half_angle:<20.16g}{math.degrees(each.half_angle):.2f} deg, "
        f"beta_r {each.beta_r:.16g}, {SPECIAL[each.name]}"
        for each in special
    ]
    lines += ["", "RATES OF MODES  (of a joint of either half; all joints add up to 1)"]
    lines += [_row("", list(words)) for words in zip(*map(str.split, COLUMNS), strict=True)]
    for point in (*marks, *special):
        for mode in point.modes:
            lines.append(_row(f"{point.name} {mode}", _rates(point, mode, weight)))
    lines.append("Sliding is associated: a joint that slides opens by mu times the slip, too.")
    return lines


def _rates(point: Landmark, mode: Mode, weight: Weight) -> list[str]:
    values = rates_of(point, mode, weight)
    return [f"{value:.8f}" if (value := values[f"{a}_{b}"]) else "-" for a, b in RATES]


def _row(name: str, cells: list[str], first: int = 19, width: int = 12) -> str:
    return f"  {name}".ljust(first) + "".join(f"{cell:{width}}" for cell in cells).rstrip()
