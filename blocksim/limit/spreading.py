"""What blocks do on supports that move slowly: hinges are followed until nothing holds them.

At each position of the supports the blocks rest on the contacts that are still closed, by the
linear programme on the displaced blocks. Which contacts open, as the supports move on, its
dual tells (`settling`). Between two events the hinges stay the same, and the blocks follow from
geometry alone, however far they move (Ochsendorf 2006). An event is a contact that closes
again, or forces that no longer fit: then the blocks move with the supports at rest, along the
mechanism of the linear programme, until a contact that closes holds them, or they fall.

Where several motions lose as much energy at first, as those of an arch whose halves mirror each
other do, one of them may balance like a pencil on its tip: of such a path there is none in
nature. Of the motions with which blocks rest a little farther on they take the one of least
energy.

Contacts neither slip nor part here, and no new ones are followed. Where they would, where
blocks meet that did not touch, and where they jam, the path ends and says so.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Load, Problem
from blocksim.common.later import optimize
from blocksim.limit.displaced import ENOUGH, Displaced, Frame, Lost
from blocksim.limit.programme import falling, settling

Ends = Literal["collapse", "range"] | Lost
FALLS = {"snaps", "collapse", "falls-slides", "falls-parts", "falls-meets"}
"""Events in which blocks move on supports at rest."""
PUSH = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3)
"""How far beyond an event it is looked at, the first that tells [size]."""
CLEAR = 1e-2
"""How far beyond a collapse blocks are looked at that have fallen, at most [size]."""
WAY = 5e-3
"""Way of the fastest corner in one step of a fall [size]."""
FALLEN = 0.2
"""Way in a fall after which nothing is expected to hold the blocks [size]."""
AHEAD = 1e-4
"""How far ahead motions are compared that are alike at first [size]."""
PUSHED = 1e-7
"""Body force that tells motions apart which are alike [weights]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Event:
    """Something that happens at one position of the supports.

    `what`: `hinges` form first, `moves`: one closes and another opens, `snaps`: the same by a
        fall that is caught, `collapse`, `falls-slides`, `falls-parts` or `falls-meets`: a fall
        in which a joint slides or parts, or blocks meet that did not touch, which is not
        followed to its end; `slides`, `parts`, `meets`; `jams`: no joint lets blocks follow.
    `before`, `after`: The same position, the hinges before and after it.
    """

    what: str
    before: Frame
    after: Frame

    @property
    def value(self) -> float:
        """The parameter of the supports' motion [m]."""
        return self.before.value


@dataclass(frozen=True, eq=False, kw_only=True)
class Path:
    """What blocks do as their supports move.

    `frames`: From where they were built to the last position of rest.
    `ends`: `collapse`, `range` (the supports moved as far as asked), or what would come at rest
        and is not followed: `slides`, `parts`, `meets`, `jams`.
    """

    frames: tuple[Frame, ...]
    events: tuple[Event, ...]
    ends: Ends

    @property
    def value(self) -> float:
        """How far the supports moved [m]."""
        return self.frames[-1].value

    @property
    def falls_for_good(self) -> bool:
        """Whether it ends in a fall in which nothing holds the blocks."""
        return self.ends == "collapse" and all(
            each.what == "collapse" for each in self.events[-1:]
        )

    @property
    def first_fall(self) -> float | None:
        """How far the supports moved when blocks first fell, caught again or not [m]."""
        if not self.events and self.ends == "collapse":
            return self.value
        falls = (each.value for each in self.events if each.what in FALLS)
        return next(falls, None)


def follow(problem: Problem, highest: float, steps: int = 100) -> Path:
    """Move the supports slowly, and follow the blocks.

    `problem`: In its plane, with `moves`.
    `highest`: How far the supports move at most [m].
    `steps`: Positions on the way at which events are looked for between.
    """
    blocks = Displaced(problem)
    frame = blocks.start
    frames, events = [frame], list[Event]()
    if blocks.margin(frame) < -ENOUGH:
        return Path(frames=(frame,), events=(), ends="collapse")
    frame, lost = _follows(blocks, frame)
    events.append(Event(what=lost or "hinges", before=frames[0], after=frame))
    frames.append(frame)
    grid = np.linspace(0, highest, steps + 1)[1:].tolist()
    while lost is None and grid:
        ahead = blocks.carried(frame, grid[0])
        what, at = _first_event(blocks, frame, ahead)
        if what is None:
            frame = ahead
            frames.append(frame)
            grid.pop(0)
            continue
        before = at
        if what == "snaps":
            caught, fallen, lost = _falls(blocks, before)
            if caught is None:
                frames.append(before)
                after = fallen or before
                what = "collapse" if lost is None else f"falls-{lost}"
                events.append(Event(what=what, before=before, after=after))
                return Path(frames=tuple(frames), events=tuple(events), ends="collapse")
            at = caught
        frame, lost = (before, what) if what == "meets" else _follows(blocks, at)
        events.append(Event(what=lost or what, before=before, after=frame))
        frames += [before, frame]
    return Path(frames=tuple(frames), events=tuple(events), ends=lost or "range")


