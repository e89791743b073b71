"""How right a motion is: run again at another step, and how far apart both runs come.

Between impacts errors are of second order, so those of the finer of two runs, whose steps are
as one to two, are about a third of their difference. Many impacts leave little of that order.
So `SAFE` times the difference is told. Where it passes `KNOWN` the motion is not known any
more: of blocks that fall in a heap no step is fine enough.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from blocksim.blocks.assembly import Array, displacement
from blocksim.engines.base import World
from blocksim.simulation.recording import Recording

KNOWN = 0.01
"""Difference of poses up to which they count as known, and of the largest rotation, relative
[size]."""
SAFE = 2.0
"""Error over the difference: enough where errors fall by a third at half the step."""
COARSER = 2
"""Steps in one of the other run."""


def estimated(recording: Recording, poses: Sequence[Array], every: int = 1) -> Recording:
    """Return a recording with the errors of its poses that another run shows.

    Parameters
    ----------
    recording : Recording
    poses : sequence of (blocks, 3 or 6) float
        Of the other run, from the release on: one for `every` frames of the recording.
    every : int
    """
    mine = recording.poses[::every][: len(poses)]
    off = SAFE * displacement(np.array(poses[: len(mine)]) - mine, recording.assembly)
    beyond = np.flatnonzero(off > KNOWN)
    count = int(beyond[0]) if len(beyond) else len(off)
    quality = replace(
        recording.quality,
        error=float(off[:count].max()),
        known=float(recording.times[::every][count - 1]) if len(beyond) else None,
    )
    return replace(recording, quality=quality)


def compared(recording: Recording, world: World) -> Recording:
    """Return a recording with the errors that a run at `COARSER` steps shows.

    Parameters
    ----------
    recording : Recording
        Of frames at equal times.
    world : World
        Of the same blocks, at rest, whose steps are that long.
    """
    if len(recording.times) < 2:
        return recording
    # Frames may be an odd number of steps apart.
    steps = round(float(recording.times[1]) / recording.settings.step)
    every = 1 if steps % COARSER == 0 else COARSER
    poses = [recording.poses[0]]
    for frame in recording.poses[every::every]:
        world.advance(steps * every // COARSER)
        poses.append(world.poses())
        # What comes after that tells no more.
        if SAFE * displacement(poses[-1] - frame, recording.assembly) > KNOWN:
            break
    return estimated(recording, poses, every)
