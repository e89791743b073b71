"""Theory and limit analysis to 1e-13, from 1 to 179.9 degrees and friction 1e-6 to inf.

Held to the paper's equations in fifty digits (`exact`). Where the last bit of an input moves
the answer by more, as next to the end of the rotational mode, so much is allowed, and no more.
"""

import math
import re
from collections.abc import Sequence
from functools import partial
from typing import Any

import exact
import numpy as np
import pytest
from mpmath import mpf

from blocksim import Arch, CircularArch, InputError, Mode, bracket, check, theory
from blocksim.arch import limit
from blocksim.arch.limit.bulk import least_thickness_of_joints
from blocksim.arch.limit.halfplanes import half_joints
from blocksim.arch.theory.regions import at_inner_sliding
from blocksim.report.answerwords import bracket_lines, check_lines

WEIGHTS = ("centreline", "sector")
RELATIVE = 1e-13
INF = math.inf


def and_long(cases: Sequence[Any], more: Sequence[Any]) -> list[Any]:
    """Parameters of a test, and more of them for `-m long`."""
    split = (case if isinstance(case, tuple) else (case,) for case in more)
    return [*cases, *(pytest.param(*case, marks=pytest.mark.long) for case in split)]


# Half-angle [deg] and friction, or a share above that of the divide (negative).
ARCHES = [
    (1, INF), (1, -0.01), (5, INF), (30, 0.7), (90, 0.32), (125, 0.9), (145, 1.6), (145.3, 1.6),
    (149.156, 1.79), (151.74, 1e3), (155, 3), (159, INF), (170, 1.0), (179.9, 1e-6),
    (179.9, INF),
]  # fmt: skip
MORE = [(1, 1e-6), (2.87, -0.05), (127.8, 30), (155, 1e6)]


def assert_close(found: float, truth: mpf, moved: mpf, what: object) -> None:
    """Relative error of 1e-13, or what two last bits of the half-angle make."""
    assert abs(found - truth) <= RELATIVE * abs(truth) + 4 * abs(moved - truth), what


@pytest.mark.parametrize("weight", WEIGHTS)
@pytest.mark.parametrize(("degrees", "mu"), and_long(ARCHES, MORE))
def test_theory(degrees: float, mu: float, weight: str) -> None:
    alpha = math.radians(degrees)
    mu = theory.divide_friction(alpha) * (1 - mu) if mu < 0 else mu
    truth = exact.least_thickness(alpha, mu, weight)
    one, many = theory.least_thickness(alpha, mu, weight), None
    many = theory.least_thicknesses(np.full(5, alpha), mu, weight)
    if truth is None:
        assert one.eta is None
        assert np.isnan(many.eta).all()
        return
    assert [*many.mode.tolist(), one.mode.value] == [truth.mode] * 6
    moved = exact.least_thickness(math.nextafter(alpha, 0), mu, weight)
    for name in ("eta", "thrust", "beta_r", "beta_s"):
        value = getattr(truth, name)
        if value is None:
            continue
        for found in (getattr(one, name), *getattr(many, name).tolist()):
            assert_close(found, value, getattr(moved, name) or value, (name, weight))


@pytest.mark.parametrize("weight", WEIGHTS)
def test_every_mode_is_asked_about(weight: str) -> None:
    degrees, mu = np.array([case for case in ARCHES if case[1] > 0]).T
    found = theory.least_thicknesses(np.radians(degrees), mu, weight)
    assert {*found.mode.tolist()} == {*Mode}


@pytest.mark.parametrize("weight", WEIGHTS)
@pytest.mark.parametrize("degrees", [1, 5, 60, 125, 145, 148])
def test_first_sliding(degrees: float, weight: str) -> None:
    alpha = math.radians(degrees)
    found = theory.first_sliding(np.array([alpha]), weight)
    truth, moved = (
        exact.first_sliding(angle, weight) for angle in (alpha, math.nextafter(alpha, 0))
    )
    assert_close(found.mu[0], truth, moved, "mu")
    assert found.eta[0] == theory.least_thickness(alpha, INF, weight).eta


@pytest.mark.parametrize("mu", [1e-9, 1e-6, 1e-3, 0.3, 0.99, 1.01, 1.8, 3.0])
def test_divide(mu: float) -> None:
    angle = theory.divide_half_angle(mu)
    truth = exact.divide_half_angle(mu, angle)
    assert angle == pytest.approx(float(truth), rel=RELATIVE)
    if not 1e-9 < mu < 2.69:  # no thickness up to 2 stands there, or digits drown
        return
    eta, beta = at_inner_sliding(mu, angle, "centreline")
    assert theory.divide(np.array([mu])).eta[0] == eta
    assert eta == pytest.approx(float(exact.divide_eta(mu, truth, eta, beta)), rel=RELATIVE)


AS_BUILT = and_long(
    [(1, INF, 4), (1, 0.7, 27), (90, 0.35, 30), (145, 1.6, 25), (160, 30, 5)],
    [(1, -0.2, 8), (5, 1e6, 5)],
)


