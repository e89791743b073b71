"""How right a motion is: run again at another step, and how far apart both runs come.

Between impacts errors are of second order, so those of the finer of two runs, whose steps are
as one to two, are about a third of their difference. Many impacts leave little of that order.
So `SAFE` times the difference is told. Where in a step blocks hit or lift off is chance for
some engines: at twice the step it may be the same, so more runs of theirs are compared. Where
the difference passes `KNOWN` the motion is not known any more: of blocks that fall in a heap no
step is fine enough. What overlaps is told as error, too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from blocksim.blocks.assembly import Array, Blocks
from blocksim.engines.base import World
from blocksim.engines.contact.geometry import Geometry
from blocksim.simulation.recording import Recording

KNOWN = 0.01
"""Difference of poses up to which they count as known, and of the largest rotation, relative
[size]."""
SAFE = 2.0
"""Error over the difference: enough where errors fall by a third at half the step."""
COARSER = 2
"""Steps in one of the other run."""


def estimated(
    recording: Recording[Blocks], poses: Sequence[Array], frames: Sequence[int]
) -> Recording[Blocks]:
    """Return a recording with the errors that another run shows, where they are the worst.

    `poses`, sequence of (blocks, 3 or 6): Of the other run, from the release on.
    `frames`: Frames of the recording at the same times; those beyond the other run do not
        count.
    """
    mine, times = (each[frames][: len(poses)] for each in (recording.poses, recording.times))
    other = np.array(poses[: len(mine)])
    displaced = recording.assembly.displacement
    off = SAFE * displaced(other - mine)
    beyond = np.flatnonzero(off > KNOWN)
    count = int(beyond[0]) if len(beyond) else len(off)
    gone = [_gone(times, displaced(each - each[0])) for each in (mine, other)]
    told = recording.quality
    late = SAFE * abs(gone[0] - gone[1]) if all(gone) else None
    known = float(times[count - 1]) if len(beyond) else None
    # It is that of the recording, whatever it is compared with.
    deepest = _deepest(recording) if told.error is None else told.penetration
    quality = replace(
        told,
        penetration=deepest,
        # Blocks that overlap are not where they would be, whether or not runs agree.
        error=max(float(off[:count].max()), told.error or 0.0, deepest or 0.0),
        late=max((each for each in (late, told.late) if each is not None), default=None),
        known=min((each for each in (known, told.known) if each is not None), default=None),
    )
    return replace(recording, quality=quality)


def _gone(times: Array, moved: Array) -> float:
    """Return when blocks have first gone by `KNOWN`; 0 if never."""
    at = int((moved > KNOWN).argmax())
    before, after = moved[at - 1], moved[at]
    back = (after - KNOWN) / (after - before) if at else 0.0
    return float(times[at] - back * (times[at] - times[at - 1])) if at else 0.0


def _deepest(recording: Recording[Any]) -> float | None:
    """Return the deepest overlap that the engine tells of, or that joints have in the plane."""
    told = recording.quality.penetration
    if recording.problem.in_space:
        return told
    geometry, deepest = Geometry(recording.assembly), told or 0.0
    for poses in recording.poses:
        touch, holds = geometry.touch(poses)
        deepest = max(deepest, -float(touch.gap[holds].min(initial=0.0)))
    return deepest


def compared(
    recording: Recording[Blocks], world_at: Callable[[float], World], beside: Sequence[float]
) -> Recording[Blocks]:
    """Return a recording with the errors that runs at other steps show, the worst of them.

    Where these pass `KNOWN` blocks are let go at half the step, too. If that agrees, it is
    what is returned.

    `world_at`: Gives the same blocks, at rest, in an engine whose steps are so long.
    `beside`: Steps of the other runs, in those of the recording; `COARSER` is the first.
    """
    if len(recording.times) < 2:
        return recording
    step, found = recording.settings.step, recording
    for share in beside:
        poses, frames, _ = _again(recording, world_at, share * step)
        found = estimated(found, poses, frames)
    if found.quality.known is None:
        return found
    poses, frames, world = _again(recording, world_at, step / COARSER)
    if len(poses) < len(recording.times):
        return found
    finer = replace(
        recording,
        settings=replace(recording.settings, step=step / COARSER),
        poses=np.array(poses),
        quality=world.quality(),
    )
    # They may part at the last frame.
    agreed = estimated(finer, list(recording.poses), frames)
    for share in beside[1:]:
        if agreed.quality.known is None:
            poses, frames, _ = _again(finer, world_at, share * step / COARSER)
            agreed = estimated(agreed, poses, frames)
    return agreed if agreed.quality.known is None else found


def _again(
    recording: Recording[Any], world_at: Callable[[float], World], step: float
) -> tuple[list[Array], Sequence[int], World]:
    """Let blocks go in other steps, as long as they go as recorded: poses, and frames."""
    displaced = recording.assembly.displacement
    counts = recording.times / step
    # Frames may be an odd number of steps apart.
    frames = np.flatnonzero(np.abs(counts - np.rint(counts)) < 1 / 4).tolist()
    world, poses, taken = world_at(step), [recording.poses[0]], 0
    for frame in frames[1:]:
        world.advance(round(counts[frame]) - taken)
        taken = round(counts[frame])
        poses.append(world.poses())
        # What comes after that tells no more.
        if SAFE * displaced(poses[-1] - recording.poses[frame]) > KNOWN:
            break
    return poses, frames, world
