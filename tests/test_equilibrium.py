"""Forces of equilibrium, held to limit analysis of arches and to closed forms of a block."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from arches import on_a_slope
from hypothesis import assume, given
from hypothesis import strategies as st

from blocksim import Arch, Assembly, Problem, equilibrium
from blocksim.arch import limit
from blocksim.arch.reduction import Reduction
from blocksim.blocks.assembly import PLANAR
from blocksim.engines import get_engine

angles = st.floats(30.0, 155.0)
frictions = st.one_of(st.floats(0.2, 4.0), st.just(1e3))
counts = st.integers(3, 60)
weights = st.sampled_from(["centreline", "sector"])


def imbalance(assembly: Assembly, forces: np.ndarray) -> float:
    """Largest force or moment that is left on any block [mean weights]."""
    joints = assembly.joint_arrays
    left = np.zeros((len(assembly.blocks) + 1, PLANAR))
    left[:-1, 1] = -assembly.masses[:, 1]
    centres = np.vstack([assembly.centres / assembly.size, np.zeros(2)])
    for sign, sides in ((1.0, joints.after), (-1.0, joints.before)):
        for joint, block in enumerate(sides):
            for end in range(2):
                pressure, friction = forces[joint, end]
                force = pressure * joints.normal[joint] + friction * joints.tangent[joint]
                x, y = joints.ends[joint, end] - centres[block]
                left[block] += sign * np.array([*force, x * force[1] - y * force[0]])
    return float(np.abs(left[:-1]).max())


def inside(forces: np.ndarray, mu: float) -> bool:
    """Tell whether all forces press and lie in their cones."""
    return bool(np.all(np.abs(forces[..., 1]) <= mu * forces[..., 0] * (1 + 1e-12)))


@given(angles, frictions, counts, weights, st.sampled_from([0.98, 1 - 1e-8, 1 + 1e-8, 1.1]))
def test_arches_have_forces_of_equilibrium_above_their_least_thickness(
    angle: float, mu: float, count: int, weight: str, ratio: float
) -> None:
    alpha = math.radians(angle)
    least = limit.least_thickness(alpha, mu, count, weight).eta
    # Three voussoirs can stand however thin they are.
    assume(least is not None and 1e-3 < least * ratio <= 2)
    arch = Arch(half_angle=alpha, eta=least * ratio, voussoirs=count, weight=weight)
    assembly = arch.assembly()
    forces = equilibrium(Problem(assembly=assembly, mu=mu)).forces
    assert (forces is not None) == (ratio > 1)
    if forces is not None:
        assert inside(forces, mu)
        assert imbalance(assembly, forces) < 1e-7


@given(st.floats(0.0, 60.0), st.floats(0.05, 2.0), st.floats(0.1, 5.0), st.booleans())
def test_a_block_on_a_slope_rests_unless_it_slides_or_tips(
    angle: float, mu: float, height: float, smooth: bool
) -> None:
    """It slides beyond tan(angle) = mu, and tips beyond tan(angle) = width / height."""
    slope = math.radians(angle)
    steepest = min(0.0 if smooth else mu, 1 / height)
    assume(abs(math.tan(slope) - steepest) > 1e-4)
    assembly = on_a_slope(slope, 1.0, height)
    joints = tuple(
        replace(joint, friction=0.0 if smooth else None) for joint in assembly.joints
    )
    assembly = replace(assembly, joints=joints)
    forces = equilibrium(Problem(assembly=assembly, mu=mu)).forces
    assert (forces is not None) == (math.tan(slope) < steepest)
    if forces is not None:
        pressure, friction = forces[0].sum(axis=0)
        assert pressure == pytest.approx(math.cos(slope), abs=1e-6)
        assert abs(friction) == pytest.approx(math.sin(slope), abs=1e-6)


@pytest.mark.parametrize("count", [26, 27])
@pytest.mark.parametrize("ratio", [0.999, 1.001])
def test_half_an_arch_rests_when_the_whole_does(count: int, ratio: float) -> None:
    """The plane of symmetry carries no friction, and half a keystone no moment."""
    alpha, mu = math.radians(125), 0.9
    least = limit.least_thickness(alpha, mu, count).eta
    assert least is not None
    arch = Arch(half_angle=alpha, eta=least * ratio, voussoirs=count)
    forces = equilibrium(Problem(assembly=Reduction.of(arch, mu).assembly, mu=mu)).forces
    assert (forces is not None) == (ratio > 1)
    if forces is not None:
        np.testing.assert_allclose(forces[-1, :, 1], 0.0, atol=1e-12)


@pytest.mark.parametrize("count", [7, 26, 60])
def test_pymunk_keeps_what_it_is_given(count: int) -> None:
    """Impulses of given forces come back as the resultants of those forces, and balance."""
    mu = 0.9
    least = limit.least_thickness(math.radians(125), mu, count).eta
    assert least is not None
    assembly = Arch(half_angle=math.radians(125), eta=least * 1.02, voussoirs=count).assembly()
    engine = get_engine("pymunk")
    world = engine.build(Problem(assembly=assembly, mu=mu), engine.rule(assembly))
    forces = equilibrium(Problem(assembly=assembly, mu=mu)).forces
    assert forces is not None
    world.begin(forces)
    joints = assembly.joint_arrays
    axes = np.stack([joints.normal, joints.tangent], axis=1)
    each = np.einsum("jek,jkd->jed", forces, axes)
    x, y = np.moveaxis(each, -1, 0)
    moment = joints.ends[..., 0] * y - joints.ends[..., 1] * x
    given = np.stack([x, y, moment], axis=-1).sum(axis=1)
    np.testing.assert_allclose(world.resultants(), given, atol=1e-4)
    assert np.abs(world.hold(1)).max() < 1e-3
