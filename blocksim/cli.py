"""The command line: options to questions, answers to text."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from blocksim.arch import GRAVITY, Arch, is_number, require
from blocksim.bracket import bracket as ask_bracket
from blocksim.check import check as ask_check
from blocksim.doctor import examine
from blocksim.engines import ENGINES
from blocksim.errors import MISSING, BlocksimError, InputError
from blocksim.files import make_folder, write_whole
from blocksim.ladder import CHOICES
from blocksim.progress import Progress as Report
from blocksim.report.answers import (
    bracket_lines,
    bracket_record,
    check_lines,
    check_record,
    ratio,
)
from blocksim.scenario import Scenario, load_scenario, shipped
from blocksim.theory import least_thickness
from blocksim.trial import simulate as record_motion
from blocksim.validate import Row, scenarios
from blocksim.validate import validate as run_validation
from blocksim.verdict import Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

app = typer.Typer(
    name="blocksim",
    help="Does a masonry arch stand, how thin can it be, how does it fall?",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

EXIT_CODES = {Verdict.STANDS: 0, Verdict.COLLAPSES: 1, Verdict.UNDECIDED: 3}
WRONG_INPUT = 2
INTERRUPTED = 130
WIDE = 128
"""Characters in a line of the widest table."""
LONGEST_RECORDING = 600.0
"""Seconds."""

Scene = Annotated[str | None, typer.Argument(help="Scenario: a .toml file or a shipped name.")]
Alpha = Annotated[float | None, typer.Option(help="Half-angle of embrace [deg], 0 to 180.")]
Eta = Annotated[float | None, typer.Option(help="Thickness-to-radius ratio, up to 2.")]
Mu = Annotated[float | None, typer.Option(help="Friction coefficient, above 0; inf allowed.")]
Voussoirs = Annotated[int | None, typer.Option(help="Number of voussoirs, 3 to 1000 [27].")]
WeightOption = Annotated[
    str | None, typer.Option(help="Where weight acts: centreline or sector [centreline].")
]
MethodOption = Annotated[str, typer.Option(help=f"{', '.join(CHOICES)}.")]
Picture = Annotated[Path, typer.Option("--out", help="Picture to write, .svg or .png.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object, nothing else.")]


def main() -> None:
    """Run the command line; wrong input is one line and exit code 2."""
    try:
        code = app(standalone_mode=False)
    except BlocksimError as error:
        _fail(str(error))
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(INTERRUPTED)
    except Exception as error:
        # Typer's own complaints about options carry a message for people.
        message = getattr(error, "format_message", None)
        if message is None:
            raise
        _fail(" ".join(str(message()).split()))
    else:
        sys.exit(code or 0)


def _fail(message: str) -> NoReturn:
    print(f"blocksim: {message}", file=sys.stderr)  # noqa: T201
    sys.exit(WRONG_INPUT)


@app.command()
def check(
    scene: Scene = None,
    alpha: Alpha = None,
    eta: Eta = None,
    mu: Mu = None,
    voussoirs: Voussoirs = None,
    weight: WeightOption = None,
    method: MethodOption = "auto",
    as_json: Json = False,
) -> None:
    """Tell whether an arch stands: exit code 0 stands, 1 collapses, 3 undecided."""
    arch, friction = _arch(scene, alpha, eta, mu, voussoirs, weight)
    with _options(), _progress() as report:
        answer = ask_check(arch, mu=friction, method=method, progress=report)
    _print(check_record(answer), check_lines(answer), as_json=as_json)
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
    as_json: Json = False,
) -> None:
    """Find how thin the arch can be."""
    asked = _question(scene, alpha, mu, voussoirs, weight)
    with _options(), _progress() as report:
        answer = ask_bracket(
            half_angle=asked.half_angle,
            mu=asked.mu,
            voussoirs=asked.voussoirs,
            weight=asked.weight,
            method=method,
            tol=tol,
            progress=report,
        )
    _print(bracket_record(answer), bracket_lines(answer), as_json=as_json)


@app.command()
def simulate(
    out: Annotated[Path, typer.Option(help="Recording to write, .npz.")],
    scene: Scene = None,
    alpha: Alpha = None,
    eta: Eta = None,
    mu: Mu = None,
    voussoirs: Voussoirs = None,
    weight: WeightOption = None,
    method: Annotated[str, typer.Option(help=f"An engine: {', '.join(ENGINES)}.")] = "pymunk",
    seconds: Annotated[
        float | None, typer.Option(help="Time to record [s]; until decided if left out.")
    ] = None,
) -> None:
    """Let an arch go and record its motion."""
    arch, friction = _arch(scene, alpha, eta, mu, voussoirs, weight)
    require(out.suffix == ".npz", "--out", str(out), "a file name ending in .npz")
    require(out.parent.is_dir(), "--out", str(out), "in an existing folder")
    duration = None
    if seconds is not None:
        ok = is_number(seconds, 0, LONGEST_RECORDING)
        require(ok, "--seconds", seconds, f"above 0 and at most {LONGEST_RECORDING:g}")
        duration = seconds / math.sqrt(arch.radius / GRAVITY)
    with _options(), _progress() as report:
        recording = record_motion(
            arch, mu=friction, method=method, duration=duration, progress=report
        )
    recording.save(out)
    moved = recording.displacement[-1]
    _say(
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
    with _progress() as report:
        rows = run_validation(chosen, workers=workers, progress=report)
    paths = write_results(rows, out)
    _show(_table(rows))
    misses = [row for row in rows if row.miss]
    _say(f"{len(rows) - len(misses)} of {len(rows)} agree with limit analysis in every respect")
    for row in misses:
        _say(f"  {row.scenario}: {row.miss} ({row.note})")
    _say("wrote " + ", ".join(str(path) for path in paths))


def _table(rows: list[Row]) -> Table:
    """Lay out validation rows for a terminal."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    words = {"scenario", "published mode", "seen"}
    for heading in ("#", "scenario", "alpha", "mu", "n", "published mode", "seen", "published",
                    "limit", "bracket", "error", "s"):  # fmt: skip
        table.add_column(heading, justify="left" if heading in words else "right", no_wrap=True)
    for number, row in enumerate(rows, start=1):
        middle = row.eta_low
        if row.eta_low is not None and row.eta_high is not None:
            middle = (row.eta_low + row.eta_high) / 2
        table.add_row(
            str(number),
            row.scenario,
            f"{math.degrees(row.half_angle):.1f}",
            f"{row.mu:.4g}",
            str(row.voussoirs),
            "/".join(row.modes_published),
            (row.mode_observed or "-") + (" !" if row.miss else ""),
            ratio(row.eta_published),
            ratio(row.eta_limit),
            "none" if row.eta_high is None and row.eta_limit is None else ratio(middle),
            "-" if row.error is None else f"{row.error:+.3%}",
            f"{row.wall_s:.1f}",
        )
    return table


