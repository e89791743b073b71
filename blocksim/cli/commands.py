"""The commands simulate and render."""

from __future__ import annotations

from pathlib import Path

from blocksim.ask.methods import choose
from blocksim.ask.simulate import simulate as let_go
from blocksim.blocks.problem import Problem
from blocksim.cli.arguments import option
from blocksim.cli.given import given_of
from blocksim.cli.options import (
    MUST_REST,
    OWN,
    SET,
    SPATIAL,
    named_options,
    refuse,
    require_given,
    settings_of,
)
from blocksim.cli.output import picture_kind, progress, say
from blocksim.cli.rendering import (
    ENGINE,
    MODELS,
    TABLES,
    Filmed,
    export,
    film,
    recordings,
    require_height,
    require_pixels,
    write_still,
)
from blocksim.cli.subject import Subject, anything_asked, arch_of
from blocksim.common.checks import Range, require
from blocksim.common.files import require_place
from blocksim.engines import NAMES
from blocksim.report.problems import length_lines
from blocksim.report.recordings import recording_lines
from blocksim.simulation.recording import Recording

FILMS = ("mp4", "gif")
RECORDED = Range(low=0, high=600, unit="s", above=True)


def simulate(
    asked: Subject,
    out: Path | None = option("Recording to write, .npz; required."),
    method: str = option(f"auto, or an engine: {', '.join(NAMES)}{OWN}.", default="auto"),
    over: str | None = option("spread: move the supports until it has fallen."),
    seconds: float | None = option(
        "Seconds to record; until decided if left out.", range=RECORDED
    ),
    settings: list[str] | None = SET,
    spatial: bool = SPATIAL,
) -> None:
    """Let it go and record its motion."""
    problem = anything_asked(asked, spatial=spatial, thick=True, out=out)
    size = problem.length_name
    out = out or Path()
    require(out.suffix == ".npz", "--out", str(out), "a file name ending in .npz")
    require_place(out)
    if over is not None:
        recording = _spread(problem, over, method, seconds, settings)
    else:
        with named_options(), progress() as report:
            recording = let_go(
                problem,
                method=method,
                duration=None if seconds is None else seconds / problem.seconds,
                settings=settings_of(settings),
                progress=report,
            )
    recording.save(out)
    first, *others = recording_lines(recording, size)
    say(f"{out}: {first}", *others, *length_lines(problem))


def _spread(
    problem: Problem,
    over: str,
    method: str,
    seconds: float | None,
    settings: list[str] | None,
) -> Recording:
    """Move the supports of a structure until it has fallen, and record it."""
    require(over == "spread", "--over", over, "spread, or left out: nothing else moves slowly")
    require(not problem.in_space, "--over", over, "left out: supports stay in space")
    able = method == "auto" or choose(method, moving=True).moves_supports
    require(able, "--method", method, "direct: others move no supports")
    require(seconds is None, "--seconds", seconds, "left out: it ends when all has fallen")
    require(settings is None, "--set", settings, "left out where supports move")
    still = "blocks at rest on ground that does not shake: supports move slowly"
    require(not problem.is_moving, "--over", over, f"left out, or {still}")
    from blocksim.ask.spread import Spreading

    with named_options(), progress() as report:
        return Spreading(problem).recorded(report)


def render(
    asked: Subject,
    filmed: Filmed,
    out: Path | None = option(
        "File to write: .pdf, .svg, .png or .dxf, .mp4 or .gif, or .glb, .gltf, "
        ".csv, .json of a recording, or .html to turn blocks in space around; required."
    ),
    method: str | None = ENGINE,
    must_rest: bool = MUST_REST,
) -> None:
    """Draw what is built to scale, or film its motion.

    A sheet (.pdf, .svg, .png, .dxf) has dimensions, supports, lines of least and greatest
    thrust, reactions, and how it falls. Of an arch without a thickness the picture is of the
    continuous arch at its least, with its lines of thrust and friction, in each of its
    collapse modes. Everything else is drawn from a recording: a film, a view in 3d, a frame
    of an .npz file, an animated model (glTF), tables. A structure is simulated first, an arch
    1 % below its least thickness where none is given. With --must-rest a picture shows the
    motion that friction lets begin, and a film the blocks let go along it in direct.
    """
    if asked.scene is None:
        arch_of(asked.given, out=out)
    require_given(out=out)
    out = out or Path()
    kind = picture_kind(out, (*FILMS, "png", "svg", "pdf", "dxf", "html", *MODELS, *TABLES))
    if kind in (*MODELS, *TABLES):
        moving = given_of(filmed, "beside", "slow", "time", "height")
        refuse(moving, why=f"left out of a .{kind}")
        export(out, kind, *recordings(asked, method, None, must_rest=must_rest))
    elif (
        kind in FILMS
        or filmed.view == "3d"
        or filmed.beside
        or str(asked.scene).endswith(".npz")
    ):
        moves = f"another kind: a .{kind} is of no recorded motion"
        require(kind not in {"dxf", "html"}, "--out", str(out), moves)
        still = filmed.time is None or kind not in FILMS
        require(still, "--time", filmed.time, "left out of a film")
        require_height(filmed.height)
        runs = recordings(asked, method, filmed.beside, must_rest=must_rest)
        film(out, runs, filmed)
    else:
        moving = given_of(filmed, "slow", "time")
        refuse(moving, why="left out: the picture is of no motion")
        require_pixels(filmed.height, kind)
        write_still(out, kind, asked, method, filmed.height, must_rest=must_rest)
