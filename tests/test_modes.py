"""Which mode an arch has: that of the mechanism it starts with, told of which arch it is."""

import math

import numpy as np
import pytest
from arches import arch_at, least
from running import inside
from worlds import observe, observed_mode

from blocksim import Arch, CircularArch, JointState, Mode, bracket, check
from blocksim.arch.limit import least_thickness
from blocksim.arch.limit.mechanism import mechanism

SEVEN = [
    (90, 0.7, 27, Mode.RRR),
    (90, 0.35, 30, Mode.SRR),
    (125, 0.9, 26, Mode.SRR),
    (145, 1.6, 27, Mode.RRS),
    (149.15618426323448, 1.79, 120, Mode.RSR),
    (149.15618426323448, 1.80, 150, Mode.RSR),
    (155, 3.0, 30, Mode.RS),
    (159.65458365332148, math.inf, 30, Mode.R),
]
"""Arches of all modes but `ss`, which no thickness has, some with many voussoirs."""


@pytest.mark.parametrize(("angle", "mu", "count", "mode"), SEVEN)
def test_direct_confirms_every_mode_close_to_the_limit(
    angle: float, mu: float, count: int, mode: Mode
) -> None:
    arch = arch_at(1 - 1e-5, angle, mu, count)
    known = least(arch.half_angle, mu, count)
    assert mode == known.mode_limit == known.mode
    assert mechanism(arch, mu).mode is mode
    seen = observe(CircularArch.of(arch, mu).problem(), "direct", moving=False)
    assert observed_mode(seen.joints, arch) is mode


def test_direct_confirms_pure_sliding_where_nothing_stands() -> None:
    arch = Arch(half_angle=math.pi / 2, eta=2.0, voussoirs=27)
    seen = observe(CircularArch.of(arch, 0.3).problem(), "direct", moving=False)
    assert observed_mode(seen.joints, arch) is Mode.SS
    assert mechanism(arch, 0.3).mode is Mode.SS


def test_rsr_is_read_from_the_start_and_not_from_motion() -> None:
    """In motion, 0.5 % below the limit, its hinge and its sliding joint change places."""
    arch = arch_at(0.995, 149.15618426323448, 1.79, 120)
    seen = check(CircularArch.of(arch, friction=1.79), method="direct")
    assert seen.arch.mode is Mode.RSR
    assert seen.arch.mode_in_motion is Mode.RRS
    active = [joint.state for joint in seen.joints if joint.state is not JointState.CLOSED]
    outside, inside = JointState.HINGE_EXTRADOS, JointState.HINGE_INTRADOS
    half = [outside, JointState.SLIDES, inside]
    assert active == half + half[::-1]


@pytest.mark.parametrize("eta", [0.05, 0.1, 0.15, 0.2, 1.0])
def test_thin_arches_start_in_another_mode(eta: float) -> None:
    """At 90 deg, mu 0.3 nothing stands, and thin arches start in another mode."""
    arch = Arch(half_angle=math.pi / 2, eta=eta, voussoirs=27)
    seen = check(CircularArch.of(arch, friction=0.3))
    assert seen.arch.mode is (Mode.SRR if eta < 0.16 else Mode.SS)
    assert (seen.arch.mode_limit, seen.arch.mode_theory) == (Mode.SS, Mode.SS)


@pytest.mark.parametrize(
    ("angle", "mu"), [(1.2, 0.5), (3.5, 2), (7, 1), (75, 0.6), (125, 0.9), (145, 1.6), (155, 3)]
)
@pytest.mark.parametrize("ratio", [0.9, 0.99, 1 - 1e-6])
def test_arches_below_their_limit_have_a_mode(angle: float, mu: float, ratio: float) -> None:
    arch = arch_at(ratio, angle, mu, 40)
    seen = check(CircularArch.of(arch, friction=mu))
    assert seen.arch.mode is not None
    if ratio > 0.98:
        assert seen.arch.mode is seen.arch.mode_limit
    assert sum(joint.state is not JointState.CLOSED for joint in seen.joints) >= 5


@pytest.mark.usefixtures("wide_window")
def test_words_tell_which_arch_which_thickness_and_which_mode() -> None:
    asked = ["--alpha", "90", "--mu", "0.3", "--eta", "0.1", "--voussoirs", "27"]
    told = inside("check", *asked).stdout
    assert "  least   eta none up to 2 (ss) as built, none up to 2 (ss) continuous" in told
    assert "  mode    srr, sliding-rotational (shoulder slides), " in told
    assert "of the voussoirs as built, at eta 0.1\n" in told
    told = inside("check", *asked, "--method", "theory").stdout
    assert "  mode    ss, purely sliding, of the continuous arch, of any thickness\n" in told
    told = inside("bracket", *asked[:4], *asked[6:]).stdout
    assert "  mode    ss, purely sliding, of the voussoirs as built, at eta 2\n" in told


def test_a_bracket_without_moving_runs_has_no_mode_in_motion() -> None:
    asked = CircularArch(
        half_angle=math.pi / 2, friction=0.7, voussoirs=15, weight="centreline"
    )
    held, let_go = (
        bracket(asked, method="direct", confirm=confirm).arch for confirm in (False, True)
    )
    assert (held.mode, held.mode_in_motion) == (Mode.RRR, None)
    assert (let_go.mode, let_go.mode_in_motion) == (Mode.RRR, Mode.RRR)


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
