"""What joints need and the range of thrust, held to closed forms and to balance."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from arches import least
from drawn import bricks, rounded
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from structure_cases import scenes

from blocksim import Arch, Assembly, CircularArch, Problem, check, equilibrium, structure_of

FLOOR = {"id": "floor", "vertices": [[-99, -1], [99, -1], [99, 0], [-99, 0]], "fixed": True}
SQUEEZED = [
    FLOOR,
    {"id": "left", "vertices": [[-1, 0], [0, 0], [0, 2], [-1, 2]], "fixed": True},
    {"id": "block", "vertices": [[0, 0], [1, 0], [1, 1], [0, 1]], "weight": 3.0},
    {"id": "right", "vertices": [[1, 0], [2, 0], [2, 2], [1, 2]], "fixed": True},
]


def slope(width: float, height: float, tilt: float, mu: float | str) -> Problem:
    """A block on a slope that goes down to the right."""
    block = {"id": "1", "vertices": [[0, 0], [width, 0], [width, height], [0, height]]}
    problem = structure_of({"friction": mu, "blocks": [FLOOR, block]})
    return problem.tilted(math.radians(tilt))


def carried(problem: Problem, joint: int | None = None) -> Any:
    """What is told of any structure: of an arch as well, its own statics left aside."""
    return check(replace(problem, maker=None), method="limit").carried_at(joint)


@given(st.floats(0.5, 40.0), st.floats(0.2, 5.0), st.floats(0.2, 5.0), st.floats(0.1, 2.0))
def test_a_block_on_a_slope_needs_what_its_weight_asks_for(
    tilt: float, width: float, height: float, mu: float
) -> None:
    """Friction tan(tilt); the weight meets the base height/2 tan(tilt) from its middle."""
    found = carried(slope(width, height, tilt, mu))
    slip, tip = math.tan(math.radians(tilt)) / mu, math.tan(math.radians(tilt)) * height / width
    # No friction holds what tips, and no width what slides.
    assert found.least_friction == (pytest.approx(slip * mu, rel=1e-8) if tip < 1 else None)
    assert found.geometrical_factor == (pytest.approx(1 / tip, rel=1e-8) if slip < 1 else None)
    assert found.strength_used == pytest.approx(max(slip, tip), rel=1e-8)


def test_unbounded_friction_is_told_as_the_coefficient_it_takes() -> None:
    least = carried(slope(4.0, 1.0, 20.0, "inf")).least_friction
    assert least == pytest.approx(math.tan(math.radians(20)), rel=1e-8)


def test_the_safest_state_of_what_needs_nothing_bears_its_weight() -> None:
    """A plumb column needs neither width nor friction, and its joints carry what is above."""
    problem = structure_of({"kind": "column", "friction": 0.6})
    found = carried(problem)
    assert found.strength_used == 0.0
    blocks = len(problem.assembly.blocks)
    above = [problem.unit_force * (blocks - place) for place in range(blocks)]
    assert found.resultants.normal == pytest.approx(above, rel=1e-9)


def test_level_blocks_need_neither_friction_nor_width() -> None:
    assert carried(structure_of({"kind": "stack", "friction": 0.5})).least_friction == 0.0
    plumb = carried(slope(1.0, 1.0, 0.0, 0.5))
    assert (plumb.geometrical_factor, plumb.least_friction) == (math.inf, 0.0)
    assert plumb.strength_used == 0.0


@settings(max_examples=10)
@example(alpha=133.0, spare=1.5, mu=2.0, voussoirs=5, weight="centreline")
@example(alpha=136.0, spare=1.5, mu=2.0, voussoirs=4, weight="sector")
@given(
    st.floats(25.0, 150.0),
    st.floats(1.01, 1.8),
    st.floats(0.4, 2.0),
    st.integers(4, 31),
    st.sampled_from(["centreline", "sector"]),
)
def test_arches_agree_with_their_own_statics(
    alpha: float, spare: float, mu: float, voussoirs: int, weight: Any
) -> None:
    """Thickness over the least where weight does not change with it, and the same thrusts."""
    half = math.radians(alpha)
    eta = least(half, mu, voussoirs).eta_limit
    assume(eta and spare * eta < 2)
    arch = Arch(half_angle=half, eta=spare * eta, voussoirs=voussoirs, weight=weight)
    problem = CircularArch.of(arch, mu).problem()
    found = carried(problem)
    if weight == "centreline":
        assert 1 / found.geometrical_factor == pytest.approx(1 / spare, rel=1e-9)
    assert found.joint in {voussoirs // 2, (voussoirs + 1) // 2}
    low, high = found.thrust
    assert low <= high
    own = check(problem, method="limit").carried
    assert own.thrust == pytest.approx((low, high), rel=1e-9)
    assert own.strength_used == pytest.approx(found.strength_used, rel=1e-9)
    assert own.least_friction == pytest.approx(found.least_friction, rel=1e-9)
    # Vertical loads leave every joint the same thrust; springings past the horizontal face
    # the other way.
    facing = math.copysign(1.0, problem.assembly.joint_arrays.normal[0, 0])
    other = sorted(facing * each for each in carried(problem, 0).thrust)
    assert other == pytest.approx([low, high], rel=1e-8, abs=1e-12 * problem.unit_force)


def acting(problem: Problem, forces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force on what is after each joint [N], and where it acts [m], from those at its ends."""
    joints = problem.assembly.joint_arrays
    pressure, friction = forces.sum(axis=1).T[..., None] * problem.unit_force
    whole = forces[:, :, 0].sum(axis=1, keepdims=True)
    share = forces[:, :, 0] / np.where(whole == 0, 1.0, whole)
    place = (share[:, :, None] * joints.ends).sum(axis=1) * problem.assembly.size
    return pressure * joints.normal + friction * joints.tangent, place


