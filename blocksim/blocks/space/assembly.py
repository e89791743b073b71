"""Rigid blocks in space, who touches whom, and what is fixed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.blocks.assembly import SUPPORT, Array, frozen
from blocksim.blocks.outlines import step_of
from blocksim.blocks.space.contact import Contact, Overlap, contact
from blocksim.blocks.space.polyhedron import Polyhedron
from blocksim.common.checks import require
from blocksim.common.errors import InputError

Flags = NDArray[np.bool_]
Places = NDArray[np.int64]
SLACK = 1e-7
"""Share of the thinner block by which faces that touch may part, whatever the rounding."""
STEPS = 2.0
"""Steps of rounding by which they may part besides."""
MOST_SHARE, GIVEN_SHARE = 1 / 40, 1 / 10
"""Share of the thinner block up to which gaps are closed: due to rounding, and asked for."""
MOST_SOLIDS = 10_000
"""Blocks, beyond which pairs that may touch would not fit into memory."""
LONGEST_BLOCK = 1000.0
"""Length of a block that moves [m]: beyond it the file is in millimetres."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Solid:
    """A rigid block in space: a convex polyhedron, or several that move as one.

    Parameters
    ----------
    parts : tuple of (k, 3) array_like
        Corners of each convex part [m], in any order.
    name : str
    fixed : bool
        Whether it is a support.
    weight : float or None
        [N]; by default density times volume.
    centre : (3,) array_like or None
        Where its weight acts [m]; by default the centroid.

    Examples
    --------
    >>> import itertools
    >>> block = Solid(parts=(list(itertools.product((0, 1), (0, 1), (0, 2))),))
    >>> block.name, block.fixed
    ('', False)
    """

    parts: tuple[ArrayLike, ...]
    name: str = ""
    fixed: bool = False
    weight: float | None = None
    centre: ArrayLike | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class SolidBlock:
    """A block of an assembly in space.

    Parameters
    ----------
    hulls : tuple of Polyhedron
        The convex parts it consists of.
    name : str
    weight : float
        [N]
    centre : (3,) float
        Centre of mass [m].
    """

    hulls: tuple[Polyhedron, ...]
    name: str
    weight: float
    centre: Array

    @cached_property
    def gyration(self) -> Array:
        """Moments of inertia about its centroid over its mass [m2], (3, 3).

        As of one material, whatever its centre of mass is.
        """
        volumes = np.array([hull.volume for hull in self.hulls])
        centroid = volumes @ np.array([hull.centroid for hull in self.hulls]) / volumes.sum()
        spread = sum(hull.second_moment(centroid) for hull in self.hulls) / volumes.sum()
        return np.trace(spread) * np.eye(3) - spread


@dataclass(frozen=True, eq=False, kw_only=True)
class FaceJoint:
    """A dry joint in space: a polygon, a segment or a point where two blocks touch.

    Parameters
    ----------
    before, after : int
        Indices of the blocks on its two sides, `SUPPORT` for the ground.
    points : (k, 3) float
        Corners of the polygon in order, ends of the segment, or the point [m].
    normal : (3,) float
        Unit normal, from `before` into `after`.
    friction : float or None
        Its own friction coefficient, where it is not that of all others.
    support : int or None
        Which of the supports it lies on.
    gap : float
        How far apart the faces are drawn that it closes, below 0 where they overlap [m].
    """

    before: int
    after: int
    points: Array
    normal: Array
    friction: float | None = None
    support: int | None = None
    gap: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class SpatialAssembly:
    """Blocks, supports and the joints between them.

    Parameters
    ----------
    blocks : tuple of SolidBlock
    supports : tuple of SolidBlock
        Fixed; their weight is of no account.
    joints : tuple of FaceJoint
    """

    blocks: tuple[SolidBlock, ...]
    supports: tuple[SolidBlock, ...]
    joints: tuple[FaceJoint, ...]

    @cached_property
    def size(self) -> float:
        """Half the longest side of the box around all blocks that move [m]."""
        boxes = np.array([hull.box for block in self.blocks for hull in block.hulls])
        return float((boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0)).max()) / 2

    @cached_property
    def friction(self) -> Array:
        """Friction coefficient of each joint, (joints,); nan where it has none of its own."""
        own = (each.friction for each in self.joints)
        return frozen([math.nan if mu is None else mu for mu in own], (-1,))

    @property
    def joint_angles(self) -> Array:
        """Directions of the joints from a crown, (joints,): nan, as there is none."""
        return np.full(len(self.joints), np.nan)

    @cached_property
    def weights(self) -> Array:
        """Weights of the blocks [N], (blocks,)."""
        return frozen([block.weight for block in self.blocks], (-1,))

    @cached_property
    def reach(self) -> Array:
        """How far corners are from the centre of their block [m], (blocks,)."""
        corners = [np.concatenate([h.corners for h in block.hulls]) for block in self.blocks]
        ways = zip(corners, self.blocks, strict=True)
        found = [np.linalg.norm(own - block.centre, axis=1).max() for own, block in ways]
        return frozen(found, (-1,))

    @cached_property
    def centres(self) -> Array:
        """Centres of mass [m], (blocks, 3)."""
        return frozen([block.centre for block in self.blocks], (-1, 3))


