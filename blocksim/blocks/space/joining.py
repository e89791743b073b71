"""Who touches whom among blocks in space: joints found, and what overlaps refused."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import SUPPORT, Array, frozen
from blocksim.blocks.given import OFF, SQUARE
from blocksim.blocks.outlines import step_of
from blocksim.blocks.space.assembly import FaceJoint, Solid, SolidBlock, SpatialAssembly
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
        Taken as they are where they lie on a block, by places among `solids`; by default
        they are found.
    density : float
        Weight of a unit of volume [N/m3].
    tolerance : float, optional
        Gaps and overlaps up to this are closed [m], but no more than a tenth of the thinner
        block; by default what rounding of the corners explains, up to a fortieth.

    Raises
    ------
    InputError
        In one line: a flat block, two that overlap, one that touches nothing, a joint that is
        given off both of its blocks or whose normal points back from the second.

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
    else:
        _require_laid(joints, made)
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


def _require_laid(joints: Sequence[FaceJoint], made: Sequence[SolidBlock]) -> None:
    """Refuse joints that are given where no block is, or the wrong way around."""
    for at, joint in enumerate(joints):
        one, other = made[joint.before], made[joint.after]
        pair = f"blocks {one.name} and {other.name}"
        faces = [face for block in (one, other) for hull in block.hulls for face in hull.faces]
        off = min(_off(joint.points, block) for block in (one, other))
        size = min(float(np.ptp(_corners(block), axis=0).max()) / 2 for block in (one, other))
        allowed = f"on a face of {pair}: it is {off:.3g} m off both"
        require(off <= OFF * size, f"joints[{at}].points", joint.points.tolist(), allowed)
        # Out of the first, and into the second.
        ways = [1.0] * sum(len(hull.faces) for hull in one.hulls)
        ways += [-1.0] * (len(faces) - len(ways))
        shares = [
            way * float(face.normal @ joint.normal)
            for way, face in zip(ways, faces, strict=True)
            if np.abs(joint.points @ face.normal - face.offset).max() <= off + SLACK * size
        ]
        turned = min(shares, default=0.0) < -SQUARE and max(shares) < SQUARE
        allowed = f"turned: it points from {other.name} to {one.name}"
        require(not turned, f"joints[{at}].normal", joint.normal.tolist(), allowed)


def _corners(block: SolidBlock) -> Array:
    return np.concatenate([hull.corners for hull in block.hulls])


def _off(points: Array, block: SolidBlock) -> float:
    """Return how far the farthest point is off the faces of a block, at least [m]."""
    planes = (hull.planes for hull in block.hulls)
    beyond = [(points @ normals.T - offsets).max(axis=1) for normals, offsets in planes]
    return float(np.abs(beyond).min(axis=0).max())


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
