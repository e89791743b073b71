"""The paper's equations to fifty digits, written apart from blocksim's own arithmetic.

The continuous arch: (1)-(4), (8) and (9) are solved as they are printed, the weight at the
radius k = 1 + eta^2/12 for the sector. Voussoirs as built: the conditions that hold as
equalities are solved for eta, h and m; then every other condition must hold, and these three
must be why no thinner arch stands (multipliers not negative, the theorem of duality).

Newton's method starts at blocksim's answer, and only starts there.
"""

import math
from typing import NamedTuple

from mpmath import mp, mpf

from blocksim import theory
from blocksim.arch import limit

DIGITS = 50
mp.dps = DIGITS


class Exact(NamedTuple):
    """The continuous arch at its least thickness."""

    mode: str
    eta: mpf
    thrust: mpf
    beta_r: mpf
    beta_s: mpf | None


def lever(eta: mpf, weight: str) -> mpf:
    """Radius of the weight over the mean radius."""
    return 1 + eta**2 / 12 if weight == "sector" else mpf(1)


def crown(h: mpf, beta: mpf, eta: mpf, weight: str) -> mpf:
    """(1): hinges at the crown extrados and the intrados at beta."""
    rise = (2 - eta) * beta * mp.sin(beta) - 2 * lever(eta, weight) * (1 - mp.cos(beta))
    return h * (2 + eta - (2 - eta) * mp.cos(beta)) - rise


def shoulder(h: mpf, alpha: mpf, beta: mpf, eta: mpf, weight: str) -> mpf:
    """(2): hinges at the shoulder extrados and the intrados at beta."""
    rise = (
        (2 + eta) * alpha * mp.sin(alpha)
        - (2 - eta) * beta * mp.sin(beta)
        - 2 * lever(eta, weight) * (mp.cos(beta) - mp.cos(alpha))
    )
    return h * ((2 - eta) * mp.cos(beta) - (2 + eta) * mp.cos(alpha)) - rise


def tangency(h: mpf, beta: mpf, eta: mpf, weight: str) -> mpf:
    """(4): the line of thrust only touches the intrados at beta."""
    cotangent = beta * mp.cot(beta) if beta else mpf(1)
    return (1 + cotangent - h) * (2 - eta) - 2 * lever(eta, weight)


def shoulder_friction(alpha: mpf, h: mpf) -> mpf:
    """(8)."""
    return (h * mp.sin(alpha) - alpha * mp.cos(alpha)) / (
        h * mp.cos(alpha) + alpha * mp.sin(alpha)
    )


def inner_friction(h: mpf) -> mpf:
    """(9)."""
    beta = mp.sqrt(h * (1 - h))
    return ((1 - h) * mp.cos(beta) - beta * mp.sin(beta)) / (
        (1 - h) * mp.sin(beta) + beta * mp.cos(beta)
    )


def inner_thrust(mu: mpf) -> mpf:
    """Thrust of (9) at a given friction; the friction falls with the thrust."""
    if mp.isinf(mu):
        return mpf(0)
    # In x = log(h/(1 - h)) both ends of the range are far away.
    low, high = mpf(-60), mpf(60)
    for _ in range(8):
        middle = (low + high) / 2
        h = 1 / (1 + mp.exp(-middle))
        low, high = (middle, high) if inner_friction(h) > mu else (low, middle)

    def misfit(x: mpf) -> mpf:
        return mp.log(inner_friction(1 / (1 + mp.exp(-x))) / mu)

    return 1 / (1 + mp.exp(-mp.findroot(misfit, (low, high), solver="anderson")))


def shoulder_thrust(alpha: mpf, mu: mpf) -> mpf:
    """Thrust of (8) at a given friction."""
    excess = alpha - mp.atan(mu)
    return alpha * mp.cot(excess) if excess > 0 else mpf("inf")


def _solve(equations: object, eta: float, beta: float, alpha: mpf) -> tuple[mpf, mpf]:
    """Solve two equations for eta and beta, in units in which flat arches are like any."""

    def scaled(u: mpf, v: mpf) -> list[mpf]:
        return [value / alpha**2 for value in equations(u * alpha**4, mp.sqrt(v) * alpha)]

    start = (mpf(eta) / alpha**4, (mpf(beta) / alpha) ** 2)
    u, v = mp.findroot(scaled, start, tol=1e-70, maxsteps=30)
    return u * alpha**4, mp.sqrt(v) * alpha


