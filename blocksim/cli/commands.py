"""The commands: each asks one question of the library."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from blocksim.arch.bracket import bracket as ask_bracket
from blocksim.arch.check import check as ask_check
from blocksim.arch.circular import GRAVITY
from blocksim.arch.motion import simulate as record_motion
from blocksim.arch.scenario import load_scenario, shipped
from blocksim.ask.doctor import examine
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
    At,
    Beside,
    EngineOption,
    Given,
    Height,
    RenderOptions,
    Slow,
    View,
    film,
    recordings,
)
from blocksim.cli.options import (
    Alpha,
    Eta,
    Json,
    Lean,
    MethodOption,
    Mu,
    Reduce,
    Scene,
    Set,
    Voussoirs,
    WeightOption,
    arch_of,
    named_options,
    question,
    settings_of,
)
from blocksim.cli.sweeping import run_sweep
from blocksim.common.checks import is_number, require
from blocksim.common.files import make_folder, require_place
from blocksim.engines import ENGINES
from blocksim.evidence.verdict import Verdict
from blocksim.report.answers import (
    bracket_lines,
    bracket_record,
    check_lines,
    check_record,
)
from blocksim.studies.chart import cases, measure
from blocksim.studies.validate import scenarios
from blocksim.studies.validate import validate as run_validation

app = typer.Typer(
    name="blocksim",
    help="Does a masonry arch stand, how thin can it be, how does it fall?",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

EXIT_CODES = {Verdict.STANDS: 0, Verdict.COLLAPSES: 1, Verdict.UNDECIDED: 3}
FILMS = ("mp4", "gif")
LONGEST_RECORDING = 600.0
"""Seconds."""


@app.command()
def check(
    scene: Scene = None,
    alpha: Alpha = None,
    eta: Eta = None,
    mu: Mu = None,
    voussoirs: Voussoirs = None,
    weight: WeightOption = None,
    method: MethodOption = "auto",
    lean: Lean = None,
    settings: Set = None,
    reduce: Reduce = False,
    as_json: Json = False,
) -> None:
    """Tell whether an arch stands: exit code 0 stands, 1 collapses, 3 undecided."""
    asked = question(scene, alpha, mu, voussoirs, weight, lean)
    arch = arch_of(asked, eta)
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
    answer_with(check_record(answer), check_lines(answer), as_json=as_json)
    raise typer.Exit(EXIT_CODES[answer.verdict])


@app.command()
def bracket(
    scene: Scene = None,
    alpha: Alpha = None,
    mu: Mu = None,
    voussoirs: Voussoirs = None,
    weight: WeightOption = None,
    method: MethodOption = "auto",
    tol: Annotated[float, typer.Option(help="Relative width of the bracket.")] = 0.005,
    settings: Set = None,
    reduce: Reduce = False,
    as_json: Json = False,
) -> None:
    """Find how thin the arch can be."""
    asked = question(scene, alpha, mu, voussoirs, weight)
    with named_options(), progress() as report:
        answer = ask_bracket(
            half_angle=asked.half_angle,
            mu=asked.mu,
            voussoirs=asked.voussoirs,
            weight=asked.weight,
            method=method,
            tol=tol,
            settings=settings_of(settings),
            reduce=reduce,
            progress=report,
        )
    answer_with(bracket_record(answer), bracket_lines(answer), as_json=as_json)


@app.command()
def simulate(
    out: Annotated[Path, typer.Option(help="Recording to write, .npz.")],
    scene: Scene = None,
    alpha: Alpha = None,
    eta: Eta = None,
    mu: Mu = None,
    voussoirs: Voussoirs = None,
    weight: WeightOption = None,
    method: Annotated[
        str, typer.Option(help=f"auto, or an engine: {', '.join(ENGINES)}.")
    ] = "pymunk",
    seconds: Annotated[
        float | None, typer.Option(help="Seconds to record; until decided if left out.")
    ] = None,
    lean: Lean = None,
    settings: Set = None,
) -> None:
    """Let an arch go and record its motion."""
    asked = question(scene, alpha, mu, voussoirs, weight, lean)
    arch = arch_of(asked, eta)
    require(out.suffix == ".npz", "--out", str(out), "a file name ending in .npz")
    require_place(out)
    duration = None
    if seconds is not None:
        ok = is_number(seconds, 0, LONGEST_RECORDING)
        require(ok, "--seconds", seconds, f"above 0 and at most {LONGEST_RECORDING:g}")
        duration = seconds / math.sqrt(arch.radius / GRAVITY)
    with named_options(), progress() as report:
        recording = record_motion(
            arch,
            mu=asked.mu,
            method=method,
            duration=duration,
            lean=asked.lean,
            settings=settings_of(settings),
            progress=report,
        )
    recording.save(out)
    moved = recording.displacement[-1]
    say(
        f"{out}: {len(recording.times)} frames, {recording.seconds(GRAVITY)[-1]:.2f} s, "
        f"moved {moved:.2g} r, state {recording.state_hash}"
    )


@app.command()
def validate(
    quick: Annotated[
        bool, typer.Option("--quick/--full", help="Scenarios marked quick, or all of them.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/validate"),
    workers: Annotated[int, typer.Option(min=1, max=64, help="Processes.")] = 2,
) -> None:
    """Simulate published arches and hold them against the analytical map."""
    # matplotlib takes a second to import, which other commands need not wait for.
    from blocksim.report.tables import write_results

    make_folder(out)
    chosen = scenarios(quick=quick)
    with progress() as report:
        rows = run_validation(chosen, workers=workers, progress=report)
    paths = write_results(rows, out)
    show(validation_table(rows))
    say("\n".join(validation_lines(rows)))
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
    design: Annotated[Path, typer.Argument(help="Which arches to ask about: a .toml file.")],
    out: Annotated[
        Path, typer.Option(help="Folder for the rows; one that has some is resumed.")
    ],
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
    run_sweep(design, out, workers, scheduler, parquet=parquet, as_json=as_json)


@app.command(name="map")
def draw_map(
    out: Annotated[Path, typer.Option(help="Picture, .svg or .png, or a page, .html.")],
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
    write_map(out, zoom, results, lines=lines)


@app.command()
def render(
    out: Annotated[Path, typer.Option(help="File to write: .mp4, .gif, .png or .svg.")],
    scene: Annotated[
        str | None, typer.Argument(help="Scenario, or a recording: an .npz file.")
    ] = None,
    alpha: Alpha = None,
    eta: Eta = None,
    mu: Mu = None,
    voussoirs: Voussoirs = None,
    weight: WeightOption = None,
    beside: Beside = None,
    view: View = "2d",
    slow: Slow = None,
    at: At = None,
    height: Height = 720,
    method: EngineOption = None,
) -> None:
    """Draw an arch, or film its motion.

    A picture of a scenario shows its lines of thrust and friction and its mechanism: at
    the thickness given, the voussoirs as built; with none given, the continuous arch at its
    least thickness, in each of its collapse modes. Everything else is drawn from a
    recording: a film, a view in 3d, a frame of an .npz file. A scenario is simulated first,
    1 % below its least thickness where none is given.
    """
    kind = picture_kind(out, (*FILMS, "png", "svg"))
    given = Given(alpha, eta, mu, voussoirs, weight)
    filmed = kind in FILMS or view == "3d" or beside is not None
    if filmed or (scene is not None and scene.endswith(".npz")):
        shown = RenderOptions(view=view, slow=slow, at=at, height=height)
        require(at is None or kind not in FILMS, "--at", at, "left out of a film")
        film(out, recordings(scene, given, method, beside), shown)
    else:
        for name, value in (("slow", slow), ("at", at), ("method", method)):
            require(value is None, f"--{name}", value, "left out: the picture is of no motion")
        write_arch(out, kind, scene, given)


@app.command(name="scenarios")
def list_scenarios() -> None:
    """List the scenarios that come with blocksim."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("name", "title", "source"):
        table.add_column(heading)
    for name in shipped():
        scenario = load_scenario(name)
        table.add_row(name, scenario.title, scenario.source)
    show(table)


@app.command()
def doctor() -> None:
    """Tell what is installed and what each method can do here."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("method", "here", "finest bracket", "sees"):
        table.add_column(heading)
    for finding in examine():
        finest = "exact" if finding.finest == 0 else f"{finding.finest:g}"
        table.add_row(finding.method, finding.remedy or "ready", finest, finding.sees)
    show(table)
