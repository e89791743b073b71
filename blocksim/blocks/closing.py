"""What gaps and overlaps of a drawing, closed at joints, may do to an answer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from blocksim.blocks.assembly import Assembly, Joint
from blocksim.blocks.rows import column

LEAST = 0.1
"""Share of its length that a joint keeps where blocks are shrunk."""

SEEN = 1e-3
"""Share of a joint's length from which on the gap it closes is marked."""


def closed_gaps(assembly: Assembly) -> dict[int, float]:
    """Gaps that were closed, below 0 where blocks overlap [m], by the index of the joint."""
    gaps = np.array(column(assembly.joints, "gap"), dtype=float)
    return {int(index): float(gaps[index]) for index in np.flatnonzero(gaps)}


def marked_gaps(assembly: Assembly) -> dict[int, float]:
    """Return closed gaps that drawings mark, not those of rounding [m]; the largest first."""
    gaps = closed_gaps(assembly)
    seen = [
        index for index, gap in gaps.items() if abs(gap) > SEEN * assembly.joints[index].length
    ]
    return {index: gaps[index] for index in sorted(seen, key=lambda index: -abs(gaps[index]))}


def resized(assembly: Assembly, sign: int) -> Assembly:
    """Return blocks grown (1) or shrunk (-1): joints longer or shorter by the gaps they close.

    Weights stay as they are. A corner on a face has no length that could change.
    """
    joints = tuple(_resized(joint, sign) for joint in assembly.joints)
    return replace(assembly, joints=joints)


def _resized(joint: Joint, sign: int) -> Joint:
    if joint.gap == 0 or joint.is_corner:
        return joint
    by = max(sign * abs(joint.gap), -(1 - LEAST) / 2 * joint.length) * joint.tangent
    inner, outer = joint.inner - by, joint.outer + by
    # Its faces end where it does: they are grown with it.
    return replace(joint, inner=inner, outer=outer, faces=None)