def rotational(half_angle: float, weight: str) -> tuple[mpf, mpf, mpf]:
    """Thrust, thickness and hinge of the purely rotational mode: (1), (3), (4)."""
    alpha = mpf(half_angle)
    guess = theory.least_thickness(half_angle, math.inf, weight)

    def whole(eta: mpf) -> mpf:
        return alpha * mp.cot(alpha / 2) - 2 * lever(eta, weight) / (2 + eta)

    def both(eta: mpf, beta: mpf) -> tuple[mpf, mpf]:
        h = whole(eta)
        return crown(h, beta, eta, weight) / alpha**2, tangency(h, beta, eta, weight)

    if guess.thrust == 0:
        eta = mp.findroot(whole, mpf(guess.eta))
        return mpf(0), eta, mpf(0)
    eta, beta = _solve(both, guess.eta, guess.beta_r, alpha)
    return whole(eta), eta, beta


def least_thickness(half_angle: float, mu: float, weight: str) -> Exact | None:
    """Least thickness of the continuous arch; None where none up to 2 stands."""
    alpha, friction = mpf(half_angle), mpf(mu)
    lower, upper = inner_thrust(friction), shoulder_thrust(alpha, friction)
    beta_s = mp.sqrt(lower * (1 - lower))
    # A joint beyond the springing cannot slide; then inner sliding never governs.
    if beta_s > alpha:
        lower = mpf("-inf")
    if lower > upper:
        return None
    if mp.cos(alpha) < 0 and -lower * 4 * mp.cos(alpha) > 4 * alpha * mp.sin(alpha) - 2 * lever(
        mpf(2), weight
    ) * (1 - mp.cos(alpha)):
        return None  # (2) with the hinge at the crown: more than a thickness of 2
    guess = theory.least_thickness(half_angle, mu, weight)
    h, eta, beta = rotational(half_angle, weight)
    if lower <= h <= upper:
        return Exact("rrr" if h > 0 else "r", eta, h, beta, None)
    if h > upper:
        h = upper
        eta, beta = _solve(
            lambda e, b: (crown(h, b, e, weight) / alpha**2, tangency(h, b, e, weight)),
            guess.eta, guess.beta_r, alpha,
        )  # fmt: skip
        return Exact("srr", eta, h, beta, None)
    h = lower
    eta = mp.findroot(lambda e: shoulder(h, alpha, mpf(0), e, weight), mpf(guess.eta))
    # With the hinge at the crown, does the intrados ask for more beside it?
    if tangency(h, mpf(0), eta, weight) <= 0:
        return Exact("rs", eta, h, mpf(0), beta_s)
    eta, beta = _solve(
        lambda e, b: (shoulder(h, alpha, b, e, weight), tangency(h, b, e, weight)),
        guess.eta, guess.beta_r, alpha,
    )  # fmt: skip
    return Exact("rrs" if beta > beta_s else "rsr", eta, h, beta, beta_s)


def divide_half_angle(mu: float, guess: float) -> mpf:
    """Half-angle at which both joints slide, (8) and (9)."""
    h = inner_thrust(mpf(mu))
    return mp.findroot(lambda a: mp.log(shoulder_friction(a, h) / mpf(mu)), mpf(guess))


def first_sliding(half_angle: float, weight: str) -> mpf:
    """Friction at which the purely rotational mode is about to slide."""
    h = rotational(half_angle, weight)[0]
    return max(shoulder_friction(mpf(half_angle), h), inner_friction(h))


def divide_eta(mu: float, alpha: mpf, eta: float, beta: float) -> mpf:
    """Thickness at the divide, centreline; the shoulder asks for more above point T."""
    h = inner_thrust(mpf(mu))
    above = mu > theory.landmarks()["T"].mu
    if beta == 0:
        eta = mp.findroot(lambda e: shoulder(h, alpha, mpf(0), e, "centreline"), mpf(eta))
        assert tangency(h, mpf(0), eta, "centreline") <= 0
        return eta

    def both(e: mpf, b: mpf) -> tuple[mpf, mpf]:
        balance = (
            shoulder(h, alpha, b, e, "centreline") if above else crown(h, b, e, "centreline")
        )
        return balance / alpha**2, tangency(h, b, e, "centreline")

    return _solve(both, eta, beta, alpha)[0]


