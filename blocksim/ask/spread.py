"""Supports that move slowly: how far until blocks fall, by limit analysis and by `direct`."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from blocksim.ask.answer import Event, OpenJoint
from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState, side_name
from blocksim.blocks.problem import Move, Problem
from blocksim.blocks.road import remade
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.progress import Progress, silent
from blocksim.engines.direct import ENGINE, USUAL
from blocksim.engines.moving import DEEP, OnMovingSupports
from blocksim.engines.stepping import UNSOLVED
from blocksim.kinds.circular import CircularArch
from blocksim.limit.bearing import bears
from blocksim.limit.spreading import Path, displaced_at, follow
from blocksim.simulation.motion import FRAME, lie_still
from blocksim.simulation.recording import Recording

SIDES = (-1.0, 1.0)
"""Ways of the left and the right support where a file does not say them."""
FARTHEST = 1.0
"""How far supports move at most [size]; what turns, turns by half a turn at most."""
SPEED, STEP = 1e-3, 0.05
"""Of the supports [size/sqrt(size/g)], and step of time [sqrt(size/g)], at first."""
SEEN, AFTER = 0.01, 20.0
"""Speed of the supports in a recording [size/sqrt(size/g)], and how long it goes on at most
once the blocks fall [sqrt(size/g)]."""
SHALLOW = 0.5
"""How far below the structure a recording shows the ground, if no support sinks [size]."""
SIDEWAYS = 0.5
"""Speed with which blocks begin, over that of their supports."""
FAST = 30.0
"""Speed of blocks, over that of their supports, from which on they fall."""
AGAIN = 50
"""How often supports go on at most where blocks that were fast stay as they stop."""
STARTS = 1e-5
"""Acceleration from which on blocks move on supports that have stopped [g]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Slow:
    """What `direct` saw on supports that move slowly.

    `low`: Farthest the supports were when the blocks stayed if they stopped [m]; None where
        they did not even at the start.
    `high`: Nearest at which the blocks fell although they stopped; None where they never fell.
    `solved`: Whether every step was, and the supports went on until blocks fell, or as far as
        asked.
    `runs`: How often the supports were stopped.
    """

    low: float | None
    high: float | None
    solved: bool
    runs: int


