"""A recording in space made ready for the eye, as `blocksim.view.stage` does it in the plane.

Lengths are in units of the size, y upwards.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.limit.carried import Carried
from blocksim.simulation.recording import Recording
from blocksim.view.solidscene import UPRIGHT, corners_of, moving_box, states_at, supports_of
from blocksim.view.timeline import Timeline

FARTHEST = 1.75
"""Blocks are followed from the start up to this far beyond where they were at rest [size]."""


class SolidMoment(NamedTuple):
    """Turns (blocks, 3, 3) and shifts [m, z upwards] at a time; `statics` falls from 1 to 0."""

    time: float
    turns: Array
    shifts: Array
    joints: tuple[JointState, ...]
    statics: float


class SolidStage(Timeline):
    """Everything that is drawn of a recording in space, without what is far from the blocks.

    `near` is the share of the usual room beside the blocks that is shown from the start;
    `depth` is that of all towards the viewer, `grain` the size of the smallest block, `ground`
    the lowest level that anything comes to.
    """

    is_arch = False
    sinks = np.inf
    thrust: tuple[Array, ...] = ()
    carried: Carried | None = None

    def __init__(self, recording: Recording[SpatialAssembly], near: float = 1.0) -> None:
        super().__init__(recording)
        self.assembly = recording.assembly
        # Turns between frames of the recording are even.
        self._turns = [Rotation.from_rotvec(each[:, 3:]) for each in recording.poses]
        size = self.assembly.size
        low, high = moving_box(self.assembly) / size
        beyond = near * FARTHEST
        times = recording.times[self.shown].tolist()
        every = np.concatenate([self.corners_at(each) for each in times]) @ UPRIGHT
        every = np.clip(every, low - beyond, high + beyond)
        ends = size * every.min(axis=0), size * every.max(axis=0)
        self.supports = supports_of(self.assembly, *ends)
        solid = [hull.corners / size for hull in self.supports]
        self.swept: Array = np.concatenate([every, *solid]) @ UPRIGHT.T
        self.ground = float(self.swept[:, 1].min())
        self.middle = float(low[0] + high[0]) / 2
        self.depth = float(high[1] - low[1])
        self.grain = float(self.assembly.reach.min()) / size

    @cached_property
    def end(self) -> float:
        """Time at which the recording ends."""
        return float(self.recording.times[-1])

    def joints_at(self, poses: Array, time: float) -> tuple[JointState, ...]:  # noqa: ARG002
        """Tell what joints are seen to do at poses, (blocks, 6)."""
        return states_at(self.assembly, poses)

    def at(self, time: float) -> SolidMoment:
        """Return where everything is at a time, between frames by even turns."""
        time = self.between(time)[0]
        turns, shifts = self._placed(time)
        built = self.recording.poses[0, :, :3] + shifts / self.assembly.size
        poses = np.concatenate([built, Rotation.from_matrix(turns).as_rotvec()], axis=1)
        joints = self.joints_at(poses, time)
        return SolidMoment(time, turns, shifts, joints, self.statics_at(time))

    def corners_at(self, time: float) -> Array:
        """Return the corners of a moment alone, (k, 3)."""
        return corners_of(self.assembly, *self._placed(time))

    def point_at(self, moment: SolidMoment, block: int, arm: Array) -> Array:
        """Where a point of a block is that lies so far from its centre as built [size]."""
        place = self.assembly.centres[block] + moment.shifts[block]
        return UPRIGHT @ (place / self.assembly.size + moment.turns[block] @ arm)

    def _placed(self, time: float) -> tuple[Array, Array]:
        """Return turns of the blocks at a time, and shifts of their centres [m]."""
        _, earlier, later, share = self.between(time)
        poses = self.recording.poses[..., :3]
        one, two = self._turns[earlier], self._turns[later]
        turns = Rotation.from_rotvec(share * (two * one.inv()).as_rotvec()) * one
        shift = poses[earlier] + share * (poses[later] - poses[earlier]) - poses[0]
        return turns.as_matrix(), shift * self.assembly.size
