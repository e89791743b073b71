"""The commands: each asks one question of the library."""

from __future__ import annotations

import math
import platform
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from blocksim import __version__
from blocksim.arch.bracket import bracket as ask_bracket
from blocksim.arch.check import check as ask_check
from blocksim.arch.scenario import load_scenario, shipped
from blocksim.ask.doctor import examine, libraries
from blocksim.cli.console import (
    answer_with,
    chart_table,
    picture_kind,
    progress,
    say,
    show,
    validation_lines,
    validation_table,
)
from blocksim.cli.drawing import write_arch, write_map
from blocksim.cli.filming import (
    HEIGHT,
    At,
    Beside,
    EngineOption,
    Height,
    RenderOptions,
    Slow,
    View,
    film,
    recordings,
)
from blocksim.cli.options import (
    EXIT_CODES,
    Alpha,
    Depth,
    Eta,
    Given,
    Json,
    Lean,
    Load,
    MethodOption,
    Mu,
    Over,
    Ratio,
    Reduce,
    Scene,
    Set,
    Tilt,
    Voussoirs,
    WeightOption,
    Within,
    arch_of,
    named_options,
    question,
    require_given,
    settings_of,
    thickness_words,
)
from blocksim.cli.structures import (
    Loading,
    bracket_structure,
    check_structure,
    draw_structure,
    is_structure,
    loaded,
    say_recorded,
    simulate_structure,
    structure,
)
from blocksim.cli.sweeping import run_sweep
from blocksim.common.checks import is_number, require
from blocksim.common.errors import ALL_MISSING, MISSING, InputError
from blocksim.common.files import make_folder, require_place
from blocksim.engines import ENGINES
from blocksim.report.answers import (
    bracket_lines,
    bracket_record,
    check_lines,
    check_record,
)
from blocksim.studies.chart import cases, measure
from blocksim.studies.validate import USUAL, scenarios, unasked
from blocksim.studies.validate import validate as run_validation