def assembly_in_space(
    solids: Sequence[Solid],
    joints: Sequence[FaceJoint] | None = None,
    *,
    density: float = 1.0,
    tolerance: float | None = None,
) -> SpatialAssembly:
    """Find who touches whom.

    Parameters
    ----------
    solids : sequence of Solid
    joints : sequence of FaceJoint, optional
        Taken as they are, by places among `solids`; by default they are found.
    density : float
        Weight of a unit of volume [N/m3].
    tolerance : float, optional
        Gaps and overlaps up to this are closed [m], but no more than a tenth of the thinner
        block; by default what rounding of the corners explains, up to a fortieth.

    Raises
    ------
    InputError
        In one line: a flat block, two that overlap, one that touches nothing.

    Examples
    --------
    >>> import itertools
    >>> box = lambda low, high: list(itertools.product((0, 1), (0, 1), (low, high)))
    >>> found = assembly_in_space(
    ...     [Solid(parts=(box(-1, 0),), fixed=True), Solid(parts=(box(0, 1),))]
    ... )
    >>> len(found.joints), found.joints[0].points.shape
    (1, (4, 3))
    """
    most = f"at most {MOST_SOLIDS} blocks in space"
    require(len(solids) <= MOST_SOLIDS, "blocks", f"{len(solids)} blocks", most)
    every = [np.asarray(part, dtype=float) for solid in solids for part in solid.parts]
    step = step_of(np.concatenate([part.ravel() for part in every])) if every else 0.0
    # Steps of twelve decimals are what a program writes; coarser ones are a survey's.
    slack = STEPS * step if tolerance is None else tolerance
    made = [_block_of(solid, at, density, slack) for at, solid in enumerate(solids)]
    fixed = np.array([solid.fixed for solid in solids])
    require(bool(fixed.any()), "blocks", "all free", "a block that is fixed")
    require(not fixed.all(), "blocks", "all fixed", "a block that is not fixed")
    # Those that move are numbered without the fixed ones, and these without the others.
    place = np.where(fixed, np.cumsum(fixed), np.cumsum(~fixed)) - 1
    if joints is None:
        joints = _found(made, fixed, slack, given=tolerance is not None)
    placed = tuple(_placed(joint, fixed, place) for joint in joints)
    touched = {index for each in placed for index in (each.before, each.after)}
    for at, solid in enumerate(solids):
        name = made[at].name
        touches = solid.fixed or int(place[at]) in touched
        require(touches, f"block {name}", "touches nothing", "joined to another block")
    return SpatialAssembly(
        blocks=tuple(made[at] for at in np.flatnonzero(~fixed)),
        supports=tuple(made[at] for at in np.flatnonzero(fixed)),
        joints=placed,
    )


