"""Who touches whom: the joints while they hold, and later whoever meets.

Until something has moved by `LOOSE`, or by what lies between blocks where supports are known
and that is less, nothing can touch but what shares a joint. From then on all blocks, the
supports and the ground are watched by their bounding boxes, and those that come near become
pairs with contacts of their own. A joint that has come apart is given up for good; its blocks
are then two like any others. A block of several polygons meets others by each of them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.blocks.outlines import outwards
from blocksim.blocks.rows import column
from blocksim.engines.contact.geometry import Geometry, Touch
from blocksim.engines.contact.meeting import Polygons
from blocksim.engines.ground import ground_level, standing, standing_at

LOOSE = 0.05
"""Motion from which blocks may meet that share no joint [size]."""
NEAR = 0.01
"""Distance within which two polygons are looked at, beyond their way in a step [size]."""
TIGHT, APART = 1e-4, 1e-6
"""Least of that motion; and the distance within which blocks touch from the beginning."""
FAR = 1e3
"""Half the width of the ground [size]."""


class Neighbours:
    """The blocks of an assembly, what they stand on, and who is near whom.

    `before`, `after`, (pairs,): Blocks of each pair with contacts, -1 for what stays.
    `keys`, (pairs,): Names that pairs keep while the list changes.
    """

    def __init__(self, assembly: Assembly) -> None:
        self._joints = Geometry(assembly)
        self._start = assembly.built[:-1]
        self._arms = np.ones_like(self._start)
        self._arms[:, 2] = assembly.reach / assembly.size
        self._assembly, self._count = assembly, len(assembly.blocks)
        self._holds = np.ones(len(assembly.joints), dtype=np.bool_)
        self._loose = self._listed = False
        self._firm = self._joints.touch(self._start)[1]
        none = np.zeros(0, dtype=np.int64)
        self._meet = none, none
        # Pairs of polygons that may meet, once blocks have moved.
        self._watched: tuple[NDArray[np.int64], NDArray[np.int64]] | None = None
        self.before, self.after = self._joints.before, self._joints.after
        self.keys = np.arange(len(self._holds))

    def touch(self, poses: Array, fastest: Callable[[], float]) -> Touch:
        """Find the contacts of all pairs, and which pairs there are.

        `poses`, (blocks, 3): Centres of mass x, y and rotations, scaled.
        `fastest`: Tells how far any corner may go in a step.
        Returns: In the order of `before` and `after`, which may have changed.
        """
        touch, holds = self._joints.touch(poses)
        if not self._loose:
            moved = poses * self._arms - self._start
            way = float(np.abs(moved).max())
            self._loose = way > TIGHT and way > self.free
            # A joint may end before: where a corner has turned onto its face.
            self._loose |= bool((self._firm & ~holds).any())
            if not self._loose:
                return touch
        margin = NEAR + 2 * fastest()
        parts = bool((self._holds & ~holds).any())
        if parts or self._watched is None:
            self._holds &= holds
            self._watched = self._strangers()
        poses = poses[self.owner]
        before, after = self._watched
        near = self._polygons.near(poses, before, after, margin)
        before, after = before[near], after[near]
        met = self._polygons.touch(poses, before, after)
        close = met.gap.min(axis=1, initial=np.inf) < margin
        before, after = before[close], after[close]
        if parts or not all(map(np.array_equal, self._meet, (before, after))):
            self._meet = before, after
            self._list()
        return Touch(
            gap=np.concatenate([touch.gap[self._holds], met.gap[close]]),
            rows=np.concatenate([touch.rows[self._holds], met.rows[close]]),
            faces=None if met.faces is None else met.faces[:, close],
        )

    def again(self, poses: Array) -> Touch:
        """Find the contacts of the pairs found last at other poses, as `touch`."""
        touch, _ = self._joints.touch(poses)
        if not self._listed:
            return touch
        met = self._polygons.touch(poses[self.owner], *self._meet)
        held = self._holds
        return Touch(
            gap=np.concatenate([touch.gap[held], met.gap]),
            rows=np.concatenate([touch.rows[held], met.rows]),
            faces=met.faces,
        )

    def followed(self, touch: Touch, poses: Array, like: Touch) -> Touch:
        """Return contacts found at poses as those of the faces that touched before.

        Which corner is which of the two contacts changes where another face looks at the
        first: of a block on the ground when it has turned by half a right angle.
        """
        if touch.faces is None or like.faces is None:
            return touch
        other = np.flatnonzero((touch.faces != like.faces).any(axis=0))
        if not len(other):
            return touch
        before, after = (each[other] for each in self._meet)
        met = self._polygons.touch(poses[self.owner], before, after, like.faces[:, other])
        gap, rows = touch.gap.copy(), touch.rows.copy()
        place = len(gap) - len(self._meet[0]) + other
        gap[place], rows[place] = met.gap, met.rows
        return Touch(gap=gap, rows=rows, faces=like.faces)

    def _strangers(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Find pairs of polygons of two blocks that no joint holds, the smaller first."""
        others = len(standing(self._assembly)) + 1
        every = np.concatenate([self.owner, np.full(others, SUPPORT)])
        count = len(self.owner)
        strange = np.arange(len(every)) > np.arange(count)[:, None]
        strange &= self.owner[:, None] != every
        joint, first, second = self.sides
        held = self._holds[joint]
        strange[first[held], second[held]] = False
        first, second = np.nonzero(strange)
        return first, second

    @cached_property
    def owner(self) -> NDArray[np.int64]:
        """Whose each polygon is: those of the blocks come first, -1 is what stays."""
        parts = [len(each) or 1 for each in column(self._assembly.blocks, "parts")]
        return np.repeat(np.arange(self._count), parts)

    @cached_property
    def _polygons(self) -> Polygons:
        """Those of the blocks, then of what they stand on, then the ground."""
        assembly, size = self._assembly, self._assembly.size
        level = ground_level(assembly) / size
        floor = np.array([(-FAR, level - 1), (FAR, level - 1), (FAR, level), (-FAR, level)])
        return Polygons(
            [
                (polygon - block.centre) / size
                for block in assembly.blocks
                for polygon in block.polygons
            ],
            [*(each / size for each in standing(assembly)), floor],
        )

    @cached_property
    def sides(self) -> tuple[NDArray[np.int64], ...]:
        """Polygons that meet in joints: the joint, and the polygons, the smaller first."""
        assembly, stands = self._assembly, standing(self._assembly)
        first = np.searchsorted(self.owner, np.arange(self._count))
        found: list[tuple[int, int, int]] = []
        on = standing_at(assembly)
        for index, joint in enumerate(assembly.joints):
            sides: list[list[int]] = []
            for body in (joint.before, joint.after):
                if body == SUPPORT:
                    begin, polygons = len(self.owner), [stands[k] for k in on[index]]
                    begin += on[index].start
                else:
                    begin, polygons = int(first[body]), assembly.blocks[body].polygons
                ends = np.stack([joint.inner, joint.outer])
                sides.append([begin + k for k in _lying_on(polygons, ends, assembly.size)])
            found += [(index, min(a, b), max(a, b)) for a in sides[0] for b in sides[1]]
        joints, one, other = np.array(found, dtype=np.int64).reshape(-1, 3).T
        return joints, one, other

    @cached_property
    def free(self) -> float:
        """Motion up to which nothing can touch but what shares a joint."""
        if not self._assembly.supports:
            return LOOSE
        poses = self._start[self.owner]
        before, after = self._strangers()
        near = self._polygons.near(poses, before, after, 4 * LOOSE)
        gap = self._polygons.apart(poses, before[near], after[near])
        # Two corners may each go by the root of 2 of that, and by as much again by turning.
        return float(gap[gap > APART].min(initial=4 * LOOSE)) / 4

    def _list(self) -> None:
        """List joints that hold, then pairs of polygons that meet."""
        self._listed = True
        held, (before, after) = self._holds, self._meet
        owner = np.append(self.owner, SUPPORT)
        count = len(self.owner)
        self.before = np.concatenate([self._joints.before[held], owner[before]])
        self.after = np.concatenate([self._joints.after[held], owner[np.minimum(after, count)]])
        # There are no more polygons that stay than this many.
        most = count + len(held) + len(standing(self._assembly)) + 1
        keys = len(held) + before * most + after
        self.keys = np.concatenate([np.flatnonzero(held), keys])


def _lying_on(polygons: Sequence[Array], ends: Array, size: float) -> list[int]:
    """Tell which polygons of a body a joint lies on: along it, or the nearest to it."""
    if len(polygons) == 1:
        return [0]
    way = ends[1] - ends[0]
    least = 10 * APART * size / float(np.hypot(*way)) if way.any() else -1.0
    found: list[int] = []
    off: list[float] = []
    for index, polygon in enumerate(polygons):
        out = outwards(polygon)
        beyond = (out * (ends[0] - polygon)).sum(axis=1)
        rise = out @ way
        # The share of the joint that is on the inner side of every face.
        room = APART * size - beyond
        with np.errstate(divide="ignore", invalid="ignore"):
            share = room / rise
        low = float(share[rise < 0].max(initial=0.0))
        high = float(share[rise > 0].min(initial=1.0))
        if high - low > least and (room[rise == 0] >= 0).all():
            found.append(index)
        off.append(float((beyond + rise / 2).max()))
    return found or [int(np.argmin(off))]