@app.command(name="map")
def draw_map(
    out: Picture,
    lines: Annotated[
        bool, typer.Option("--lines", help="Dividing lines and lines of equal alpha instead.")
    ] = False,
    zoom: Annotated[
        str, typer.Option(help="whole, central; with --lines: whole, lower, upper.")
    ] = "whole",
) -> None:
    """Draw the analytical map of least thickness and collapse modes."""
    from blocksim.view.linemap import line_map_figure
    from blocksim.view.mapfigure import map_figure

    zooms = LINE_ZOOMS if lines else {"whole": (0.0, 2.0), "central": (0.6, 1.2)}
    require(zoom in zooms, "--zoom", zoom, f"one of {', '.join(zooms)}")
    kind = _picture_kind(out)
    figure = line_map_figure(zooms[zoom]) if lines else map_figure(central=zoom == "central")
    _save_picture(figure, out, kind)


LINE_ZOOMS = {"whole": (0.0, 2.0), "lower": (0.0, 1.0), "upper": (0.6, 2.0)}


@app.command()
def render(
    out: Picture,
    scene: Scene = None,
    alpha: Alpha = None,
    eta: Eta = None,
    mu: Mu = None,
    voussoirs: Voussoirs = None,
    weight: WeightOption = None,
) -> None:
    """Draw an arch with its lines of thrust and friction and its mechanism.

    At the thickness given, the voussoirs as built; with none given, the continuous arch
    at its least thickness, in each of its collapse modes.
    """
    from blocksim.view.archfigure import arch_figure, picture_of_arch, picture_of_theory

    kind = _picture_kind(out)
    asked = _question(scene, alpha, mu, voussoirs, weight)
    ratio_given = asked.eta if eta is None else eta
    with _options():
        if ratio_given is not None:
            pictures = [picture_of_arch(asked.arch(ratio_given), asked.mu)]
        else:
            critical = least_thickness(asked.half_angle, asked.mu, asked.weight)
            if critical.eta is None:
                raise InputError("eta", MISSING, "given where no thickness stands")
            arch = asked.half_angle, asked.mu, asked.weight
            pictures = [picture_of_theory(critical, mode, *arch) for mode in critical.modes]
    _save_picture(arch_figure(pictures), out, kind)


