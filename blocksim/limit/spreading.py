"""What blocks do on supports that move slowly: hinges are followed until nothing holds them.

At each position of the supports the blocks rest on the contacts that are still closed, by the
linear programme on the displaced blocks. Which contacts open, as the supports move on, its
dual tells (`settling`). Between two events the hinges stay the same, and the blocks follow from
geometry alone, however far they move (Ochsendorf 2006). An event is a contact that closes
again, or forces that no longer fit: then the blocks move with the supports at rest, along the
mechanism of the linear programme, until a contact that closes holds them, or they fall.

Contacts neither slip nor part here. Where they would, the path ends and says so.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array, Block, Joint
from blocksim.blocks.joints import JointState
from blocksim.blocks.problem import Load, Problem
from blocksim.limit.programme import equilibrium, falling, settling

Closed = NDArray[np.bool_]
Ends = Literal["collapse", "slides", "parts", "range"]
ENOUGH = 1e-9
"""Lack of force at which blocks still rest [mean weights]."""
OPENS = 1e-7
"""Rate of a contact, over the largest of any block, from which on it opens or slips."""
SHUT = 1e-11
"""Overlap of a contact that is round-off [size]."""
PUSH = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3)
"""How far beyond an event it is looked at, the first that tells [size]."""
WAY = 5e-3
"""Way of the fastest corner in one step of a fall [size]."""
FALLEN = 0.2
"""Way in a fall after which nothing is expected to hold the blocks [size]."""
OFF = 1e-9
"""How far closed contacts may be apart; the blocks cannot follow where it is more [size]."""
ROUNDS = 50
"""Most corrections of places; a few are the rule."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Frame:
    """Blocks at rest on supports that have moved.

    Parameters
    ----------
    value : float
        The parameter of the supports' motion [m].
    poses : (blocks, 3) float
        Centres of mass x, y in units of the size, and rotations.
    closed : (joints, 2) bool
        Which ends of the joints are closed, inner and outer.
    """

    value: float
    poses: Array
    closed: Closed

    @property
    def states(self) -> tuple[JointState, ...]:
        """What each joint does."""
        return tuple(_STATES[inner, outer] for inner, outer in self.closed.tolist())


_STATES = {
    (True, True): JointState.CLOSED,
    (True, False): JointState.HINGE_INTRADOS,
    (False, True): JointState.HINGE_EXTRADOS,
    (False, False): JointState.OPEN,
}


@dataclass(frozen=True, eq=False, kw_only=True)
class Event:
    """Something that happens at one position of the supports.

    Parameters
    ----------
    what : str
        `hinges` form first, `moves`: one closes and another opens, `snaps`: the same by a fall
        that is caught, `collapse`, `falls-slides` or `falls-parts`: a fall in which a joint
        slides or parts, which is not followed to its end; `slides`, `parts`.
    before, after : Frame
        The same position, the hinges before and after it.
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

    Parameters
    ----------
    frames : tuple of Frame
        From where they were built to the last position of rest.
    events : tuple of Event
    ends : str
        `collapse`, `range` (the supports moved as far as asked), or `slides`, `parts`: what
        joints would do at rest, which is not followed.
    """

    frames: tuple[Frame, ...]
    events: tuple[Event, ...]
    ends: Ends

    @property
    def value(self) -> float:
        """How far the supports moved [m]."""
        return self.frames[-1].value


def follow(problem: Problem, highest: float, steps: int = 100) -> Path:
    """Move the supports slowly, and follow the blocks.

    Parameters
    ----------
    problem : Problem
        In its plane, with `moves`.
    highest : float
        How far the supports move at most [m].
    steps : int
        Positions on the way at which events are looked for between.

    Returns
    -------
    Path
    """
    blocks = _Displaced(problem)
    frame = blocks.start
    frames, events = [frame], list[Event]()
    if blocks.margin(frame) < -ENOUGH:
        return Path(frames=(frame,), events=(), ends="collapse")
    frame, lost = blocks.follows(frame)
    events.append(Event(what="hinges", before=frames[0], after=frame))
    grid = np.linspace(0, highest, steps + 1)[1:].tolist()
    while lost is None and grid:
        ahead = blocks.carried(frame, grid[0])
        what, at = blocks.first_event(frame, ahead)
        if what is None:
            frame = ahead
            frames.append(frame)
            grid.pop(0)
            continue
        before = at
        if what == "snaps":
            caught, lost = blocks.falls(before)
            if caught is None:
                frames.append(before)
                after = blocks.fallen or before
                what = "collapse" if lost is None else f"falls-{lost}"
                events.append(Event(what=what, before=before, after=after))
                return Path(frames=tuple(frames), events=tuple(events), ends="collapse")
            at = caught
        frame, lost = blocks.follows(at)
        events.append(Event(what=lost or what, before=before, after=frame))
        frames += [before, frame]
    return Path(frames=tuple(frames), events=tuple(events), ends=lost or "range")


