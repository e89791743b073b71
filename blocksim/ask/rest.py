"""Must it rest? What friction allows where forces of equilibrium exist."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.groups import Group, groups_of
from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.common.progress import Progress, silent

if TYPE_CHECKING:
    from blocksim.engines.direct import Blocks
    from blocksim.simulation.recording import Recording

SPEED, FAR, STILL = 1e-3, 0.05, 1e-6
"""Speed with which blocks are let go along a motion [size/sqrt(size/g)], the way that counts as
gone on [size], and the speed that counts as rest."""
LONG, LOOKS = 30.0, 100
"""How long they are watched [sqrt(size/g)], and how often at most they are looked at."""
Rest = Literal["must", "can", "cannot"]
WORDS = {
    "must": "it must rest: friction lets no motion begin",
    "can": "it can rest, and friction may let it move as well",
}
NOT_FOUND = "it can rest; whether it must was not found out in the time allowed"


@dataclass(frozen=True, kw_only=True, eq=False)
class Moving:
    """A motion that friction lets begin although blocks can rest.

    `accelerations`, (blocks, 3): x, y [g] and rotation [g/size].
    `goes_on`: Whether it goes on in `direct`, let go slowly along it.
    """

    accelerations: Array
    goes_on: bool


def rest_words(rest: Rest | None, motion: Moving | None = None, *, asked: bool) -> str | None:
    """Return what is said of blocks that can rest; None where nothing is to be said."""
    said = (NOT_FOUND if asked else None) if rest is None else WORDS.get(rest)
    if motion is None:
        return said
    ends = "it goes on" if motion.goes_on else "it comes to rest"
    return f"{said}; let go along that motion in direct {ends}"


def require_rest(problem: Problem[Any]) -> None:
    """Raise `InputError` where it cannot be found out whether blocks must rest."""
    plane = not problem.in_space
    require(plane, "must_rest", "asked", "left out: it is not known in space")
    allowed = "left out where gravity leans or the ground shakes"
    require(problem.has_statics, "must_rest", "asked", allowed)
    rigid = problem.strength is None
    require(rigid, "must_rest", "asked", "left out beside a strength: blocks are rigid there")
    bounded = bool(np.isfinite(problem.friction).all())
    require(bounded, "must_rest", "asked", "left out where friction is unbounded")


def rest_of(
    problem: Problem | None,
    *,
    exists: bool | None,
    moved: bool,
    progress: Progress = silent,
) -> tuple[Rest | None, Moving | None]:
    """Tell what friction allows blocks at rest.

    `problem`: Where it is to be found out whether blocks must rest.
    `exists`: Whether there are forces of equilibrium; None where that was not found out.
    `moved`: Whether a motion was seen.
    Returns `rest`, {"must", "can", "cannot"} or None: None where it was not found out whether
        it must rest.
    Returns `motion`: Where it was asked for and found.
    """
    if not exists:
        return (None if exists is None else "cannot"), None
    if moved or problem is None:
        return ("can" if moved else None), None
    # Imported here: few ask, and it takes longer to load than an answer.
    from blocksim.limit.starting import may_start

    progress(1.0, "motions that friction lets begin")
    start = may_start(problem)
    if start.accelerations is None:
        return (None if start.moves is None else "must"), None
    way = start.accelerations
    gone = let_go(problem, way, until=FAR, progress=progress)
    return "can", Moving(accelerations=way, goes_on=bool(gone.displacement[-1] > FAR))


def let_go(
    problem: Problem, way: Array, *, until: float = math.inf, progress: Progress = silent
) -> Recording:
    """Let blocks go slowly along a motion in `direct`, and record them until they rest.

    The title of the recording says that they were pushed.

    What moves is let go without what rests, which may be heavier by far.

    `way`, (blocks, 3): Velocities or accelerations in proportion to those with which they
        begin.
    `until`: Displacement at which it ends [size].
    """
    from blocksim.engines.direct import ENGINE, Blocks
    from blocksim.simulation.recording import Recording

    assembly = problem.assembly
    settings = ENGINE.rule(assembly)
    moving = [group for group in groups_of(problem) if way[group.blocks].any()]
    worlds = [Blocks(group.problem, settings) for group in moving]
    built = assembly.built[:-1]
    start = way * SPEED / float(assembly.displacement(way))
    for group, world in zip(moving, worlds, strict=True):
        world.push(start[group.blocks])
    steps = round(LONG / settings.step / LOOKS)
    times, poses = [0.0], [_poses(built, moving, worlds)]
    for look in range(LOOKS):
        speeds = np.zeros_like(built)
        for group, world in zip(moving, worlds, strict=True):
            world.advance(steps)
            speeds[group.blocks] = world.velocities
        times.append(times[-1] + steps * settings.step)
        poses.append(_poses(built, moving, worlds))
        progress((look + 1) / LOOKS, "let go along a motion")
        gone = float(assembly.displacement(poses[-1] - built)) > until
        if gone or float(assembly.displacement(speeds)) < STILL:
            break
    qualities = [world.quality() for world in worlds]
    title = f"{problem.title or 'blocks'}, pushed along a motion that friction lets begin"
    return Recording(
        problem=replace(problem, title=title),
        engine=ENGINE.name,
        engine_version=ENGINE.version,
        settings=settings,
        times=np.array(times),
        poses=np.array(poses),
        quality=max(qualities, key=lambda each: each.residual or 0.0),
    )


def _poses(built: Array, moving: list[Group], worlds: list[Blocks]) -> Array:
    """Return where blocks are: those of no world as built."""
    poses = built.copy()
    for group, world in zip(moving, worlds, strict=True):
        poses[group.blocks] = world.poses()
    return poses
