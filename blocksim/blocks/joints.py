"""Poses to joint motions to joint states."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array, Assembly

if TYPE_CHECKING:
    from blocksim.blocks.space.assembly import SpatialAssembly


class JointState(StrEnum):
    """What a joint does."""

    CLOSED = "closed"
    HINGE_INTRADOS = "hinge-intrados"
    HINGE_EXTRADOS = "hinge-extrados"
    SLIDES = "slides"
    HINGE_AND_SLIDES = "hinge-and-slides"
    OPEN = "open"

    @classmethod
    def of(cls, *, inner: bool, outer: bool, slides: bool = False) -> JointState:
        """Return what a joint does of which ends open, and whose sides slide along it."""
        if inner and outer:
            return cls.OPEN
        if inner or outer:
            hinge = cls.HINGE_EXTRADOS if inner else cls.HINGE_INTRADOS
            return cls.HINGE_AND_SLIDES if slides else hinge
        return cls.SLIDES if slides else cls.CLOSED

    @property
    def hinge(self) -> int | None:
        """End about which a joint turns: 0 is the inner one, 1 the outer; else None."""
        return {JointState.HINGE_INTRADOS: 0, JointState.HINGE_EXTRADOS: 1}.get(self)

    @property
    def words(self) -> str:
        """The state as people read it."""
        return self.value.replace("-", " ")


@dataclass(frozen=True, eq=False)
class JointMotion:
    """How far the two sides of each joint have parted.

    `gap`, (joints, 2): Opening at the inner and outer end; negative where blocks overlap.
    `slip`, (joints,): Tangential displacement of `after` relative to `before`, mean of the
        ends.
    `turn`, (joints,): Rotation of `after` relative to `before` [rad].
    """

    gap: Array
    slip: Array
    turn: Array


BESIDE = 1e-3
"""Motion of joints, as a share of that of blocks, less than which is round-off beside it."""


def joint_motion(assembly: Assembly, poses: Array) -> JointMotion:
    """Measure every joint at one instant.

    `poses`, (blocks, 3 or 6): Centres of mass x, y and rotations [rad], in units of the
        assembly's size; motion out of the plane is left aside.
    Returns: Lengths in units of the assembly's size.
    """
    joints, arms = assembly.joint_arrays, assembly.joint_arms
    # The support is appended as a block that stays where it is, index -1.
    moved = np.zeros((len(poses) + 1, PLANAR))
    moved[:-1] = poses[:, :PLANAR] - assembly.built[:-1]
    sides = moved[assembly.sides]
    turns: Array = sides[..., 2]
    # cos - 1 = -2 sin^2(angle/2): no cancellation for small rotations.
    sine, versine = np.sin(turns)[..., None], 2 * np.sin(turns / 2)[..., None] ** 2
    x, y = arms[..., 0], arms[..., 1]
    # Where blocks have taken the two ends of the joints, less where they were.
    x, y = (
        sides[..., :1] - y * sine - x * versine,
        sides[..., 1:2] + x * sine - y * versine,
    )
    x, y = x[1] - x[0], y[1] - y[0]
    mean: Array = (turns[1] + turns[0]) / 2
    if joints.is_corner.any():
        # The face that carries a corner says which way it opens.
        own: Array = turns[joints.carrier, np.arange(len(mean))]
        mean = np.where(joints.is_corner, own, mean)
    cos, sin = np.cos(mean), np.sin(mean)
    right, up = joints.normal.T
    right, up = (right * cos - up * sin)[:, None], (right * sin + up * cos)[:, None]
    # The tangent is the normal turned by a right angle.
    slip = y * right - x * up
    return JointMotion(
        gap=x * right + y * up,
        slip=(slip[:, 0] + slip[:, 1]) / 2,
        turn=turns[1] - turns[0],
    )


def overlap_and_slip(assembly: Assembly, poses: Array) -> tuple[float, float]:
    """Deepest overlap at the end of a joint, and largest slip of one.

    Both are shares of the largest motion of a joint: opening by rotation, or slip, or `BESIDE`
    of how far blocks go, some of which no joint may hold. A corner has no length: the reach of
    the smaller block stands for it. A motion that contacts allow has next to no overlap; one
    driven by contacts that have not converged presses blocks into each other.
    """
    motion, joints = joint_motion(assembly, poses), assembly.joint_arrays
    gap, slip = motion.gap.min(axis=1), np.abs(motion.slip)
    turned = np.abs(motion.turn) * np.where(
        joints.is_corner, assembly.lesser_reach, joints.length
    )
    parted = np.where(joints.is_corner, np.abs(motion.gap[:, 0]), 0.0)
    gone = BESIDE * assembly.displacement(poses[:, :PLANAR] - assembly.built[:-1])
    moves = [turned, parted, slip, gone]
    moved = max(float(move.max(initial=0.0)) for move in moves)
    if not moved > 0:
        return 0.0, 0.0
    deepest = max(0.0, -float(gap.min(initial=0.0)))
    return deepest / moved, float(slip.max(initial=0.0)) / moved


ACTIVE = 0.02
"""A joint takes part if it turns or slips more than this share of the most active one."""
LEFT = 0.02
"""Gap of both ends at which the blocks of a joint have left each other [size]."""
PARTED = 0.25
"""A turning joint is open if its closer end parts by this share of what its turn opens."""


@dataclass(frozen=True, kw_only=True)
class ObservedJoint:
    """State of one joint.

    `angle`: Direction of the joint from the crown, positive to the right [rad].
    """

    angle: float
    state: JointState


def closed_joints(angles: Array) -> tuple[ObservedJoint, ...]:
    """Joints at rest, in these directions from the vertical, shape (joints,) [rad]."""
    return tuple(
        ObservedJoint(angle=angle, state=JointState.CLOSED) for angle in angles.tolist()
    )


def classify(
    assembly: Assembly, poses: Array, *, least: float | None = None
) -> tuple[ObservedJoint, ...]:
    """Tell what each joint does at one instant.

    Turning (relative rotation times the assembly's size) and slipping are both lengths
    of the motion itself and compared with the largest of either. A turning joint is
    hinged at the end that stays closed, and open where neither does. A joint whose blocks
    have left each other, apart or past each other, is open whatever else it did. A corner
    on a face is open or slides, and closed where it only turns.

    `poses`, (blocks, 3 or 6): As for `joint_motion`; best an early instant, while the motion is
        the collapse mechanism and not yet what follows from it.
    `least`: A joint takes part if it turns or slips more than this, in units of the assembly's
        size; by default more than the share `ACTIVE` of the most active one.
    Returns: All closed where nothing moved.
    """
    motion, joints = joint_motion(assembly, poses), assembly.joint_arrays
    turns, slips = np.abs(motion.turn), np.abs(motion.slip)
    if least is None:
        least = ACTIVE * max(float(turns.max(initial=0.0)), float(slips.max(initial=0.0)))
    observed: list[ObservedJoint] = []
    every = (joints.tangent, joints.length, joints.is_corner, motion.gap, turns, slips)
    for index, (tangent, length, is_corner, opening, turn, slip) in enumerate(
        zip(*(each.tolist() for each in every), strict=True)
    ):
        slides = slip > least > 0
        state = JointState.of(inner=False, outer=False, slides=slides)
        if is_corner:
            # How far it can slip on its face.
            far = slip > _left_to_slip(assembly, index, float(motion.slip[index]))
            state = JointState.OPEN if far or min(opening) > least > 0 else state
        elif min(opening) > LEFT or slip > length:
            state = JointState.OPEN
        elif turn > least > 0:
            parted, inner = min(opening) > PARTED * turn * length, opening[0] >= opening[1]
            state = JointState.of(
                inner=parted or inner, outer=parted or not inner, slides=slides
            )
        observed.append(ObservedJoint(angle=math.atan2(*tangent), state=state))
    return tuple(observed)


def _left_to_slip(assembly: Assembly, joint: int, slip: float) -> float:
    """Length of the face that carries a corner, from it in the sense of its slip."""
    joints = assembly.joint_arrays
    carrier = int(joints.carrier[joint])
    ends = (joints.faces[joint, carrier] - joints.ends[joint, 0]) @ joints.tangent[joint]
    # The face moves where the block behind it is `after`.
    sense = slip if carrier == 0 else -slip
    return float(abs(ends[1] if sense > 0 else ends[0]))


def joint_names(assembly: Assembly | SpatialAssembly) -> list[str]:
    """Name each joint by the bodies on its two sides."""
    return [
        f"{side_name(assembly, k, 0)}-{side_name(assembly, k, 1)}"
        for k in range(len(assembly.joints))
    ]


def side_name(assembly: Assembly | SpatialAssembly, joint: int, side: int) -> str:
    """Name the body on a side of a joint."""
    here = assembly.joints[joint]
    index = (here.before, here.after)[side]
    if index != SUPPORT:
        return assembly.blocks[index].name or str(index)
    if here.support is None:
        return "support"
    return assembly.supports[here.support].name or "support"
