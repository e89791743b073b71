"""A vehicle that crosses a structure, as text, JSON and a table."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, BinaryIO

from blocksim.blocks.joints import joint_names
from blocksim.blocks.vehicles import axle_words
from blocksim.common.sheets import write_sheet
from blocksim.common.version import __version__
from blocksim.common.words import few, lasting
from blocksim.limit.margins import crown
from blocksim.report.problems import described, problem_record, size_lines

if TYPE_CHECKING:
    from blocksim.ask.crossing import Crossing
    from blocksim.ask.worst import Place
    from blocksim.blocks.vehicles import Vehicle
    from blocksim.report.schema import CrossingRecord, PlaceRecord

SHOWN = 4
"""Axles whose places are said."""


def crossing_lines(answer: Crossing) -> list[str]:
    """Return what a vehicle comes to, in words."""
    problem, worst, vehicle = answer.problem, answer.worst, answer.vehicle
    turned = ", heading left" if worst.heading == "left" else ""
    said = f"least {answer.load_factor:.9g}, with {_axles(worst, vehicle)}{turned}"
    if math.isinf(answer.load_factor):
        said = "inf: nothing that the vehicle weighs is too much"
    lines = [
        f"LOAD FACTOR: {said}  (limit, {lasting(answer.wall_s)})",
        f"  what    {described(problem)}",
        *size_lines(problem),
        f"  vehicle {vehicle.words}",
        f"  bound   at least {answer.low:.9g} everywhere, also between the "
        f"{len(answer.places)} places that were asked",
    ]
    if vehicle.source:
        lines.append(f"  source  {vehicle.source}")
    found = [
        (*ends, at) for ends, at in zip(answer.thrusts, answer.places, strict=True) if ends
    ]
    joint = crown(problem)
    if found and joint is not None:
        least = min(found, key=lambda each: each[0])
        most = max(found, key=lambda each: each[1])
        where = joint_names(problem.assembly)[joint]
        lines.append(
            f"  thrust  at {where}, of all places where it stands: "
            f"least {least[0] / 1e3:.6g} kN "
            f"({_axles(least[2], vehicle)}), greatest {most[1] / 1e3:.6g} kN "
            f"({_axles(most[2], vehicle)})"
        )
    return lines


def _axles(place: Place, vehicle: Vehicle) -> str:
    """Say where each axle stands."""
    weights = (weight for _, weight in vehicle.axles)
    return few(axle_words(zip(place.axles, weights, strict=True), stand=6), SHOWN)


def crossing_record(answer: Crossing) -> CrossingRecord:
    """Return what a vehicle comes to as a dict for JSON."""
    records = _records(answer)
    worst = next(
        record
        for record, place in zip(records, answer.places, strict=True)
        if place is answer.worst
    )
    return {
        "version": __version__,
        "vehicle": answer.vehicle.title,
        "axles": [[place, weight / 1e3] for place, weight in answer.vehicle.axles],
        "source": answer.vehicle.source,
        "low": answer.low,
        "high": answer.load_factor,
        "worst": worst,
        "places": records,
        "problem": problem_record(answer.problem),
        "wall_s": answer.wall_s,
    }


def _records(answer: Crossing) -> list[PlaceRecord]:
    found: list[PlaceRecord] = []
    for place, ends in zip(answer.places, answer.thrusts, strict=True):
        least, most = (None, None) if ends is None else ends
        found.append(
            {
                "heading": "left" if place.heading == "left" else "right",
                "position_m": place.position,
                "axles_m": list(place.axles),
                "load_factor": place.load_factor,
                "thrust_min_kN": None if least is None else least / 1e3,
                "thrust_max_kN": None if most is None else most / 1e3,
            }
        )
    return found


def write_places(answer: Crossing, file: BinaryIO) -> None:
    """Write load factor and thrust at every place as CSV."""
    axles = [f"axle_{index + 1}_m" for index in range(len(answer.vehicle.axles))]
    names = ["heading", "position_m", *axles, "load_factor", "thrust_min_kN", "thrust_max_kN"]
    rows = (
        [told["heading"], told["position_m"], *told["axles_m"], *list(told.values())[3:]]
        for told in _records(answer)
    )
    write_sheet(file, names, rows)
