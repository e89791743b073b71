"""The commands simulate and render."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from blocksim.ask.methods import choose
from blocksim.ask.simulate import simulate as let_go
from blocksim.ask.spread import Spreading
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.cli.arguments import Argument, Option
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
from blocksim.cli.options import (
    OWN,
    Given,
    Loading,
    MustRest,
    Scene,
    Set,
    named_options,
    require_given,
    settings_of,
)
from blocksim.cli.output import picture_kind, progress, say
from blocksim.cli.question import question
from blocksim.cli.spacefilm import film_in_space, model_in_space
from blocksim.cli.subject import anything_asked, is_structure, problem_asked
from blocksim.common.checks import Range, require
from blocksim.common.files import require_place
from blocksim.engines import NAMES
from blocksim.report.recordings import recording_lines
from blocksim.simulation.recording import Recording

FILMS = ("mp4", "gif")
RECORDED = Range(low=0, high=600, unit="s", above=True)


def simulate(
    given: Given,
    loading: Loading,
    out: Annotated[Path | None, Option(about="Recording to write, .npz; required.")] = None,
    scene: Scene = None,
    method: Annotated[
        str, Option(about=f"auto, or an engine: {', '.join(NAMES)}{OWN}.")
    ] = "auto",
    over: Annotated[
        str | None, Option(about="spread: move the supports until it has fallen.")
    ] = None,
    seconds: Annotated[
        float | None,
        Option(about="Seconds to record; until decided if left out.", range=RECORDED),
    ] = None,
    settings: Set = None,
) -> None:
    """Let it go and record its motion."""
    problem = problem_asked(scene, given, loading, thick=True, out=out)
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
    say(f"{out}: {first}", *others)


def _spread(
    problem: Problem,
    over: str,
    method: str,
    seconds: float | None,
    settings: list[str] | None,
) -> Recording:
    """Move the supports of a structure until it has fallen, and record it."""
    require(over == "spread", "--over", over, "spread, or left out: nothing else moves slowly")
    able = method == "auto" or choose(method, moving=True).moves_supports
    require(able, "--method", method, "direct: others move no supports")
    require(seconds is None, "--seconds", seconds, "left out: it ends when all has fallen")
    require(settings is None, "--set", settings, "left out where supports move")
    require(problem.shaking is None, "--shake", over, "left out where supports move")
    with named_options(), progress() as report:
        return Spreading(problem).recorded(report)


def render(
    given: Given,
    loading: Loading,
    out: Annotated[
        Path | None,
        Option(
            about="File to write: .pdf, .svg, .png or .dxf, .mp4 or .gif, or .glb, .gltf, "
            ".csv, .json of a recording, or .html to turn blocks in space around; required."
        ),
    ] = None,
    scene: Annotated[
        str | None,
        Argument(about="Scenario, structure, or a recording: an .npz file."),
    ] = None,
    beside: Beside = None,
    view: View = "2d",
    slow: Slow = None,
    time: Time = None,
    height: Height = None,
    method: EngineOption = None,
    must_rest: MustRest = False,
) -> None:
    """Draw what is built to scale, or film its motion.

    A sheet (.pdf, .svg, .png, .dxf) has dimensions, supports, lines of least and greatest
    thrust, reactions, and how it falls. Of an arch without a thickness the picture is of the
    continuous arch at its least, with its lines of thrust and friction, in each of its
    collapse modes. Everything else is drawn from a recording: a film, a view in 3d, a frame
    of an .npz file, an animated model (glTF), tables. A scenario is simulated first, 1 % below
    its least thickness where none is given. With --must-rest a picture shows the motion that
    friction lets begin, and a film the blocks let go along it in direct.
    """
    if scene is None:
        question(scene, given, out=out)
    require_given(out=out)
    out = out or Path()
    kind = picture_kind(out, (*FILMS, "png", "svg", "pdf", "dxf", "html", *MODELS, *TABLES))
    if kind in (*MODELS, *TABLES):
        options = {"beside": beside, "slow": slow, "time": time, "height": height}
        for name, value in options.items():
            require(value is None, f"--{name}", value, f"left out of a .{kind}")
        if kind in MODELS and is_structure(scene):
            asked = anything_asked(scene, given, loading)
            if isinstance(asked, SpatialProblem):
                require(not must_rest, "--must-rest", must_rest, "left out in space")
                model_in_space(out, kind, asked, method)
                return
        export(out, kind, *recordings(scene, given, loading, method, None, must_rest=must_rest))
        return
    filmed = kind in FILMS or view == "3d" or beside is not None
    if filmed or (scene is not None and scene.endswith(".npz")):
        require(kind != "dxf", "--out", str(out), "another kind: a .dxf is of no motion")
        shown = RenderOptions(view=view, slow=slow, time=time, height=height or HEIGHT)
        require(time is None or kind not in FILMS, "--time", time, "left out of a film")
        asked = None
        if kind in FILMS and is_structure(scene):
            asked = anything_asked(scene, given, loading)
            if isinstance(asked, SpatialProblem):
                require(not must_rest, "--must-rest", must_rest, "left out in space")
                film_in_space(out, asked, method, shown, beside)
                return
        runs = recordings(scene, given, loading, method, beside, asked, must_rest=must_rest)
        film(out, runs, shown)
    else:
        for name, value in (("slow", slow), ("time", time)):
            require(value is None, f"--{name}", value, "left out: the picture is of no motion")
        if height is not None:
            require(kind == "png", "--height", height, f"left out: a .{kind} has no pixels")
            require_height(height)
        write_still(out, kind, scene, given, loading, method, height, must_rest=must_rest)
