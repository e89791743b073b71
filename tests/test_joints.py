"""Poses to joint motion to joint state to mode, on poses made by hand.

Turning two parts of an arch about a known corner, or shifting one along a joint, gives
gaps, slip and turn in closed form. Mechanisms are built from their hinges alone.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from blocksim import Arch, Assembly, JointState, Mode
from blocksim.arch.circular import crown_width
from blocksim.arch.modes import ActiveJoint, name_mode, observed_mode
from blocksim.blocks.joints import (
    ObservedJoint,
    classify,
    closed_joints,
    joint_motion,
    overlap_and_slip,
)

ARCH = Arch(half_angle=1.4, eta=0.2, voussoirs=8, radius=3.0)
ASSEMBLY = ARCH.assembly()
REST = np.column_stack([ASSEMBLY.centres / 3.0, np.zeros(8)])
STATE = JointState


def turned(poses: np.ndarray, blocks: list[int], about: np.ndarray, angle: float) -> np.ndarray:
    """Turn blocks together about a point, lengths in units of r."""
    moved = poses.copy()
    cosine, sine = math.cos(angle), math.sin(angle)
    spin = np.array([[cosine, -sine], [sine, cosine]])
    for block in blocks:
        moved[block, :2] = about + spin @ (poses[block, :2] - about)
        moved[block, 2] += angle
    return moved


def shifted(poses: np.ndarray, blocks: list[int], by: np.ndarray) -> np.ndarray:
    moved = poses.copy()
    moved[blocks, :2] += by
    return moved


def states(assembly: Assembly, poses: np.ndarray) -> list[JointState]:
    return [joint.state for joint in classify(assembly, poses)]


def test_nothing_moved() -> None:
    motion = joint_motion(ASSEMBLY, REST)
    assert np.abs(motion.gap).max() < 1e-15
    assert np.abs(motion.slip).max() < 1e-15
    assert not motion.turn.any()
    assert set(states(ASSEMBLY, REST)) == {STATE.CLOSED}
    for one, other in zip(
        closed_joints(ARCH.joint_angles), classify(ASSEMBLY, REST), strict=True
    ):
        assert one.state is other.state
        assert one.angle == pytest.approx(other.angle, rel=1e-14)
    assert observed_mode(closed_joints(ARCH.joint_angles), ARCH) is None


@given(st.integers(1, 7), st.floats(1e-9, 0.3), st.booleans())
def test_hinge(index: int, angle: float, intrados: bool) -> None:
    """All blocks after a joint turn about one of its ends: gap 0 there, 2 t sin(a/2) there."""
    joint = ASSEMBLY.joints[index]
    about = (joint.inner if intrados else joint.outer) / 3.0
    # The far part turns so that the joint opens: clockwise about the intrados end.
    signed = -angle if intrados else angle
    moved = turned(REST, list(range(index, 8)), about, signed)
    motion = joint_motion(ASSEMBLY, moved)
    closed, opened = (0, 1) if intrados else (1, 0)
    assert motion.gap[index, closed] == pytest.approx(0, abs=1e-14)
    # Measured along the mean of both sides' normals: the chord 2 t sin(angle/2).
    expected = 2 * 0.2 * math.sin(angle / 2)
    assert motion.gap[index, opened] == pytest.approx(expected, rel=1e-6, abs=1e-14)
    assert motion.slip[index] == pytest.approx(0, abs=1e-14)
    assert motion.turn[index] == pytest.approx(signed, rel=1e-12)
    others = [i for i in range(8) if i != index]
    assert np.abs(motion.gap[others]).max() < 1e-13
    assert np.abs(motion.slip[others]).max() < 1e-13
    found = states(ASSEMBLY, moved)
    kind = STATE.HINGE_INTRADOS if intrados else STATE.HINGE_EXTRADOS
    if angle > 1e-6:
        assert found[index] is kind
    assert all(found[i] is STATE.CLOSED for i in range(8) if i != index)


@given(st.integers(1, 7), st.floats(-0.1, 0.1).filter(lambda s: abs(s) > 1e-9))
def test_slide(index: int, slip: float) -> None:
    joint = ASSEMBLY.joints[index]
    moved = shifted(REST, list(range(index, 8)), slip * joint.tangent)
    motion = joint_motion(ASSEMBLY, moved)
    assert motion.slip[index] == pytest.approx(slip, rel=1e-6, abs=1e-14)
    assert np.abs(motion.gap[index]).max() < 1e-14
    assert not motion.turn.any()
    assert states(ASSEMBLY, moved)[index] is STATE.SLIDES


@given(st.integers(1, 7), st.floats(1e-6, 0.1))
def test_slide_has_a_sign_and_gap_another(index: int, size: float) -> None:
    joint = ASSEMBLY.joints[index]
    apart = joint_motion(ASSEMBLY, shifted(REST, list(range(index, 8)), size * joint.normal))
    pressed = joint_motion(ASSEMBLY, shifted(REST, list(range(index, 8)), -size * joint.normal))
    assert apart.gap[index] == pytest.approx([size, size], rel=1e-8)
    assert pressed.gap[index] == pytest.approx([-size, -size], rel=1e-8)
    assert abs(apart.slip[index]) < 1e-14


def test_open_joint() -> None:
    """Turned and parted by more than its turn: open at both ends."""
    joint = ASSEMBLY.joints[3]
    part = list(range(3, 8))
    for share, state in ((0.6, STATE.OPEN), (0.1, STATE.HINGE_INTRADOS)):
        moved = turned(REST, part, joint.inner / 3, -0.01)
        moved = shifted(moved, part, share * 0.01 * 0.2 * joint.normal)
        assert states(ASSEMBLY, moved)[3] is state


def test_hinge_and_slide() -> None:
    joint = ASSEMBLY.joints[3]
    part = list(range(3, 8))
    moved = shifted(turned(REST, part, joint.inner / 3, -0.01), part, 0.01 * joint.tangent)
    assert states(ASSEMBLY, moved)[3] is STATE.HINGE_AND_SLIDES


def test_overlap_share() -> None:
    joint = ASSEMBLY.joints[4]
    middle = (joint.inner + joint.outer) / 6
    block = [4]
    # About the middle of a joint, half of what turns in overlaps: 0.5 t of t.
    moved = turned(REST, block, middle, 1e-4)
    lone = Assembly(blocks=ASSEMBLY.blocks, joints=(joint,), size=3.0)
    assert overlap_and_slip(lone, moved)[0] == pytest.approx(0.5, rel=1e-3)
    hinged = turned(REST, block, joint.inner / 3, -1e-4)
    assert overlap_and_slip(lone, hinged)[0] == pytest.approx(0, abs=1e-6)
    pressed = turned(REST, block, joint.inner / 3, 1e-4)
    assert overlap_and_slip(lone, pressed)[0] == pytest.approx(1, rel=1e-3)


@settings(max_examples=25)
@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-0.05, 0.05), st.floats(-0.05, 0.05))
def test_a_joint_does_not_see_a_common_motion(
    x: float, y: float, angle: float, more: float
) -> None:
    """Turn both sides of a joint together: neither gap nor slip changes."""
    part = list(range(2, 6))
    moved = turned(REST, [4, 5], ASSEMBLY.joints[4].outer / 3, more)
    both = turned(moved, part, np.array([x, y]), angle)
    one, two = joint_motion(ASSEMBLY, moved), joint_motion(ASSEMBLY, both)
    assert two.gap[3:6] == pytest.approx(one.gap[3:6], abs=1e-13)
    assert two.slip[3:6] == pytest.approx(one.slip[3:6], abs=1e-13)
    assert two.turn[3:6] == pytest.approx(one.turn[3:6], abs=1e-13)


def spread_poses(arch: Arch, poses: np.ndarray) -> tuple[ObservedJoint, ...]:
    return classify(arch.assembly(), poses)


def rotational_collapse(arch: Arch, hinge: int, angle: float) -> np.ndarray:
    """Five-hinge mechanism of an arch with a crown joint, to first order in the angle.

    The lower part turns about the extrados of the springing, the upper one about the
    instantaneous centre on the line through springing and intrados hinge, at the height
    of the crown's extrados, so that the crown hinge moves straight down.
    """
    assembly = arch.assembly()
    half = arch.voussoirs // 2
    poses = np.column_stack([assembly.centres / arch.radius, np.zeros(arch.voussoirs)])
    joints = assembly.joints
    foot = joints[-1].outer / arch.radius
    knee = joints[half + hinge].inner / arch.radius
    crown = joints[half].outer / arch.radius
    # Centre of the upper part: level with the crown hinge, in line with foot and knee.
    along = (crown[1] - foot[1]) / (knee[1] - foot[1])
    centre = foot + along * (knee - foot)
    lower = -angle
    upper = lower * float(np.dot(knee - foot, knee - foot) / np.dot(knee - foot, knee - centre))
    for index in range(half, arch.voussoirs):
        spin, about = (lower, foot) if index >= half + hinge else (upper, centre)
        arm = poses[index, :2] - about
        step = spin * np.array([-arm[1], arm[0]])
        mirror = arch.voussoirs - 1 - index
        poses[index] += [step[0], step[1], spin]
        poses[mirror] += [-step[0], step[1], -spin]
    return poses


@pytest.mark.parametrize(("count", "hinge"), [(20, 6), (30, 9), (40, 12)])
def test_theoretical_rotational_mechanism(count: int, hinge: int) -> None:
    arch = Arch(half_angle=math.pi / 2, eta=0.107, voussoirs=count)
    poses = rotational_collapse(arch, hinge, 1e-7)
    found = spread_poses(arch, poses)
    middle = count // 2
    expected = dict.fromkeys(range(count + 1), STATE.CLOSED)
    expected[0] = expected[count] = expected[middle] = STATE.HINGE_EXTRADOS
    expected[middle - hinge] = expected[middle + hinge] = STATE.HINGE_INTRADOS
    assert {i: joint.state for i, joint in enumerate(found)} == expected
    assert observed_mode(found, arch) is Mode.RRR
    assert overlap_and_slip(arch.assembly(), poses)[0] < 1e-5


ONE_SIDE: dict[Mode, list[ActiveJoint]] = {
    Mode.RRR: [
        ActiveJoint(2.0, slides=False),
        ActiveJoint(1.0, slides=False, intrados=True),
        ActiveJoint(0.0, slides=False),
    ],
    Mode.SS: [ActiveJoint(2.0, slides=True), ActiveJoint(0.3, slides=True)],
    Mode.SRR: [
        ActiveJoint(2.0, slides=True),
        ActiveJoint(1.0, slides=False, intrados=True),
        ActiveJoint(0.0, slides=False),
    ],
    Mode.RRS: [
        ActiveJoint(2.0, slides=False),
        ActiveJoint(1.0, slides=False, intrados=True),
        ActiveJoint(0.3, slides=True),
    ],
    Mode.RSR: [
        ActiveJoint(2.0, slides=False),
        ActiveJoint(0.3, slides=True),
        ActiveJoint(0.2, slides=False, intrados=True),
    ],
    Mode.RS: [
        ActiveJoint(2.0, slides=False),
        ActiveJoint(0.3, slides=True),
        ActiveJoint(0.0, slides=False, intrados=True),
    ],
    Mode.R: [
        ActiveJoint(2.0, slides=False),
        ActiveJoint(0.0, slides=False),
        ActiveJoint(0.0, slides=False, intrados=True),
    ],
}


@pytest.mark.parametrize("mode", Mode)
@given(st.randoms())
def test_every_mode_has_its_name_in_any_order(mode: Mode, random: object) -> None:
    joints = list(ONE_SIDE[mode])
    random.shuffle(joints)
    assert name_mode(joints, 1e-9) is mode
    assert mode.description


@pytest.mark.parametrize(
    "joints",
    [
        [],
        [ActiveJoint(2.0, slides=True)],
        [ActiveJoint(1.0, slides=False), ActiveJoint(0.0, slides=False)],
        [*ONE_SIDE[Mode.RRR], ActiveJoint(0.5, slides=False, intrados=True)],
        [*ONE_SIDE[Mode.SS], ActiveJoint(1.0, slides=True)],
    ],
)
def test_anything_else_has_none(joints: list[ActiveJoint]) -> None:
    assert name_mode(joints, 1e-9) is None


def test_inner_hinge_and_slide_at_one_joint_is_rrs() -> None:
    """Fig. 21 (low), beta_r = beta_s: the paper's rrs, beta_r >= beta_s."""
    joints = [
        ActiveJoint(2.0, slides=False),
        ActiveJoint(0.3, slides=True),
        ActiveJoint(0.3, slides=False, intrados=True),
    ]
    assert name_mode(joints, 1e-9) is Mode.RRS


