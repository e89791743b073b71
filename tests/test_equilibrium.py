"""Forces of equilibrium, held to limit analysis of arches and to closed forms of a block."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st

from blocksim import Arch, Assembly, Problem, equilibrium
from blocksim.arch import limit

angles = st.floats(30.0, 155.0)
frictions = st.one_of(st.floats(0.2, 4.0), st.just(1e3))
counts = st.integers(3, 60)
weights = st.sampled_from(["centreline", "sector"])


def imbalance(assembly: Assembly, forces: np.ndarray) -> float:
    """Largest force or moment that is left on any block [mean weights]."""
    joints = assembly.joint_arrays
    left = np.zeros((len(assembly.blocks) + 1, 3))
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
