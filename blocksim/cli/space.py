"""Structures in space on the command line: what is asked, and what is said of it."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import NoReturn

import click

from blocksim.ask.bracket import bracket
from blocksim.ask.check import check
from blocksim.ask.options import Options
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.cli.options import (
    EXIT_CODES,
    Given,
    Loading,
    named_options,
    option_of,
)
from blocksim.cli.output import answer_with, save_picture, say
from blocksim.common.checks import require
from blocksim.common.files import write_whole
from blocksim.report.space import (
    bracket_in_space_lines,
    bracket_in_space_record,
    check_in_space_lines,
    check_in_space_record,
)

IN_SPACE = {"parameters", "mu", "friction_angle", "unit_weight", "tolerance"}
"""Options on what is built that mean something in space."""
ACTING = {"load", "tilt", "azimuth"}
"""The same of what acts on it."""


def loaded_in_space(problem: SpatialProblem, given: Given, loading: Loading) -> SpatialProblem:
    """Put on a problem in space what the options say.

    Raises
    ------
    InputError
        If an option means nothing in space.
    """
    refuse({**asdict(given), **asdict(loading)}, IN_SPACE | ACTING)
    if given.friction is not None:
        problem = problem.with_friction(given.friction)
    if loading.load is not None:
        require(bool(problem.live), "--load", loading.load, "left out: no live loads")
        problem = problem.with_load(loading.load)
    problem = replace(problem, azimuth=math.radians(loading.azimuth or 0.0))
    return problem if loading.tilt is None else problem.tilted(math.radians(loading.tilt))


def refuse(options: Mapping[str, object], known: Collection[str] = ()) -> None:
    """Refuse options that are given and mean nothing in space."""
    for name, value in options.items():
        unset = value is None or value is False or name in known
        require(unset, option_of(name), value, "left out: it is not known in space")


def draw_in_space(
    out: Path, kind: str, problem: SpatialProblem, method: str | None, height: int | None
) -> None:
    """Answer the command render: a still in perspective, or a page to turn it around."""
    allowed = "a .png, .svg or .pdf: it is drawn in perspective; or .html, to turn it around"
    require(kind in {"png", "svg", "pdf", "html"}, "--out", str(out), allowed)
    # Drawing takes a second to import, which other commands need not wait for.
    from blocksim.view.solidfigure import solid_figure

    with named_options():
        answer = check(problem, method=method or "auto")
    if kind == "html":
        from blocksim.view.turning import turning_page

        text = turning_page(answer).encode()
        write_whole(out, lambda file: file.write(text))
        say(f"wrote {out}: a page to turn it around")
        return
    save_picture(solid_figure(answer), out, kind, height)


def check_in_space(
    problem: SpatialProblem, options: Options, others: dict[str, object], *, as_json: bool
) -> NoReturn:
    """Answer the command check."""
    refuse(others)
    with named_options():
        answer = check(problem, **options)
    lines = [] if as_json else check_in_space_lines(answer)
    answer_with(check_in_space_record(answer), lines, as_json=as_json)
    raise click.exceptions.Exit(EXIT_CODES[answer.verdict])


def bracket_in_space(
    problem: SpatialProblem,
    over: str | None,
    options: Options,
    others: dict[str, object],
    *,
    as_json: bool,
) -> None:
    """Answer the command bracket."""
    refuse(others)
    with named_options():
        answer = bracket(problem, over=over, **options)
    lines = [] if as_json else bracket_in_space_lines(answer)
    answer_with(bracket_in_space_record(answer), lines, as_json=as_json)
