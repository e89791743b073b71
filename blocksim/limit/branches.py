"""How blocks on supports that begin to move go on: the stable one of their motions.

The linear programme says which contacts open (`blocksim.limit.programme.settling`). Where
several motions lose as much energy at first, as those of an arch whose halves mirror each other
do, one of them may balance like a pencil on its tip: of such a path there is none in nature. Of
the motions with which blocks rest a little farther on they take the one of least energy.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Load, Problem
from blocksim.limit.displaced import ENOUGH, Displaced, Frame, Lost
from blocksim.limit.programme import falling, settling

AHEAD = 1e-4
"""How far ahead motions are compared that are alike at first [size]."""
PUSHED = 1e-7
"""Body force that tells motions apart which are alike [weights]."""


def follows(blocks: Displaced, frame: Frame) -> tuple[Frame, Lost | None]:
    """Open the contacts that open as the supports move on.

    Parameters
    ----------
    blocks : Displaced
    frame : Frame
        At rest.

    Returns
    -------
    after : Frame
    lost : str or None
        What else a joint does, which is not followed.
    """
    lies, speeds = blocks.problem(frame), blocks.speeds(frame.value)
    rates = settling(lies, speeds)
    if rates is None:
        return frame, None
    after, lost = blocks.opened(frame, rates, 1.0)
    found = [after]
    for way in () if lost else _ways(blocks, after):
        leaning = settling(_pushed(lies, way), speeds)
        if leaning is None:
            continue
        turned, slips = blocks.opened(frame, leaning, 1.0)
        if slips is None and blocks.closing(_ahead(blocks, turned)) > 0:
            found.append(turned)
    if len(found) == 1:
        return after, lost

    def rank(one: Frame) -> tuple[bool, float]:
        ahead = _ahead(blocks, one)
        return blocks.margin(ahead) < -ENOUGH, blocks.energy(ahead)

    return min(found, key=rank), None


def _ahead(blocks: Displaced, frame: Frame) -> Frame:
    """Carry the blocks a little farther on."""
    return blocks.carried(frame, frame.value + AHEAD * blocks.size)


def _ways(blocks: Displaced, frame: Frame) -> Array:
    """Return motions on supports at rest that blocks may take a little farther on.

    Those in which all closed contacts stay closed, both ways; else that in which they fall.
    """
    free, ahead = blocks.free(frame), _ahead(blocks, frame)
    if len(free) or blocks.margin(ahead) >= -ENOUGH:
        return np.concatenate([free, -free])
    falls = falling(blocks.problem(ahead)) if blocks.fit(ahead) else None
    return free if falls is None else falls[None]


def _pushed(problem: Problem, way: Array) -> Problem:
    """Return a problem whose blocks are pushed a little along a motion."""
    largest = np.abs(way).max()
    pushes = tuple(
        Load(force=PUSHED * each[:2] / largest, blocks=(index,), per_weight=True)
        for index, each in enumerate(way)
    )
    return replace(problem, dead=(*problem.dead, *pushes))