def _block_of(solid: Solid, at: int, density: float, slack: float) -> SolidBlock:
    """Make a block of its parts."""
    name = solid.name or str(at)
    try:
        hulls = tuple(Polyhedron(part) for part in solid.parts)
        # Rounding bends faces, but no more than a fraction of the block.
        hulls = tuple(
            hull.with_slack(min(slack, MOST_SHARE * hull.thickness)) for hull in hulls
        )
    except InputError as error:
        raise InputError(f"block {name}: {error.field}", error.value, error.allowed) from None
    long = max(float(np.ptp(hull.corners, axis=0).max()) for hull in hulls)
    allowed = f"blocks up to {LONGEST_BLOCK:g} m long: are these millimetres?"
    require(solid.fixed or long <= LONGEST_BLOCK, f"block {name}", f"{long:g} m long", allowed)
    volumes = np.array([hull.volume for hull in hulls])
    centroids = np.array([hull.centroid for hull in hulls])
    volume = float(volumes.sum())
    centroid = volumes @ centroids / volume
    centre = centroid if solid.centre is None else np.asarray(solid.centre, dtype=float)
    weight = density * volume if solid.weight is None else float(solid.weight)
    _require_apart(hulls, name, slack)
    return SolidBlock(
        hulls=hulls,
        name=name,
        weight=weight,
        centre=frozen(centre, (3,)),
    )


def _require_apart(hulls: Sequence[Polyhedron], name: str, slack: float) -> None:
    """Refuse parts of one block that overlap: their volume would count twice."""
    for at, first in enumerate(hulls):
        for second in hulls[at + 1 :]:
            found = contact(first, second, _slack_of(first, second, slack, MOST_SHARE))
            if isinstance(found, Overlap):
                depth = f"{found.depth:.3g} m"
                raise InputError(f"block {name}: polyhedra", depth, "parts that do not overlap")


def _slack_of(first: Polyhedron, second: Polyhedron, slack: float, share: float) -> float:
    """Return how far apart two polyhedra that touch may be drawn [m]."""
    thin = min(first.thickness, second.thickness)
    return max(SLACK * thin, min(slack, share * thin))


def _found(
    made: Sequence[SolidBlock], fixed: Flags, slack: float, *, given: bool
) -> list[FaceJoint]:
    """Find all joints but those between two fixed blocks."""
    hulls = [hull for block in made for hull in block.hulls]
    owner = [at for at, block in enumerate(made) for _ in block.hulls]
    joints: list[FaceJoint] = []
    for one, other in _near(hulls, slack):
        a, b = owner[one], owner[other]
        if a == b or (fixed[a] and fixed[b]):
            continue
        share = GIVEN_SHARE if given else MOST_SHARE
        own = _slack_of(hulls[one], hulls[other], slack, share)
        found = contact(hulls[one], hulls[other], own)
        if isinstance(found, Overlap):
            pair = f"blocks {made[a].name} and {made[b].name}"
            depth = f"overlap by {found.depth:.3g} m"
            raise InputError(pair, depth, "apart; tolerance closes what is smaller")
        if isinstance(found, Contact):
            joints.append(
                FaceJoint(
                    before=a,
                    after=b,
                    points=frozen(found.points, (-1, 3)),
                    normal=frozen(found.normal, (3,)),
                    gap=found.gap,
                )
            )
    return joints


def _near(hulls: Sequence[Polyhedron], slack: float) -> Iterable[tuple[int, int]]:
    """Give pairs of polyhedra whose boxes meet, by the first, then the second."""
    boxes = np.array([hull.box for hull in hulls])
    reach = slack + SLACK * np.ptp(boxes, axis=1).max(axis=1)
    low, high = boxes[:, 0] - reach[:, None], boxes[:, 1] + reach[:, None]
    for at in range(len(hulls) - 1):
        meet = ((low[at + 1 :] <= high[at]) & (high[at + 1 :] >= low[at])).all(axis=1)
        for other in np.flatnonzero(meet).tolist():
            yield at, at + 1 + other


def _placed(joint: FaceJoint, fixed: Flags, place: Places) -> FaceJoint:
    """Return a joint by the places of blocks among those that move."""
    sides = joint.before, joint.after
    before, after = (SUPPORT if fixed[each] else int(place[each]) for each in sides)
    support = next((int(place[each]) for each in sides if fixed[each]), None)
    return replace(joint, before=before, after=after, support=support)
