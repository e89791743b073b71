"""What Cocchetti and Rizzi (2024) remark, in sections 2, 3, 3.1 and 4, by other derivations.

Statics are written out here, hinges and sliding joints are looked for on a grid, and the
thickness that a thrust asks for is one moment balance: nothing of it is blocksim's own theory,
which is what it is compared with. blocksim's exact statics of voussoirs are another witness.
"""

import math
from itertools import combinations

import derivations
import numpy as np
import pytest
from derivations import PAPER
from scipy.optimize import brentq, minimize_scalar, root

from blocksim import Arch, Mode, theory
from blocksim.arch import limit

TABLE = PAPER["table1"]
T, J, B = (TABLE[name] for name in "TJB")


def shear_ratio(x: np.ndarray, thrust: float) -> np.ndarray:
    """T/N at angle x, below 0 where the part above slides inwards."""
    normal = thrust * np.cos(x) + x * np.sin(x)
    return (thrust * np.sin(x) - x * np.cos(x)) / normal


def least_thrust(mu: float) -> float:
    """Thrust below which an inner joint slides, by looking at all of them."""
    x = np.linspace(0, 1.2, 20_001)
    return float(brentq(lambda h: float(-shear_ratio(x, h).min()) - mu, 1e-6, 1, xtol=1e-15))


def widest(mu: float, thrust: float) -> float:
    """Half-angle beyond which the shoulder slides at a thrust."""

    def pushed(a: float) -> float:
        slides = thrust * math.sin(a) - a * math.cos(a)
        return slides - mu * (thrust * math.cos(a) + a * math.sin(a))

    friction_angle = math.atan(mu)
    return float(brentq(pushed, friction_angle, friction_angle + math.pi / 2, xtol=1e-15))


def asked(x: np.ndarray, half_angle: float, thrust: float) -> np.ndarray:
    """Thickness of moment balance between intrados at x and the shoulder's extrados, (2)."""
    side = half_angle * math.sin(half_angle)
    rise = np.cos(x) - math.cos(half_angle)
    force = thrust * (np.cos(x) + math.cos(half_angle)) + x * np.sin(x) + side
    return 2 * (x * np.sin(x) - side + (1 + thrust) * rise) / force


def inner_hinge(half_angle: float, thrust: float) -> tuple[float, float]:
    """Where the most thickness is asked for, and how much."""
    x = np.linspace(0, half_angle - 0.01, 40_001)
    eta = asked(x, half_angle, thrust)
    place = int(np.argmax(eta))
    return float(x[place]), float(eta[place])


def rotational(beta: float, sign: float) -> tuple[float, float, float]:
    """alpha, eta and h of eq. (7)."""
    sine, cosine = math.sin(beta), math.cos(beta)
    f, g = sine + beta * cosine, beta + sine * cosine
    gap = sign * math.sqrt(max(f * f - 2 * g * sine + sine * sine, 0.0))
    level = g * (f + gap) / (sine * (2 * g - sine))
    alpha = brentq(lambda a: a / math.tan(a / 2) - level, 1e-6, 3.1, xtol=1e-15)
    return float(alpha), 2 * (g - sine - gap) / (f + g), (f - sine + gap) / (2 * sine)


