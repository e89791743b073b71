"""What the map explorer computes in a browser: its numbers and its mechanisms."""

import math

import numpy as np
import pytest

from blocksim import Arch, Mode, theory
from blocksim.arch import limit
from blocksim.arch.circular import centroid_factor
from blocksim.arch.limit import statics
from blocksim.arch.theory.lines import critical_moment, friction_line, thrust_line

playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")


@pytest.fixture(scope="module")
def page(one_page: playwright.Page) -> playwright.Page:
    return one_page


WEIGHTS = ("centreline", "sector")
COUNT = 500
TOLERANCE = 1e-9


@pytest.fixture(params=[4, pytest.param(1, marks=pytest.mark.long)])
def every(request: pytest.FixtureRequest) -> int:
    """Of the random arches one in so many is asked about; by one in 4 all modes are seen."""
    return request.param


def sample(seed: int, every: int = 1) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Half-angle, friction (a tenth of it unbounded) and thickness of random arches."""
    random = np.random.default_rng(seed)
    alpha = random.uniform(0.02, 2.78, COUNT)
    mu = np.tan(random.uniform(0.02, 1.45, COUNT))
    mu[::10] = math.inf
    eta = random.uniform(0.001, 2.0, COUNT)
    chosen = slice(every // 2, None, every)
    return alpha[chosen], mu[chosen], eta[chosen]


CALL = """([rows, weight]) => rows.map(
  (row) => {{ const [a, m, e] = row.map(Number); return {expression}; }})"""


def evaluate(
    page: playwright.Page, expression: str, rows: np.ndarray, weight: str
) -> list[dict]:
    """Evaluate an expression in a, m, e (and weight) for every row, in the page."""
    texts = [["Infinity" if math.isinf(v) else repr(float(v)) for v in row] for row in rows]
    return page.evaluate(CALL.format(expression=expression), [texts, weight])


def column(found: list[dict], key: str) -> np.ndarray:
    return np.array([math.nan if row[key] is None else row[key] for row in found], dtype=float)


@pytest.mark.parametrize("weight", WEIGHTS)
def test_least_thickness_at_many_points(page: playwright.Page, weight: str, every: int) -> None:
    alpha, mu, eta = sample(1, every)
    expected = theory.least_thicknesses(alpha, mu, weight)
    rows = np.column_stack([alpha, mu, eta])
    found = evaluate(page, "theory.leastThickness(a, m, weight)", rows, weight)
    assert [row["mode"] for row in found] == expected.mode.tolist()
    np.testing.assert_allclose(column(found, "eta"), expected.eta, rtol=TOLERANCE)
    for key in ("thrust", "beta_r", "beta_s"):
        script = key.replace("_r", "R").replace("_s", "S")
        exact = getattr(expected, key)
        np.testing.assert_allclose(column(found, script), exact, rtol=TOLERANCE, atol=TOLERANCE)


@pytest.mark.parametrize("weight", WEIGHTS)
def test_points_of_the_map_at_many_points(
    page: playwright.Page, weight: str, every: int
) -> None:
    _, mu, eta = sample(2, every)
    expected = theory.at_points(eta, mu, weight)
    rows = np.column_stack([eta, mu, eta])
    found = evaluate(page, "theory.atPoint(e, m, weight)", rows, weight)
    modes = [[Mode(mode) for mode in row["modes"]] for row in found]
    assert modes == [list(names) for names in expected.regions]
    np.testing.assert_allclose(column(found, "halfAngle"), expected.half_angle, rtol=TOLERANCE)


@pytest.mark.parametrize("weight", WEIGHTS)
def test_lines_of_thrust_and_friction(page: playwright.Page, weight: str, every: int) -> None:
    """At a random joint of each arch at its least thickness."""
    alpha, mu, share = sample(3, every)
    rows = np.column_stack([alpha, mu, share / 2])
    expression = """(() => {
      const { eta, thrust, betaR } = theory.leastThickness(a, m, weight);
      if (eta === null) return null;
      // The line of thrust touches the intrados at the inner hinge.
      const unforced = theory.sectionMoment(betaR, thrust, 0, eta, weight);
      const moment = -theory.normalForce(betaR, thrust) * eta / 2 - unforced;
      return [theory.thrustLine(a * e, thrust, moment, eta, weight),
              theory.frictionLine(a * e, thrust, m)];
    })()"""
    found = evaluate(page, expression, rows, weight)
    compared = 0
    for (half_angle, friction, place), lines in zip(rows.tolist(), found, strict=True):
        critical = theory.least_thickness(half_angle, friction, weight)
        assert (lines is None) == (critical.eta is None)
        # Flatter, the thickness drowns in the round-off of the lever arms.
        if lines is None or half_angle < 0.3:
            continue
        moment = critical_moment(half_angle, critical, weight)
        angle, thrust = half_angle * place, critical.thrust
        expected = [
            thrust_line(angle, thrust, moment, critical.eta, weight),
            friction_line(angle, thrust, friction),
        ]
        assert lines == pytest.approx(expected, rel=1e-7, abs=1e-7)
        compared += 1
    assert compared > len(rows) / 2


@pytest.mark.parametrize("weight", WEIGHTS)
def test_equilibrium_needs_the_share_it_says(
    page: playwright.Page, weight: str, every: int
) -> None:
    """The lines shown reach just that share of the faces; it is 1 where theory says so."""
    alpha, mu, eta = sample(4, every)
    alpha = 0.3 + alpha * 0.85
    rows = np.column_stack([alpha, mu, eta])
    found = evaluate(page, "theory.equilibrium(a, m, e, weight)", rows, weight)
    least = theory.least_thicknesses(alpha, mu, weight).eta
    for (half_angle, friction, ratio), critical, balance in zip(
        rows.tolist(), least.tolist(), found, strict=True
    ):
        stands = ratio >= critical  # False for nan
        assert stands == (balance is not None and balance["share"] <= 1)
        if balance is None:
            continue
        angles = np.linspace(0, half_angle, 2001)
        thrust, moment = balance["thrust"], balance["crownMoment"]
        if thrust < 1e-6:  # without thrust the crown bears no force
            angles = angles[1:]
        pressure = thrust_line(angles, thrust, moment, ratio, weight)
        shear = friction_line(angles, thrust, friction)
        reached = max(np.abs(pressure).max(), np.abs(shear).max())
        assert reached == pytest.approx(balance["share"], rel=2e-3)


def test_share_against_limit_analysis(page: playwright.Page) -> None:
    """Both scaled by 1 % less than the share, many voussoirs fall; by 1 % more they stand."""
    alpha = np.array([1.0, 1.6, 2.2, 2.45, 2.55])
    mu = np.array([0.6, 0.5, 0.95, 1.5, 2.2])
    eta = np.array([0.2, 0.09, 0.9, 0.5, 1.2])
    rows = np.column_stack([alpha, mu, eta])
    found = evaluate(page, "theory.equilibrium(a, m, e, weight)", rows, "centreline")
    for (half_angle, friction, ratio), balance in zip(rows.tolist(), found, strict=True):
        for change, stands in ((0.99, False), (1.01, True)):
            share = change * balance["share"]
            built = limit.least_thickness(half_angle, share * friction, 120).eta
            assert (built is not None and built <= share * ratio) == stands


# --- voussoirs as built --------------------------------------------------------------------

BUILT = """((n) => ({ ...built.leastThickness(a, m, n, weight),
  ...Object.fromEntries([["share", built.equilibrium(a, m, 0.4, n, weight)?.share ?? null]]),
  grip: built.leastFriction(a, 0.4, n, weight) }))(e)"""


def as_built(seed: int) -> np.ndarray:
    """Half-angle, friction and number of voussoirs; flatter, Python's differences cancel."""
    random = np.random.default_rng(seed)
    alpha, mu, _ = sample(seed)
    drawn = np.column_stack([0.3 + 0.9 * alpha, mu, random.integers(4, 60, COUNT)])[:300]
    return np.concatenate([drawn, [[2.53, 1.62, 41], [2.5, 1.6, 30]]])