def lying(problem: Problem, path: Path, value: float) -> Problem:
    """Return a problem as it lies where the supports have moved so far.

    Contacts that are open are none; beyond the end of the path the last hinges go on.
    """
    blocks = _Displaced(problem)
    before = [each for each in path.frames if each.value <= value]
    return blocks.problem(blocks.carried(before[-1] if before else path.frames[0], value))


class _Displaced:
    """A problem whose blocks and supports have moved, and what its contacts allow."""

    def __init__(self, problem: Problem) -> None:
        assembly = problem.assembly
        self._problem, self._size = problem, assembly.size
        self._count = len(assembly.blocks)
        joints = assembly.joint_arrays
        on = [0 if each.support is None else each.support for each in assembly.joints]
        supports = self._count + np.array(on, dtype=np.int64)
        self._sides = np.stack(
            [
                np.where(side == SUPPORT, supports, side)
                for side in (joints.before, joints.after)
            ],
            axis=1,
        )
        self._supports = max(len(assembly.supports), 1 + max(on, default=0))
        built = np.zeros((self._count + self._supports, 2))
        built[: self._count] = assembly.centres / self._size
        self._arms = joints.ends[:, None] - built[self._sides][:, :, None]
        self._axes, self._corner = joints.normal, joints.is_corner
        self._reach = assembly.reach / self._size
        closed = np.ones((len(assembly.joints), 2), dtype=np.bool_)
        closed[self._corner, 1] = False
        poses = np.column_stack([built[: self._count], np.zeros(self._count)])
        self.start = Frame(value=0.0, poses=poses, closed=closed)
        self.fallen: Frame | None = None

    def _placed(self, value: float) -> Array:
        """Poses of the supports, as turned about the origin and then shifted."""
        found = np.zeros((self._supports, PLANAR))
        for move in self._problem.moves:
            turn, about = move.turn * value, move.about / self._size
            cos, sin = math.cos(turn), math.sin(turn)
            turned = np.array(
                [cos * about[0] - sin * about[1], sin * about[0] + cos * about[1]]
            )
            shift = about - turned + move.direction * value / self._size
            found[move.support] = *shift, turn
        return found

    def _speeds(self, value: float) -> Array:
        """Velocities of the supports over the parameter [size], as `settling` takes them."""
        found = np.zeros((self._supports, PLANAR))
        for move in self._problem.moves:
            turn = move.turn * self._size
            x, y = (move.about + move.direction * value) / self._size
            found[move.support] = (
                move.direction[0] + turn * y,
                move.direction[1] - turn * x,
                turn,
            )
        return found

    def _arms_at(self, frame: Frame) -> tuple[Array, Array]:
        """Poses of the bodies on both sides of joints, and arms from them to their ends."""
        poses = np.vstack([frame.poses, self._placed(frame.value)])[self._sides]
        cos, sin = np.cos(poses[:, :, 2])[:, :, None], np.sin(poses[:, :, 2])[:, :, None]
        x, y = self._arms[..., 0], self._arms[..., 1]
        return poses, np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)

    def _points(self, frame: Frame) -> Array:
        """Return the ends of the joints on both bodies, (joints, 2 bodies, 2 ends, 2)."""
        poses, arms = self._arms_at(frame)
        return poses[:, :, None, :2] + arms

    def gaps(self, frame: Frame) -> Array:
        """How far apart the ends of joints are, (joints, 2); inf of those that cannot close."""
        points = self._points(frame)
        poses = np.vstack([frame.poses, self._placed(frame.value)])
        turn = poses[self._sides[:, 0], 2]
        x, y = self._axes.T
        normal = np.stack(
            [np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y], axis=-1
        )
        gap = ((points[:, 1] - points[:, 0]) * normal[:, None]).sum(axis=-1)
        gap[self._corner, 1] = np.inf
        gap[~frame.closed.any(axis=1)] = np.inf
        return gap

    def problem(self, frame: Frame) -> Problem:
        """Return the problem as it lies, with the contacts that are closed."""
        asked, size = self._problem, self._size
        places = frame.poses.copy()
        places[:, :2] *= size
        points = self._points(frame) * size
        blocks = tuple(
            _moved(block, pose)
            for block, pose in zip(asked.assembly.blocks, places, strict=True)
        )
        joints: list[Joint] = []
        for index, joint in enumerate(asked.assembly.joints):
            ends = np.flatnonzero(frame.closed[index])
            on_before, on_after = points[index]
            middle = points[index].mean(axis=0)
            if len(ends) == 0:
                continue
            if len(ends) > 1:
                joints.append(replace(joint, inner=middle[0], outer=middle[1], faces=None))
                continue
            # A hinge bears across the line that halves the angle between both faces.
            faces = [side[1] - side[0] for side in (on_before, on_after)]
            if joint.is_corner:
                faces = [np.array([-joint.normal[1], joint.normal[0]])]
            along = np.sum([each / np.hypot(*each) for each in faces], axis=0)
            along = along / np.hypot(*along)
            at = middle[ends[0]]
            joints.append(
                replace(
                    joint,
                    inner=at,
                    outer=at,
                    across=np.array([along[1], -along[0]]),
                    faces=np.array([[at, at + along], [at, at]]),
                )
            )
        return replace(
            asked,
            assembly=replace(asked.assembly, blocks=blocks, joints=tuple(joints)),
            dead=self._carried_loads(asked.dead, frame),
            live=self._carried_loads(asked.live, frame),
        )

    def _carried_loads(self, loads: tuple[Load, ...], frame: Frame) -> tuple[Load, ...]:
        """Return loads whose points have moved with their blocks."""
        found: list[Load] = []
        for load in loads:
            if load.point is None:
                found.append(load)
                continue
            for index in load.blocks:
                x, y, turn = frame.poses[index]
                arm = load.point - self._problem.assembly.centres[index]
                point = np.array([x, y]) * self._size + _turned(arm, turn)
                found.append(replace(load, blocks=(index,), point=point))
        return tuple(found)

    def margin(self, frame: Frame) -> float:
        """Say how well forces of equilibrium fit into the closed contacts."""
        if len(left := self._apart(frame)[0]) and np.abs(left).max() > OFF:
            return -1.0
        return max(equilibrium(self.problem(frame)).margin, -1.0)

    def opened(
        self, frame: Frame, rates: Array, value_rate: float
    ) -> tuple[Frame, Ends | None]:
        """Return a frame without the contacts that a motion opens, and what else it does."""
        _, arms = self._arms_at(frame)
        bodies = np.vstack([rates, value_rate * self._speeds(frame.value)])[self._sides]
        # Velocities of supports are told at the origin, so their arms are points.
        points = self._points(frame)
        arms = np.where((self._sides < self._count)[:, :, None, None], arms, points)
        turn = bodies[:, :, None, 2]
        way = np.stack(
            [
                bodies[:, :, None, 0] - turn * arms[..., 1],
                bodies[:, :, None, 1] + turn * arms[..., 0],
            ],
            axis=-1,
        )
        apart = way[:, 1] - way[:, 0]
        scale = np.abs(rates).max() or 1.0
        poses = np.vstack([frame.poses, self._placed(frame.value)])
        middle = (poses[self._sides[:, 0], 2] + poses[self._sides[:, 1], 2]) / 2
        normal = _turned(self._axes.T, middle).T
        opens = frame.closed & ((apart * normal[:, None]).sum(axis=-1) > OPENS * scale)
        stays = frame.closed & ~opens
        slips = np.hypot(apart[..., 0], apart[..., 1]) > 10 * OPENS * scale
        lost: Ends | None = None
        if (stays & slips).any():
            lost = "slides"
        elif (frame.closed.any(axis=1) & ~stays.any(axis=1)).any():
            lost = "parts"
        return replace(frame, closed=stays), lost

    def follows(self, frame: Frame) -> tuple[Frame, Ends | None]:
        """Open the contacts that open as the supports move on."""
        rates = settling(self.problem(frame), self._speeds(frame.value))
        if rates is None:
            return frame, None
        return self.opened(frame, rates, 1.0)

    def carried(self, frame: Frame, value: float, poses: Array | None = None) -> Frame:
        """Carry the blocks to another position of the supports, contacts closed as they are."""
        now = replace(frame, value=value, poses=frame.poses if poses is None else poses)
        for _ in range(ROUNDS):
            left, rows = self._apart(now)
            change = np.linalg.lstsq(rows, -left, rcond=1e-12)[0]
            now = replace(now, poses=now.poses + change.reshape(-1, PLANAR))
            if np.abs(change).max(initial=0.0) < 1e-14:
                break
        return now

    def _apart(self, frame: Frame) -> tuple[Array, Array]:
        """How far closed contacts are apart, and the rates of that."""
        poses, arms = self._arms_at(frame)
        points = poses[:, :, None, :2] + arms
        left: list[float] = []
        rows: list[Array] = []
        for index, closed in enumerate(frame.closed.tolist()):
            if not any(closed):
                continue
            end = 0 if closed[0] else 1
            for axis in (0, 1):
                row = np.zeros((self._count + self._supports, PLANAR))
                for side, sign in ((1, 1.0), (0, -1.0)):
                    body = self._sides[index, side]
                    arm = arms[index, side, end]
                    row[body, axis] = sign
                    row[body, 2] = sign * (-arm[1] if axis == 0 else arm[0])
                rows.append(row)
                left.append(points[index, 1, end, axis] - points[index, 0, end, axis])
            if all(closed):
                row = np.zeros((self._count + self._supports, PLANAR))
                row[self._sides[index, 1], 2], row[self._sides[index, 0], 2] = 1.0, -1.0
                rows.append(row)
                left.append(float(poses[index, 1, 2] - poses[index, 0, 2]))
        whole = np.array(rows)[:, : self._count].reshape(len(rows), -1)
        return np.array(left), whole

    def first_event(self, frame: Frame, ahead: Frame) -> tuple[str | None, Frame]:
        """Find what happens first on the way from a frame to the next."""

        def closing(now: Frame) -> float:
            return float(np.where(frame.closed, np.inf, self.gaps(now)).min()) + SHUT

        what, found = None, ahead
        for name, measure, least in (("moves", closing, 0), ("snaps", self.margin, -ENOUGH)):
            if measure(found) >= least:
                continue
            found = self._where(measure, frame, found)
            what = name
        if what == "moves":
            shut = ~frame.closed & (self.gaps(found) <= 10 * SHUT)
            found = replace(found, closed=frame.closed | shut)
        return what, found

    def _where(self, measure: Callable[[Frame], float], frame: Frame, ahead: Frame) -> Frame:
        """Find the position at which a measure falls to nothing."""

        def at(share: float) -> Frame:
            value = frame.value + share * (ahead.value - frame.value)
            return self.carried(frame, value, frame.poses + share * (ahead.poses - frame.poses))

        if measure(at(0.0)) <= 0:
            return at(0.0)
        return at(float(brentq(lambda share: measure(at(share)), 0.0, 1.0, xtol=1e-13)))

    def falls(self, frame: Frame) -> tuple[Frame | None, Ends | None]:
        """Let the blocks fall on supports at rest; return where they are caught."""
        self.fallen, now = None, frame
        for push in PUSH:
            now = self.carried(frame, frame.value + push * self._size)
            if self.margin(now) < -10 * ENOUGH:
                break
        way = 0.0
        while way < FALLEN:
            rates = falling(self.problem(now))
            if rates is None:
                return now, None
            now, lost = self.opened(now, rates, 0.0)
            self.fallen = self.fallen or now
            if lost is not None:
                return None, lost
            fastest = (np.hypot(*rates[:, :2].T) + np.abs(rates[:, 2]) * self._reach).max()
            ahead = self.carried(now, now.value, now.poses + WAY / fastest * rates)
            what, now = self._caught(now, ahead)
            way += WAY if what is None else WAY / 100
        return None, None

    def _caught(self, frame: Frame, ahead: Frame) -> tuple[str | None, Frame]:
        """Go on with a fall until the first contact closes."""

        def closing(now: Frame) -> float:
            return float(np.where(frame.closed, np.inf, self.gaps(now)).min()) + SHUT

        if closing(ahead) >= 0:
            return None, ahead
        found = self._where(closing, frame, ahead)
        shut = ~frame.closed & (self.gaps(found) <= 10 * SHUT)
        return "shut", replace(found, closed=frame.closed | shut)


def _turned(arm: Array, turn: Array | float) -> Array:
    """Vectors (2, ...) turned by angles."""
    cos, sin = np.cos(turn), np.sin(turn)
    return np.array([cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]])


def _moved(block: Block, pose: Array) -> Block:
    """Return a block where it lies."""
    x, y, turn = pose.tolist()

    def carried(points: Array) -> Array:
        return _turned((points - block.centre).T, turn).T + np.array([x, y])

    return replace(
        block,
        vertices=carried(block.vertices),
        centre=np.array([x, y]),
        parts=tuple(carried(part) for part in block.parts),
    )
