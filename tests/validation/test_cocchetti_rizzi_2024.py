"""Every number printed in the paper that blocksim is held to, and its equations.

@article{CocchettiRizzi2024,
  author = {Cocchetti, Giuseppe and Rizzi, Egidio},
  title  = {Finite-friction least-thickness self-standing domains of symmetric circular
            masonry arches},
  note   = {Accepted preprint, 19 June 2024},
  year   = {2024},
}

The numbers are in cocchetti_rizzi_2024.toml, each with its figure, table or section. The
equations are truth from outside in two ways: (1)-(9) are asked for as residuals, while the
solver finds its thickness from one moment balance between two touching sections; (10)-(14)
are written out here from the statics of the half-arch, the weight summed by quadrature.
"""

import math

import derivations
import numpy as np
import pytest
from derivations import PAPER
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from blocksim import Mode, theory
from blocksim.arch.theory import equations
from blocksim.studies.paper import TABLE_1, numbers

CONSTANTS = PAPER["constants"]
TABLE = PAPER["table1"]
CAPTIONS = PAPER["captions"]
SYMBOLS = {
    "eta": "eta",
    "mu": "mu",
    "half_angle": "alpha",
    "thrust": "h",
    "beta_r": "beta_r",
    "beta_s": "beta_s",
}
PRINTED = 1e-13
"""The paper prints 16 digits; three are left to round-off on both sides."""

wide = st.floats(math.radians(5), math.radians(155))
friction = st.floats(0.05, 20.0)
weights = st.sampled_from(["centreline", "sector"])


def half_angle_of(caption: dict[str, float]) -> float:
    return caption["alpha"] if "alpha" in caption else math.radians(caption["alpha_deg"])


@pytest.mark.parametrize("name", TABLE)
@pytest.mark.parametrize("field", SYMBOLS)
def test_landmarks_follow_from_what_defines_them(name: str, field: str) -> None:
    value = getattr(theory.landmarks()[name], field)
    assert value == pytest.approx(TABLE[name][SYMBOLS[field]], rel=PRINTED, abs=0)


@pytest.mark.parametrize("name", TABLE)
def test_least_thickness_at_the_landmarks(name: str) -> None:
    printed = TABLE[name]
    found = theory.least_thickness(printed["alpha"], printed["mu"])
    assert found.eta == pytest.approx(printed["eta"], rel=1e-12)
    assert found.thrust == pytest.approx(printed["h"], rel=1e-12)
    assert found.beta_s == pytest.approx(printed["beta_s"], rel=1e-12)
    # The hinge leaves the crown as the root of a thrust: 16 digits of mu leave 8 of it.
    near_crown = 1e-6 if name in {"J", "B"} else 1e-12
    assert found.beta_r == pytest.approx(printed["beta_r"], rel=1e-12, abs=near_crown)


@pytest.mark.parametrize("caption", CAPTIONS, ids=[caption["place"] for caption in CAPTIONS])
def test_captions(caption: dict[str, float]) -> None:
    found = theory.least_thickness(half_angle_of(caption), caption["mu"])
    assert found.eta == pytest.approx(caption["eta"], rel=1e-13)
    assert caption["mode"] in found.modes


def test_modes_that_share_an_arch_are_those_of_its_captions() -> None:
    published: dict[tuple[float, float], set[str]] = {}
    for caption in CAPTIONS:
        key = (half_angle_of(caption), caption["mu"])
        published.setdefault(key, set()).add(str(caption["mode"]))
    for (half_angle, mu), modes in published.items():
        found = {str(mode) for mode in theory.least_thickness(half_angle, mu).modes}
        # At J the line beta_r = 0 meets the divide: rsr, with beta_r <= beta_s, ties too.
        assert found - modes <= ({"rsr"} if modes == {"ss", "rs"} else set())
        assert modes <= found


def test_misprint_of_figure_15() -> None:
    caption = next(each for each in CAPTIONS if each["place"] == "Fig. 15 (top)")
    found = theory.least_thickness(half_angle_of(caption), caption["mu"])
    assert found.eta != pytest.approx(caption["eta_as_printed"], rel=1e-10)
    digits = f"{caption['eta']:.16f}"
    dropped = [digits[:i] + digits[i + 1 :] for i in range(len(digits))]
    assert str(caption["eta_as_printed"]) in dropped