def test_four_modes_at_t_are_triple_combinations() -> None:
    """Section 4: any mechanism at T is a mixture of three of the four; they have rank 3."""
    alpha, mu, eta = T["alpha"], T["mu"], T["eta"]

    def section(x: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Coefficients of h and m in N, T, M."""
        normal, shear = np.array([math.cos(x), 0.0]), np.array([math.sin(x), 0.0])
        return normal, shear, np.array([0.0, 1.0]) - normal

    def turns(x: float, side: float) -> np.ndarray:
        normal, _, moment = section(x)
        return side * moment - eta / 2 * normal

    def slides(x: float, side: float) -> np.ndarray:
        normal, shear, _ = section(x)
        return side * shear - mu * normal

    rows = np.array([turns(0.0, 1), turns(T["beta_r"], -1), turns(alpha, 1),
                     slides(alpha, 1), slides(T["beta_s"], -1)])  # fmt: skip
    # No force does work on rates that fit together, whatever h and m are.
    acts = {"rrr": (0, 1, 2), "srr": (0, 1, 3), "rrs": (1, 2, 4), "ss": (3, 4)}
    modes = []
    for name, places in acts.items():
        rates = np.zeros(5)
        rates[list(places)] = np.linalg.svd(rows[list(places)].T)[2][-1]
        rates /= rates.sum()
        assert np.abs(rates @ rows).max() < 1e-12, name
        assert rates.min() >= 0, name
        modes.append(rates)
    sizes = np.linalg.svd(np.array(modes))[1]
    assert sizes[2] > 0.05
    assert sizes[3] < 1e-12
    for three in combinations(modes, 3):
        assert np.linalg.svd(np.array(three))[1][-1] > 0.02
    # Three is all there is: five rates, two equations.
    assert np.linalg.matrix_rank(rows) == 2


def test_h_u_belongs_to_rrs_and_h_l_to_srr() -> None:
    """Section 3: the part in which a joint slides is in no balance of its own."""
    basin, pond = math.radians(145), math.radians(125)
    found = theory.least_thickness(basin, 1.6)
    upper = derivations.upper_thrust(basin, found.beta_r, found.eta)
    lower = derivations.lower_thrust(found.beta_r, found.eta)
    assert upper == pytest.approx(found.thrust, rel=1e-12)
    assert upper == pytest.approx(0.0802, abs=5e-5)
    assert lower == pytest.approx(0.0610, abs=5e-5)
    assert least_thrust(1.6) == pytest.approx(upper, rel=1e-6)
    found = theory.least_thickness(pond, 0.9)
    upper = derivations.upper_thrust(pond, found.beta_r, found.eta)
    lower = derivations.lower_thrust(found.beta_r, found.eta)
    assert lower == pytest.approx(found.thrust, rel=1e-12)
    assert widest(0.9, lower) == pytest.approx(pond, rel=1e-12)
    assert upper > 1.25 * lower


@pytest.mark.parametrize(("degrees", "mu"), [(145, 1.6), (125, 0.9)])
def test_exchanged_thrusts_ask_for_too_little(degrees: float, mu: float) -> None:
    """With the other thrust a thickness comes out that does not stand, however cut."""
    alpha = math.radians(degrees)
    found = theory.least_thickness(alpha, mu)

    def least(thrust_of) -> float:
        def equations(unknowns: np.ndarray) -> list[float]:
            beta, eta = unknowns
            return [thrust_of(beta, eta) - found.thrust,
                    derivations.tangency_thrust(beta, eta) - found.thrust]  # fmt: skip

        solved = root(equations, [found.beta_r, found.eta])
        assert np.abs(equations(solved.x)).max() < 1e-9
        return float(solved.x[1])

    by_upper = least(lambda beta, eta: derivations.upper_thrust(alpha, beta, eta))
    by_lower = least(derivations.lower_thrust)
    right, wrong = (by_upper, by_lower) if degrees == 145 else (by_lower, by_upper)
    assert right == pytest.approx(found.eta, rel=1e-9)
    assert wrong < 0.95 * right
    for eta, stands in ((right, True), ((right + wrong) / 2, False), (wrong, False)):
        arch = Arch(half_angle=alpha, eta=eta, voussoirs=400)
        assert (limit.slack(arch, mu) >= 0) is stands


def test_inner_hinge_of_fig_21_is_near_half_of_the_sliding_angle() -> None:
    thrust = least_thrust(1.79)
    beta_r, eta = inner_hinge(J["alpha"], thrust)
    beta_s = math.sqrt(thrust * (1 - thrust))
    assert eta == pytest.approx(0.9630759684607590, rel=1e-7)
    assert beta_r / beta_s == pytest.approx(0.4846, abs=5e-4)
    found = theory.least_thickness(J["alpha"], 1.79)
    assert found.beta_r / found.beta_s == pytest.approx(0.4846, abs=5e-5)


def test_greatest_intrinsic_thrust() -> None:
    """Eta h is largest at alpha 2.14390, along the first branch of eq. (7): 0.114791."""

    def less(beta: float) -> float:
        _, eta, thrust = rotational(beta, 1.0)
        return -eta * thrust

    best = minimize_scalar(
        less, bounds=(0.5, 1.129), method="bounded", options={"xatol": 1e-11}
    )
    alpha, eta, thrust = rotational(float(best.x), 1.0)
    assert eta * thrust == pytest.approx(0.114791, abs=5e-7)
    assert alpha == pytest.approx(2.14390, abs=2e-5)
    others = [theory.least_thickness(a, math.inf) for a in np.linspace(0.1, 2.6, 400)]
    intrinsic = [each.eta * each.thrust for each in others]
    assert max(intrinsic) <= eta * thrust * (1 + 1e-12)
    at = theory.least_thickness(alpha, math.inf)
    assert at.eta * at.thrust == pytest.approx(eta * thrust, rel=1e-12)
    beside = theory.least_thickness(alpha + 0.01, math.inf)
    assert beside.eta * beside.thrust < eta * thrust


def heyman(half_angle: float) -> tuple[float, float, float]:
    """beta, eta and h of Heyman's solution: (1), (3), and (4) without its term in eta."""

    def parts(beta: float) -> tuple[float, float]:
        thrust = beta / math.tan(beta)
        rise = 1 - math.cos(beta)
        eta = 2 * (beta * math.sin(beta) - rise * (1 + thrust))
        return eta / (thrust * (1 + math.cos(beta)) + beta * math.sin(beta)), thrust

    def excess(beta: float) -> float:
        eta, thrust = parts(beta)
        return thrust + 2 / (2 + eta) - half_angle / math.tan(half_angle / 2)

    beta = float(brentq(excess, 0.01, 1.6, xtol=1e-14))
    return beta, *parts(beta)


def test_heyman_is_near_but_his_hinge_never_turns_back() -> None:
    """Semicircle: 58.8 deg and 0.106 (Heyman 1969). His hinge only goes down; ours does not."""
    beta, eta, _ = heyman(math.pi / 2)
    assert math.degrees(beta) == pytest.approx(58.8, abs=0.05)
    assert eta == pytest.approx(0.106, abs=5e-5)
    angles = np.linspace(0.3, 2.62, 60)
    his = np.array([heyman(float(a)) for a in angles])
    ours = [theory.least_thickness(float(a), math.inf) for a in angles]
    hinge = np.array([each.beta_r for each in ours])
    eta, thrust = (
        np.array([getattr(each, name) for each in ours]) for name in ("eta", "thrust")
    )
    assert (np.diff(his[:, 0]) > 0).all()
    turn = int(np.argmax(hinge))
    assert angles[turn] == pytest.approx(PAPER["constants"]["alpha_sbeta"], abs=0.04)
    assert (np.diff(hinge[: turn + 1]) > 0).all()
    assert (np.diff(hinge[turn:]) < 0).all()
    # Thickness and thrust are monotonic in both, and stay near; his is always the thinner.
    for each in (his[:, 1], eta, -his[:, 2], -thrust):
        assert (np.diff(each) > 0).all()
    complete = angles <= math.pi / 2
    assert (his[:, 1] < eta).all()
    assert np.abs(his[:, 1] / eta - 1)[complete].max() < 0.015
    assert np.abs(his[:, 2] / thrust - 1)[complete].max() < 0.005
    assert np.abs(his[:, 1] / eta - 1).max() < 0.17
    assert (hinge < his[:, 0]).all()


def test_no_sliding_up_to_alpha_t_with_more_friction_than_mu_t() -> None:
    """Section 3.1: at the thrust of eq. (7) no joint needs more friction than mu_T."""
    needed = []
    hinges = np.linspace(0.05, 1.129, 60)
    for sign, betas in ((1.0, hinges), (-1.0, hinges[::-1])):
        for beta in betas:
            alpha, _, thrust = rotational(float(beta), sign)
            most = np.abs(shear_ratio(np.linspace(1e-9, alpha, 4001), thrust)).max()
            needed.append((alpha, float(most)))
    narrow = [most for alpha, most in needed if alpha <= T["alpha"]]
    wide = [most for alpha, most in needed if alpha > T["alpha"] + 1e-3]
    assert len(narrow) > 60
    assert max(narrow) <= T["mu"] * (1 + 1e-9)
    assert min(wide) > T["mu"]
    at_t = np.abs(shear_ratio(np.linspace(1e-9, T["alpha"], 40_001), T["h"])).max()
    assert at_t == pytest.approx(T["mu"], rel=1e-6)
    random = np.random.default_rng(5)
    for _ in range(40):
        alpha = T["alpha"] * random.uniform(0.2, 1.0)
        mu = T["mu"] / random.uniform(0.2, 1.0)
        assert theory.least_thickness(alpha, mu).modes[0] is Mode.RRR
        built = limit.least_thickness(alpha, mu, int(random.integers(150, 300)))
        assert built.mode is Mode.RRR
        assert built.slides == ()


def test_no_overturning_sliding_below_mu_j() -> None:
    """Section 3.1: with less friction the shoulder slides before the hinge is at the crown."""
    for share, at_crown in ((0.5, False), (0.9, False), (0.999, False), (1.001, True),
                            (1.3, True)):  # fmt: skip
        mu = J["mu"] * share
        thrust = least_thrust(mu)
        end = widest(mu, thrust)
        hinges = [inner_hinge(end * part, thrust)[0] for part in (0.9, 0.97, 0.99, 1.0)]
        # A wider arch has its hinge nearer to the crown.
        assert hinges == sorted(hinges, reverse=True)
        assert (hinges[-1] == 0) is at_crown, share
    mu, alpha = np.meshgrid(np.linspace(0.05, 4, 120), np.linspace(0.3, 2.79, 150))
    found = theory.least_thicknesses(alpha.ravel(), mu.ravel())
    overturns = found.mode == "rs"
    assert overturns.sum() > 500
    assert mu.ravel()[overturns].min() > J["mu"]
    assert mu.ravel()[overturns].min() < J["mu"] + 0.1


def test_no_pure_sliding_above_mu_b() -> None:
    """Section 3.1: where both joints slide there, more than eta = 2 is asked for."""
    for share in (0.9, 0.999, 1.001, 1.1, 1.5):
        mu = B["mu"] * share
        thrust = least_thrust(mu)
        _, eta = inner_hinge(widest(mu, thrust), thrust)
        assert (eta > 2) is (share > 1), share
    mu, eta = np.meshgrid(np.linspace(1.0, 6, 60), np.linspace(0.02, 2, 60))
    slides = np.array([Mode.SS in names for names in theory.at_points(eta, mu).regions.ravel()])
    assert mu.ravel()[slides].max() <= B["mu"]
    assert mu.ravel()[slides].max() > B["mu"] - 0.1


def test_with_less_friction_lines_ask_for_less_thickness() -> None:
    """Section 3.1: along every line eta falls as mu does, and the half-angle with it."""
    mu = np.linspace(0.02, B["mu"], 9)
    lines = [theory.divide(mu), theory.first_sliding(np.linspace(0.1, 2.64, 14)),
             theory.equal_angles(np.linspace(TABLE["S"]["mu"] + 1e-6, 12, 8)),
             theory.crown_hinge(np.linspace(J["mu"] + 1e-6, 12, 8))]  # fmt: skip
    for line in lines:
        assert (np.diff(line.mu) > 0).all()
        assert (np.diff(line.eta) > 0).all()
        half_angles = theory.at_points(line.eta, line.mu).half_angle
        assert (np.diff(half_angles) > 0).all()


def test_overturning_is_between_two_thirds_and_a_half() -> None:
    """Section 3.1: 2/3 >= A >= 1/2, where eta is from 1 to 2 and nothing pushes."""
    for level, eta in ((2 / 3, 1.0), (0.6, 4 / 3), (0.5, 2.0)):
        alpha = float(
            brentq(lambda a, level=level: a / math.tan(a / 2) - level, 2, 3, xtol=1e-15)
        )
        # The weight of the half, at the centroid of its arc, is above the shoulder's extrados.
        centroid = (1 - math.cos(alpha)) / alpha
        assert centroid == pytest.approx((1 + eta / 2) * math.sin(alpha), rel=1e-12)
        found = theory.least_thickness(alpha - 1e-12, math.inf)
        assert found.eta == pytest.approx(eta, rel=1e-9)