@pytest.mark.parametrize("every", [4, pytest.param(1, marks=pytest.mark.long)])
@pytest.mark.parametrize("weight", WEIGHTS)
def test_voussoirs_as_built_are_those_of_limit_analysis(
    page: playwright.Page, weight: str, every: int
) -> None:
    rows = as_built(7)
    # The widest have the rarest modes.
    rows = rows[(np.arange(len(rows)) % every == 1 % every) | (rows[:, 0] > 2.45)]
    found = evaluate(page, BUILT, rows, weight)
    seen = set()
    for (half_angle, friction, count), row in zip(rows.tolist(), found, strict=True):
        exact = limit.least_thickness(half_angle, friction, int(count), weight)
        assert row["mode"] == exact.mode
        assert (row["eta"] is None) == (exact.eta is None)
        seen.add(row["mode"])
        if exact.eta is not None:
            assert row["eta"] == pytest.approx(exact.eta, rel=1e-12)
            assert row["thrust"] == pytest.approx(exact.thrust, rel=1e-9, abs=1e-9)
            inner = [j["angle"] for j in row["joints"] if j["kind"] == "intrados"]
            if row["mode"] not in {"r", "rs"}:
                assert inner == pytest.approx(list(exact.hinges_intrados))
        arch = Arch(half_angle=half_angle, eta=0.4, voussoirs=int(count), weight=weight)
        slack = statics.slack(arch, friction)
        assert (row["share"] is None) == math.isinf(slack)
        if row["share"] is not None:
            assert 1 - row["share"] == pytest.approx(slack, abs=1e-11 * row["share"])
        if math.isfinite(row["grip"]):
            assert statics.slack(arch, row["grip"] * (1 + 1e-9)) >= 0
            assert statics.slack(arch, row["grip"] * (1 - 1e-9)) < 0
        else:
            assert statics.slack(arch, 1e6) < 0
    assert seen >= {"rrr", "ss", "srr", "rrs", "rs", "r"}