def _rows(half_angle: float, mu: float, voussoirs: int) -> list[tuple[str, int, object]]:
    """Conditions g(eta, h, m) <= 0 at each joint of one half, by kind and joint."""
    first, count = voussoirs % 2, voussoirs // 2 + 1
    rows: list[tuple[str, int, object]] = []
    for place in range(count):
        x = mpf(half_angle) * (2 * place + first) / voussoirs
        sine, cosine = mp.sin(x), mp.cos(x)

        def resultant(
            eta: mpf, h: mpf, m: mpf, weight: str, x=x, sine=sine, cosine=cosine
        ) -> tuple[mpf, mpf, mpf]:
            force = h * cosine + x * sine
            moment = m - force + lever(eta, weight) * (1 - cosine)
            return force, h * sine - x * cosine, moment

        for kind, sign in (("extrados", 1), ("intrados", -1)):

            def turns(e, h, m, weight, sign=sign, resultant=resultant) -> mpf:
                force, _, moment = resultant(e, h, m, weight)
                return sign * moment - e / 2 * force

            rows.append((kind, place, turns))
        for kind, sign in (("slides", 1), ("slides", -1)):

            def slides(e, h, m, weight, sign=sign, resultant=resultant) -> mpf:
                force, shear, _ = resultant(e, h, m, weight)
                return sign * shear - mpf(mu) * force

            if not math.isinf(mu):
                rows.append((kind, place, slides))
    return rows


def least_thickness_as_built(
    half_angle: float, mu: float, voussoirs: int, weight: str
) -> tuple[mpf, mpf]:
    """Least thickness and thrust of n voussoirs, with proof.

    Raises
    ------
    AssertionError
        If the joints that blocksim names do not prove the answer.
    """
    state = limit.least_thickness(half_angle, mu, voussoirs, weight)
    assert state.eta is not None
    assert state.thrust is not None
    rows = _rows(half_angle, mu, voussoirs)
    places = {
        kind: [round((x / half_angle * voussoirs - voussoirs % 2) / 2) for x in angles]
        for kind, angles in (
            ("extrados", state.hinges_extrados),
            ("intrados", state.hinges_intrados),
            ("slides", state.slides),
        )
    }
    eta, h = mpf(state.eta), mpf(state.thrust)
    flat = mpf(half_angle) ** 4
    # The moment at the crown follows from any joint that turns.
    kind, place = next(
        (kind, places[kind][0]) for kind in ("intrados", "extrados") if places[kind]
    )
    turning = next(g for k, p, g in rows if (k, p) == (kind, place))
    base, unit = turning(eta, h, mpf(0), weight), turning(eta, h, mpf(1), weight)
    m = -base / (unit - base)
    active = [
        g
        for k, p, g in rows
        if p in places[k] and (k != "slides" or abs(g(eta, h, m, weight)) < abs(1e-6 * mu))
    ]
    assert len(active) == 3, (places, len(active))
    unknowns = (eta / flat, (1 - h) / half_angle**2, (m - h) / flat)

    def at(u: mpf, v: mpf, w: mpf) -> tuple[mpf, mpf, mpf]:
        thrust = 1 - v * mpf(half_angle) ** 2
        return u * flat, thrust, thrust + w * flat

    def equations(u: mpf, v: mpf, w: mpf) -> list[mpf]:
        return [g(*at(u, v, w), weight) / flat for g in active]

    solution = mp.findroot(equations, unknowns, tol=1e-60, maxsteps=40)
    found = at(*solution)
    for _, _, g in rows:
        assert g(*found, weight) <= mpf("1e-40")
    # min eta subject to g <= 0: grad eta + sum of l grad g = 0 with every l >= 0.
    step = mpf("1e-25")
    gradients = mp.matrix(3, 3)
    for column, g in enumerate(active):
        for row in range(3):
            ahead, behind = list(solution), list(solution)
            ahead[row] += step
            behind[row] -= step
            rate = g(*at(*ahead), weight) - g(*at(*behind), weight)
            gradients[row, column] = rate / (2 * step) / flat
    multipliers = mp.lu_solve(gradients, mp.matrix([-1, 0, 0]))
    assert min(multipliers) >= -mpf("1e-15"), multipliers
    return found[0], found[1]
