"""Structures in space on the command line: what is asked, and what is said of it."""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from pathlib import Path

import click

from blocksim.arch.dimensions import require_unit_weight
from blocksim.ask.bracket import bracket
from blocksim.ask.check import check
from blocksim.ask.options import Options
from blocksim.blocks.space.extruded import extruded
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.cli.options import (
    EXIT_CODES,
    Given,
    Loading,
    named_options,
    option_of,
    parameters_of,
    require_given,
)
from blocksim.cli.output import answer_with, save_picture
from blocksim.cli.subject import in_space, problem_asked
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.kinds import SOLID_KINDS
from blocksim.kinds.files import load_in_space
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


def problem_in_space(scene: str | None, given: Given, loading: Loading) -> SpatialProblem:
    """Read or make a structure in space and put on it what the options say.

    One of the plane is asked as prisms; a table then tilts towards the azimuth.

    Raises
    ------
    InputError
        If the file cannot be used, or an option means nothing in space.
    """
    if scene is None or not in_space(scene):
        problem = extruded(
            problem_asked(scene, given, replace(loading, azimuth=None), thick=True)
        )
        return replace(problem, azimuth=math.radians(loading.azimuth or 0.0))
    refuse({**asdict(given), **asdict(loading)}, IN_SPACE | ACTING)
    heavy = given.unit_weight
    if heavy is not None:
        require_unit_weight("--unit-weight", heavy)
    density = None if heavy is None else 1000 * heavy
    if scene in SOLID_KINDS:
        problem = _made(scene, given, density)
    else:
        allowed = "left out: the file has blocks, not a kind"
        require(not given.parameters, "--with", given.parameters, allowed)
        problem = load_in_space(
            scene, density, friction=given.friction, tolerance=given.tolerance
        )
    if given.friction is not None:
        problem = problem.with_friction(given.friction)
    if loading.load is not None:
        require(bool(problem.live), "--load", loading.load, "left out: no live loads")
        problem = problem.with_load(loading.load)
    if loading.azimuth is not None:
        problem = replace(problem, azimuth=math.radians(loading.azimuth))
    return problem if loading.tilt is None else problem.tilted(math.radians(loading.tilt))


def _made(name: str, given: Given, density: float | None) -> SpatialProblem:
    """Make a kind in space, of its parameters."""
    allowed = "left out: a kind of structure has no gaps"
    require(given.tolerance is None, "--tolerance", given.tolerance, allowed)
    require_given(mu=given.friction)
    maker = SOLID_KINDS[name](friction=given.friction, density=density)
    try:
        return maker.but(**parameters_of(given.parameters)).problem()
    except InputError as error:
        said = f"{error.field}={error.value}"
        raise InputError("--with", said, error.allowed) from None


def refuse(options: dict[str, object], known: set[str] = frozenset()) -> None:  # type: ignore[assignment]
    """Refuse options that are given and mean nothing in space."""
    for name, value in options.items():
        unset = value is None or value is False or name in known
        require(unset, option_of(name), value, "left out: it is not known in space")


def draw_in_space(
    out: Path, kind: str, problem: SpatialProblem, others: dict[str, object]
) -> None:
    """Answer the command render: a still in perspective."""
    height = others.pop("height")
    refuse(others)
    allowed = "a .png, .svg or .pdf: there are no films in space"
    require(kind in {"png", "svg", "pdf"}, "--out", str(out), allowed)
    pixels = height if isinstance(height, int) else None
    require(pixels is None or kind == "png", "--height", pixels, "left out of a drawing")
    # Drawing takes a second to import, which other commands need not wait for.
    from blocksim.view.solidfigure import solid_figure

    save_picture(solid_figure(check(problem)), out, kind, pixels)


def check_in_space(
    problem: SpatialProblem, options: Options, others: dict[str, object], *, as_json: bool
) -> None:
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
