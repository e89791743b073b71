"""The generator, held to integrals over the continuous arch done here by quadrature.

Every joint of the voussoirs must carry the resultant of the continuous arch, whatever the
number of voussoirs; mass and centre of mass are those of the annular sector or of its mean
line, inertia that of the sector; mirror images are equal to the last bit.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import Polygon

from blocksim import Arch, InputError

arches = st.builds(
    Arch,
    half_angle=st.floats(0.01, 3.14),
    eta=st.floats(1e-3, 2.0),
    voussoirs=st.integers(3, 200),
    weight=st.sampled_from(["centreline", "sector"]),
    radius=st.floats(1e-2, 1e3),
    depth=st.floats(1e-2, 1e3),
    specific_weight=st.floats(1.0, 1e5),
)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


def gauss(low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    half = (high - low) / 2
    return (low + high) / 2 + half * NODES, half * WEIGHTS


def continuous(arch: Arch, left: float, right: float) -> tuple[float, np.ndarray, float]:
    """Mass, first moments and polar moment between two angles, by Gauss quadrature."""
    angles, shares = gauss(left, right)
    density = arch.specific_weight * arch.depth / 9.81
    if arch.weight == "centreline":
        radii, thick = np.array([arch.radius]), np.array([arch.radius * arch.thickness])
    else:
        half = arch.thickness / 2
        radii, widths = gauss(arch.radius - half, arch.radius + half)
        thick = radii * widths
    rays = np.array([np.sin(angles), np.cos(angles)])
    mass = density * shares.sum() * thick.sum()
    first = density * (rays @ shares) * (thick @ radii)
    polar = density * shares.sum() * (thick @ radii**2)
    return float(mass), first, float(polar)


@given(arches)
def test_every_joint_carries_the_resultant_of_the_continuous_arch(arch: Arch) -> None:
    blocks = arch.assembly().blocks
    angles = arch.joint_angles
    masses = np.cumsum([block.mass for block in blocks])
    firsts = np.cumsum([block.mass * block.centre for block in blocks], axis=0)
    # Thickness is the difference of two radii.
    round_off = 1e-13 + 1e-15 / arch.eta
    for index in range(arch.voussoirs):
        mass, first, _ = continuous(arch, angles[0], angles[index + 1])
        assert masses[index] == pytest.approx(mass, rel=round_off)
        scale = mass * arch.radius
        assert firsts[index] == pytest.approx(first, rel=0, abs=round_off * scale)


@given(arches)
def test_inertia_is_that_of_the_sector(arch: Arch) -> None:
    """Whatever the weight model: it moves the weight, not the voussoir."""
    block = arch.assembly().blocks[-1]
    mass, first, polar = continuous(replace(arch, weight="sector"), *arch.joint_angles[-2:])
    expected = polar - first @ first / mass
    # Inertia is a small difference of polar moments: to the round-off of those.
    assert block.inertia == pytest.approx(expected, rel=1e-12, abs=4e-15 * polar)
    assert block.inertia > 0


@given(arches)
def test_mirror_symmetry_is_exact(arch: Arch) -> None:
    assembly = arch.assembly()
    flip = np.array([-1.0, 1.0])
    for one, other in zip(assembly.blocks, reversed(assembly.blocks), strict=True):
        assert np.array_equal(one.centre * flip, other.centre)
        assert one.mass == other.mass
        assert one.inertia == other.inertia
        corners = {tuple(corner) for corner in (one.vertices * flip + 0.0).tolist()}
        assert corners == {tuple(corner) for corner in (other.vertices + 0.0).tolist()}
    for one, other in zip(assembly.joints, reversed(assembly.joints), strict=True):
        assert np.array_equal(one.inner * flip, other.inner)
        assert np.array_equal(one.outer * flip, other.outer)


@given(arches)
def test_joints_are_radial_and_point_from_before_to_after(arch: Arch) -> None:
    assembly = arch.assembly()
    assert len(assembly.joints) == len(assembly.blocks) + 1
    assert assembly.joints[0].before < 0
    assert assembly.joints[-1].after < 0
    for index, (joint, angle) in enumerate(
        zip(assembly.joints, arch.joint_angles, strict=True)
    ):
        assert joint.length == pytest.approx(arch.thickness, rel=1e-9)
        ray = [math.sin(angle), math.cos(angle)]
        assert joint.tangent == pytest.approx(ray, abs=1e-9)
        assert joint.normal == pytest.approx([ray[1], -ray[0]], abs=1e-9)
        middle = (joint.inner + joint.outer) / 2
        if joint.before >= 0:
            assert joint.before == index - 1
            assert (middle - assembly.blocks[joint.before].centre) @ joint.normal > 0
        if joint.after >= 0:
            assert joint.after == index
            assert (assembly.blocks[joint.after].centre - middle) @ joint.normal > 0


@given(arches)
def test_collision_polygons(arch: Arch) -> None:
    """Counter-clockwise, and of the area of the chord-sided quadrilateral."""
    angle = 2 * arch.half_angle / arch.voussoirs
    outer, inner = arch.radius * (1 + arch.eta / 2), arch.radius * (1 - arch.eta / 2)
    expected = (outer**2 - inner**2) * math.sin(angle) / 2
    for block in arch.assembly().blocks:
        drawn = Polygon(block.vertices)
        assert drawn.exterior.is_ccw
        assert drawn.area == pytest.approx(expected, rel=1e-9)
        assert block.depth == arch.depth


def test_thickest_arch_is_made_of_triangles() -> None:
    for eta, corners in ((2.0, 3), (1.999, 4)):
        assembly = Arch(half_angle=2.0, eta=eta, voussoirs=7).assembly()
        assert {len(block.vertices) for block in assembly.blocks} == {corners}
    outer = {
        tuple(joint.inner) for joint in Arch(half_angle=2, eta=2, voussoirs=7).assembly().joints
    }
    assert all(np.hypot(*inner) == 0 for inner in outer)


@pytest.mark.parametrize("voussoirs", [3, 4, 27, 1000])
def test_crown_joint(voussoirs: int) -> None:
    arch = Arch(half_angle=1.0, eta=0.1, voussoirs=voussoirs)
    assert (0.0 in arch.joint_angles) == (voussoirs % 2 == 0)
    assert arch.joint_angles[0] == -1.0
    assert arch.joint_angles[-1] == 1.0
    assert np.array_equal(arch.joint_angles, -arch.joint_angles[::-1])


WRONG: list[tuple[str, Any, str]] = [
    *(
        ("half_angle", value, "0.001 to 3.14159 rad")
        for value in (0, -1.0, math.pi, 4.0, math.nan, "1")
    ),
    *(("eta", value, "1e-15 to 2") for value in (0, -0.1, 2.0000001, math.nan, math.inf, None)),
    *(("voussoirs", value, "3 to 10000") for value in (2, 0, -3, 10001, 3.5, math.nan, True)),
    *(("weight", value, "centreline, sector") for value in ("", "Sector", "mean", None, 1)),
    *(
        (field, value, unit)
        for field, unit in (
            ("radius", "1e-06 to 1e+06 m"),
            ("depth", "1e-06 to 1e+06 m"),
            ("specific_weight", "1e-06 to 1e+09 N/m3"),
        )
        for value in (0, -1.0, math.inf, math.nan, "1", False, 1e308, 1e-320, 10**19)
    ),
]


@pytest.mark.parametrize(("field", "value", "allowed"), WRONG)
def test_wrong_values_are_named_in_one_line(field: str, value: object, allowed: str) -> None:
    good: dict[str, Any] = {"half_angle": 1.0, "eta": 0.1, "voussoirs": 9}
    with pytest.raises(InputError) as caught:
        Arch(**{**good, field: value})
    message = str(caught.value)
    assert caught.value.field == field
    assert message.startswith(f"{field} = {value!r}: must be ")
    assert allowed in message
    assert "\n" not in message


def test_arrays_cannot_be_changed() -> None:
    assembly = Arch(half_angle=1.0, eta=0.1, voussoirs=5).assembly()
    for array in (
        assembly.blocks[0].vertices,
        assembly.blocks[0].centre,
        assembly.joints[0].inner,
        assembly.centres,
        assembly.reach,
    ):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


@given(arches)
def test_arrays_are_those_of_its_voussoirs(arch: Arch) -> None:
    assembly = arch.assembly()
    made = replace(assembly, blocks=tuple(assembly.blocks), joints=tuple(assembly.joints))
    assert made.joints == assembly.joints[:], "no joint is turned round"
    for name in ("centres", "masses", "depths", "reach"):
        assert np.array_equal(getattr(assembly, name), getattr(made, name)), name
    for name, mine, its in zip(
        assembly.joint_arrays._fields, assembly.joint_arrays, made.joint_arrays, strict=True
    ):
        assert np.array_equal(mine, its, equal_nan=name == "friction"), name