FALL = """((n) => {
  const critical = built.leastThickness(a, m, n, weight);
  if (critical.eta === null || !critical.joints.length) return null;
  const { joints, eta } = critical;
  const [pieces, small] = [mechanism.pieces(joints), mechanism.pose(joints, eta, 1e-6)];
  return { ...critical, pieces, small };
})(e)"""


@pytest.mark.parametrize("weight", WEIGHTS)
def test_mechanisms_of_voussoirs_balance_weight_and_friction(
    page: playwright.Page, weight: str
) -> None:
    """Odd numbers, too, with a keystone that goes straight down."""
    rows = as_built(8)
    seen = set()
    for row, friction in zip(evaluate(page, FALL, rows, weight), rows[:, 1], strict=True):
        if row is None or row["mode"] == "r":
            continue
        seen.add(row["mode"])
        assert row["small"]["closed"]
        # The last piece reaches the crown: symmetry asks that it does not lean out.
        if row["pieces"][-1][1] == 0 and row["joints"][-1]["angle"] > 0:
            last = row["small"]["motions"][-1]
            assert abs(last["turn"]) < 1e-15
            assert abs(last["x"]) < 1e-11
        power, drop = spent(row, friction, weight)
        assert abs(power) < 2e-5 * drop
    assert seen >= {"rrr", "srr", "rrs", "rs"}


def spent(row: dict, friction: float, weight: str) -> tuple[float, float]:
    """Power of the weight less that of friction, and the farthest fall."""
    lever, power, drop = centroid_factor(row["eta"], weight), 0.0, 0.0
    for (lower, upper), motion in zip(row["pieces"], row["small"]["motions"], strict=True):
        nodes, weights = np.polynomial.legendre.leggauss(20)
        angles = (lower + upper) / 2 + (lower - upper) / 2 * nodes
        points = lever * np.column_stack([np.sin(angles), np.cos(angles)])
        fall = points[:, 1] - moved(motion, points)[:, 1]
        power += (lower - upper) / 2 * weights @ fall
        drop = max(drop, float(np.abs(fall).max()))
    active = [joint for joint in row["joints"] if joint["angle"] > 0]
    for joint, amount in zip(active, row["small"]["amounts"], strict=True):
        if joint["kind"] in {"in", "out"}:
            angle, thrust = joint["angle"], row["thrust"]
            force = thrust * math.cos(angle) + angle * math.sin(angle)
            power -= friction * force * amount
    return power, drop