def observed(angles: list[float], kinds: list[JointState]) -> tuple[ObservedJoint, ...]:
    both = {0.0: STATE.CLOSED}
    for angle, kind in zip(angles, kinds, strict=True):
        both[angle] = both[-angle] = kind
    return tuple(ObservedJoint(angle=a, state=s) for a, s in sorted(both.items()))


def test_keystone_hinges_count_as_the_crown() -> None:
    """Odd n: no crown joint, one or two hinges beside it, and both name rrr."""
    alpha, count = math.pi / 2, 27
    beside, shoulder, haunch = alpha / 27, alpha, 17 * alpha / 27
    kinds = [STATE.HINGE_EXTRADOS, STATE.HINGE_INTRADOS, STATE.HINGE_EXTRADOS]
    both = observed([shoulder, haunch, beside], kinds)
    arch = Arch(half_angle=alpha, eta=0.1, voussoirs=count)
    assert observed_mode(both, arch) is Mode.RRR
    one = tuple(joint for joint in both if joint.angle != -beside)
    assert observed_mode(one, arch) is Mode.RRR
    assert crown_width(alpha, 27) >= beside > crown_width(alpha, 28)


def test_a_hinge_between_two_joints_shows_as_both_and_counts_once() -> None:
    alpha, count = math.pi / 2, 20
    step = 2 * alpha / count
    kinds = [
        STATE.HINGE_EXTRADOS,
        STATE.HINGE_INTRADOS,
        STATE.HINGE_INTRADOS,
        STATE.HINGE_EXTRADOS,
    ]
    arch = Arch(half_angle=alpha, eta=0.1, voussoirs=count)
    near = observed([alpha, 6 * step, 5 * step, 0.0], kinds)
    far = observed([alpha, 7 * step, 5 * step, 0.0], kinds)
    assert observed_mode(near, arch) is Mode.RRR
    assert observed_mode(far, arch) is None