def test_misprint_of_figure_22() -> None:
    caption = next(each for each in CAPTIONS if each["place"] == "Fig. 22 (top)")
    phi = math.degrees(math.atan(caption["mu"]))
    assert phi == pytest.approx(73.546, abs=5e-4)
    assert round(phi, 1) != caption["phi_deg_as_printed"]


def test_the_command_paper_compares_with_what_is_printed() -> None:
    for name, values in TABLE_1.items():
        printed = TABLE[name]
        symbols = ("eta", "mu", "alpha", "h", "beta_r", "beta_s")
        assert values == tuple(printed[symbol] for symbol in symbols), name
    assert len(numbers()) == 45
    assert max(each.difference for each in numbers()) <= PRINTED


@pytest.mark.parametrize(
    ("left", "right", "modes"),
    [
        ("Fig. 14 (top)", "Fig. 14 (low)", {Mode.SRR}),
        ("Fig. 16 (top)", "Fig. 16 (low)", {Mode.RRS}),
    ],
)
def test_both_sides_of_the_lines(left: str, right: str, modes: set[Mode]) -> None:
    by_place = {caption["place"]: caption for caption in CAPTIONS}
    low, high = by_place[left], by_place[right]
    half_angle = half_angle_of(low)
    step = 1e-9
    sliding = theory.least_thickness(half_angle, low["mu"] * (1 - step))
    assert (sliding.eta, sliding.modes) == (None, (Mode.SS,))
    for mu in (low["mu"] * (1 + step), high["mu"] * (1 - step)):
        assert set(theory.least_thickness(half_angle, mu).modes) == modes
    assert theory.least_thickness(half_angle, high["mu"] * (1 + step)).modes == (Mode.RRR,)


def test_figure_21_both_sides_of_equal_angles() -> None:
    alpha, mu = 2.603266515104794, 1.832508693777595
    below = theory.least_thickness(alpha, mu * (1 + 1e-9))
    above = theory.least_thickness(alpha, mu * (1 - 1e-9))
    assert below.modes == (Mode.RRS,)
    assert above.modes == (Mode.RSR,)
    assert below.beta_r > below.beta_s
    assert above.beta_r < above.beta_s


def test_lines_of_the_map_pass_through_the_captions() -> None:
    found = theory.first_sliding(np.radians([125.0, 145.0]))
    assert found.mu == pytest.approx([0.9245590639478306, 1.761938080825641], rel=1e-13)
    assert found.eta == pytest.approx([0.3849612500740051, 0.7406376307743147], rel=1e-13)
    left = theory.divide(np.array([0.8477497839674316, 1.536310506737699, 1.809583028035458]))
    assert left.eta == pytest.approx([0.5081418006878796, 0.7643357111953571, 1], rel=1e-13)
    same = theory.equal_angles(np.array([1.832508693777595]))
    assert same.eta == pytest.approx([0.9563124518512550], rel=1e-13)
    junction = TABLE["J"]
    top = theory.crown_hinge(np.array([junction["mu"]]))
    assert top.eta == pytest.approx([junction["eta"]], rel=1e-12)


def test_constants_of_the_rotational_mode() -> None:
    end = theory.least_thickness(CONSTANTS["alpha_l"], math.inf)
    assert end.eta == pytest.approx(1, rel=1e-13)
    assert end.thrust == pytest.approx(0, abs=1e-14)
    for name in ("l", "L"):
        alpha = CONSTANTS[f"alpha_{name}"]
        assert equations.shape(alpha) == pytest.approx(CONSTANTS[f"A_{name}"], rel=1e-14)
    assert theory.least_thickness(CONSTANTS["alpha_L"] - 1e-9, math.inf).eta < 2
    assert theory.least_thickness(CONSTANTS["alpha_L"] + 1e-9, math.inf).eta is None


def test_widest_inner_hinge() -> None:
    at = CONSTANTS["alpha_sbeta"]
    widest = theory.least_thickness(at, math.inf).beta_r
    # A maximum: at a distance d beside it the angle is lower by order d^2.
    assert widest == pytest.approx(CONSTANTS["beta_sbeta"], rel=1e-12)
    for beside in (-1e-3, 1e-3):
        assert theory.least_thickness(at + beside, math.inf).beta_r < widest
    assert discriminant(CONSTANTS["beta_sbeta"]) == pytest.approx(0, abs=1e-14)


