"""How far friction lets arches move that can rest: a closed form, rows, figure."""

import math
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from arches import problem_at
from running import answered, csv_rows, inside
from scipy.optimize import brentq

from blocksim import InputError, Problem, check, equilibrium, structure_of
from blocksim.ask.rest import FAR, SPEED, let_go
from blocksim.limit.starting import Start, may_start, rates_of
from blocksim.view.sheet import answer_sheet

pytestmark = pytest.mark.usefixtures("wide_window")

study = import_module("analysis.two_answers")
FIGURES = Path(__file__).parent.parent / "analysis" / "figures"


def rows(name: str) -> list[dict[str, str]]:
    """Rows of a study as they are kept."""
    return csv_rows(FIGURES / f"{name}.csv")


def closed_end(n: int, alpha: float, mu: float, least: float) -> float | None:
    """Thickness at which the keystone ceases to push a half over, by two balances of moments.

    Centreline weights: the keystone has W = 2a at its centroid, in units of gamma t r^2.
    """
    a = alpha / n
    c = (math.cos(a) - mu * math.sin(a)) / (math.sin(a) + mu * math.cos(a))

    def excess(eta: float) -> float:
        inner, outer = 1 - eta / 2, 1 + eta / 2
        # What C carries of the keystone, by moments about both of its corners.
        borne = (
            2 * a * inner * math.sin(a)
            / ((inner + outer) * math.sin(a) + c * (outer - inner) * math.cos(a))
        )  # fmt: skip
        # The half's weight about the outer corner of the springing, against -(cF, F) at C.
        overturns = (math.cos(a) - math.cos(alpha)) - (alpha - a) * outer * math.sin(alpha)
        across, up = math.sin(alpha) - math.sin(a), math.cos(a) - math.cos(alpha)
        return overturns - borne * outer * (across - c * up)

    high = 2 - 1e-9
    return brentq(excess, least, high) if excess(least) > 0 > excess(high) else None


@pytest.mark.long
def test_the_band_ends_where_two_balances_say() -> None:
    arch = study.Case(7, "centreline", 155.0, 3.0)
    end = closed_end(7, math.radians(155), 3.0, study.limit_of(arch)[0])
    asked = [study.may_start(arch.problem(eta)).moves for eta in (0.9995 * end, 1.0005 * end)]
    assert asked == [True, False]


def test_kept_bands_end_where_the_closed_form_says_or_before() -> None:
    """Before, where the rest of the arch does not hold what the keystone needs."""
    there = before = 0
    for row in rows("two_answers"):
        n, alpha, mu = int(row["voussoirs"]), math.radians(float(row["alpha_deg"])), row["mu"]
        if row["band"] != "True" or not row["eta_rests"] or row["weight"] != "centreline":
            continue
        if float(mu) * math.tan(alpha / n) >= 1:
            end = closed_end(n, alpha, float(mu), float(row["eta_limit"]))
            moves, rests = float(row["eta_moves"]), float(row["eta_rests"])
            assert moves <= end
            if moves == pytest.approx(end, rel=5e-4):
                assert end < rests
                there += 1
            else:
                before += 1
    assert (there, before) == (27, 6)


def test_the_kept_map_draws_every_wide_arch() -> None:
    kept = [{key: number(value) for key, value in row.items()} for row in rows("two_answers")]
    wide = [row for row in kept if row["alpha_deg"] > 140]
    figure = import_module("analysis.two_answers_map").draw(kept)
    points = 0
    for axes in figure.axes:
        for line in axes.lines:
            label = str(line.get_label())
            if "voussoirs" in label:
                points += 1
            elif label.endswith("least"):
                points += len(line.get_xdata())
    assert points == len(wide) > 100


def number(text: str) -> object:
    """A number where it is one, None where it is blank."""
    try:
        return float(text) if text else None
    except ValueError:
        return text


def between_walls(lean: float, mu: float) -> Problem:
    """A block between two walls that lean apart towards its top, by `lean` rad each."""
    top, bottom = 0.5 + 0.5 * math.tan(lean), 0.5 - 0.5 * math.tan(lean)
    corners = [[-bottom, -0.5], [bottom, -0.5], [top, 0.5], [-top, 0.5]]
    out = 3.0
    right = [[bottom, -0.5], [out, -0.5], [out, 0.5], [top, 0.5]]
    left = [[-x, y] for x, y in reversed(right)]
    return structure_of(
        {
            "friction": mu,
            "blocks": [
                {"id": "block", "vertices": corners},
                {"id": "left", "vertices": left, "fixed": True},
                {"id": "right", "vertices": right, "fixed": True},
            ],
        }
    )


