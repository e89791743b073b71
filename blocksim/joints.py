"""Poses to joint motions to joint states to the collapse mode."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from blocksim.arch import Arch, crown_width
from blocksim.assembly import SUPPORT, Array, Assembly
from blocksim.modes import ActiveJoint, Mode, name_mode


class JointState(StrEnum):
    """What a joint does."""

    CLOSED = "closed"
    HINGE_INTRADOS = "hinge-intrados"
    HINGE_EXTRADOS = "hinge-extrados"
    SLIDES = "slides"
    HINGE_AND_SLIDES = "hinge-and-slides"
    OPEN = "open"


@dataclass(frozen=True, eq=False)
class JointMotion:
    """How far the two sides of each joint have parted.

    Parameters
    ----------
    gap : (joints, 2) float
        Opening at the inner and outer end; negative where blocks overlap.
    slip : (joints,) float
        Tangential displacement of `after` relative to `before`, mean of the ends.
    turn : (joints,) float
        Rotation of `after` relative to `before` [rad].
    """

    gap: Array
    slip: Array
    turn: Array


def joint_motion(assembly: Assembly, poses: Array) -> JointMotion:
    """Measure every joint at one instant.

    Parameters
    ----------
    assembly : Assembly
    poses : (blocks, 3) float
        Centres of mass x, y and rotations [rad], in units of the assembly's size.

    Returns
    -------
    JointMotion
        Lengths in units of the assembly's size.
    """
    size = assembly.size
    before, after = assembly.joint_sides.T
    ends = assembly.joint_ends / size
    tangent = (ends[:, 1] - ends[:, 0]) / (assembly.joint_lengths / size)[:, None]
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
    # The support is appended as a block that stays where it is, index -1.
    start = np.vstack([assembly.centres / size, np.zeros(2)])
    moved = np.vstack([poses, np.zeros(3)])

    def carried(block: NDArray[np.int64]) -> Array:
        """Where the block has taken the two ends of the joint, less where they were."""
        arm = ends - start[block][:, None]
        angle = moved[block, 2][:, None, None]
        # cos - 1 = -2 sin^2(angle/2): no cancellation for small rotations.
        versine = 2 * np.sin(angle / 2) ** 2
        spun = np.stack([-arm[..., 1], arm[..., 0]], axis=-1) * np.sin(angle) - arm * versine
        return spun + (moved[block, :2] - start[block])[:, None]

    apart = carried(after) - carried(before)
    mean = (moved[after, 2] + moved[before, 2]) / 2
    mean = np.where((after == SUPPORT) | (before == SUPPORT), 0.0, mean)
    cos, sin = np.cos(mean)[:, None], np.sin(mean)[:, None]

    def along(axis: Array) -> Array:
        turned = np.stack(
            [axis[:, :1] * cos - axis[:, 1:] * sin, axis[:, :1] * sin + axis[:, 1:] * cos], -1
        )
        return np.einsum("jek,jk->je", apart, turned[:, 0])

    return JointMotion(
        gap=along(normal),
        slip=along(tangent).mean(axis=1),
        turn=moved[after, 2] - moved[before, 2],
    )


def overlap_share(assembly: Assembly, poses: Array) -> float:
    """Deepest overlap at the end of a joint, as a share of the largest motion of a joint.

    A motion that contacts allow has next to none; one driven by contacts that have not
    converged presses blocks into each other.
    """
    motion = joint_motion(assembly, poses)
    lengths = assembly.joint_lengths / assembly.size
    turned, slipped = np.abs(motion.turn) * lengths, np.abs(motion.slip)
    moved = max(float(turned.max()), float(slipped.max()))
    return max(0.0, -float(motion.gap.min())) / moved if moved > 0 else 0.0


ACTIVE = 0.02
"""A joint takes part if it turns or slips more than this share of the most active one."""
PARTED = 0.25
"""A turning joint is open if its closer end parts by this share of what its turn opens."""


@dataclass(frozen=True, kw_only=True)
class ObservedJoint:
    """State of one joint.

    Parameters
    ----------
    angle : float
        Direction of the joint from the crown, positive to the right [rad].
    state : JointState
    """

    angle: float
    state: JointState


def closed_joints(arch: Arch) -> tuple[ObservedJoint, ...]:
    """Joints of an arch at rest."""
    return tuple(
        ObservedJoint(angle=float(angle), state=JointState.CLOSED)
        for angle in arch.joint_angles
    )


def classify(assembly: Assembly, poses: Array) -> tuple[ObservedJoint, ...]:
    """Tell what each joint does at one instant.

    Turning (relative rotation times the assembly's size) and slipping are both lengths
    of the motion itself and compared with the largest of either. A turning joint is
    hinged at the end that stays closed, and open where neither does.

    Parameters
    ----------
    assembly : Assembly
    poses : (blocks, 3) float
        As for `joint_motion`; best an early instant, while the motion is the collapse
        mechanism and not yet what follows from it.

    Returns
    -------
    tuple of ObservedJoint
        All closed where nothing moved.
    """
    motion = joint_motion(assembly, poses)
    turn, slip = np.abs(motion.turn), np.abs(motion.slip)
    least = ACTIVE * max(float(turn.max()), float(slip.max()))
    observed: list[ObservedJoint] = []
    for index, joint in enumerate(assembly.joints):
        angle = math.atan2(joint.tangent[0], joint.tangent[1])
        opening = motion.gap[index]
        slips = bool(slip[index] > least > 0)
        if turn[index] > least > 0:
            parted = turn[index] * joint.length / assembly.size
            state = _turning(opening, parted, slips=slips)
        else:
            state = JointState.SLIDES if slips else JointState.CLOSED
        observed.append(ObservedJoint(angle=angle, state=state))
    return tuple(observed)


def _turning(opening: Array, parted: float, *, slips: bool) -> JointState:
    """State of a joint that turns: which end stays closed, and does it slip."""
    if opening.min() > PARTED * parted:
        return JointState.OPEN
    if slips:
        return JointState.HINGE_AND_SLIDES
    if opening[0] < opening[1]:
        return JointState.HINGE_INTRADOS
    return JointState.HINGE_EXTRADOS


def observed_mode(
    joints: tuple[ObservedJoint, ...], half_angle: float, voussoirs: int
) -> Mode | None:
    """Name the mode of the observed joints of an arch, both halves folded onto one.

    A hinge that falls between two joints shows as both of them: neighbours that do the
    same count as one, at the place of the outermost.

    Parameters
    ----------
    joints : tuple of ObservedJoint
    half_angle : float
        alpha [rad].
    voussoirs : int

    Returns
    -------
    Mode or None
        None where they form none of the seven modes.
    """
    spacing = 2 * half_angle / voussoirs
    active: list[ActiveJoint] = []
    for observed in sorted(joints, key=lambda joint: -abs(joint.angle)):
        for kind in _KINDS[observed.state]:
            joint = ActiveJoint(abs(observed.angle), *kind)
            if not any(_neighbours(joint, other, spacing) for other in active):
                active.append(joint)
    return name_mode(active, crown_width(half_angle, voussoirs))


_TURNS_OUTSIDE, _TURNS_INSIDE, _SLIDES = (False, False), (False, True), (True, False)
_KINDS: dict[JointState, tuple[tuple[bool, bool], ...]] = {
    JointState.CLOSED: (),
    JointState.HINGE_INTRADOS: (_TURNS_INSIDE,),
    JointState.HINGE_EXTRADOS: (_TURNS_OUTSIDE,),
    JointState.SLIDES: (_SLIDES,),
    JointState.HINGE_AND_SLIDES: (_TURNS_INSIDE, _SLIDES),
    JointState.OPEN: (_TURNS_OUTSIDE, _TURNS_INSIDE),
}
"""(slides, intrados) of what a joint in each state does."""


def _neighbours(joint: ActiveJoint, other: ActiveJoint, spacing: float) -> bool:
    same = joint.slides == other.slides and joint.intrados == other.intrados
    return same and abs(joint.angle - other.angle) < 1.5 * spacing
