"""Forces of equilibrium, held to limit analysis of arches and to closed forms of a block."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from blocksim import Arch, Assembly, Problem, equilibrium
from blocksim.arch import limit
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


@pytest.mark.parametrize("count", [7, 26, 60])
def test_pymunk_keeps_what_it_is_given(count: int) -> None:
    """Impulses of given forces come back as the resultants of those forces, and balance."""
    mu = 0.9
    least = limit.least_thickness(math.radians(125), mu, count).eta
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
