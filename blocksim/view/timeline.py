"""What a recording shows at any time, in the plane or in space, and what joints are seen to do.

Lengths are in units of the assembly's size, which is an arch's radius r, times in units of
sqrt(size/g).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.blocks.space.extruded import lifted
from blocksim.common.later import transform
from blocksim.simulation.motion import AT_REST, FRAME, UNMOVED, UNSEEN
from blocksim.simulation.recording import Recording

UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Turns what has z upwards so that y is upwards."""
SAMPLES = 500
"""Most frames that are looked at for what a film needs to know beforehand."""
ROUNDING = 1e-12
"""Way from one frame to the next that is none [size]."""
STILL, GONE = 2e-3, 3e-2
"""Displacements between which forces at rest fade: they are those of what is built."""
SEEN = 4e-3
"""Turn or slip of a joint from which on it is coloured [r]: a pixel of a film."""


class Moment(NamedTuple):
    """Blocks and joints at one time, y upwards, z towards the viewer.

    `turns`, `places`, (blocks, 3, 3) and (blocks, 3): Turns of blocks since they were built,
        and their centres.
    `statics`: 1 while the line of thrust of the arch at rest still says something, falling to
        0.
    """

    time: float
    turns: Array
    places: Array
    joints: tuple[JointState, ...]
    statics: float


def poses_between(recording: Recording[Any], earlier: int, later: int, share: float) -> Array:
    """Return poses at a share of the way from one frame to another.

    Returns: Centres x, y, z (upwards) and rotation vectors, (blocks, 6).
    """
    poses = recording.poses[[earlier, later]]
    one, two = poses if recording.problem.in_space else lifted(poses)
    if not share:
        return one
    # Turns between frames are even.
    first = transform.Rotation.from_rotvec(one[:, 3:])
    way = (transform.Rotation.from_rotvec(two[:, 3:]) * first.inv()).as_rotvec()
    turned = transform.Rotation.from_rotvec(share * way) * first
    places = one[:, :3] + share * (two[:, :3] - one[:, :3])
    return np.hstack([places, turned.as_rotvec()])


def upright(poses: Array) -> tuple[Array, Array]:
    """Return turns, (blocks, 3, 3), and centres, (blocks, 3), y upwards, of poses."""
    turns = transform.Rotation.from_rotvec(poses[:, 3:]).as_matrix()
    return UPRIGHT @ turns @ UPRIGHT.T, poses[:, :3] @ UPRIGHT.T