def test_a_two_hinged_wedge_by_hand() -> None:
    """Two voussoirs: half the weight W/2 acts at a; the thrust line passes crown and springing
    within their joints, so H = (W/2)(x - a)/(rise) between its two extremes."""
    arch = Arch(half_angle=math.pi / 2, eta=0.4, voussoirs=4, weight="sector", radius=2.0)
    problem = CircularArch.of(arch, math.inf).problem()
    found = carried(problem, 2)
    for each in (found.least, found.greatest):
        force, point = acting(problem, each.forces)
        # Moments of the right half about where its springing presses.
        base, top = point[4], point[2]
        thrust = abs(force[2, 0])
        turning = thrust * (top[1] - base[1])
        centres = problem.assembly.centres[2:, 0]
        assert turning == pytest.approx(
            arch.voussoir_weight * (base[0] - centres).sum(), rel=1e-9
        )
        assert thrust == pytest.approx(abs(each.thrust) * problem.unit_force, rel=1e-12)
        # Where an end bears nothing all of the width is used.
        bare = each.forces[:, :, 0].min(axis=1) / each.forces[:, :, 0].sum(axis=1)
        assert np.isclose(bare, 0.0, atol=5e-9).sum() >= 3


def test_a_squeezed_block_has_no_greatest_thrust() -> None:
    """Two walls may press as hard as they like, and need not press at all."""
    problem = structure_of({"friction": 0.5, "blocks": SQUEEZED})
    # Whichever way a joint's normal points, what presses is above 0.
    normals = problem.assembly.joint_arrays.normal[:, 0]
    sides = [k for k, each in enumerate(problem.assembly.joints) if each.support in {1, 2}]
    assert sorted(normals[sides]) == pytest.approx([-1.0, 1.0])
    for side in sides:
        low, high = carried(problem, side).thrust
        assert low == pytest.approx(0.0, abs=1e-9)
        assert high == math.inf


@pytest.mark.parametrize(
    "table",
    [
        {"kind": "pointed-arch", "thickness": 0.3, "density": 20e3},
        {"kind": "portal", "pier_width": 1.5, "density": 20e3},
        {"kind": "wall", "density": 18e3},
        {"kind": "flat-arch", "thickness": 0.6},
    ],
    ids=lambda table: table["kind"],
)
def test_supports_bear_the_weight_and_its_moment(table: dict[str, Any]) -> None:
    """In every state that is told: forces and moments of supports balance the loads."""
    problem = structure_of({"friction": 0.8, **table})
    found = carried(problem)
    weight = problem.applied_forces() * problem.unit_force
    centres = problem.assembly.centres
    moment = (weight[:, 2] * problem.assembly.size).sum()
    moment += (centres[:, 0] * weight[:, 1] - centres[:, 1] * weight[:, 0]).sum()
    states = [[(each.force, each.point) for each in found.reactions]]
    joints = problem.assembly.joint_arrays
    on_supports = (joints.before < 0) | (joints.after < 0)
    for each in (found.least, found.greatest):
        if each is not None and each.forces is not None:
            force, point = acting(problem, each.forces)
            force[joints.after < 0] *= -1
            states.append([*zip(force[on_supports], point[on_supports], strict=True)])
    for borne in states:
        total = sum((force for force, _ in borne), np.zeros(2))
        assert total == pytest.approx(-weight[:, :2].sum(axis=0), rel=1e-9, abs=1e-6)
        turned = sum(x * up - y * across for (across, up), (x, y) in borne)
        assert turned == pytest.approx(-moment, rel=1e-8, abs=1e-6)


@pytest.mark.parametrize(
    "name",
    ["box2d_arch", "overhang_three_blocks", "rampant_75_20", "diamond_4", "compas_cra_shelf"],
)
def test_no_joint_uses_more_than_is_said(name: str) -> None:
    """The safest state uses at most the share of strength, and some joint all of that."""
    told = [carried(structure_of(scene)) for scene in scenes(name)]
    standing = [each for each in told if each.stands]
    assert standing
    for each in standing:
        assert each.strength_used == 0 or each.resultants.used.max() == pytest.approx(
            each.strength_used, rel=1e-6
        )


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
    eta = least(alpha, mu, count, weight).eta_limit
    # Three voussoirs can stand however thin they are.
    assume(eta is not None and 1e-3 < eta * ratio <= 2)
    arch = Arch(half_angle=alpha, eta=eta * ratio, voussoirs=count, weight=weight)
    assembly = arch.assembly()
    forces = equilibrium(Problem(assembly=assembly, mu=mu)).forces
    assert (forces is not None) == (ratio > 1)
    if forces is not None:
        assert inside(forces, mu)
        assert imbalance(assembly, forces) < 1e-7


@pytest.mark.parametrize("degrees", [5, 10, 15])
def test_a_turned_wall_of_rounded_bricks_needs_the_tangent_as_friction(degrees: int) -> None:
    """Without friction the programme tells nothing where corners are rounded to 1e-9."""
    wall = structure_of(rounded(bricks(4, 6), degrees, 9, 0.7))
    told = check(wall, method="limit").carried
    assert told is not None
    assert told.least_friction == pytest.approx(math.tan(math.radians(degrees)), rel=1e-4)