def arch(mu: float, times: float, voussoirs: int = 3) -> Problem:
    """A wide arch of so many times its least thickness."""
    return problem_at(times, 155, mu, voussoirs)


def wrong(problem: Problem, start: Start) -> float:
    """By how much a motion breaks Newton's law or Coulomb's, joint by joint [g]."""
    rates = rates_of(problem) @ start.accelerations.ravel()
    pulls = np.einsum("je,jen->n", start.forces[..., 0], rates_of(problem)[:, :2]) + np.einsum(
        "j,jn->n", start.forces[..., 1].sum(axis=1), rates_of(problem)[:, 2]
    )
    inertia = problem.assembly.masses.ravel() * start.accelerations.ravel()
    worst = float(np.abs(inertia - problem.applied_forces().ravel() - pulls).max())
    for joint, mu in enumerate(problem.friction):
        pressure, friction = start.forces[joint].sum(axis=0)
        opening, slip = rates[joint, :2], rates[joint, 2]
        for end in range(2):
            press = start.forces[joint, end, 0]
            worst = max(worst, -press, -opening[end], min(abs(press), abs(opening[end])))
        beyond = abs(friction) - mu * pressure
        against = mu * pressure + math.copysign(1, slip) * friction
        worst = max(worst, beyond, min(abs(slip), abs(against)))
    return worst


@pytest.mark.parametrize("mu", [0.2, 0.6])
def test_a_block_that_hangs_by_friction_may_fall(mu: float) -> None:
    # Walls that lean together upwards carry it by squeezing from the friction angle on; as
    # nothing need squeeze it, it may also fall freely.
    angle = math.atan(mu)
    hangs = may_start(between_walls(-0.9 * angle, mu))
    assert hangs.moves
    assert hangs.accelerations == pytest.approx(np.array([[0.0, -1.0, 0.0]]), abs=1e-6)
    assert hangs.power == pytest.approx(1.0, abs=1e-6)
    assert equilibrium(between_walls(-0.9 * angle, mu)).exists
    assert not equilibrium(between_walls(-1.1 * angle, mu)).exists


def test_the_motion_is_recorded_and_drawn() -> None:
    """What hangs by friction may fall freely; let go slowly, it is caught again at once."""
    found = check(between_walls(-0.9 * math.atan(0.6), 0.6), must_rest=True, method="limit")
    gone = let_go(found.problem, found.motion.accelerations)
    assert ", pushed along a motion" in gone.problem.title
    fallen = gone.poses[0, 0, 1] - gone.poses[:, 0, 1]
    assert (fallen <= gone.times**2 / 2 + SPEED * gone.times + 1e-9).all()
    assert not found.motion.goes_on
    assert np.abs(fallen).max() < FAR
    sheet = answer_sheet(found)
    assert sheet.mechanism == pytest.approx(np.array([[0.0, -1.0, 0.0]]), abs=1e-6)
    assert any("friction may let it move as well" in fact for fact in sheet.facts)


@pytest.mark.parametrize("mu", [0.2, 0.6])
def test_a_block_in_a_wedge_must_rest(mu: float) -> None:
    assert may_start(between_walls(0.3, mu)).moves is False


def test_its_motion_is_none_with_other_friction() -> None:
    problem = arch(3.0, 1.05)
    start = may_start(problem)
    assert wrong(problem, start) < 1e-6
    assert wrong(arch(2.9, 1.05), start) > 1e-4


@pytest.mark.parametrize(
    ("alpha", "mu"),
    [
        (90, 0.35),
        pytest.param(140, 1.6, marks=pytest.mark.long),
        pytest.param(90, 0.6, marks=pytest.mark.long),
        pytest.param(115, 0.7, marks=pytest.mark.long),
    ],
)
def test_elsewhere_there_is_no_band(alpha: float, mu: float) -> None:
    assert may_start(problem_at(1.001, alpha, mu, 7)).moves is False