class Timeline(ABC):
    """Times of a recording, what is known of them, and where blocks are.

    `near`: Share of the usual room beside the blocks that is shown from the start.
    `pieces`: Each convex piece of a block: the block, and corners from its centre as built,
        (k, 3) [size], y upwards.
    """

    def __init__(
        self, recording: Recording[Any], near: float, pieces: Sequence[tuple[int, Array]]
    ) -> None:
        self.recording, self._near = recording, near
        self._corners = np.concatenate([each for _, each in pieces])[:, None]
        self._owner = np.repeat([at for at, _ in pieces], [len(each) for _, each in pieces])

    def at(self, time: float) -> Moment:
        """Return where everything is at a time, between frames by even turns."""
        poses = self.poses_at(time)
        time, earlier, later, share = self.between(time)
        joints = self.joints_at(self._looked_at(poses, earlier, later, share), time)
        return Moment(time, *upright(poses), joints, self.statics_at(time))

    def _looked_at(self, poses: Array, earlier: int, later: int, share: float) -> Array:  # noqa: ARG002
        """Return poses as joints are looked at, at a share of the way between two frames."""
        return poses

    def corners_at(self, time: float) -> Array:
        """Return the corners of all pieces at a time, (corners, 3)."""
        return self._placed(self.poses_at(time))

    def _placed(self, poses: Array) -> Array:
        turns, places = upright(poses)
        corners = self._corners @ turns[self._owner].swapaxes(1, 2)
        return corners[:, 0] + places[self._owner]

    def corners_of(self, frame: int) -> Array:
        """Return the corners of all pieces in a frame, (corners, 3)."""
        return self._placed(poses_between(self.recording, frame, frame, 0.0))

    def point_at(self, moment: Moment, block: int, arm: Array) -> Array:
        """Return the place of a point of a block, given from its centre as built [size]."""
        return moment.places[block] + moment.turns[block] @ UPRIGHT @ arm

    @cached_property
    @abstractmethod
    def end(self) -> float:
        """Time until which it is shown."""

    @abstractmethod
    def joints_at(self, poses: Array, time: float) -> tuple[JointState, ...]:
        """Tell what joints are seen to do at poses, and their time."""

    @cached_property
    def carriers(self) -> frozenset[int]:
        """The blocks that are supports which move: the last ones."""
        count = len(self.recording.assembly.blocks)
        return frozenset(range(count - len(self.recording.problem.moves), count))

    @property
    def _last(self) -> int:
        """The last frame that is shown."""
        return int(np.searchsorted(self.recording.times, self.end, "right")) - 1

    @property
    def unit(self) -> float:
        """Seconds in the unit of time."""
        return self.recording.problem.seconds

    @cached_property
    def displaced(self) -> Array:
        """Largest displacement of any corner at each frame."""
        return self.recording.displacement

    @property
    def moves(self) -> bool:
        """Whether anything can be seen to move."""
        return bool(self.displaced.max() > SEEN)

    @cached_property
    def speed(self) -> float:
        """Speed of the fastest corner at the end [m/s]: 0 where blocks have lain still."""
        times, poses = self.recording.times, self.recording.poses
        last = self._last
        if last == 0:
            return 0.0
        first = min(int(np.searchsorted(times, float(times[last]) - AT_REST * FRAME)), last - 1)
        since = poses[first : last + 1] - poses[last]
        # Supports that are moved do not tell whether blocks lie still.
        since[:, sorted(self.carriers)] = 0.0
        since = self.recording.assembly.displacement(since)
        is_long = first > 0 or bool(self.displaced[: last + 1].max() <= UNMOVED)
        if is_long and float(since.max()) < UNSEEN:
            return 0.0
        if float(since[-2]) < ROUNDING:
            return 0.0
        step = float(times[last] - times[last - 1]) * self.recording.problem.seconds
        return float(since[-2]) * self.recording.assembly.size / step

    @cached_property
    def rested(self) -> float:
        """Time from which on nothing is seen to move, at the latest the end."""
        if self.recording.problem.shaking is not None:
            return self.end
        poses, way = self.recording.poses, self.recording.assembly.displacement
        last = still = self._last
        while still and float(way(poses[still - 1] - poses[last])) < SEEN:
            still -= 1
        return float(self.recording.times[still])

    @cached_property
    def states(self) -> tuple[JointState, ...]:
        """Joint states that are ever seen, in the order of `JointState`, closed left out."""
        times, poses = self.recording.times.tolist(), self.recording.poses
        seen = {each for k in self.shown for each in self.joints_at(poses[k], times[k])}
        return tuple(state for state in JointState if state in seen - {JointState.CLOSED})

    @cached_property
    def shown(self) -> list[int]:
        """Frames that are shown, or as many of them as tell enough of a long recording."""
        last = self._last
        return sorted({*range(0, last, 1 + last // SAMPLES), last})

    def between(self, time: float) -> tuple[float, int, int, float]:
        """Return a time that is shown, the frames around it, and its share of the way."""
        times = self.recording.times
        time = float(np.clip(time, times[0], self.end))
        later = int(np.clip(np.searchsorted(times, time), 1, len(times) - 1))
        earlier = later - 1 if len(times) > 1 else later
        gap = times[later] - times[earlier]
        return time, earlier, later, float((time - times[earlier]) / gap) if gap > 0 else 0.0

    def poses_at(self, time: float) -> Array:
        """Return poses at a time that is shown, as of `poses_between`."""
        return poses_between(self.recording, *self.between(time)[1:])

    def statics_at(self, time: float) -> float:
        """Return how much forces at rest still say at a time, from 1 falling to 0."""
        moved = float(np.interp(time, self.recording.times, self.displaced))
        return float(np.interp(moved, (STILL, GONE), (1.0, 0.0)))