app = typer.Typer(
    name="blocksim",
    invoke_without_command=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

THICKNESS = "thickness"
"""The parameter of `bracket` that is left out: of arches only."""
FILMS = ("mp4", "gif")
NUMBERS = {"alpha", "mu", "n", "eta"}
LONGEST_RECORDING = 600.0
"""Seconds."""


@app.callback()
def start(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    """Answer whether a masonry arch stands, how thin it can be and how it falls."""
    if version:
        say(f"blocksim {__version__}")
        raise typer.Exit
    if context.invoked_subcommand is None:
        say(context.get_help())


@app.command()
def check(
    scene: Scene = None,
    alpha: Alpha = None,
    eta: Eta = None,
    ratio: Ratio = None,
    mu: Mu = None,
    voussoirs: Voussoirs = None,
    weight: WeightOption = None,
    depth: Depth = None,
    method: MethodOption = "auto",
    load: Load = None,
    tilt: Tilt = None,
    lean: Lean = None,
    settings: Set = None,
    reduce: Reduce = False,
    as_json: Json = False,
) -> None:
    """Tell whether it stands: exit code 0 stands, 1 collapses, 3 undecided."""
    given = Given(
        alpha=alpha, eta=eta, ratio=ratio, mu=mu, voussoirs=voussoirs, weight=weight,
        depth=depth, lean=lean,
    )  # fmt: skip
    loading = Loading(load=load, tilt=tilt)
    if scene is not None and is_structure(scene):
        require(not reduce, "--reduce", reduce, "left out: it is for arches")
        problem = structure(scene, given, loading)
        check_structure(problem, method, settings, as_json=as_json)
    asked = question(scene, given, thick=True)
    arch = arch_of(asked, ratio)
    if loading.given:
        require(not reduce, "--reduce", reduce, "left out with a load or a tilt")
        problem = loaded(arch.problem(asked.mu, asked.lean), Given(), loading)
        check_structure(problem, method, settings, as_json=as_json)
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
    answer = replace(answer, reason=answer.reason + thickness_words(asked, ratio))
    answer_with(check_record(answer), check_lines(answer), as_json=as_json)
    raise typer.Exit(EXIT_CODES[answer.verdict])


@app.command()
def bracket(
    scene: Scene = None,
    alpha: Alpha = None,
    mu: Mu = None,
    voussoirs: Voussoirs = None,
    weight: WeightOption = None,
    depth: Depth = None,
    over: Over = None,
    within: Within = None,
    eta: Eta = None,
    ratio: Ratio = None,
    load: Load = None,
    tilt: Tilt = None,
    lean: Lean = None,
    method: MethodOption = "auto",
    tol: Annotated[float, typer.Option(help="Relative width of the bracket.")] = 0.005,
    settings: Set = None,
    reduce: Reduce = False,
    as_json: Json = False,
) -> None:
    """Find the value of a parameter from which on it falls: how thin an arch can be."""
    given = Given(
        alpha=alpha, eta=eta, ratio=ratio, mu=mu, voussoirs=voussoirs, weight=weight,
        depth=depth, lean=lean,
    )  # fmt: skip
    loading = Loading(load=load, tilt=tilt)
    if is_structure(scene) or over not in {None, THICKNESS}:
        require(not reduce, "--reduce", reduce, "left out but for the thickness of arches")
        if scene is not None and is_structure(scene):
            problem = structure(scene, given, loading)
        else:
            asked = question(scene, given, thick=True)
            built = arch_of(asked, ratio).problem(asked.mu, asked.lean)
            problem = loaded(built, Given(), loading)
        bracket_structure(problem, over, within, method, tol, settings, as_json=as_json)
        return
    for name, value in (("eta", eta), ("ratio", ratio), ("load", load), ("tilt", tilt)):
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
    answer_with(bracket_record(answer, asked.radius), bracket_lines(answer), as_json=as_json)


@app.command()
def simulate(
    out: Annotated[
        Path | None, typer.Option(help="Recording to write, .npz; required.")
    ] = None,
    scene: Scene = None,
    alpha: Alpha = None,
    eta: Eta = None,
    ratio: Ratio = None,
    mu: Mu = None,
    voussoirs: Voussoirs = None,
    weight: WeightOption = None,
    depth: Depth = None,
    method: Annotated[
        str, typer.Option(help=f"auto, or an engine: {', '.join(ENGINES)}.")
    ] = "auto",
    seconds: Annotated[
        float | None, typer.Option(help="Seconds to record; until decided if left out.")
    ] = None,
    load: Load = None,
    tilt: Tilt = None,
    lean: Lean = None,
    settings: Set = None,
) -> None:
    """Let it go and record its motion."""
    given = Given(
        alpha=alpha, eta=eta, ratio=ratio, mu=mu, voussoirs=voussoirs, weight=weight,
        depth=depth, lean=lean,
    )  # fmt: skip
    loading = Loading(load=load, tilt=tilt)
    if scene is not None and is_structure(scene):
        require_given(out=out)
        problem, size = structure(scene, given, loading), "L"
    else:
        asked = question(scene, given, thick=True, out=out)
        built = arch_of(asked, ratio).problem(asked.mu, asked.lean)
        problem, size = loaded(built, Given(), loading), "r"
    out = out or Path()
    require(out.suffix == ".npz", "--out", str(out), "a file name ending in .npz")
    require_place(out)
    if seconds is not None:
        ok = is_number(seconds, 0, LONGEST_RECORDING)
        require(ok, "--seconds", seconds, f"above 0 and at most {LONGEST_RECORDING:g}")
    recording = simulate_structure(problem, method, seconds, settings)
    recording.save(out)
    say_recorded(out, recording, size)


@app.command()
def validate(
    quick: Annotated[
        bool, typer.Option("--quick/--full", help="Scenarios marked quick, or all of them.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/validate"),
    methods: Annotated[
        str | None,
        typer.Option(
            help=f"Engines, with commas: {', '.join(ENGINES)}; "
            f"{' and '.join(USUAL)} if left out."
        ),
    ] = None,
    workers: Annotated[int, typer.Option(min=1, max=64, help="Processes.")] = 2,
) -> None:
    """Simulate published arches and hold them against the analytical map."""
    # matplotlib takes a second to import, which other commands need not wait for.
    from blocksim.report.tables import write_results

    engines = None if methods is None else [each.strip() for each in methods.split(",")]
    for each in engines or ():
        require(each in ENGINES, "--methods", each, f"one or more of {', '.join(ENGINES)}")
    make_folder(out)
    chosen = scenarios(quick=quick)
    left_out = unasked(chosen, engines)
    with progress() as report:
        rows = run_validation(chosen, engines, workers=workers, progress=report)
    paths = write_results(rows, out, left_out)
    show(validation_table(rows))
    say("\n".join(validation_lines(rows, left_out)))
    say("wrote " + ", ".join(str(path) for path in paths))


@app.command()
def chart(
    quick: Annotated[
        bool, typer.Option("--quick/--full", help="Two small arches, or five.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/chart"),
    beside: Annotated[
        Path | None, typer.Option(help="Points of another program: JSON like chart.json.")
    ] = None,
) -> None:
    """Chart the error of every method, from coarse to fine, against time and work."""
    # matplotlib takes a second to import, which other commands need not wait for.
    from blocksim.report.chart import read_points, write_chart

    foreign = read_points(beside) if beside else []
    make_folder(out)
    with progress() as report:
        points = measure(cases(quick=quick), quick=quick, progress=report) + foreign
    paths = write_chart(points, out)
    show(chart_table(points))
    say("wrote " + ", ".join(str(path) for path in paths))


@app.command()
def sweep(
    design: Annotated[
        Path | None, typer.Argument(help="Which arches to ask about: a .toml file; required.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for the rows; one that has some is resumed; required."),
    ] = None,
    workers: Annotated[int, typer.Option(min=1, max=256, help="Processes.")] = 2,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a dask scheduler, instead of processes.")
    ] = None,
    parquet: Annotated[
        bool, typer.Option("--parquet", help="Write all rows as a table, too: rows.parquet.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Ask about many arches; a kill at any moment loses nothing that was done."""
    if design is None:
        extra = " and --out" if out is None else ""
        raise InputError(f"DESIGN{extra}", ALL_MISSING if extra else MISSING, "given")
    require_given(out=out)
    run_sweep(design, out or Path(), workers, scheduler, parquet=parquet, as_json=as_json)


@app.command(name="map")
def draw_map(
    out: Annotated[
        Path | None, typer.Option(help="Picture, .svg or .png, or a page, .html; required.")
    ] = None,
    lines: Annotated[
        bool, typer.Option("--lines", help="Dividing lines and lines of equal alpha instead.")
    ] = False,
    zoom: Annotated[
        str, typer.Option(help="whole, central; with --lines: whole, lower, upper.")
    ] = "whole",
    results: Annotated[
        Path | None, typer.Option(help="validate.json of a `validate` run, shown on the page.")
    ] = None,
) -> None:
    """Draw the analytical map of least thickness and collapse modes.

    As a page (.html) it can be explored: any point's arch, its lines of thrust and
    friction, and its collapse.
    """
    require_given(out=out)
    write_map(out or Path(), zoom, results, lines=lines)


@app.command()
def render(
    out: Annotated[
        Path | None, typer.Option(help="File to write: .mp4, .gif, .png or .svg; required.")
    ] = None,
    scene: Annotated[
        str | None, typer.Argument(help="Scenario, or a recording: an .npz file.")
    ] = None,
    alpha: Alpha = None,
    eta: Eta = None,
    ratio: Ratio = None,
    mu: Mu = None,
    voussoirs: Voussoirs = None,
    weight: WeightOption = None,
    depth: Depth = None,
    load: Load = None,
    tilt: Tilt = None,
    lean: Lean = None,
    beside: Beside = None,
    view: View = "2d",
    slow: Slow = None,
    at: At = None,
    height: Height = None,
    method: EngineOption = None,
) -> None:
    """Draw an arch, or film its motion.

    A picture of a scenario shows its lines of thrust and friction and its mechanism: at
    the thickness given, the voussoirs as built; with none given, the continuous arch at its
    least thickness, in each of its collapse modes. Everything else is drawn from a
    recording: a film, a view in 3d, a frame of an .npz file. A scenario is simulated first,
    1 % below its least thickness where none is given.
    """
    given = Given(
        alpha=alpha, eta=eta, ratio=ratio, mu=mu, voussoirs=voussoirs, weight=weight,
        depth=depth, lean=lean,
    )  # fmt: skip
    loading = Loading(load=load, tilt=tilt)
    if scene is None:
        question(scene, given, out=out)
    require_given(out=out)
    out = out or Path()
    kind = picture_kind(out, (*FILMS, "png", "svg"))
    filmed = kind in FILMS or view == "3d" or beside is not None
    if filmed or (scene is not None and scene.endswith(".npz")):
        shown = RenderOptions(view=view, slow=slow, at=at, height=height or HEIGHT)
        require(at is None or kind not in FILMS, "--at", at, "left out of a film")
        film(out, recordings(scene, given, loading, method, beside), shown)
    else:
        shown = {"slow": slow, "at": at, "height": height, "method": method}
        built = scene is not None and is_structure(scene)
        for name, value in shown.items():
            # The picture of a structure shows the answer of a method.
            free = value is None or (built and name == "method")
            require(free, f"--{name}", value, "left out: the picture is of no motion")
        if scene is not None and built:
            problem = structure(scene, given, loading)
            draw_structure(out, kind, problem, method or "auto")
        else:
            require(
                not loading.given, "--load, --tilt", scene, "left out: film it, or use check"
            )
            write_arch(out, kind, scene, given)


@app.command(name="scenarios")
def list_scenarios() -> None:
    """List the scenarios that come with blocksim."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("name", "alpha", "mu", "n", "eta", "title", "source"):
        table.add_column(heading, justify="right" if heading in NUMBERS else "left")
    for name in shipped():
        each = load_scenario(name)
        eta = "-" if each.eta is None else f"{each.eta:g}"
        numbers = f"{math.degrees(each.half_angle):g}", f"{each.mu:.4g}", str(each.voussoirs)
        table.add_row(name, *numbers, eta, each.title, each.source)
    show(table)


@app.command()
def doctor() -> None:
    """Tell what is installed and what each method can do here."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("method", "version", "here", "finest bracket", "sees"):
        table.add_column(heading)
    for finding in examine():
        finest = "exact" if finding.finest == 0 else f"{finding.finest:g}"
        here = finding.remedy or "ready"
        table.add_row(finding.method, finding.version or "-", here, finest, finding.sees)
    show(table)
    say(f"blocksim {__version__}, Python {platform.python_version()}")
    say(", ".join(f"{name} {found or '-'}" for name, found in libraries().items()))
