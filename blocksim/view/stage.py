"""A recording made ready for the eye: blocks in space at any time, supports, ground, joints.

Lengths are in units of the assembly's size, which is an arch's radius r, times in units of
sqrt(size/g). Blocks are shown on their supports where these are known, else on the piers of
`blocksim.engines.ground`, and above its floor. A film ends with the recording, or when the last
block has left the picture.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from blocksim.ask.answer import SOUGHT
from blocksim.blocks.assembly import Array, Assembly
from blocksim.blocks.joints import JointState, classify
from blocksim.blocks.outlines import distances
from blocksim.blocks.space.extruded import lifted, prism, prisms
from blocksim.engines.ground import ground_level, piers
from blocksim.kinds.offers import carried_of
from blocksim.limit.carried import Carried
from blocksim.simulation.recording import Recording
from blocksim.view.drawing import clipped, grain_of, rims
from blocksim.view.solidscene import Solids
from blocksim.view.thrustlines import is_chained, near_blocks, thrust_lines
from blocksim.view.timeline import SEEN, Moment, Timeline, upright

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
WIDER = 1.12
"""Depth of the footings over that of the blocks."""
DIGITS = 9
"""Decimals of a line of thrust [size]."""


class Placing:
    """Convex pieces of blocks of the plane, and joints, carried by poses.

    It has:
    `owner`, (pieces,): The block that each piece belongs to.
    `outlines`, (pieces, sides, 2): Of the pieces, from the centres of their blocks; what has
        fewer corners repeats its last one.
    """

    def __init__(self, assembly: Assembly) -> None:
        self._assembly = assembly
        pieces = [
            (index, (part - block.centre) / assembly.size)
            for index, block in enumerate(assembly.blocks)
            for part in block.polygons
        ]
        self.owner = np.array([index for index, _ in pieces])
        sides = max(len(each) for _, each in pieces)
        self.outlines = np.array(
            [np.pad(each, ((0, sides - len(each)), (0, 0)), "edge") for _, each in pieces]
        )
        self._half = assembly.depths[self.owner] / 2

    def corners(self, poses: Array) -> Array:
        """Return the corners in space at poses, (pieces, 2, sides, 3)."""
        turns, centres = upright(poses)
        half = np.broadcast_to(self._half[:, None, None], (*self.outlines.shape[:2], 1))
        near = np.concatenate([self.outlines, half], axis=-1)
        local = np.stack([near, near * [1, 1, -1]], axis=1)
        owner = self.owner
        return centres[owner][:, None, None] + local @ turns[owner][:, None].swapaxes(2, 3)

    def faces(self, poses: Array) -> Array:
        """Return the ends of joints in space, as the blocks on both sides carry them."""
        assembly = self._assembly
        turns, centres = upright(poses)
        # The support comes last, as index -1 says: it stays.
        centres = np.vstack([centres, np.zeros(3)])
        turns = np.concatenate([turns, np.eye(3)[None]])
        sides = assembly.sides.T
        local = np.zeros((*sides.shape, 2, 3))
        local[..., :2] = assembly.joint_arms.swapaxes(0, 1)
        return centres[sides][:, :, None] + local @ turns[sides].swapaxes(2, 3)


class Stage(Timeline):
    """Everything that is drawn of a recording of the plane, whatever the view.

    `near` is the share of the usual room beside the blocks that is shown from the start. It
    knows convex outlines of footings, cut off far from the blocks, the level of the ground,
    which block owns each piece, the distance from block to block (`grain`), and their middle.
    """

    eye = math.radians(-32.0), math.radians(14.0)
    """Where it is seen from in perspective: turned about the vertical, and raised."""

    def __init__(self, recording: Recording, near: float = 1.0) -> None:
        super().__init__(recording)
        self._near = near
        self.assembly = recording.assembly
        size = self.assembly.size
        self.depth = float(self.assembly.depths.max())
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
        self._placing = Placing(self.assembly)
        self.owner = self._placing.owner
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
        first, *shown = lifted(self.recording.poses[[0, *self.shown]])
        rest = np.concatenate([self._placing.corners(first).reshape(-1, 3), *solid])
        moved = np.concatenate([self._placing.corners(each) for each in shown]).reshape(-1, 3)
        low, high = rest.min(axis=0), rest.max(axis=0)
        bounded = np.clip(
            moved,
            [self._low[0] - self._aside, low[1], low[2] - FARTHEST],
            [self._high[0] + self._aside, *(high[1:] + FARTHEST)],
        )
        return np.concatenate([rest, bounded])

    @cached_property
    def rims(self) -> list[tuple[int, Array]]:
        """Rims of blocks that have several pieces, from their centres, with the block."""
        blocks = enumerate(self.assembly.blocks)
        return [
            (at, (rim - block.centre) / self.assembly.size)
            for at, block in blocks
            if len(block.polygons) > 1
            for rim in rims(block.polygons)
        ]

    def at(self, time: float) -> Moment:
        """Return where everything is at a time, between frames by interpolation."""
        time, earlier, later, share = self.between(time)
        one, two = self.recording.poses[earlier], self.recording.poses[later]
        poses = self.poses_at(time)
        return self._moment(time, poses, one + (two - one) * share)._replace(
            corners=self._placing.corners(poses), faces=self._placing.faces(poses)
        )

    def corners_at(self, time: float) -> Array:
        """Return the corners of a moment alone, which cost little."""
        return self._placing.corners(self.poses_at(time))

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
            faces = self._placing.faces(lifted(poses))[..., :2]
            # Turned far, blocks may have left each other though neither end seems open.
            apart = np.array([joint.state is JointState.OPEN for joint in seen])
            apart |= distances(faces, faces[:, ::-1, None]).min(axis=(1, 2)) > SEEN
            parted = np.minimum(parted, np.where(apart, time, np.inf))
            held = np.zeros(blocks + 1, dtype=bool)
            for side in (before, after):
                held[side[parted > time]] = True
            bottoms = self._placing.corners(lifted(poses))[..., 1].min(axis=(1, 2))
            lowest = np.full(blocks, np.inf)
            np.minimum.at(lowest, self._placing.owner, bottoms)
            loose = ~held[:blocks] | (lowest < self.ground + TOUCHING)
            rubble[:blocks] = np.minimum(rubble[:blocks], np.where(loose, time, np.inf))
        return parted, np.minimum(rubble[before], rubble[after])
