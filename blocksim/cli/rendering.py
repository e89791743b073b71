"""What `render` draws: stills of what is built, recordings, and films of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, Literal

from blocksim.arch.theory import least_thickness
from blocksim.ask.answer import Check
from blocksim.ask.check import check
from blocksim.ask.methods import asked_as, choose
from blocksim.ask.rest import let_go, rest_words
from blocksim.ask.simulate import simulate
from blocksim.blocks.problem import STANDARD_GRAVITY, Problem
from blocksim.cli.arguments import option
from blocksim.cli.options import OWN, named_options, refuse
from blocksim.cli.output import progress, say, write
from blocksim.cli.subject import Subject, anything_asked, arch_of, is_thick
from blocksim.common.checks import Range, require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.progress import Progress
from blocksim.common.words import counted
from blocksim.engines import NAMES
from blocksim.kinds.loading import load_recording
from blocksim.report.recordings import unsolved_words, write_recording_csv, write_recording_json
from blocksim.simulation.motion import EARLY
from blocksim.simulation.observation import hold
from blocksim.simulation.recording import Recording
from blocksim.simulation.verdict import Verdict

FALL = 20.0
"""Time recorded of a structure at most: it ends when the rubble lies still [sqrt(r/g)]."""
HEIGHT = 720
HEIGHTS = (180, 2160)
MOST_NUMBERS = 5_000_000
"""Most numbers of the poses that are written as a model or a table."""
ROUGH = 1e-4
"""Residual of contacts in space that is told."""
DEEP, GAINED = 0.01, 1e-3
"""Overlap over the width of the smallest block, and energy over what fell, that are told."""
MODELS, TABLES = ("glb", "gltf"), ("csv", "json")
"""Endings of recordings as glTF, and as numbers."""

ENGINE = option(
    f"Simulates a structure: auto (if left out), {', '.join(NAMES)}{OWN}.", name="--method"
)


@dataclass(frozen=True, kw_only=True)
class Filmed:
    """Options that say how motion is drawn. Those not given are None."""

    heading: ClassVar[str] = "How motion is drawn"

    beside: Path | None = option("A second recording, .npz, to show side by side.")
    view: Literal["2d", "3d"] = option("From the front, or in perspective.", default="2d")
    slow: float | None = option(
        "Times slower than it happened (by default it takes about 6 s).",
        range=Range(low=0, high=1000, above=True),
    )
    time: float | None = option(
        "For .png, .svg, .pdf: time since the release, as the clock shows it (the end).",
        range=Range(low=0, high=math.inf, unit="s"),
    )
    height: int | None = option(
        "In pixels: of a frame (720 if left out; frames are 16:9) or a .png picture."
    )


def require_height(height: int | None) -> None:
    """Refuse a height of frames or pictures that is out of range."""
    low, high = HEIGHTS
    fits = height is None or (low <= height <= high and height % 2 == 0)
    require(fits, "--height", height, f"an even number from {low} to {high}")


def require_pixels(height: int | None, kind: str) -> None:
    """Refuse a height of a picture that has no pixels, or one out of range."""
    if height is not None:
        require(kind == "png", "--height", height, f"left out: a .{kind} has no pixels")
        require_height(height)


def recordings(
    asked: Subject,
    method: str | None,
    beside: Path | None,
    *,
    must_rest: bool = False,
) -> list[Recording[Any]]:
    """Read recordings, or simulate the structure, in the plane or in space.

    Where it is asked whether it must rest, blocks are let go along the motion that is found.
    """
    second = [] if beside is None else [load_recording(beside)]
    if asked.scene is not None and asked.scene.endswith(".npz"):
        said = {**asked.options, "method": method, "must_rest": must_rest}
        refuse(said, why="left out: the recording says it")
        return [load_recording(Path(asked.scene)), *second]
    problem = asked_as(anything_asked(asked))
    if must_rest:
        refuse({"must_rest": must_rest and problem.in_space})
        return [_along_motion(problem, method), *second]
    with named_options(), progress() as report:
        return [_run(problem, method or "auto", report), *second]


def _run(problem: Problem, method: str, progress: Progress) -> Recording:
    """Record until what falls lies still, what stands until that is certain."""
    if problem.is_moving:
        return simulate(problem, method=method, progress=progress)
    held = hold(problem, choose(method, problem=problem, moving=True).name, progress=progress)
    rests = held.onset.verdict is Verdict.STANDS
    return held.record(None if rests else FALL, progress)


def _along_motion(problem: Problem, method: str | None) -> Recording:
    """Let blocks go along the motion that friction lets begin."""
    require(method in {None, "auto", "direct"}, "--method", method, "direct, or left out")
    with named_options(), progress() as report:
        found = check(problem, method="limit", must_rest=True, progress=report)
        if found.motion is None:
            said = rest_words(found.rest, asked=True) or "it falls: no motion besides is sought"
            raise InputError("--must-rest", said, "left out: no such motion was found")
        return let_go(problem, found.motion.accelerations, progress=report)


def film(out: Path, shown: Sequence[Recording[Any]], how: Filmed) -> None:
    """Draw recordings into a file and say so."""
    from blocksim.view.video import STILLS, render

    tall = how.height or HEIGHT
    with progress() as report:
        made = render(
            shown, out, view=how.view, slow=how.slow, at=how.time, height=tall, progress=report
        )
    if out.suffix.removeprefix(".") in STILLS:
        asked = how.time or 0.0
        end = made.ends_before(asked)
        later = f": {asked:g} is after the end, so it shows the end, {end}"
        say(f"wrote {out}{later if end else ''}")
        return
    radius = "" if made.metric else " (if r = 1 m)"
    length = made.count / made.rate
    pace = f"{made.slow:g} times slower" if made.slow != 1 else "in real time"
    rest = f"{length - made.seconds * made.slow:.1g} s"
    ends = f"{rest} of stills; blocks still move as it ends, at {made.speed:.3g} m/s"
    shows = (
        f"{made.seconds:.3g} s of motion{radius}, {pace}, and "
        f"{ends if made.speed else f'{rest} at rest'}"
    )
    said = shows if any(made.moves) else "nothing is seen to move"
    say(f"wrote {out}: a film of {length:.1f} s: {said}")
    for recording, moves in zip(shown, made.moves, strict=True):
        left = recording.quality.residual or 0.0
        if recording.problem.in_space and left > ROUGH:
            say(f"Coulomb's law was kept to {left:.1g} of the forces, where it was worst")
        if recording.unsolved:
            say(unsolved_words(recording))
        if (deep := recording.overlap_share or 0.0) > DEEP:
            say(f"blocks overlap by {deep:.1%} of the smallest, where it is worst")
        if (gain := recording.quality.gain or 0.0) > GAINED:
            say(f"energy rose again, by {gain:.2%} of what fell")
        if not moves:
            say(_motionless(recording))


def export(out: Path, kind: str, recording: Recording[Any]) -> None:
    """Write a recording as glTF or as a table, in metres and seconds, and say so."""
    numbers = recording.poses.size
    allowed = f"at most {MOST_NUMBERS} as .{kind}: of a shorter recording"
    require(numbers <= MOST_NUMBERS, "numbers", numbers, allowed)
    if kind in MODELS:
        from blocksim.view.models import write_model

        made = partial(write_model, recording, kind=kind)
    else:
        of_table = write_recording_csv if kind == "csv" else write_recording_json
        made = partial(of_table, recording)
    radius = "" if recording.problem.has_size else " if r = 1 m"
    said = (
        f": {counted(len(recording.assembly.blocks), 'block')}, "
        f"{counted(len(recording.times), 'frame')}, "
        f"{recording.seconds(STANDARD_GRAVITY)[-1]:.3g} s{radius}"
    )
    write(out, made, said=said)


def _motionless(recording: Recording) -> str:
    """Say that nothing is seen to move in a recording, and what to do where it falls."""
    moved = float(recording.displacement.max())
    arch = ", ".join([*recording.problem.measures, recording.engine])
    if moved > EARLY:
        return (
            f"nothing is seen to move in one recording ({arch}): it ends when it has "
            f"moved {moved:.2g} r; simulate --seconds 2 records how it falls"
        )
    return f"nothing is seen to move in one recording ({arch}): it is at rest"


def write_still(
    out: Path,
    kind: str,
    asked: Subject,
    method: str | None,
    height: int | None,
    *,
    must_rest: bool,
) -> None:
    """Draw what stands still: a sheet of what is built, or the arch at its least thickness.

    What leans out of its plane is drawn in space, where it is asked about.
    """
    solid = "another kind: a page to turn around (.html) is of blocks in space"
    given, acts = asked.given, asked.loading.given
    if asked.scene is not None or acts or given.lean is not None or is_thick(given):
        problem = anything_asked(asked, thick=given.lean is None)
        if problem.in_space or not problem.is_planar:
            problem = asked_as(problem)
            refuse({"must_rest": must_rest})
            perspective = "a .png, .svg or .pdf: it is drawn in perspective; or .html, to turn "
            require(kind != "dxf", "--out", str(out), f"{perspective}it around")
        else:
            require(kind != "html", "--out", str(out), solid)
            as_built = "limit or an engine: it is drawn as built"
            require(method != "theory", "--method", method, as_built)
        with named_options(), progress() as report:
            chosen = method or "auto"
            answer = check(problem, method=chosen, must_rest=must_rest, progress=report)
        _write(out, kind, answer, height)
        return
    require(kind != "html", "--out", str(out), solid)
    require(method is None, "--method", method, "left out: the picture is of no motion")
    require(not must_rest, "--must-rest", must_rest, "left out: nothing is built in its plane")
    thin = "a .png, .svg or .pdf where no thickness is given"
    require(kind != "dxf", "--out", str(out), thin)
    from blocksim.view.archfigure import arch_figure, picture_of_theory

    with named_options():
        maker = arch_of(replace(given, eta=1.0))
        shape = maker.shape
        assert shape is not None  # noqa: S101 - by its half-angle, or span and rise
        arch = shape.half_angle, maker.known_friction, shape.weight
        critical = least_thickness(*arch)
        if critical.eta is None:
            raise InputError("eta", MISSING, "given where no thickness stands")
        pictures = [picture_of_theory(critical, mode, *arch) for mode in critical.modes]
    write(out, arch_figure(pictures), height=height)


def _write(out: Path, kind: str, answer: Check[Any], height: int | None) -> None:
    """Draw an answer to scale, in space in perspective, or write a page to turn it around."""
    if kind == "html":
        from blocksim.view.turning import turning_page

        write(out, turning_page(answer).encode(), said=": a page to turn it around")
    elif answer.problem.in_space:
        from blocksim.view.solidfigure import solid_figure

        write(out, solid_figure(answer), height=height)
    else:
        from blocksim.view.sheet import answer_sheet
        from blocksim.view.sheetdxf import write_dxf
        from blocksim.view.sheetfigure import sheet_figure

        sheet = answer_sheet(answer)
        made = partial(write_dxf, sheet) if kind == "dxf" else sheet_figure(sheet)
        write(out, made, height=height)
