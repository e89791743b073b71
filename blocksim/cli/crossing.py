"""What `bracket --vehicle` asks, tells and writes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import BinaryIO

from blocksim.ask.crossing import Crossing, crossing
from blocksim.blocks.problem import Problem
from blocksim.blocks.vehicles import vehicle_of
from blocksim.cli.options import Crossed, named_options
from blocksim.cli.output import answer_with, picture_kind, progress, say
from blocksim.common.checks import require
from blocksim.common.files import write_whole
from blocksim.report.crossing import crossing_lines, crossing_record, write_places

KINDS = ("csv", "pdf", "svg", "png", "dxf")


def cross(
    problem: Problem, crossed: Crossed, usual: Mapping[str, bool], *, as_json: bool
) -> None:
    """Find the worst place of a vehicle, and tell it.

    Parameters
    ----------
    problem : Problem
    crossed : Crossed
    usual : mapping of str to bool
        Options of other searches, and whether they were left out or say nothing else.
    as_json : bool
    """
    for option, ok in usual.items():
        allowed = "left out beside --vehicle: limit analysis searches over its places"
        require(ok, option, "given", allowed)
    files = [(path, picture_kind(path, KINDS)) for path in crossed.out or ()]
    allowed = "given beside --vehicle: blocks have no weight in kN"
    require(problem.weighed, "--unit-weight", "none", allowed)
    with named_options(), progress() as report:
        found = crossing(problem, vehicle_of(crossed.vehicle or ""), progress=report)
    answer_with(crossing_record(found), crossing_lines(found), as_json=as_json)
    for path, kind in files:
        write_whole(path, _writer(found, kind))
        if not as_json:
            say(f"wrote {path}")


def _writer(found: Crossing, kind: str) -> Callable[[BinaryIO], None]:
    """Return what writes a file of a kind."""
    if kind == "csv":
        return lambda file: write_places(found, file)
    # Drawing takes a second to import, which other commands need not wait for.
    if kind == "dxf":
        from blocksim.view.sheet import sheet_of
        from blocksim.view.sheetdxf import write_dxf

        verdict = f"worst place of {found.vehicle.words}"
        sheet = sheet_of(found.problem, verdict=verdict, mechanism=found.mechanism)
        return lambda file: write_dxf(sheet, file)
    from blocksim.view.drawing import save_figure
    from blocksim.view.envelope import envelope_figure

    return lambda file: save_figure(envelope_figure(found), file, kind)