def displaced_at(problem: Problem, path: Path, value: float) -> Problem:
    """Return a problem as it lies where the supports have moved so far.

    Contacts that are open are none. Beyond a collapse it is the problem as it begins to fall,
    so far on that engines see it, too; beyond another end of the path the last hinges go on.
    """
    blocks = Displaced(problem)
    if value > path.value and path.falls_for_good:
        return blocks.problem(blocks.held(_clearly(blocks, path.frames[-1], value)))
    before = [each for each in path.frames if each.value <= value]
    # As built all contacts are closed.
    last = before[-1] if before and value > 0 else path.frames[0]
    return blocks.problem(blocks.carried(last, value))


def _first_event(
    blocks: Displaced, frame: Frame, ahead: Frame
) -> tuple[Literal["moves", "snaps", "meets"] | None, Frame]:
    """Find what happens first on the way from a frame to the next."""
    what, found = None, ahead
    if blocks.closing(ahead) < 0:
        what, found = "moves", _where(blocks, blocks.closing, frame, ahead)
    if blocks.margin(found) < -ENOUGH:
        # Where hinges have just formed none of their force is left.
        least = -ENOUGH if blocks.margin(frame) < ENOUGH else 0.0
        what = "snaps"
        found = _where(blocks, lambda each: blocks.margin(each) - least, frame, found)
    if blocks.room(found) < 0:
        return "meets", _where(blocks, blocks.room, frame, found)
    return what, blocks.shut(found) if what == "moves" else found


def _where(
    blocks: Displaced, measure: Callable[[Frame], float], frame: Frame, ahead: Frame
) -> Frame:
    """Find the position at which a measure falls to nothing."""
    # Where blocks cannot follow, their places say nothing of those on the way.
    way = ahead.poses - frame.poses if blocks.fit(ahead) else 0.0

    def at(share: float) -> Frame:
        value = frame.value + share * (ahead.value - frame.value)
        return blocks.carried(frame, value, frame.poses + share * way)

    def left(share: float) -> float:
        found = measure(at(share))
        # Hinges about to get into line press without bound, which the programme does not tell.
        return 0.0 if math.isnan(found) else found

    return at(0.0 if left(0.0) <= 0 else float(optimize.brentq(left, 0.0, 1.0, xtol=1e-13)))


def _falls(blocks: Displaced, frame: Frame) -> tuple[Frame | None, Frame | None, Lost | None]:
    """Let the blocks fall on supports at rest.

    Returns `caught`: Where they are held again.
    Returns `fallen`: The hinges with which they begin to fall.
    Returns `lost`: What else a joint does in the fall, which is not followed.
    """
    now, first, way = _beyond(blocks, frame), None, 0.0
    if not blocks.fit(now):
        # Hinges have got into line: the blocks cannot follow, and come apart.
        return None, None, None
    while way < FALLEN:
        rates = falling(blocks.problem(now))
        if rates is None:
            return now, first, None
        now, lost = blocks.opened(now, rates, 0.0)
        first = first or now
        if lost is not None:
            return None, first, lost
        ahead = blocks.carried(now, now.value, now.poses + WAY / blocks.fastest(rates) * rates)
        shuts = blocks.closing(ahead) < 0
        now = blocks.shut(_where(blocks, blocks.closing, now, ahead)) if shuts else ahead
        if blocks.room(now) < 0:
            return None, first, "meets"
        way += WAY / 100 if shuts else WAY
    return None, first, None


def _beyond(blocks: Displaced, frame: Frame) -> Frame:
    """Carry the blocks on until they clearly fall, or cannot follow."""
    now = frame
    for push in (0.0, *PUSH):
        now = blocks.carried(frame, frame.value + push * blocks.size)
        # Where they cannot follow it is -1.
        if blocks.margin(now) < -10 * ENOUGH:
            break
    return now


def _clearly(blocks: Displaced, frame: Frame, value: float) -> Frame:
    """Carry blocks that fall on, up to a value, while ever more force is lacking."""
    now = _beyond(blocks, frame)
    lacking = blocks.margin(now)
    for push in (*PUSH, CLEAR):
        ahead = blocks.carried(frame, min(frame.value + push * blocks.size, value))
        if ahead.value < now.value:
            continue
        margin = blocks.margin(ahead) if blocks.fit(ahead) else math.inf
        if margin > lacking or blocks.closing(ahead) < 0 or blocks.room(ahead) < 0:
            break
        now, lacking = ahead, margin
    return now


def _follows(blocks: Displaced, frame: Frame) -> tuple[Frame, Lost | None]:
    """Open contacts as the supports move on; return what else a joint does, which ends it."""
    lies, speeds = blocks.problem(frame), blocks.speeds(frame.value)
    rates = settling(lies, speeds)
    if rates is None or isinstance(rates, str):
        return frame, rates
    after, lost = blocks.opened(frame, rates, 1.0)
    found = [after]
    for way in () if lost else _ways(blocks, after):
        leaning = settling(_pushed(lies, way), speeds)
        if leaning is None or isinstance(leaning, str):
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
