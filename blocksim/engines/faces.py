"""What touches at each joint, as engines with shapes of their own need it.

A joint is two sides, one on the face of either block, and each side touches the other and
nothing else. So faces that continue each other, or meet at a corner, never get into each
other's way, however many joints there are on a face.

Where the faces of a joint end at the same place, as voussoirs do, their corners coincide, which
engines do not bear: there the side of the higher block reaches beyond the other by a ledge. The
contacts are those of the shorter side, whose corners are true. Where one face goes on beyond
the joint, it is that which is longer, and nothing has to be added.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array, Assembly, Joint
from blocksim.engines.contact.geometry import faces_at_joints

LEDGE = 2e-3
"""Most that one face of each joint reaches beyond the other [size]."""
LEDGE_SHARE = 0.05
"""The same, in units of the joint's length."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Side:
    """One side of a joint, scaled.

    `body`: Index of its block, or `SUPPORT`.
    `ends`, (2, 2): Inner and outer end of what touches; the same twice for a corner.
    `inward`, (2,): Unit normal into the body.
    `room`: Extent of the body along `inward`; of a support the length of the joint.
    """

    joint: int
    body: int
    ends: Array
    inward: Array
    room: float

    @property
    def is_corner(self) -> bool:
        """Whether it is a corner that rests on the other side."""
        return bool((self.ends[0] == self.ends[1]).all())

    @property
    def length(self) -> float:
        """How long it is; 0 for a corner."""
        return float(np.hypot(*(self.ends[1] - self.ends[0])))


def sides_of(assembly: Assembly) -> tuple[tuple[Side, Side], ...]:
    """Return what touches at each joint: the side of `before` and that of `after`."""
    faces, joints = faces_at_joints(assembly), assembly.joint_arrays
    found: list[tuple[Side, Side]] = []
    for index, joint in enumerate(assembly.joints):
        reach = _reaches(assembly, joint, faces[index], int(joints.carrier[index]))
        first, second = (
            Side(
                joint=index,
                body=body,
                ends=joints.ends[index] + joints.tangent[index] * reach[side, :, None],
                inward=(1.0 if side else -1.0) * joints.normal[index],
                room=_room(assembly, joint, side),
            )
            for side, body in enumerate((joint.before, joint.after))
        )
        found.append((first, second))
    return tuple(found)


def reaching(sides: tuple[Side, Side], ends: Array, ways: Array) -> tuple[Side, Side]:
    """Let the shorter side of a joint reach into the other, by a way at each end.

    The other is the one Bullet takes the normal from.

    `sides`, (Side, Side).
    `ends`, (2, 2): Of the joint.
    `ways`, (2,): At either end; negative for a gap.
    """
    shorter = int(sides[1].length < sides[0].length)
    side, along = sides[shorter], ends[1] - ends[0]
    shares = (side.ends - ends[0]) @ along / (along @ along) if along.any() else np.zeros(2)
    reach = ways[0] + shares * (ways[1] - ways[0])
    moved = replace(side, ends=side.ends - np.outer(reach, side.inward))
    return (sides[0], moved) if shorter else (moved, sides[1])


def _reaches(assembly: Assembly, joint: Joint, faces: Array, carrier: int) -> Array:
    """Return where both sides end, along the tangent from the joint's ends, shape (2, 2)."""
    ends = np.stack([joint.inner, joint.outer]) / assembly.size
    reach = ((faces - ends) * joint.tangent).sum(axis=-1)
    bodies = (joint.before, joint.after)
    length = joint.length / assembly.size
    if joint.is_corner:
        longer = carrier
        least = LEDGE
    else:
        # A support is as wide as needed, else the higher block: a mirror image stays one.
        longer = bodies.index(SUPPORT) if SUPPORT in bodies else _higher(assembly, bodies)
        least = min(LEDGE, LEDGE_SHARE * length)
    for end, outward in enumerate((-1.0, 1.0)):
        beyond = outward * reach[:, end]
        if not joint.is_corner and not assembly.supports and bodies[longer] == SUPPORT:
            beyond[longer] = max(beyond[longer], length)
        if abs(beyond[1] - beyond[0]) < least:
            wide = longer if beyond[0] == beyond[1] else int(beyond.argmax())
            beyond[wide] = beyond[1 - wide] + least
        reach[:, end] = outward * beyond
    return reach


def _higher(assembly: Assembly, bodies: tuple[int, int]) -> int:
    """Tell which of two blocks is the higher one; of two at one height the second."""
    first, second = assembly.centres[list(bodies), 1] / assembly.size
    return int(second > first - LEDGE)


def _room(assembly: Assembly, joint: Joint, side: int) -> float:
    """Return how far a body reaches from a joint, along the normal."""
    sign = 1.0 if side else -1.0
    polygons = assembly.polygons_at(joint, side)
    if (joint.before, joint.after)[side] == SUPPORT or not polygons:
        return max(joint.length / assembly.size, LEDGE)
    corners = np.concatenate(polygons)
    return float(((corners - joint.inner) @ (sign * joint.normal)).max()) / assembly.size