@pytest.mark.parametrize("weight", WEIGHTS)
@pytest.mark.parametrize(("degrees", "mu", "count"), AS_BUILT)
def test_limit(degrees: float, mu: float, count: int, weight: str) -> None:
    alpha = math.radians(degrees)
    mu = theory.divide_friction(alpha) * (1 - mu) if mu < 0 else mu
    one = limit.least_thickness(alpha, mu, count, weight)
    angles = half_joints(np.array([alpha]), count)
    (many,) = least_thickness_of_joints(angles, np.array([mu]), weight)
    eta, thrust = exact.least_thickness_as_built(alpha, mu, count, weight)
    assert one.eta == pytest.approx(float(eta), rel=RELATIVE)
    assert many == pytest.approx(float(eta), rel=RELATIVE)
    assert one.thrust == pytest.approx(float(thrust), rel=RELATIVE)


@pytest.mark.parametrize("mu", [5e5, 1e6, 1e9, 1e12])
def test_overturning_slides_at_any_finite_friction(mu: float) -> None:
    found = theory.least_thickness(math.radians(155), mu)
    assert found.modes == (Mode.RS,)
    # h = 1/(4 mu^2) and beta_s = sqrt h.
    assert found.thrust == pytest.approx(1 / (4 * mu * mu), rel=1e-5)
    assert found.beta_s == pytest.approx(1 / (2 * mu), rel=1e-5)
    assert theory.least_thickness(math.radians(155), INF).modes == (Mode.R,)


@pytest.mark.parametrize("weight", WEIGHTS)
@pytest.mark.parametrize("mu", and_long([1.0, 2.8, INF], [100.0]))
def test_what_stands_at_a_point_of_the_map(mu: float, weight: str) -> None:
    """At eta = 2 the widest arch stands, and one wider by 1e-14 does not."""
    alpha = float(theory.at_points(2.0, mu, weight).half_angle)
    assert theory.least_thickness(alpha, mu, weight).eta is not None
    wider = exact.least_thickness(alpha * (1 + 1e-14), mu, weight)
    assert exact.least_thickness(alpha * (1 - 1e-15), mu, weight) is not None
    assert wider is None or wider.eta > 2 - mpf("1e-12")


@pytest.mark.parametrize(
    ("line", "value", "field", "named"),
    [
        (theory.divide, 0.0, "mu", "2.690297882"),
        (theory.divide, 2.7, "mu", "2.690297882"),
        (theory.equal_angles, 1.7, "mu", "1.765868463"),
        (theory.equal_angles, INF, "mu", "1.765868463"),
        (theory.crown_hinge, 1.77, "mu", "1.777213608"),
        (partial(theory.crown_hinge, weight="sector"), math.nan, "mu", "1.546270801"),
        (theory.first_sliding, 2.65, "half_angle", "2.648388899"),
        (theory.first_sliding, 0.0, "half_angle", "2.648388899"),
    ],
)
def test_lines_name_their_range(line: object, value: float, field: str, named: str) -> None:
    with pytest.raises(InputError) as caught:
        line(np.array([value]))
    assert caught.value.field == field
    assert named in str(caught.value)


@pytest.mark.parametrize("degrees", [5, 90, 179])
def test_when_three_voussoirs_stand_at_any_thickness(degrees: float) -> None:
    """The line through the middle of both joints, and the friction it asks for.

    h = (a sin a - b sin b)/(cos b - cos a) - 1 with a = alpha, b = alpha/3.
    """
    a, b = math.radians(degrees), math.radians(degrees) / 3
    h = (a * math.sin(a) - b * math.sin(b)) / (math.cos(b) - math.cos(a)) - 1
    needed = max(
        abs(h * math.sin(x) - x * math.cos(x)) / (h * math.cos(x) + x * math.sin(x))
        for x in (a, b)
    )
    for weight in WEIGHTS:
        assert limit.least_thickness(a, needed * (1 + 1e-9), 3, weight).eta == 0
        below = limit.least_thickness(a, needed * (1 - 1e-3), 3, weight).eta
        assert below is None or below > 1e-9
        assert limit.least_thickness(a, INF, 4, weight).eta != 0


def test_any_thickness_is_said() -> None:
    arch = Arch(half_angle=math.radians(60), eta=0.1, voussoirs=3)
    seen = check(CircularArch.of(arch, friction=0.7))
    assert "any thickness of the voussoirs as built stands" in seen.reason
    assert "inf" not in seen.reason
    assert "eta any as built" in "\n".join(check_lines(seen))
    found = bracket(CircularArch.of(arch, friction=0.7).but(eta=None))
    told = found.arch
    assert (told.eta_low, told.eta_high, told.eta_limit, told.mode) == (None, 0, 0, None)
    assert bracket_lines(found)[0].startswith("ANY THICKNESS STANDS")


@pytest.mark.parametrize("tol", [5e-3, 1e-5, 1e-8])
def test_as_many_digits_are_printed_as_tell_the_ends_apart(tol: float) -> None:
    found = bracket(
        CircularArch(half_angle=math.pi / 2, friction=0.7, voussoirs=7, weight="centreline"),
        method="direct",
        tol=tol,
        confirm=False,
    )
    head, *others = bracket_lines(found)
    (exact,) = (line for line in others if "exact" in line)
    low, high = (float(each) for each in re.findall(r"0\.\d+", head)[:2])
    assert low < float(re.findall(r"0\.\d+", exact)[0]) < high
    assert high - low == pytest.approx(
        (found.arch.eta_high or 0) - (found.arch.eta_low or 0), rel=0.1
    )