def f_and_g(beta: float) -> tuple[float, float]:
    """Terms f and g of eq. (6)."""
    sine, cosine = math.sin(beta), math.cos(beta)
    return sine + beta * cosine, beta + sine * cosine


def discriminant(beta: float) -> float:
    """Term under the root of eq. (7)."""
    f, g = f_and_g(beta)
    return f * f - 2 * g * math.sin(beta) + math.sin(beta) ** 2


@given(st.floats(0.02, CONSTANTS["alpha_l"] - 1e-3))
def test_quadratic_problem_of_rotation(alpha: float) -> None:
    """Eqs (5)-(7): the solver knows nothing of them."""
    found = theory.least_thickness(alpha, math.inf)
    assert found.modes == (Mode.RRR,)
    beta, eta, h = found.beta_r, found.eta, found.thrust
    f, g = f_and_g(beta)
    sine, shape = math.sin(beta), alpha / math.tan(alpha / 2)
    assert sine * (2 * g - sine) * shape**2 - 2 * f * g * shape + g * g == near(g * g)
    assert (f + g) * eta**2 - 4 * (g - sine) * eta + 4 * (g - f) == near(4 * g)
    assert 2 * sine * h**2 - 2 * (f - sine) * h + g - f == near(g + f)
    # The root is lost to round-off next to the branch point; elsewhere (7) is explicit.
    assume(discriminant(beta) > 1e-3 * beta**2)
    root = math.sqrt(discriminant(beta)) * (1 if alpha < CONSTANTS["alpha_sbeta"] else -1)
    assert shape == pytest.approx(g * (f + root) / (sine * (2 * g - sine)), rel=1e-8)
    assert eta == pytest.approx(2 * (g - sine - root) / (f + g), rel=1e-8, abs=1e-10)
    assert h == pytest.approx((f - sine + root) / (2 * sine), rel=1e-8)


def near(scale: float) -> object:
    return pytest.approx(0, abs=1e-12 * scale)


def solution(alpha: float, mu: float, weight: str = "centreline") -> theory.Critical:
    found = theory.least_thickness(alpha, mu, weight)
    assume(found.eta is not None)
    return found


@settings(max_examples=50)
@given(wide, friction)
def test_equations_hold_at_the_solution(alpha: float, mu: float) -> None:
    """Eqs (1)-(4), (8), (9), each in the modes in which the paper says it rules."""
    found = solution(alpha, mu)
    modes, eta, h, beta = set(found.modes), found.eta, found.thrust, found.beta_r
    tolerance = 1e-11
    at_crown, at_shoulder = {Mode.RRR, Mode.SRR} & modes, modes - {Mode.SRR, Mode.SS}
    if at_crown:
        assert derivations.lower_thrust(beta, eta) == pytest.approx(h, rel=tolerance)
    if at_shoulder:
        upper = derivations.upper_thrust(alpha, beta, eta)
        assert upper == pytest.approx(h, rel=tolerance, abs=tolerance)
    if Mode.RRR in modes:
        assert derivations.whole_thrust(alpha, eta) == pytest.approx(h, rel=tolerance)
    if 0 < beta < alpha:
        assert derivations.tangency_thrust(beta, eta) == pytest.approx(h, abs=tolerance)
    if {Mode.SRR, Mode.SS} & modes:
        assert equations.shoulder_friction(alpha, h) == pytest.approx(mu, rel=tolerance)
    if found.beta_s is not None:
        assert equations.inner_friction(h) == pytest.approx(mu, rel=tolerance)
        assert equations.inner_sliding_angle(h) == pytest.approx(found.beta_s, rel=tolerance)
    # No solution passes without one of (1) and (2).
    assert at_crown or at_shoulder


