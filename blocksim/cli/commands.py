"""The commands that ask a question: check, bracket, simulate, render."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated

import typer

from blocksim.arch.bracket import bracket as ask_bracket
from blocksim.arch.carried import carried_by_arch
from blocksim.arch.check import check as ask_check
from blocksim.arch.circular import arch_of as arch_of_problem
from blocksim.cli.app import app
from blocksim.cli.console import (
    answer_with,
    picture_kind,
    progress,
)
from blocksim.cli.drawing import write_still
from blocksim.cli.filming import (
    HEIGHT,
    MODELS,
    TABLES,
    Beside,
    EngineOption,
    Height,
    RenderOptions,
    Slow,
    Time,
    View,
    export,
    film,
    recordings,
    require_height,
)
from blocksim.cli.groups import grouped
from blocksim.cli.options import (
    EXIT_CODES,
    AtJoint,
    Given,
    Json,
    Loading,
    MethodOption,
    Over,
    Reduce,
    Scene,
    Set,
    Within,
    named_options,
    require_given,
    settings_of,
)
from blocksim.cli.question import arch_of, question, thickness_words
from blocksim.cli.structures import (
    THICKNESS,
    bracket_structure,
    check_structure,
    is_structure,
    joint_of,
    problem_asked,
    problem_of_arch,
    say_recorded,
    simulate_structure,
    spread_structure,
    structure,
)
from blocksim.common.checks import is_number, require
from blocksim.common.files import require_place
from blocksim.engines import ENGINES
from blocksim.report.answers import (
    bracket_lines,
    bracket_record,
    check_lines,
    check_record,
    joint_names_of,
)
from blocksim.report.sizes import bracket_size_lines, bracket_size_record

FILMS = ("mp4", "gif")
LONGEST_RECORDING = 600.0
"""Seconds."""


@app.command()
@grouped
def check(
    given: Given,
    loading: Loading,
    scene: Scene = None,
    method: MethodOption = "auto",
    settings: Set = None,
    joint: AtJoint = None,
    reduce: Reduce = None,
    as_json: Json = False,
) -> None:
    """Tell whether it stands: exit code 0 stands, 1 collapses, 3 undecided."""
    if scene is not None and is_structure(scene):
        require(not reduce, "--reduce", reduce, "left out: it is for arches")
        problem = structure(scene, given, loading)
        check_structure(problem, method, settings, joint, as_json=as_json)
    asked = question(scene, given, thick=True)
    arch = arch_of(asked, given.ratio)
    if loading.given:
        require(not reduce, "--reduce", reduce, "left out with a load or a tilt")
        problem = problem_of_arch(arch, asked, loading)
        check_structure(problem, method, settings, joint, as_json=as_json)
    at_joint = None if joint is None else joint_of(joint, joint_names_of(arch))
    with named_options(), progress() as report:
        answer = ask_check(
            arch,
            mu=asked.mu,
            method=method,
            lean=asked.lean,
            settings=settings_of(settings),
            reduce=reduce,
            progress=report,
        )
    answer = replace(answer, reason=answer.reason + thickness_words(asked, given.ratio))
    at = asked.line and asked.line.at
    told = answer.carried
    if told is not None and at_joint is not None:
        told = carried_by_arch(arch, asked.mu, at_joint)
    answer_with(check_record(answer, told), check_lines(answer, at, told), as_json=as_json)
    raise typer.Exit(EXIT_CODES[answer.verdict])


@app.command()
@grouped
def bracket(
    given: Given,
    loading: Loading,
    scene: Scene = None,
    over: Over = None,
    within: Within = None,
    method: MethodOption = "auto",
    tol: Annotated[float, typer.Option(help="Relative width of the bracket.")] = 0.005,
    settings: Set = None,
    reduce: Reduce = None,
    as_json: Json = False,
) -> None:
    """Find the value of a parameter from which on it falls: how thin an arch can be."""
    if is_structure(scene) or loading.on_road or over not in {None, THICKNESS}:
        require(not reduce, "--reduce", reduce, "left out but for the thickness of arches")
        problem = problem_asked(scene, given, loading, thick=True)
        bracket_structure(problem, over, within, method, tol, settings, as_json=as_json)
        return
    left = {"eta": given.eta, "ratio": given.ratio, **asdict(loading)}
    for name, value in left.items():
        require(value is None, f"--{name}", value, "left out over thickness")
    require(within is None, "--within", within, "left out over thickness")
    asked = question(scene, given)
    with named_options(), progress() as report:
        answer = ask_bracket(
            half_angle=asked.half_angle,
            mu=asked.mu,
            voussoirs=asked.voussoirs,
            weight=asked.weight,
            method=method,
            tol=tol,
            lean=asked.lean,
            depth=asked.depth / asked.radius,
            settings=settings_of(settings),
            reduce=reduce,
            progress=report,
        )
    record = bracket_record(answer, asked.radius) | bracket_size_record(answer, asked)
    lines = bracket_lines(answer) + bracket_size_lines(answer, asked)
    answer_with(record, lines, as_json=as_json)


@app.command()
@grouped
def simulate(
    given: Given,
    loading: Loading,
    out: Annotated[
        Path | None, typer.Option(help="Recording to write, .npz; required.")
    ] = None,
    scene: Scene = None,
    method: Annotated[
        str, typer.Option(help=f"auto, or an engine: {', '.join(ENGINES)}.")
    ] = "auto",
    over: Annotated[
        str | None, typer.Option(help="spread: move the supports until it has fallen.")
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(help="Seconds to record; until decided if left out.")
    ] = None,
    settings: Set = None,
) -> None:
    """Let it go and record its motion."""
    problem = problem_asked(scene, given, loading, thick=True, out=out)
    size = "L" if arch_of_problem(problem) is None else "r"
    out = out or Path()
    require(out.suffix == ".npz", "--out", str(out), "a file name ending in .npz")
    require_place(out)
    if seconds is not None:
        ok = is_number(seconds, 0, LONGEST_RECORDING)
        require(ok, "--seconds", seconds, f"above 0 and at most {LONGEST_RECORDING:g}")
    if over is not None:
        recording = spread_structure(problem, over, method, seconds, settings)
    else:
        recording = simulate_structure(problem, method, seconds, settings)
    recording.save(out)
    say_recorded(out, recording, size)


@app.command()
@grouped
def render(
    given: Given,
    loading: Loading,
    out: Annotated[
        Path | None,
        typer.Option(
            help="File to write: .pdf, .svg, .png or .dxf, .mp4 or .gif, or .glb, .gltf, .csv, "
            ".json of a recording; required."
        ),
    ] = None,
    scene: Annotated[
        str | None,
        typer.Argument(help="Scenario, structure, or a recording: an .npz file."),
    ] = None,
    beside: Beside = None,
    view: View = "2d",
    slow: Slow = None,
    time: Time = None,
    height: Height = None,
    method: EngineOption = None,
) -> None:
    """Draw what is built to scale, or film its motion.

    A sheet (.pdf, .svg, .png, .dxf) has dimensions, supports, lines of least and greatest
    thrust, reactions, and how it falls. Of an arch without a thickness the picture is of the
    continuous arch at its least, with its lines of thrust and friction, in each of its
    collapse modes. Everything else is drawn from a recording: a film, a view in 3d, a frame
    of an .npz file, an animated model (glTF), tables. A scenario is simulated first, 1 % below
    its least thickness where none is given.
    """
    if scene is None:
        question(scene, given, out=out)
    require_given(out=out)
    out = out or Path()
    kind = picture_kind(out, (*FILMS, "png", "svg", "pdf", "dxf", *MODELS, *TABLES))
    if kind in (*MODELS, *TABLES):
        options = {"beside": beside, "slow": slow, "time": time, "height": height}
        for name, value in options.items():
            require(value is None, f"--{name}", value, f"left out of a .{kind}")
        export(out, kind, *recordings(scene, given, loading, method, None))
        return
    filmed = kind in FILMS or view == "3d" or beside is not None
    if filmed or (scene is not None and scene.endswith(".npz")):
        require(kind != "dxf", "--out", str(out), "another kind: a .dxf is of no motion")
        shown = RenderOptions(view=view, slow=slow, time=time, height=height or HEIGHT)
        require(time is None or kind not in FILMS, "--time", time, "left out of a film")
        film(out, recordings(scene, given, loading, method, beside), shown)
    else:
        for name, value in (("slow", slow), ("time", time)):
            require(value is None, f"--{name}", value, "left out: the picture is of no motion")
        if height is not None:
            require(kind == "png", "--height", height, f"left out: a .{kind} has no pixels")
            require_height(height)
        write_still(out, kind, scene, given, loading, method, height)
