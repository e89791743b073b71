"""A recording in space made ready for the eye, as `blocksim.view.stage` does it in the plane.

Lengths are in units of the size, y upwards.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.limit.carried import Carried
from blocksim.simulation.recording import Recording
from blocksim.view.solidscene import Solids, moving_box, states_at, supports_of
from blocksim.view.timeline import UPRIGHT, Timeline

FARTHEST = 1.75
"""Blocks are followed from the start up to this far beyond where they were at rest [size]."""


class SolidStage(Timeline):
    """Everything that is drawn of a recording in space, without what is far from the blocks.

    `near` is the share of the usual room beside the blocks that is shown from the start;
    `depth` is that of all towards the viewer, `grain` the size of the smallest block, `ground`
    the lowest level that anything comes to.
    """

    eye = math.radians(30.0), math.radians(22.0)
    """Where it is seen from, turned about the vertical and raised: tops have much to show."""
    is_arch = False
    thrust: tuple[Array, ...] = ()
    carried: Carried | None = None

    def __init__(self, recording: Recording[SpatialAssembly], near: float = 1.0) -> None:
        self.assembly = recording.assembly
        size = self.assembly.size
        pieces = [
            (at, (hull.corners - block.centre) / size @ UPRIGHT.T)
            for at, block in enumerate(self.assembly.blocks)
            for hull in block.hulls
        ]
        super().__init__(recording, near, pieces)
        low, high = moving_box(self.assembly) / size
        beyond = near * FARTHEST
        every = np.concatenate([self.corners_of(frame) for frame in self.shown]) @ UPRIGHT
        every = np.clip(every, low - beyond, high + beyond)
        ends = size * every.min(axis=0), size * every.max(axis=0)
        self.supports = supports_of(self.assembly, *ends)
        solid = [hull.corners / size for hull in self.supports]
        self.swept: Array = np.concatenate([every, *solid]) @ UPRIGHT.T
        self.ground = float(self.swept[:, 1].min())
        self.middle = float(low[0] + high[0]) / 2
        self.depth = float(high[1] - low[1])
        self.grain = float(self.assembly.reach.min()) / size

    def solids(self, line: float) -> Solids:
        """Return its pieces, with edges so wide [pixels]."""
        size = self.assembly.size
        return Solids(self.assembly, self.supports, line, size, is_arch=False)

    @cached_property
    def end(self) -> float:
        """Time at which the recording ends."""
        return float(self.recording.times[-1])

    def joints_at(self, poses: Array, time: float) -> tuple[JointState, ...]:  # noqa: ARG002
        """Tell what joints are seen to do at poses, (blocks, 6)."""
        return states_at(self.assembly, poses)