# --- mechanisms ----------------------------------------------------------------------------

MOVE = """(() => {
  const point = theory.atPoint(e, m, weight);
  const halfAngle = point.halfAngle * (1 - 1e-9);
  const critical = theory.leastThickness(halfAngle, m, weight);
  const { mode, eta, betaR, betaS } = critical;
  const joints = mechanism.activeJoints(mode, halfAngle, betaR, betaS);
  const far = mechanism.amountFor(joints, eta, 0.16);
  return { halfAngle, ...critical, joints, pieces: mechanism.pieces(joints),
    small: mechanism.pose(joints, eta, 1e-6), large: mechanism.pose(joints, eta, far) };
})()"""


def moved(motion: dict, points: np.ndarray) -> np.ndarray:
    sine, cosine = math.sin(motion["turn"]), math.cos(motion["turn"])
    turned = points @ np.array([[cosine, -sine], [sine, cosine]])
    return turned + np.array([motion["x"], motion["y"]])


@pytest.mark.parametrize("weight", WEIGHTS)
def test_mechanisms_balance_weight_and_friction(page: playwright.Page, weight: str) -> None:
    """Virtual power at the onset: what the weight does is what friction takes."""
    _, mu, eta = sample(5)
    rows = np.column_stack([eta, mu, eta])[:200]
    rows[:40, 1], rows[:40, 2] = math.inf, np.linspace(1.02, 1.9, 40)  # overturning
    rows[40:80, 1], rows[40:80, 2] = 1.8, np.linspace(0.9, 1.0, 40)  # rrs, rsr and rs
    seen = set()
    for row, friction in zip(evaluate(page, MOVE, rows, weight), rows[:, 1], strict=True):
        seen.add(row["mode"])
        assert min(row["small"]["amounts"]) >= 0
        assert min(row["large"]["amounts"]) >= 0
        assert row["large"]["closed"]
        power, drop = spent(row, friction, weight)
        assert abs(power) < 2e-5 * drop
    assert seen >= {"rrr", "srr", "rrs", "rs", "r"}


@pytest.mark.parametrize("weight", WEIGHTS)
def test_large_motions_keep_the_pieces_together(
    page: playwright.Page, weight: str, every: int
) -> None:
    """Hinges stay at their edges, faces that slide stay in line, the halves meet."""
    _, mu, eta = sample(6)
    rows = np.column_stack([eta, mu, eta])[:200:every]
    for row in evaluate(page, MOVE, rows, weight):
        motions = [{"turn": 0, "x": 0, "y": 0}, *row["large"]["motions"]]
        active = [joint for joint in row["joints"] if joint["angle"] > 0]
        for joint, below, above in zip(active, motions, motions[1:], strict=False):
            ray = np.array([math.sin(joint["angle"]), math.cos(joint["angle"])])
            if joint["kind"] in {"extrados", "intrados"}:
                side = 1 if joint["kind"] == "extrados" else -1
                edge = (1 + side * row["eta"] / 2) * ray[None]
                np.testing.assert_allclose(moved(below, edge), moved(above, edge), atol=1e-12)
            else:
                face = np.array([0.8, 1.2])[:, None] * ray
                along, slid = moved(below, face), moved(above, face)
                across = np.array([along[1, 1] - along[0, 1], along[0, 0] - along[1, 0]])
                assert np.abs((slid - along[0]) @ across).max() < 1e-12
        if row["mode"] != "r":
            radius = 1 - row["eta"] / 2 if row["mode"] == "rs" else 1 + row["eta"] / 2
            crown = moved(motions[-1], np.array([[0.0, radius]]))
            assert abs(crown[0, 0]) < 1e-11
