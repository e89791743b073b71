"""A recording made ready for the eye: blocks in space at any time, supports, ground, joints.

Lengths are in units of the assembly's size, which is an arch's radius r, times in units of
sqrt(size/g). Blocks are shown on their supports where these are known, else on the piers of
`blocksim.engines.ground`, and above its floor. A film ends with the recording, when the last
block has left the picture, or when one sinks into what it does not rest on (old recordings).
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from blocksim.ask.carried import carried_of
from blocksim.ask.check import SOUGHT
from blocksim.blocks.assembly import SUPPORT, Array, displacement
from blocksim.blocks.joints import JointState
from blocksim.engines.ground import ground_level, piers
from blocksim.limit.carried import Carried
from blocksim.simulation.motion import AT_REST, FRAME, UNMOVED, UNSEEN
from blocksim.simulation.recording import Recording
from blocksim.view.drawing import Part, clipped, outer_parts
from blocksim.view.placing import Placing, depth_of
from blocksim.view.seenjoints import SEEN, SeenJoints
from blocksim.view.thrustlines import is_chained, near_blocks, thrust_lines

FEWEST = 4
"""Sides of a footing, and of a block at least."""
SUNK = 0.02
"""Depth of a corner in the ground or in a footing that passes for touching it [r]."""
FARTHEST = 1.75
"""Blocks are followed up to this far beyond where they were at rest [r]."""
ALONG = 2.25
"""The same to the sides on supports that are known, which are shown as far [size]."""
FOLLOWED = 5.0
"""How far a camera follows blocks that go on and on [widths of what it shows at first]."""
BESIDE, ABOVE = 0.25, 0.1
"""How far beyond the blocks supports are shown, sidewards and upwards [r]."""
SAMPLES = 500
"""Most frames that are looked at for what a film needs to know beforehand."""
DIGITS = 9
"""Of a line of thrust [size]."""
STILL, GONE = 2e-3, 3e-2
"""Displacements between which the line of thrust fades: it is of the arch at rest [r]."""


class Moment(NamedTuple):
    """Where everything is at one time.

    Parameters
    ----------
    time : float
    corners : (pieces, 2, sides, 3) float
        Of the near and the far face of each convex piece of a block: x, y, and z towards the
        viewer.
    faces : (joints, 2, 2, 3) float
        Both ends of each joint as the blocks before and after it have carried them.
    joints : tuple of JointState
    statics : float
        1 while the line of thrust of the arch at rest still says something, falling to 0.
    """

    time: float
    corners: Array
    faces: Array
    joints: tuple[JointState, ...]
    statics: float


class Stage:
    """Everything that is drawn of a recording, whatever the view.

    Parameters
    ----------
    recording : Recording

    Attributes
    ----------
    depth : float
        Of the deepest block, out of the plane.
    ground : float
        Level of the ground.
    footings : tuple of (k, 2) float
        Convex outlines of what it stands on, cut off far from the blocks.
    owner : (pieces,) int
        The block that each piece belongs to.
    sides : int
        Corners of a piece and of a footing at most.
    grain : float
        Distance from block to block.
    is_arch : bool
        Whether its joints have an intrados and an extrados.
    middle : float
        Of the blocks at rest, along x.
    """

    def __init__(self, recording: Recording) -> None:
        self.recording = recording
        self.assembly = recording.assembly
        size = self.assembly.size
        self.depth = float(self.assembly.depths.max())
        self.is_arch = recording.problem.is_arch
        rest = np.concatenate([block.vertices for block in self.assembly.blocks]) / size
        self._low, self._high = rest.min(axis=0), rest.max(axis=0)
        self.middle = float(self._low[0] + self._high[0]) / 2
        self.ground = ground_level(self.assembly) / size
        self.footings, self._bearing = self._standing()
        corners = max(FEWEST, *(len(each) for each in self.footings))
        self._placing = Placing(recording, corners)
        self.owner, self.sides = self._placing.owner, self._placing.sides
        self.grain = self._grain()

    def _standing(self) -> tuple[tuple[Array, ...], list[int]]:
        """Footings, and for each the block that has nothing to reach in it, or `SUPPORT`."""
        assembly, size = self.assembly, self.assembly.size
        if not assembly.supports:
            bears = [joint.bears for joint in assembly.springings]
            return tuple(pier / size for pier in piers(assembly)), bears
        # Of a wide or a high support, or one deep in the ground, a part is enough.
        poses, reach = self.recording.poses, assembly.reach / size
        gone = (poses[..., 0] - reach).min(), (poses[..., 0] + reach).max()
        left = max(float(gone[0]), self._low[0] - ALONG) - BESIDE
        right = min(float(gone[1]), self._high[0] + ALONG) + BESIDE
        low, high = np.array([left, self.ground]), np.array([right, self._high[1] + ABOVE])
        parts = [
            clipped(part / size, low, high)
            for support in assembly.supports
            for part in support.polygons
        ]
        kept = tuple(part for part in parts if len(part))
        return kept, [SUPPORT] * len(kept)

    def _grain(self) -> float:
        """Least distance between the centres of blocks that meet; of one alone its width."""
        before, after, *_ = self.assembly.joint_arrays
        pairs = (before != SUPPORT) & (after != SUPPORT)
        centres = self.assembly.centres
        apart = np.hypot(*(centres[after[pairs]] - centres[before[pairs]]).T)
        least = apart.min() if len(apart) else self.assembly.reach.min()
        return float(least) / self.assembly.size

    @cached_property
    def end(self) -> float:
        """Time at which a block sinks, the last has left the picture, or the recording ends."""
        # A block that slides on and on leaves a picture in which nothing is to be seen.
        along = self.recording.poses[..., 0]
        reach = FOLLOWED * (self._high[0] - self._low[0] + 2 * self._aside)
        near = (along > self._low[0] - reach) & (along < self._high[0] + reach)
        last = np.flatnonzero(near.any(axis=1))[-1]
        return min(self.sinks, float(self.recording.times[last]))

    @cached_property
    def sinks(self) -> float:
        """Time at which a block sinks into ground or footing, or inf."""
        times = self.recording.times
        depths: list[float] = []
        for frame in range(len(times) if self.moves else 0):
            depths.append(self._sunk(self._placing.corners(frame, frame, 0.0)[..., :2]))
            # Where footings are so near that they meet blocks at rest, that is no end.
            touch = SUNK + max(0.0, depths[0])
            if depths[-1] > touch:
                between = times[frame - 1 : frame + 1]
                return float(np.interp(touch, depths[-2:], between))
        return np.inf

    def _sunk(self, corners: Array) -> float:
        """Deepest that a block is in the ground, or meets a footing of another block."""
        outlines = corners[:, 0]
        deepest = self.ground - float(outlines[..., 1].min())
        for block, footing in zip(self._bearing, self.footings, strict=True):
            others = outlines[self.owner != block]
            if not len(others):
                continue
            for points, around in ((others, footing), (footing, others[:, None])):
                deepest = max(deepest, float(depth_of(points, around).max()))
        return deepest

    @cached_property
    def speed(self) -> float:
        """Speed of the fastest corner as it ends [m/s]; 0 where blocks have lain still."""
        times, poses = self.recording.times, self.recording.poses
        last = int(np.searchsorted(times, self.end, "right")) - 1
        if last == 0:
            return 0.0
        first = min(int(np.searchsorted(times, float(times[last]) - AT_REST * FRAME)), last - 1)
        since = poses[first : last + 1] - poses[last]
        # Supports that are moved do not tell whether blocks lie still.
        since[:, sorted(self.carriers)] = 0.0
        since = displacement(since, self.assembly)
        is_long = first > 0 or bool(self._displaced[: last + 1].max() <= UNMOVED)
        if is_long and float(since.max()) < UNSEEN:
            return 0.0
        step = float(times[last] - times[last - 1]) * self.recording.problem.seconds
        return float(since[-2]) * self.assembly.size / step

    @property
    def moves(self) -> bool:
        """Whether anything can be seen to move."""
        return bool(self._displaced.max() > SEEN)

    @cached_property
    def carried(self) -> Carried | None:
        """What it carries at rest; None where that is not known, or takes long to find."""
        problem = self.recording.problem
        small = problem.is_arch or len(self.assembly.joints) <= SOUGHT
        return carried_of(problem) if small else None

    @cached_property
    def thrust(self) -> tuple[Array, ...]:
        """Lines of thrust at rest, by limit analysis, (k, 2); none that leave the picture."""
        problem, carried = self.recording.problem, self.carried
        if carried is None or carried.forces is None or not is_chained(problem):
            return ()
        paths = thrust_lines(problem, carried.forces)
        if not paths or not near_blocks(problem, paths):
            return ()
        # Last digits, which differ by who found the forces, move no pixel.
        return tuple((path / self.assembly.size).round(DIGITS) for path in paths)

    @cached_property
    def states(self) -> tuple[JointState, ...]:
        """Joint states that are ever seen, in the order of `JointState`, closed left out."""
        poses = self.recording.poses
        times = self.recording.times
        seen = {
            state
            for frame in self._shown
            for state in self._seen.at(poses[frame], float(times[frame]))
        }
        return tuple(state for state in JointState if state in seen - {JointState.CLOSED})

    @property
    def _aside(self) -> float:
        return ALONG if self.assembly.supports else FARTHEST

    @cached_property
    def swept(self) -> Array:
        """Every corner at every frame that is shown, and of the footings, (k, 3).

        Blocks are followed up to `FARTHEST` or `ALONG` beyond where they were at rest.
        """
        footings = np.concatenate([*self.footings, [[self.middle, self.ground]]])
        half = self.depth / 2
        solid = [np.pad(footings, ((0, 0), (0, 1)), constant_values=z) for z in (-half, half)]
        rest = np.concatenate([self._placing.corners(0, 0, 0.0).reshape(-1, 3), *solid])
        moved = np.concatenate([self._placing.corners(i, i, 0.0) for i in self._shown]).reshape(
            -1, 3
        )
        low, high = rest.min(axis=0), rest.max(axis=0)
        bounded = np.clip(
            moved,
            [self._low[0] - self._aside, low[1], low[2] - FARTHEST],
            [self._high[0] + self._aside, *(high[1:] + FARTHEST)],
        )
        return np.concatenate([rest, bounded])

    @cached_property
    def joint_sides(self) -> tuple[tuple[Part | None, Part | None], ...]:
        """Where the joints are on the pieces before and after them; None for the support."""
        return tuple(
            (self._placing.side(j, j.before), self._placing.side(j, j.after))
            for j in self.assembly.joints
        )

    @cached_property
    def outer(self) -> dict[int, list[Part]]:
        """Parts of sides that are seen, by piece, of blocks that have several."""
        found: dict[int, list[Part]] = {}
        first = 0
        for block in self.assembly.blocks:
            if len(block.polygons) > 1:
                for piece in range(len(block.polygons)):
                    found[first + piece] = []
                for part in outer_parts(block.polygons):
                    piece = first + part.polygon
                    # The last side comes after the repeated corners.
                    closes = part.side == len(block.polygons[part.polygon]) - 1
                    side = self.sides - 1 if closes else part.side
                    found[piece].append(part._replace(polygon=piece, side=side))
            first += len(block.polygons)
        return found

    def at(self, time: float) -> Moment:
        """Return where everything is at a time, between frames by interpolation."""
        times = self.recording.times
        time = float(np.clip(time, times[0], self.end))
        later = int(np.clip(np.searchsorted(times, time), 1, len(times) - 1))
        earlier = later - 1 if len(times) > 1 else later
        gap = times[later] - times[earlier]
        share = float((time - times[earlier]) / gap) if gap > 0 else 0.0
        one, two = self.recording.poses[earlier], self.recording.poses[later]
        moved = float(np.interp(time, times, self._displaced))
        return Moment(
            time=time,
            corners=self._placing.corners(earlier, later, share),
            faces=self._placing.faces(earlier, later, share),
            joints=self._seen.at(one + (two - one) * share, time),
            statics=float(np.interp(moved, (STILL, GONE), (1.0, 0.0))),
        )

    def point_at(self, moment: Moment, block: int, arm: Array) -> Array:
        """Where a point of a block is that lies so far from its centre as built, (3,) float.

        Parameters
        ----------
        moment : Moment
        block : int
        arm : (2,) float
        """
        piece = int(np.flatnonzero(self.owner == block)[0])
        outline, now = self._placing.outlines[piece], moment.corners[piece].mean(axis=0)
        # Its corners tell how the block has been carried.
        plain = np.column_stack([outline, np.ones(len(outline))])
        way: Array = np.linalg.pinv(plain) @ now
        return np.append(arm, 1.0) @ way

    @cached_property
    def carriers(self) -> frozenset[int]:
        """The blocks that are supports which move: the last ones."""
        count = len(self.assembly.blocks)
        return frozenset(range(count - len(self.recording.problem.moves), count))

    @cached_property
    def _seen(self) -> SeenJoints:
        frames = self._shown if self.moves else []
        return SeenJoints(self.recording, self._placing, frames, self.ground + SUNK)

    @cached_property
    def _displaced(self) -> Array:
        return self.recording.displacement

    @cached_property
    def _shown(self) -> list[int]:
        """Frames that are shown, or as many of them as tell enough of a long recording."""
        last = int(np.searchsorted(self.recording.times, self.end, "right")) - 1
        return sorted({*range(0, last, 1 + last // SAMPLES), last})
