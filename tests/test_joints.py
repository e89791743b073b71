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
from worlds import classify, joint_motion, observed_mode, overlap_and_slip

from blocksim import Arch, Assembly, JointState
from blocksim.blocks.joints import closed_joints

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
