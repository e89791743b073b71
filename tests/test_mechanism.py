"""The complementary problem (15), (16): its own conditions, and rigid-body kinematics."""

import math

import numpy as np
import pytest

from blocksim import Arch
from blocksim.arch.limit import least_thickness
from blocksim.arch.limit.mechanism import mechanism

ARCHES = [
    (math.pi / 2, 0.9, 27, "rrr"),
    (math.pi / 2, 0.37, 30, "srr"),
    (math.radians(125), 0.9, 40, "srr"),
    (math.radians(145), 1.6, 40, "rrs"),
    (2.603266515104794, 1.85, 60, None),
    (2.7, 3.0, 40, "rs"),
    (2.7, math.inf, 24, "r"),
    (0.6, 0.5, 9, "rrr"),
]
WEIGHTS = pytest.mark.parametrize("weight", ["centreline", "sector"])


@WEIGHTS
@pytest.mark.parametrize(("half_angle", "mu", "voussoirs", "mode"), ARCHES)
def test_complementary_at_and_below_the_limit(
    half_angle: float, mu: float, voussoirs: int, mode: str | None, weight: str
) -> None:
    least = least_thickness(half_angle, mu, voussoirs, weight).eta
    eta = 2.0 if least is None else least
    for share in (1.0, 0.97, 0.8):
        arch = Arch(half_angle=half_angle, eta=share * eta, voussoirs=voussoirs, weight=weight)
        found = mechanism(arch, mu)
        assert found.strength.max() <= 1e-13
        assert found.rates.min() >= 0
        assert np.abs(found.strength * found.rates).max() <= 1e-13
        assert found.rates.sum() == pytest.approx(1, abs=1e-9)
        if share == 1.0 and least is not None:
            assert abs(found.extra_strength) <= 1e-12
            if weight == "centreline" and mode is not None:
                assert found.mode == mode
        else:
            assert found.extra_strength > 1e-6
        # The last voussoir, moved by its joint with the springing, must be at rest.
        check_motions(arch, mu, found)


def check_motions(arch: Arch, mu: float, found) -> None:
    """Follow every joint in plane kinematics, written out again from the assembly."""
    motions = np.vstack([np.zeros(3), found.motions, np.zeros(3)])
    depth = arch.eta / 2
    for i, joint in enumerate(arch.assembly().joints):
        inner, outer = np.array(joint.inner), np.array(joint.outer)
        normal = np.array([math.cos(found.angles[i]), -math.sin(found.angles[i])])
        before, after = motions[i], motions[i + 1]

        def velocity(point: np.ndarray, motion: np.ndarray) -> np.ndarray:
            return motion[:2] + motion[2] * np.array([-point[1], point[0]])

        openings = [
            float(normal @ (velocity(p, after) - velocity(p, before))) for p in (inner, outer)
        ]
        rates = found.rates[i]
        grip = mu if math.isfinite(mu) else 0.0
        sliding = rates[2] + rates[3]
        expected = np.array([rates[0], rates[1]]) * 2 * depth + grip * sliding
        np.testing.assert_allclose(openings, expected, atol=1e-12)
        radial = (outer - inner) / np.hypot(*(outer - inner))
        middle = (inner + outer) / 2
        slip = float(radial @ (velocity(middle, after) - velocity(middle, before)))
        assert abs(slip) == pytest.approx(abs(rates[2] - rates[3]), abs=1e-12)


@WEIGHTS
def test_weight_does_work_below_the_limit(weight: str) -> None:
    """The power of the weights equals the extra strength times the rates, which add to 1."""
    for half_angle, mu, voussoirs, _ in ARCHES[:6]:
        eta = least_thickness(half_angle, mu, voussoirs, weight).eta
        if eta is None:
            continue
        for share in (1.0, 0.9):
            arch = Arch(
                half_angle=half_angle, eta=share * eta, voussoirs=voussoirs, weight=weight
            )
            found = mechanism(arch, mu)
            centres = np.array([block.centre for block in arch.assembly().blocks])
            fall = -(found.motions[:, 1] + found.motions[:, 2] * centres[:, 0])
            power = float(fall.sum() * 2 * half_angle / voussoirs)
            assert power == pytest.approx(found.extra_strength, abs=1e-12)


def test_nothing_moves_where_it_stands() -> None:
    for eta in (0.12, 0.5, 2.0):
        arch = Arch(half_angle=math.pi / 2, eta=eta, voussoirs=27)
        found = mechanism(arch, 0.7)
        assert found.extra_strength < 0
        assert found.mode is None
        assert not found.rates.any()
        assert not found.motions.any()