def beside(problem: Problem, weight: float) -> Problem:
    """The same with a block at rest on ground of its own, of so many times its weight."""
    table = problem.to_dict()
    total = sum(block.mass for block in problem.assembly.blocks) * 9.81
    table["blocks"] += [
        {"id": "bed", "vertices": [[9, -6], [10, -6], [10, -5], [9, -5]], "fixed": True},
        {
            "id": "other",
            "vertices": [[9, -5], [10, -5], [10, -4], [9, -4]],
            "weight": weight * total,
        },
    ]
    table["joints"] += [{"a": "bed", "b": "other", "ends": [[9, -5], [10, -5]]}]
    return structure_of(table)


@pytest.mark.parametrize(
    "weight", [1e5, *(pytest.param(each, marks=pytest.mark.long) for each in (1e-6, 1.0, 1e9))]
)
def test_what_rests_beside_it_hides_no_motion(weight: float) -> None:
    # Of five voussoirs: seven take six times as long, and are let go below.
    alone, together = arch(3.0, 1.2, 5), beside(arch(3.0, 1.2, 5), weight)
    want, found = may_start(alone), may_start(together)
    assert found.moves
    assert found.power == pytest.approx(want.power, rel=1e-4)
    assert np.abs(found.accelerations[-1]).max() == 0
    assert wrong(together, found) < 1e-6 * max(1.0, weight)


def test_the_motion_is_shown_and_goes_on_in_direct() -> None:
    said = check(beside(arch(3.0, 1.2, 7), 1e5), method="limit", must_rest=True)
    assert (said.verdict.value, said.rest) == ("stands", "can")
    assert said.motion.goes_on
    assert np.abs(said.mechanism[:-1]).max() > 0.1
    assert {joint.state.value for joint in said.joints} > {"closed"}


def test_what_a_heavy_block_that_it_touches_may_hide_is_not_told() -> None:
    """It hangs by friction between a wall and a block 1e5 times as heavy: it may fall."""
    light = between_walls(-0.2, 0.5).to_dict()
    for block in light["blocks"]:
        if block["id"] == "right":
            block.update(fixed=False, weight=1e5)
        if block["id"] == "block":
            block["weight"] = 1.0
    floor = [[0.4, -1.5], [3, -1.5], [3, -0.5], [0.4, -0.5]]
    light["blocks"] += [{"id": "floor", "vertices": floor, "fixed": True}]
    problem = structure_of({"friction": 0.5, "blocks": light["blocks"]})
    assert may_start(problem).moves is not False


def test_two_groups_are_asked_by_themselves() -> None:
    """One that must rest does not hide one that may move, nor does it move with it."""
    problem = beside(between_walls(-0.2, 0.5), 3.0)
    start = may_start(problem)
    assert start.accelerations == pytest.approx(np.array([[0, -1, 0], [0, 0, 0]]), abs=1e-6)
    assert may_start(beside(between_walls(0.3, 0.5), 1e4)).moves is False


def test_below_the_least_thickness_it_moves() -> None:
    problem = arch(3.0, 0.98)
    start = may_start(problem)
    assert start.moves
    assert wrong(problem, start) < 1e-6


def test_check_says_which_of_the_three() -> None:
    problems = [between_walls(lean, 0.5) for lean in (-0.6, -0.4, 0.3)]
    said = [check(each, method="limit", must_rest=True).rest for each in problems]
    assert said == ["cannot", "can", "must"]
    assert check(problems[2], method="limit").rest is None


def test_unbounded_friction_is_refused() -> None:
    with pytest.raises(InputError, match="unbounded"):
        check(arch(3.0, 1.5).with_friction(math.inf), method="limit", must_rest=True)


def test_the_command_says_it() -> None:
    asked = ("--method", "limit", "--must-rest")
    wide = ("--alpha", "155", "--mu", "3", "--voussoirs", "3")
    narrow = ("--alpha", "60", "--mu", "0.9", "--voussoirs", "4")
    words = inside("check", *wide, "--ratio", "1.05", *asked).stdout
    assert "  rest    it can rest, and friction may let it move as well; let go along " in words
    assert answered("check", *narrow, "--ratio", "1.5", *asked)["rest"] == "must"


@pytest.mark.long
def test_two_methods_find_the_same_end_of_the_band(tmp_path: Path) -> None:
    said = import_module("analysis.two_answers").main(tmp_path, processes=1, quick=True)
    assert "2 arches, 1 with a band, the widest of 38.6%" in said
    assert "both ends within 0.1" in said