def _picture_kind(out: Path) -> str:
    kind = out.suffix.removeprefix(".")
    require(kind in {"svg", "png"}, "--out", str(out), "a file name ending in .svg or .png")
    return kind


def _save_picture(figure: Figure, out: Path, kind: str) -> None:
    from blocksim.view.mapfigure import save_figure

    write_whole(out, lambda file: save_figure(figure, file, kind))
    _say(f"wrote {out}")


@app.command(name="scenarios")
def list_scenarios() -> None:
    """List the scenarios that come with blocksim."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("name", "title", "source"):
        table.add_column(heading)
    for name in shipped():
        scenario = load_scenario(name)
        table.add_row(name, scenario.title, scenario.source)
    _show(table)


@app.command()
def doctor() -> None:
    """Tell what is installed and what each method can do here."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("method", "here", "finest bracket", "sees"):
        table.add_column(heading)
    for finding in examine():
        finest = "exact" if finding.finest == 0 else f"{finding.finest:.2%}"
        table.add_row(finding.method, finding.remedy or "ready", finest, finding.sees)
    _show(table)


def _question(
    scene: str | None,
    alpha: float | None,
    mu: float | None,
    voussoirs: int | None,
    weight: str | None,
) -> Scenario:
    """Merge a scenario, where there is one, with the options that override it."""
    if alpha is not None:
        ok = is_number(alpha, 0, math.nextafter(180, 0))
        require(ok, "--alpha", alpha, "above 0 and below 180 deg")
    if scene is None:
        require(alpha is not None, "--alpha", MISSING, "given where no scenario is")
        require(mu is not None, "--mu", MISSING, "given where no scenario is")
    asked = load_scenario(scene) if scene is not None else NO_SCENARIO
    changes: dict[str, object] = {
        "half_angle": None if alpha is None else math.radians(alpha),
        "mu": mu,
        "voussoirs": voussoirs,
        "weight": weight,
    }
    return replace(asked, **{key: value for key, value in changes.items() if value is not None})


def _arch(
    scene: str | None,
    alpha: float | None,
    eta: float | None,
    mu: float | None,
    voussoirs: int | None,
    weight: str | None,
) -> tuple[Arch, float]:
    asked = _question(scene, alpha, mu, voussoirs, weight)
    ratio_given = asked.eta if eta is None else eta
    if ratio_given is None:
        raise InputError("--eta", MISSING, "given where no scenario sets it")
    with _options():
        return asked.arch(ratio_given), asked.mu


NO_SCENARIO = Scenario(
    name="",
    title="",
    source="",
    half_angle=math.pi / 2,
    mu=math.inf,
    voussoirs=27,
    weight="centreline",
    eta=None,
    radius=1.0,
    depth=1.0,
    specific_weight=20_000.0,
    expected_modes=(),
    expected_eta=None,
    quick=False,
)
"""Defaults of the options; half-angle and friction have none and are always replaced."""


@contextmanager
def _options() -> Generator[None]:
    """Name the option, not the field, in what is said of wrong input."""
    try:
        yield
    except InputError as error:
        if error.where is None and error.field in {
            "eta",
            "mu",
            "voussoirs",
            "weight",
            "method",
            "tol",
        }:
            raise InputError(f"--{error.field}", error.value, error.allowed) from None
        raise


@contextmanager
def _progress() -> Generator[Report]:
    """Show a bar on standard error while something goes on."""
    columns = (TextColumn("{task.description:34}"), BarColumn(), TimeElapsedColumn())
    console = Console(stderr=True)
    hidden = not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=hidden) as bar:
        task = bar.add_task("", total=1.0)

        def report(share: float, what: str) -> None:
            bar.update(task, completed=share, description=what)

        yield report


def _print(record: dict[str, object], lines: list[str], *, as_json: bool) -> None:
    _say(json.dumps(record, allow_nan=False) if as_json else "\n".join(lines))


def _show(table: Table) -> None:
    """Print a table; a narrow window wraps its lines rather than losing columns."""
    Console(width=max(Console().width, WIDE)).print(table)


def _say(text: str) -> None:
    typer.echo(text)
