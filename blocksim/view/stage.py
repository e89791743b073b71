"""A recording made ready for the eye: blocks in space at any time, supports, ground, joints.

Lengths are in units of the assembly's size, which is an arch's radius r, times in units of
sqrt(size/g). Blocks of the plane are shown on their supports where these are known, else on the
piers of `blocksim.engines.ground`, and above its floor. Their film ends with the recording, or
when the last block has left the picture.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np

from blocksim.ask.answer import SOUGHT
from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState, classify
from blocksim.blocks.outlines import distances
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.blocks.space.extruded import lifted, prism, prisms
from blocksim.engines.ground import ground_level, piers
from blocksim.kinds.offers import carried_of
from blocksim.limit.carried import Carried
from blocksim.simulation.recording import Recording
from blocksim.view.drawing import clipped, grain_of, rims
from blocksim.view.solidscene import Solids, moving_box, states_at, supports_of
from blocksim.view.thrustlines import is_chained, near_blocks, thrust_lines
from blocksim.view.timeline import SEEN, UPRIGHT, Timeline, upright

TOUCHING = 0.02
"""Height of a corner over the ground below which its block lies on it [r]."""
FARTHEST = 1.75
"""Blocks are followed up to this far beyond where they were at rest [r]."""
ALONG = 2.25
"""Distance to the sides up to which blocks on known supports are followed [size]."""
FOLLOWED = 5.0
"""How far a camera follows blocks that go on and on [widths of what it shows at first]."""
BESIDE, ABOVE = 0.25, 0.1
"""How far beyond the blocks supports are shown, sidewards and upwards [r]."""
APART, CLEAR = 0.35, 0.1
"""How far a scale bar lies in front of blocks of the plane, and of all there is in space."""
SPOKEN = 0.3
"""Room for its words in front of it."""
WIDER = 1.12
"""Depth of the footings over that of the blocks."""
DIGITS = 9
"""Decimals of a line of thrust [size]."""


class Outline(NamedTuple):
    """A part of a block as it is seen from the front, or the rim of a block of several parts.

    `points`, (k, 2): From the centre of the block as built [size].
    `whole`: Whether it is all of the block.
    """

    block: int
    points: Array
    filled: bool
    whole: bool


class Stage(Timeline):
    """Everything that is drawn of a recording of the plane, whatever the view.

    It knows convex outlines of footings, cut off far from the blocks, the level of the ground,
    the distance from block to block (`grain`), their middle, and where a scale bar lies in
    perspective (`front`).
    """

    eye = math.radians(-32.0), math.radians(14.0)
    """Where it is seen from in perspective: turned about the vertical, and raised."""

    def __init__(self, recording: Recording, near: float = 1.0) -> None:
        self.assembly = recording.assembly
        size, half = self.assembly.size, self.assembly.depths / 2
        faces = [
            (block, np.pad(points, ((0, 0), (0, 1)), constant_values=side * half[block]))
            for block, points, filled, _ in self.outlines
            for side in (1.0, -1.0)
            if filled
        ]
        super().__init__(recording, near, faces)
        self.depth = float(self.assembly.depths.max())
        self.front = self.depth / 2 + APART
        self.is_arch = recording.problem.is_arch
        rest = np.concatenate([block.vertices for block in self.assembly.blocks]) / size
        self._low, self._high = rest.min(axis=0), rest.max(axis=0)
        self.middle = float(self._low[0] + self._high[0]) / 2
        # Where all supports move, what is fixed below them is the ground.
        self._fixed = self.assembly.supports
        self.ground = ground_level(self.assembly) / size
        if self.recording.problem.moves and not self.assembly.springings:
            tops = [part[:, 1].max() for each in self._fixed for part in each.polygons]
            self.ground, self._fixed = float(max(tops)) / size, ()
        self.footings = self._standing()
        self.grain = grain_of(self.assembly) / size

    def solids(self, line: float) -> Solids:
        """Return its pieces as prisms, with edges so wide [pixels]."""
        size = self.assembly.size
        feet = [prism(each * size, WIDER * self.depth * size) for each in self.footings]
        return Solids(prisms(self.assembly), feet, line, size, is_arch=self.is_arch)

    def _standing(self) -> tuple[Array, ...]:
        """Return the outlines of what blocks stand on, cut off far from them."""
        assembly, size = self.assembly, self.assembly.size
        if not assembly.supports:
            return tuple(pier / size for pier in piers(assembly))
        # Of a wide or a high support, or one deep in the ground, a part is enough.
        poses, reach = self.recording.poses, assembly.reach / size
        gone = (poses[..., 0] - reach).min(), (poses[..., 0] + reach).max()
        left = max(float(gone[0]), self._low[0] - ALONG) - BESIDE
        right = min(float(gone[1]), self._high[0] + ALONG) + BESIDE
        low, high = np.array([left, self.ground]), np.array([right, self._high[1] + ABOVE])
        parts = [
            clipped(part / size, low, high)
            for support in self._fixed
            for part in support.polygons
        ]
        return tuple(part for part in parts if len(part))

    @cached_property
    def end(self) -> float:
        """Time at which the last block has left the picture, or the recording ends."""
        # A block that slides on and on leaves a picture in which nothing is to be seen.
        along = self.recording.poses[..., 0]
        reach = FOLLOWED * (self._high[0] - self._low[0] + 2 * self._aside / self._near)
        near = (along > self._low[0] - reach) & (along < self._high[0] + reach)
        last = np.flatnonzero(near.any(axis=1))[-1]
        return float(self.recording.times[last])

    @cached_property
    def carried(self) -> Carried | None:
        """Forces and margins at rest, or None where they take long to find."""
        problem = self.recording.problem
        small = problem.is_arch or len(self.assembly.joints) <= SOUGHT
        return carried_of(problem) if small else None

    @cached_property
    def thrust(self) -> tuple[Array, ...]:
        """Lines of thrust at rest by limit analysis, (k, 2), that stay in the picture."""
        problem, carried = self.recording.problem, self.carried
        if carried is None or carried.forces is None or not is_chained(problem):
            return ()
        paths = thrust_lines(problem, carried.forces)
        if not paths or not near_blocks(problem, paths):
            return ()
        # Last digits, which differ by who found the forces, move no pixel.
        return tuple((path / self.assembly.size).round(DIGITS) for path in paths)

    @property
    def _aside(self) -> float:
        return self._near * (ALONG if self.assembly.supports else FARTHEST)

    @cached_property
    def swept(self) -> Array:
        """Every corner at every frame that is shown, and of the footings, (k, 3).

        Blocks are followed up to `FARTHEST` or `ALONG` beyond where they were at rest.
        """
        footings = np.concatenate([*self.footings, [[self.middle, self.ground]]])
        half = self.depth / 2
        solid = [np.pad(footings, ((0, 0), (0, 1)), constant_values=z) for z in (-half, half)]
        rest = np.concatenate([self.corners_of(0), *solid])
        moved = np.concatenate([self.corners_of(frame) for frame in self.shown])
        low, high = rest.min(axis=0), rest.max(axis=0)
        bounded = np.clip(
            moved,
            [self._low[0] - self._aside, low[1], low[2] - FARTHEST],
            [self._high[0] + self._aside, *(high[1:] + FARTHEST)],
        )
        return np.concatenate([rest, bounded])

    @cached_property
    def outlines(self) -> list[Outline]:
        """Parts of all blocks, then the rims of those that have several."""
        found = list[Outline]()
        for filled in (True, False):
            for at, block in enumerate(self.assembly.blocks):
                whole = len(block.polygons) == 1
                parts = block.polygons if filled else () if whole else rims(block.polygons)
                found += [
                    Outline(at, (part - block.centre) / self.assembly.size, filled, whole)
                    for part in parts
                ]
        return found

    def faces(self, turns: Array, places: Array) -> Array:
        """Return the ends of joints as the blocks on both sides carry them.

        `turns`, `places`: Of a `Moment`.
        Returns: (joints, 2 sides, 2 ends, 2).
        """
        # The support comes last, as index -1 says: it stays.
        centres = np.vstack([places[:, :2], np.zeros(2)])
        turns = np.concatenate([turns[:, :2, :2], np.eye(2)[None]])
        sides, arms = self.assembly.sides.T, self.assembly.joint_arms.swapaxes(0, 1)
        return centres[sides][:, :, None] + arms @ turns[sides].swapaxes(2, 3)

    def _looked_at(self, poses: Array, earlier: int, later: int, share: float) -> Array:  # noqa: ARG002
        one, two = self.recording.poses[earlier], self.recording.poses[later]
        return one + (two - one) * share

    def joints_at(self, poses: Array, time: float) -> tuple[JointState, ...]:
        """Tell what joints are seen to do at poses, (blocks, 3), and their time."""
        states: list[JointState] = []
        seen = classify(self.assembly, poses, least=SEEN)
        for joint, parted, gone in zip(seen, *self._fates, strict=True):
            state = JointState.OPEN if time >= parted else joint.state
            states.append(JointState.CLOSED if time >= gone else state)
        return tuple(states)

    @cached_property
    def _fates(self) -> tuple[Array, Array]:
        """Times from which each joint has parted, and is none any more, (joints,) each.

        What has parted and meets again is no hinge, and a block that lies on the ground, or
        has come loose of both its neighbours, is rubble: it has no joints.
        """
        before, after, *_ = self.assembly.joint_arrays
        blocks = len(self.assembly.blocks)
        parted = np.full(len(before), np.inf)
        rubble = np.full(blocks + 1, np.inf)  # the last stands for the support
        for frame in self.shown if self.moves else []:
            time = float(self.recording.times[frame])
            poses = self.recording.poses[frame]
            seen = classify(self.assembly, poses, least=SEEN)
            faces = self.faces(*upright(lifted(poses)))
            # Turned far, blocks may have left each other though neither end seems open.
            apart = np.array([joint.state is JointState.OPEN for joint in seen])
            apart |= distances(faces, faces[:, ::-1, None]).min(axis=(1, 2)) > SEEN
            parted = np.minimum(parted, np.where(apart, time, np.inf))
            held = np.zeros(blocks + 1, dtype=bool)
            for side in (before, after):
                held[side[parted > time]] = True
            lowest = np.full(blocks, np.inf)
            np.minimum.at(lowest, self._owner, self.corners_of(frame)[:, 1])
            loose = ~held[:blocks] | (lowest < self.ground + TOUCHING)
            rubble[:blocks] = np.minimum(rubble[:blocks], np.where(loose, time, np.inf))
        return parted, np.minimum(rubble[before], rubble[after])


class SolidStage(Timeline):
    """Everything that is drawn of a recording in space, without what is far from the blocks.

    `depth` is that of all towards the viewer, `grain` the size of the smallest block, `ground`
    the lowest level that anything comes to, and `front` is before all that is seen.
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
        near_by = np.clip(every, low - beyond, high + beyond)
        # Supports are drawn below all blocks, and at first shown as far as blocks are.
        self.supports, shown = (
            supports_of(self.assembly, size * each.min(axis=0), size * each.max(axis=0))
            for each in (every, near_by)
        )
        solid = [hull.corners / size for hull in shown]
        self.swept: Array = np.concatenate([near_by, *solid]) @ UPRIGHT.T
        self.ground = float(self.swept[:, 1].min())
        self.middle = float(low[0] + high[0]) / 2
        self.depth = float(high[1] - low[1])
        self.front = float(self.swept[:, 2].max()) + CLEAR
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