@dataclass(frozen=True, eq=False)
class Spreading:
    """A problem whose supports move, by `moves` or else two of them apart, each by half."""

    asked: Problem

    @cached_property
    def problem(self) -> Problem:
        """The problem with its supports' motion."""
        asked = self.asked
        if not asked.moves and isinstance(asked.maker, CircularArch) and asked.maker.in_radii:
            # On two planes; what moves are supports that are drawn.
            asked = remade(asked, asked.maker.but(on_supports=True))
        supports = asked.assembly.supports
        allowed = "left out where supports move"
        require(not bears(asked), "fill_passive", "given", allowed)
        crush = asked.strength
        value = f"{(crush or 0.0) / 1e6:g} MPa"
        require(crush is None, "strength", value, f"{allowed}: blocks are rigid there")
        if asked.moves:
            return asked
        joints = asked.assembly.springings
        if len(supports) != len(SIDES) or {joint.support for joint in joints} != {0, 1}:
            allowed = "another parameter, or `move` in the file: what moves has to be said"
            raise InputError("--over", "spread", allowed)
        middles = [np.concatenate(each.polygons).mean(axis=0) for each in supports]
        left = 0 if middles[0][0] < middles[1][0] else 1
        moves = tuple(
            Move(support=at, direction=np.array([side / 2, 0.0]), about=middles[at])
            for at, side in zip((left, 1 - left), SIDES, strict=True)
        )
        return replace(asked, moves=moves)

    @cached_property
    def fastest(self) -> float:
        """How much faster than the parameter joints on a support move, at least 1."""
        assembly = self.problem.assembly
        found = 1.0
        for move in self.problem.moves:
            on = [each for each in assembly.joints if each.support == move.support]
            ends = np.array([end for each in on for end in (each.inner, each.outer)])
            arm = float(np.hypot(*(ends.reshape(-1, 2) - move.about).T).max(initial=0.0))
            turned = max(arm, assembly.size / math.pi) * abs(move.turn)
            found = max(found, math.hypot(*move.direction) + turned)
        return found

    @property
    def farthest(self) -> float:
        """Largest value of the parameter, at which supports are as far as they go [m]."""
        return FARTHEST * self.problem.assembly.size / self.fastest

    @cached_property
    def path(self) -> Path:
        """What limit analysis says of the way."""
        return follow(self.problem, self.farthest)

    def at(self, value: float) -> Problem:
        """Return the problem as it lies where the supports have moved so far."""
        return displaced_at(self.problem, self.path, value)

    @property
    def exact(self) -> float | None:
        """How far the supports can move until blocks first fall, caught again or not [m].

        None where what they do before that was not followed.
        """
        falls = self.path.first_fall
        return math.inf if falls is None and self.path.ends == "range" else falls

    @property
    def words(self) -> str:
        """Say what happens on the way."""
        return "".join(f"; {event_words(event)}" for event in self.events)

    @property
    def events(self) -> tuple[Event, ...]:
        """What happens on the way, each with the joints that are open after it."""
        assembly = self.problem.assembly
        return tuple(
            Event(
                value=event.value,
                what=event.what,
                joints=tuple(
                    OpenJoint(
                        a=side_name(assembly, index, 0),
                        b=side_name(assembly, index, 1),
                        state=state.value,
                    )
                    for index, state in enumerate(event.after.states)
                    if state is not JointState.CLOSED
                ),
            )
            for event in self.path.events
        )

    def slowly(self, tol: float, highest: float, progress: Progress = silent) -> Slow:
        """Move the supports slowly in `direct`, and stop them at times.

        Blocks fall at once when their supports move beyond what they bear, but how fast
        is a matter of the supports' speed. So the position is sought, by halving, from
        which on blocks do not stay where they are when the supports stop.

        `tol`: Relative distance between the two positions.
        `highest`: How far the supports move at most [m].
        """
        problem = self.problem
        settings = replace(USUAL, step=STEP)

        def stays(frame: _At) -> bool:
            stopped = OnMovingSupports(problem, settings, 0.0)
            stopped.place(*frame)
            return stopped.starts() < STARTS

        speed, runs, whole = SPEED / self.fastest, 0, True
        world = OnMovingSupports(problem, settings, speed)
        # Blocks that mirror each other would balance where any breath lets them fall.
        sideways = np.zeros_like(world.poses())
        sideways[: len(problem.assembly.blocks), 0] = SIDEWAYS * SPEED
        world.push(sideways)
        frames, again = _run(world, highest, FAST * speed * self.fastest, progress), 0
        while True:
            whole = whole and solved(world)
            last, more = _last(frames, stays)
            runs += more
            low = None if last < 0 else frames[last][0]
            high = None if last + 1 == len(frames) else frames[last + 1][0]
            if high is not None and low is not None and high - low > tol * high:
                speed *= 0.9 * tol * high / (high - low)
            elif low is None or high is not None or low >= highest or not whole:
                break
            elif again == AGAIN:
                whole = False
                break
            else:
                # They were fast, but did not fall: they were caught, or hinges are near a line.
                again += 1
            world = OnMovingSupports(problem, settings, speed)
            world.place(*frames[last])
            frames = _run(world, highest, FAST * speed * self.fastest, progress)
        return Slow(low=low, high=high, solved=whole, runs=runs)

    def recorded(self, progress: Progress = silent) -> Recording:
        """Move the supports by `direct`, faster than `slowly`, until the blocks fall.

        There they stop. The recording goes on until what has fallen lies still.

        Returns: Of the blocks and, after them, the supports that move.
        """
        settings = USUAL
        level = all(move.direction[1] >= 0 and not move.turn for move in self.problem.moves)
        deep = SHALLOW if level else DEEP
        world = OnMovingSupports(self.problem, settings, SEEN / self.fastest, deep)
        stride = round(FRAME / settings.step)
        times, poses, fell = [0.0], [world.poses()], math.inf
        while world.value < self.farthest and times[-1] < fell + AFTER and solved(world):
            for _ in range(stride):
                world.advance_once()
            times.append(times[-1] + stride * settings.step)
            poses.append(world.poses())
            if world.fastest > FAST * SEEN and fell == math.inf:
                fell = times[-1]
                world.stop()
            if fell < times[-1] and lie_still(world.problem.assembly, poses):
                break
            progress(world.value / self.farthest, f"supports at {world.value:.4g} m")
        return Recording(
            # Supports that move are its last blocks; it says so by their moves.
            problem=replace(
                world.problem,
                moves=tuple(
                    replace(move, support=len(world.problem.assembly.supports) - 1)
                    for move in self.problem.moves
                ),
            ),
            engine=ENGINE.name,
            engine_version=ENGINE.version,
            settings=settings,
            times=np.array(times),
            poses=np.array(poses),
            quality=replace(world.quality(), gain=None),
        )


_At = tuple[float, Array]
"""How far the supports are [m], and poses of blocks and supports."""


def _run(
    world: OnMovingSupports, highest: float, fastest: float, progress: Progress
) -> list[_At]:
    """Move the supports until the blocks fall, or as far as they go."""
    frames = [(world.value, world.poses())]
    while world.value < highest and world.fastest < fastest:
        world.advance_once()
        if not solved(world):
            break
        frames.append((world.value, world.poses()))
        progress(world.value / highest, f"supports at {world.value:.4g} m")
    return frames


def solved(world: OnMovingSupports) -> bool:
    """Tell whether every step of a world was solved."""
    return (world.quality().residual or 0.0) <= UNSOLVED


def _last(frames: Sequence[_At], stays: Callable[[_At], bool]) -> tuple[int, int]:
    """Find the last frame at which blocks stay, -1 for none; and how many were tried."""
    if stays(frames[-1]):
        return len(frames) - 1, 1
    if not stays(frames[0]):
        return -1, 2
    low, high, runs = 0, len(frames) - 1, 2
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if stays(frames[middle]) else (low, middle)
        runs += 1
    return low, runs


def event_words(event: Event) -> str:
    """Say what happens, and where."""
    said = ", ".join(f"{joint.a}-{joint.b} {joint.state}" for joint in event.joints)
    what = _WORDS[event.what] if said or event.what != "hinges" else "no joint opens"
    return f"at {event.value:.6g} m {what}{': ' if said else ''}{said}"


_WORDS = {
    "hinges": "hinges form",
    "moves": "a hinge closes and another opens",
    "snaps": "it falls and is caught",
    "collapse": "it falls",
    "falls-slides": "it gives way, and a joint slides, which is not followed",
    "falls-parts": "it gives way, and a joint parts, which is not followed",
    "falls-meets": "it gives way, and blocks meet that did not touch, which is not followed",
    "slides": "a joint begins to slide, which is not followed",
    "parts": "a joint parts, which is not followed",
    "meets": "blocks meet that did not touch, which is not followed",
    "jams": "blocks jam: they follow only if joints slide, which is not followed",
}
