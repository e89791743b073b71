"""The commands check and bracket, and the files of bracket."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import click

from blocksim.ask.bracket import Bracket
from blocksim.ask.bracket import bracket as ask_bracket
from blocksim.ask.check import check as ask_check
from blocksim.ask.crossing import crossing
from blocksim.ask.options import Options
from blocksim.blocks.joints import joint_names
from blocksim.blocks.problem import Problem
from blocksim.blocks.vehicles import vehicle_of
from blocksim.cli.arguments import option
from blocksim.cli.given import Crossed, given_of
from blocksim.cli.options import (
    CASES,
    EXIT_CODES,
    JOINT,
    JSON,
    METHOD,
    MUST_REST,
    OVER,
    PROOF,
    REDUCE,
    SET,
    SPATIAL,
    THICKNESS,
    WITHIN,
    named_options,
    refuse,
    settings_of,
)
from blocksim.cli.output import CURVES, answer_with, picture_kind, progress, write_files
from blocksim.cli.proving import write_proof
from blocksim.cli.subject import Subject, anything_asked
from blocksim.common.checks import require
from blocksim.common.sheets import write_sheet
from blocksim.report.answers import bracket_record, check_record
from blocksim.report.answerwords import bracket_lines, check_lines
from blocksim.report.cases import cases_lines, cases_record
from blocksim.report.crossing import crossing_lines, crossing_record, write_places

if TYPE_CHECKING:
    from matplotlib.figure import Figure

OF_ONE = "left out beside --cases: it is of one case"
MOVING = ("push", "spread")
"""Searches that move blocks."""


def check(
    asked: Subject,
    method: str = METHOD,
    settings: list[str] | None = SET,
    joint: str | None = JOINT,
    reduce: bool | None = REDUCE,
    must_rest: bool = MUST_REST,
    spatial: bool = SPATIAL,
    proof: Path | None = PROOF,
    cases: Path | None = CASES,
    as_json: bool = JSON,
) -> None:
    """Tell whether it stands: exit code 0 stands, 1 collapses, 3 undecided.

    Of a folder of structures, or of JSON lines on standard input (-), a line of JSON for each,
    by limit analysis. Of --cases, a table with the governing case first, whose exit code it is.
    """
    how = Options(method=method, settings=settings_of(settings), reduce=reduce)
    if cases is not None:
        from blocksim.cli.many import asked_of_cases

        refuse({"joint": joint, "must_rest": must_rest, "proof": proof}, why=OF_ONE)
        told = asked_of_cases(cases, asked, how, spatial=spatial)
        answer_with(cases_record, cases_lines, told, as_json=as_json)
        raise click.exceptions.Exit(EXIT_CODES[told.governing.answer.verdict])
    if asked.is_many:
        from blocksim.cli.many import check_each

        alone: dict[str, object] = {
            "method": None if method in {"auto", "limit"} else method,
            "set": settings, "joint": joint, "reduce": reduce, "must_rest": must_rest,
            "spatial": spatial, "proof": proof,
        }  # fmt: skip
        check_each(asked, alone)
    problem = anything_asked(asked, spatial=spatial, thick=True)
    if problem.in_space:
        refuse({"joint": joint, "must_rest": must_rest})
    at = _place_of(joint, problem)
    with named_options(), progress() as report:
        answer = ask_check(problem, must_rest=must_rest, **{**how, "progress": report})
        if at is not None:
            report(1.0, "thrust")
        carried = answer.carried if at is None else answer.carried_at(at)
    write_proof(answer.method, () if answer.proof is None else (answer.proof,), proof)
    answer_with(check_record, check_lines, answer, carried, as_json=as_json)
    raise click.exceptions.Exit(EXIT_CODES[answer.verdict])


def _place_of(joint: str | None, problem: Problem) -> int | None:
    """Return the place of a joint that is named by its two blocks, or None."""
    if joint is None:
        return None
    names = joint_names(problem.assembly)
    require(joint in names, "--joint", joint, f"one like {names[len(names) // 2]}")
    return names.index(joint)


def bracket(
    asked: Subject,
    crossed: Crossed,
    over: str | None = OVER,
    within: tuple[float, float] | None = WITHIN,
    method: str = METHOD,
    tol: float = option("Relative width of the bracket.", default=0.005),
    settings: list[str] | None = SET,
    reduce: bool | None = REDUCE,
    spatial: bool = SPATIAL,
    proof: Path | None = PROOF,
    as_json: bool = JSON,
) -> None:
    """Find where it starts to fall as one parameter changes: how thin an arch can be.

    Of a vehicle that crosses it is the least load factor, and where it stands then.
    """
    crosses, given, loading = crossed.vehicle is not None, asked.given, asked.loading
    if not crosses:
        allowed = "left out, or --vehicle beside it"
        require(crossed.along is None, "--along", crossed.along, allowed)
        require_curves(over, crossed.out)
    of_arch = over in {None, THICKNESS} and asked.scene is None
    # The thickness of an arch under its own weight need not be given to be sought.
    sought = of_arch and not (crosses or spatial or loading.given)
    if sought:
        refuse({"eta": given.eta, "ratio": given.ratio}, why="left out: the least is sought")
    acting = {"lean": given.lean, **given_of(loading, "load", "push", "spread", "tilt")}
    refuse(
        {name: acting[name] for name in acting if name == over}, why="left out: it is sought"
    )
    push = loading.push
    allowed = "left out beside --vehicle"
    require(push is None or not crosses, "--push", push, allowed)
    unpushed = replace(asked, loading=replace(loading, push=None))
    problem = anything_asked(
        unpushed, spatial=spatial, tilts=over == "tilt",
        pushes=over == "push" or push is not None, thick=not sought, sought=sought,
    )  # fmt: skip
    if problem.in_space:
        refuse(asdict(crossed))
    elif crosses:
        usual = {"--over": over in {None, "load"}, "--within": within is None,
                 "--method": method in {"auto", "limit"}, "--set": settings is None,
                 "--reduce": reduce is None}  # fmt: skip
        cross(problem, crossed, usual, as_json=as_json)
        return
    with named_options(), progress() as report:
        how = Options(method=method, tol=tol, settings=settings_of(settings), reduce=reduce)
        answer = _answer(problem, push, over, within, {**how, "progress": report})
    write_proof(answer.method, () if proof is None else answer.proofs, proof)
    if crossed.out is not None and not problem.in_space:
        write_curves(problem, answer.over, crossed.out, silent=as_json)
    answer_with(bracket_record, bracket_lines, answer, as_json=as_json)


def _answer(
    problem: Problem,
    push: float | None,
    over: str | None,
    within: tuple[float, float] | None,
    options: Options,
) -> Bracket[Any]:
    """Search, with a push to either side and for where it falls first if there is one."""
    if push is None:
        return ask_bracket(problem, over=over, within=within, **options)
    from blocksim.ask.push import first_to_fall, pushed_each_way

    ways = pushed_each_way(problem, push)
    found = [ask_bracket(each, over=over, within=within, **options) for each in ways]
    return first_to_fall(found)


def require_curves(over: str | None, out: Sequence[Path] | None) -> None:
    """Raise `InputError` unless files can be written of what is searched over."""
    if out is not None:
        allowed = "left out, or --vehicle, --over push or --over spread beside it"
        require(over in MOVING, "--out", str(out[0]), allowed)
    for path in out or ():
        picture_kind(path, CURVES)


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
    for name, ok in usual.items():
        allowed = "left out beside --vehicle: limit analysis searches over its places"
        require(ok, name, "given", allowed)
    for path in crossed.out or ():
        picture_kind(path, (*CURVES, "dxf"))
    allowed = "given beside --vehicle: blocks have no weight in kN"
    require(problem.weighed, "--unit-weight", "none", allowed)
    with named_options(), progress() as report:
        found = crossing(problem, vehicle_of(crossed.vehicle or ""), progress=report)
    answer_with(crossing_record, crossing_lines, found, as_json=as_json)

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
