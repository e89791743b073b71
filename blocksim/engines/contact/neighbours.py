"""Who touches whom: the joints while they hold, and later whoever meets.

Until something has moved by `LOOSE` nothing can touch but what shares a joint. From then on
all blocks, the piers and the ground are watched by their bounding boxes, and those that come
near become pairs with contacts of their own. A joint that has come apart is given up for
good; its blocks are then two like any others.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.engines.contact.geometry import Geometry, Touch
from blocksim.engines.contact.meeting import Polygons
from blocksim.engines.ground import ground_level, piers

LOOSE = 0.05
"""Motion from which blocks may meet that share no joint [size]."""
NEAR = 0.01
"""Distance within which two polygons are looked at, beyond their way in a step [size]."""
FAR = 1e3
"""Half the width of the ground [size]."""


class Neighbours:
    """The blocks of an assembly, what they stand on, and who is near whom.

    Parameters
    ----------
    assembly : Assembly

    Attributes
    ----------
    before, after : (pairs,) int
        Blocks of each pair with contacts, -1 for what stays.
    keys : (pairs,) int
        Names that pairs keep while the list changes.
    """

    def __init__(self, assembly: Assembly) -> None:
        size = assembly.size
        self._joints = Geometry(assembly)
        self._start = assembly.centres / size
        self._reach = assembly.reach / size
        self._assembly, self._count = assembly, len(assembly.blocks)
        self._holds = np.ones(len(assembly.joints), dtype=np.bool_)
        self._loose = False
        # Which polygon is on each side of a joint: piers come after the blocks, in order.
        sides = np.stack([self._joints.before, self._joints.after])
        fixed = (sides == SUPPORT).any(axis=0)
        pier = np.zeros(len(fixed), dtype=np.int64)
        pier[fixed] = self._count + np.arange(fixed.sum())
        self._sides = np.where(sides == SUPPORT, pier, sides)
        none = np.zeros(0, dtype=np.int64)
        self._meet = (none, none)
        self._list()

    def touch(self, poses: Array, reach: float) -> Touch:
        """Find the contacts of all pairs, and which pairs there are.

        Parameters
        ----------
        poses : (blocks, 3) float
            Centres of mass x, y and rotations, scaled.
        reach : float
            How far any corner may go in a step.

        Returns
        -------
        Touch
            In the order of `before` and `after`, which may have changed.
        """
        touch, holds = self._joints.touch(poses)
        moved = poses.copy()
        moved[:, :2] -= self._start
        moved[:, 2] *= self._reach
        self._loose = self._loose or bool(np.abs(moved).max() > LOOSE)
        if not self._loose:
            return touch
        self._holds &= holds
        near = self._polygons.near(poses, NEAR + 2 * reach)
        first, second = np.sort(self._sides[:, self._holds], axis=0)
        near[first, second] = False
        before, after = (index.astype(np.int64) for index in np.nonzero(near))
        met = self._polygons.touch(poses, before, after)
        close = met.gap.min(axis=1, initial=np.inf) < NEAR + 2 * reach
        self._meet = before[close], after[close]
        self._list()
        return Touch(
            gap=np.concatenate([touch.gap[self._holds], met.gap[close]]),
            rows=np.concatenate([touch.rows[self._holds], met.rows[close]]),
        )

    @cached_property
    def _polygons(self) -> Polygons:
        """Blocks, then piers in the order of their joints, then the ground."""
        assembly, size = self._assembly, self._assembly.size
        level = ground_level(assembly) / size
        floor = np.array([(-FAR, level - 1), (FAR, level - 1), (FAR, level), (-FAR, level)])
        return Polygons(
            [(block.vertices - block.centre) / size for block in assembly.blocks],
            [*(pier / size for pier in piers(assembly)), floor],
        )

    def _list(self) -> None:
        held, (before, after) = self._holds, self._meet
        count = self._count
        self.before = np.concatenate([self._joints.before[held], before])
        after_block = np.where(after < count, after, SUPPORT)
        self.after = np.concatenate([self._joints.after[held], after_block])
        keys = len(held) + before * (count + len(held)) + after
        self.keys = np.concatenate([np.flatnonzero(held), keys])
