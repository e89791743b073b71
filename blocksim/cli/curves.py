"""Files of `bracket`: what is borne as blocks move, and as a vehicle crosses."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from blocksim.ask.crossing import crossing
from blocksim.blocks.problem import Problem
from blocksim.blocks.vehicles import vehicle_of
from blocksim.cli.acting import Crossed
from blocksim.cli.options import named_options
from blocksim.cli.output import answer_with, picture_kind, progress, write_files
from blocksim.common.checks import require
from blocksim.common.sheets import write_sheet
from blocksim.report.crossing import crossing_lines, crossing_record, write_places

if TYPE_CHECKING:
    from matplotlib.figure import Figure

KINDS = ("csv", "pdf", "svg", "png")
OVER = ("push", "spread")
"""Searches that move blocks."""


def require_curves(over: str | None, out: Sequence[Path] | None) -> None:
    """Raise `InputError` unless files can be written of what is searched over."""
    if out is not None:
        allowed = "left out, or --vehicle, --over push or --over spread beside it"
        require(over in OVER, "--out", str(out[0]), allowed)
    for path in out or ():
        picture_kind(path, KINDS)


def write_curves(problem: Problem, over: str, out: Sequence[Path], *, silent: bool) -> None:
    """Write tables and pictures of what is borne as it moves."""
    from blocksim.view.curvefigure import Line, curve_figure
    from blocksim.view.sheet import title_of
    from blocksim.view.style import THRUST

    title = title_of(problem)
    if over == "push":
        from blocksim.ask.push import WAYS, curve

        found = [curve(problem, way) for way in WAYS]
        names = ["way", "moved_m", "push_g"]
        rows = [
            [each.way, moved, push]
            for each in found
            for moved, push in zip(each.moved, each.pushes, strict=True)
        ]
        words = f"{title}: push that is borne as the first mechanism moves"
        lines = [Line(f"to the {each.way}", each.moved, each.pushes) for each in found]
        axes = "way of the centre of mass [m]", "push over weight [g]"
    else:
        from blocksim.ask.moved import thrusts_over

        points = thrusts_over(problem)
        names = ["spread_m", "thrust_min_kN", "thrust_max_kN"]
        rows = [
            [value, *(None if math.isnan(each) else each / 1e3 for each in ends)]
            for value, *ends in points
        ]
        words = f"{title}: thrust at the crown as the supports move apart, until it falls"
        way = [each[0] for each in points]
        lines = [
            Line(name, way, [each[place] / 1e3 for each in points], THRUST)
            for name, place in (("least thrust", 1), ("greatest thrust", 2))
        ]
        axes = "way of the supports [m]", "thrust [kN]"
    tables = {"csv": partial(write_sheet, names=names, rows=rows)}
    write_files(out, tables, lambda: curve_figure(words, *axes, lines), silent=silent)


def cross(
    problem: Problem, crossed: Crossed, usual: Mapping[str, bool], *, as_json: bool
) -> None:
    """Find the worst place of a vehicle, and tell it.

    `usual`: Options of other searches, and whether they were left out or say nothing else.
    """
    for option, ok in usual.items():
        allowed = "left out beside --vehicle: limit analysis searches over its places"
        require(ok, option, "given", allowed)
    for path in crossed.out or ():
        picture_kind(path, (*KINDS, "dxf"))
    allowed = "given beside --vehicle: blocks have no weight in kN"
    require(problem.weighed, "--unit-weight", "none", allowed)
    with named_options(), progress() as report:
        found = crossing(problem, vehicle_of(crossed.vehicle or ""), progress=report)
    answer_with(lambda: crossing_record(found), lambda: crossing_lines(found), as_json=as_json)

    def draw(file: BinaryIO) -> None:
        from blocksim.view.sheet import sheet_of
        from blocksim.view.sheetdxf import write_dxf

        verdict = f"worst place of {found.vehicle.words}"
        sheet = sheet_of(found.problem, verdict=verdict, mechanism=found.mechanism)
        write_dxf(sheet, file)

    def figure() -> Figure:
        from blocksim.view.curvefigure import envelope_figure

        return envelope_figure(found)

    tables = {"csv": partial(write_places, found), "dxf": draw}
    write_files(crossed.out or (), tables, figure, silent=as_json)