def lines(
    angles: np.ndarray, thrust: float, crown: float, lever: float
) -> tuple[np.ndarray, np.ndarray]:
    """Eccentricity (positive inwards) and shear, both over the normal force.

    The part of the right half between crown and angle x is pushed by the thrust at radius
    `crown` and pulled down by its weight, 1 per angle at radius `lever`. The weight's
    moment is summed by Gauss quadrature between neighbouring angles.
    """
    nodes, weights = np.polynomial.legendre.leggauss(8)
    edges = np.concatenate([[0.0], angles])
    half, middle = np.diff(edges) / 2, (edges[1:] + edges[:-1]) / 2
    places = middle[:, None] + half[:, None] * nodes
    weight = np.cumsum((half[:, None] * weights).sum(axis=1))
    first_moment = np.cumsum((half[:, None] * weights * lever * np.sin(places)).sum(axis=1))
    sine, cosine = np.sin(angles), np.cos(angles)
    normal = thrust * cosine + weight * sine
    shear = weight * cosine - thrust * sine
    # About the middle of the section; counter-clockwise positive.
    moment = -thrust * (crown - cosine) - (first_moment - weight * sine)
    return moment / normal, shear / normal


@settings(max_examples=40)
@given(wide, st.one_of(friction, st.just(math.inf)), weights)
def test_lines_of_thrust_and_friction(alpha: float, mu: float, weight: str) -> None:
    """Eqs (10)-(14), and that nowhere in between the arch is asked for more."""
    found = solution(alpha, mu, weight)
    modes, eta, h, beta = set(found.modes), found.eta, found.thrust, found.beta_r
    lever = 1 + eta**2 / 12 if weight == "sector" else 1.0
    angles = np.linspace(0, alpha, 4001)[1:]

    def both(at: np.ndarray, crown: float) -> tuple[np.ndarray, np.ndarray]:
        eccentricity, ratio = lines(at, h, crown, lever)
        return eccentricity / (eta / 2), ratio / mu

    crown = 1 + eta / 2
    if not {Mode.RRR, Mode.SRR} & modes:
        # The shoulder hinge sets the line: shift it by the moment missing there.
        at_shoulder, _ = lines(np.array([alpha]), h, 1.0, lever)
        normal = h * math.cos(alpha) + alpha * math.sin(alpha)
        assume(h > 1e-3)
        crown = 1 + (at_shoulder[0] + eta / 2) * normal / h
    e_hat, e_s_hat = both(angles, crown)
    assert np.abs(e_hat).max() <= 1 + 1e-9
    assert abs(crown - 1) <= eta / 2 * (1 + 1e-9)
    if modes - {Mode.SRR, Mode.SS}:
        assert e_hat[-1] == pytest.approx(-1, abs=1e-9)  # (11)
    if 0.02 < beta < alpha - 0.02:
        step = 1e-3
        around, _ = both(beta + step * np.array([-1.0, 0.0, 1.0]), crown)
        assert around[1] == pytest.approx(1, abs=1e-9)  # (10)
        slope, bend = (around[2] - around[0]) / 2, around[2] + around[0] - 2 * around[1]
        assert bend < 0
        assert abs(slope) <= 1e-2 * abs(bend)  # (12), to the third order in the step
    if math.isinf(mu):
        return
    assert np.abs(e_s_hat).max() <= 1 + 1e-9
    if {Mode.SRR, Mode.SS} & modes:
        assert e_s_hat[-1] == pytest.approx(-1, abs=1e-9)  # (13)
    if found.beta_s is not None and 0.02 < found.beta_s < alpha - 0.02:
        step = 1e-3
        _, around = both(found.beta_s + step * np.array([-1.0, 0.0, 1.0]), crown)
        assert around[1] == pytest.approx(1, abs=1e-9)  # (14)
        bend = around[2] + around[0] - 2 * around[1]
        assert bend < 0
        assert abs(around[2] - around[0]) / 2 <= 2e-2 * abs(bend)


@given(wide, friction, weights, st.floats(0.0, 1.0))
def test_no_other_hinge_asks_for_more_thickness(
    alpha: float, mu: float, weight: str, share: float
) -> None:
    """The inner hinge is where the most is asked for: any other place gives less."""
    found = solution(alpha, mu, weight)
    modes = set(found.modes)
    start = 0.0 if {Mode.RRR, Mode.SRR} & modes else alpha
    beta = alpha * (0.01 + 0.98 * share)
    asked = equations.touching_eta(found.thrust, start, beta, weight)
    assert asked <= found.eta * (1 + 1e-12)
