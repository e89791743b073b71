"""Structures on the command line: files, or kinds by name, asked the same as arches."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import click

from blocksim.arch.asked import Scenario
from blocksim.arch.circular import Arch
from blocksim.arch.dimensions import require_unit_weight
from blocksim.ask.bracket import bracket
from blocksim.ask.check import check
from blocksim.ask.families import families_of, family_of
from blocksim.ask.simulate import simulate
from blocksim.ask.spread import Spreading
from blocksim.blocks.problem import Problem
from blocksim.blocks.shaking import SHAPES, Shaking, read_table
from blocksim.cli.options import (
    EXIT_CODES,
    THICKNESS,
    Given,
    Loading,
    named_options,
    option_of,
    parameters_of,
    require_given,
    settings_of,
)
from blocksim.cli.output import answer_with, progress, say
from blocksim.cli.question import arch_of, joint_of, question
from blocksim.cli.road import under_road
from blocksim.common.checks import is_number, require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.files import read_file, toml_of
from blocksim.evidence.recording import Recording
from blocksim.kinds import KINDS
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.files import (
    changed,
    is_drawing,
    load_structure,
    shipped_structures,
    structure_of,
    weighed,
)
from blocksim.limit.carried import carried_by
from blocksim.report.recordings import recording_lines
from blocksim.report.structures import (
    bracket_lines,
    bracket_record,
    check_lines,
    check_record,
    joint_names,
)

LARGEST_PEEK = 1 << 20
"""Bytes of a TOML file that are looked at to tell a structure from a scenario."""


def is_structure(scene: str | None) -> bool:
    """Tell a structure from a scenario of an arch: by its name, or by what is in the file."""
    if scene in KINDS or scene in shipped_structures():
        return True
    if scene is None:
        return False
    if is_drawing(scene) or scene.lower().endswith(".json"):
        return True
    if not scene.endswith(".toml"):
        return False
    try:
        table = toml_of(read_file(scene, "structure", "a file", LARGEST_PEEK))
    except ValueError:
        return False  # the reader of scenarios says what is wrong with it
    return "blocks" in table or "kind" in table


def problem_asked(
    scene: str | None, given: Given, loading: Loading, *, thick: bool = False, **needed: object
) -> Problem:
    """Return the structure or the arch asked about, and what the options put on it.

    Parameters
    ----------
    scene, given, thick, needed
        As of `question`.
    loading : Loading
    """
    if scene is not None and is_structure(scene):
        require_given(**needed)
        return structure(scene, given, loading)
    asked = question(scene, given, thick=thick, **needed)
    return problem_of_arch(arch_of(asked, given.ratio), asked, loading)


def problem_of_arch(arch: Arch, asked: Scenario, loading: Loading) -> Problem:
    """Return an arch asked about, with what the options put on it."""
    # Fill and loads on the road are borne by a structure, of the arch's kind.
    made = CircularArch.of(arch, friction=asked.mu)
    if loading.on_road:
        made = made.between_supports()
    return loaded(made.problem().leaning(asked.lean), Given(), loading)


def structure(scene: str, given: Given, loading: Loading) -> Problem:
    """Read or make a structure and put on it what the options say.

    Raises
    ------
    InputError
        If the file cannot be used, or an option is one of arches only.
    """
    for name, value in given.of_arches.items():
        allowed = "left out: the file or --with says what is built"
        require(value is None, option_of(name), value, allowed)
    changes = parameters_of(given.parameters)
    heavy = given.unit_weight
    if heavy is not None:
        require_unit_weight("--unit-weight", heavy)
    density = None if heavy is None else 1000 * heavy
    try:
        if scene in KINDS:
            require_given(mu=given.friction)
            # Friction is put on with the loads.
            table = changed({"kind": scene, "friction": 0.0}, changes)
            built = structure_of(table if density is None else weighed(table, density))
        else:
            if is_drawing(scene):
                require_given(mu=given.friction)
            friction = None if given.friction is None else 0.0
            built = load_structure(scene, changes, density, friction=friction)
    except InputError as error:
        name = error.field.partition("[")[0]
        if name not in changes:
            raise
        raise InputError("--with", f"{error.field}={error.value}", error.allowed) from None
    return loaded(built, given, loading)


def loaded(problem: Problem, given: Given, loading: Loading) -> Problem:
    """Put on a problem what the options say: friction, load, tilt, lean."""
    with named_options():
        if given.friction is not None:
            problem = problem.with_friction(given.friction)
        if loading.on_road:
            problem = under_road(problem, loading)
        if loading.load is not None:
            require(bool(problem.live), "--load", loading.load, "left out: no live loads")
            problem = problem.with_load(loading.load)
        if loading.tilt is not None:
            ok = is_number(loading.tilt, -180, 180)
            require(ok, "--tilt", loading.tilt, "above -180 and at most 180 deg")
            problem = problem.tilted(math.radians(loading.tilt))
        if given.lean is not None:
            ok = is_number(given.lean, -90, math.nextafter(90, 0))
            require(ok, "--lean", given.lean, "above -90 and below 90 deg")
            problem = problem.leaning(math.radians(given.lean))
        return replace(problem, shaking=_shaking(problem.shaking, loading))


def _shaking(shaking: Shaking | None, loading: Loading) -> Shaking | None:
    """Shake the ground as the options say, which change what a file says."""
    shape, amplitude, duration = loading.shake, loading.amplitude, loading.duration
    if shape is not None and shape.endswith(".csv"):
        shaking = read_table(shape)
    elif shape is not None:
        shapes = ", ".join(SHAPES)
        require(shape in SHAPES, "--shake", shape, f"one of {shapes}, or a .csv file")
        require_given(amplitude=amplitude, duration=duration)
        shaking = Shaking(shape=shape, amplitude=amplitude or 0.0, duration=duration or 0.0)
    for name, value in (("amplitude", amplitude), ("duration", duration)):
        allowed = "left out, or --shake beside it: the ground is at rest"
        require(value is None or shaking is not None, f"--{name}", value, allowed)
    if shaking is not None and amplitude is not None:
        shaking = shaking.with_amplitude(amplitude)
    if shaking is not None and duration is not None:
        shaking = shaking.with_duration(duration)
    return shaking


def check_problem(
    scene: str | None,
    given: Given,
    loading: Loading,
    method: str,
    settings: list[str] | None,
    joint: str | None,
    *,
    reduce: bool | None,
    must_rest: bool,
    as_json: bool,
) -> None:
    """Answer `check` of a structure, or of an arch that bears loads, and leave.

    Nothing is done where an arch bears its own weight only.
    """
    if scene is not None and is_structure(scene):
        problem = structure(scene, given, loading)
        check_structure(
            problem,
            method,
            settings,
            joint,
            reduce=reduce,
            must_rest=must_rest,
            as_json=as_json,
        )
    if loading.given:
        asked = question(scene, given, thick=True)
        problem = problem_of_arch(arch_of(asked, given.ratio), asked, loading)
        check_structure(
            problem,
            method,
            settings,
            joint,
            reduce=reduce,
            must_rest=must_rest,
            as_json=as_json,
        )


def check_structure(
    problem: Problem,
    method: str,
    settings: list[str] | None,
    joint: str | None = None,
    *,
    reduce: bool | None = None,
    must_rest: bool = False,
    as_json: bool,
) -> None:
    """Answer `check` and leave with its exit code."""
    at = None if joint is None else joint_of(joint, joint_names(problem.assembly))
    with named_options(), progress() as report:
        answer = check(
            problem,
            method=method,
            settings=settings_of(settings),
            reduce=reduce,
            must_rest=must_rest,
            progress=report,
        )
        told = answer.carried
        if at is not None and told is not None:
            report(1.0, "thrust")
            told = carried_by(problem, at)
    answer_with(check_record(answer, told), check_lines(answer, told), as_json=as_json)
    raise click.exceptions.Exit(EXIT_CODES[answer.verdict])


def bracket_problem(
    scene: str | None,
    given: Given,
    loading: Loading,
    over: str | None,
    within: tuple[float, float] | None,
    method: str,
    tol: float,
    settings: list[str] | None,
    *,
    reduce: bool | None,
    as_json: bool,
) -> bool:
    """Answer `bracket` but over the thickness of an arch; tell whether it was answered."""
    if not (is_structure(scene) or loading.on_road or over not in {None, THICKNESS}):
        return False
    problem = problem_asked(scene, given, loading, thick=True)
    bracket_structure(
        problem, over, within, method, tol, settings, reduce=reduce, as_json=as_json
    )
    return True


def bracket_structure(
    problem: Problem,
    over: str | None,
    within: tuple[float, float] | None,
    method: str,
    tol: float,
    settings: list[str] | None,
    *,
    reduce: bool | None = None,
    as_json: bool,
) -> None:
    """Answer `bracket` over any parameter."""
    known = families_of(problem)
    over = over or (THICKNESS if THICKNESS in known else None)
    if over is None:
        raise InputError("--over", MISSING, f"one of {', '.join(known)}")
    with named_options(), progress() as report:
        answer = bracket(
            family_of(problem, over),
            method=method,
            tol=tol,
            within=within,
            settings=settings_of(settings),
            reduce=reduce,
            progress=report,
        )
    answer_with(bracket_record(answer), bracket_lines(answer), as_json=as_json)


def simulate_structure(
    problem: Problem, method: str, seconds: float | None, settings: list[str] | None
) -> Recording:
    """Let a structure go and record it."""
    duration = None
    if seconds is not None:
        duration = seconds / problem.seconds
    with named_options(), progress() as report:
        return simulate(
            problem,
            method=method,
            duration=duration,
            settings=settings_of(settings),
            progress=report,
        )


def spread_structure(
    problem: Problem,
    over: str,
    method: str,
    seconds: float | None,
    settings: list[str] | None,
) -> Recording:
    """Move the supports of a structure until it has fallen, and record it."""
    require(over == "spread", "--over", over, "spread, or left out: nothing else moves slowly")
    require(method in {"auto", "direct"}, "--method", method, "direct: others move no supports")
    require(seconds is None, "--seconds", seconds, "left out: it ends when all has fallen")
    require(settings is None, "--set", settings, "left out where supports move")
    require(problem.shaking is None, "--shake", over, "left out where supports move")
    with named_options(), progress() as report:
        return Spreading(problem).recorded(report)


def say_recorded(out: Path, recording: Recording, unit: str) -> None:
    """Say what was written."""
    first, *others = recording_lines(recording, unit)
    say(f"{out}: {first}", *others)
