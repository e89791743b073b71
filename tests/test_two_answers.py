"""How far friction lets arches and walls move that can rest: closed forms, rows, figure."""

from __future__ import annotations

import csv
import math
from collections import Counter
from dataclasses import replace
from importlib import import_module
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from structure_cases import case, scenes

from blocksim.blocks.structure import structure_of
from blocksim.engines.contact.coulomb import OPEN, SLIDES_UP

study = import_module("analysis.two_answers")
keystone = import_module("analysis.keystone")
slipping = import_module("analysis.slipping")
walls = import_module("analysis.walls_two_answers")
FIGURES = Path(__file__).parent.parent / "analysis" / "figures"


def rows(name: str) -> list[dict[str, str]]:
    """Rows of a study as they are kept."""
    with (FIGURES / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def case_of(row: dict[str, str]) -> object:
    """The arch of a row."""
    numbers = float(row["alpha_deg"]), float(row["mu"])
    return study.Case(int(row["voussoirs"]), row["weight"], *numbers)


def test_the_closed_form_is_where_branch_and_bound_ends_the_band() -> None:
    held = 0
    for row in rows("two_answers"):
        arch, least = case_of(row), float(row["eta_limit"])
        if arch.voussoirs % 2 == 0 or arch.alpha_deg < 140 or keystone.wedge(arch) < 1:
            continue
        end = keystone.end(arch, least)
        if end is None or not keystone.rest_holds(arch, end * keystone.BEYOND):
            continue
        held += 1
        if row["band"] == "False":
            # The one whose band does not begin at the least thickness.
            assert (row["weight"], arch.alpha_deg, arch.mu) == keystone.APART[0][1:]
            continue
        assert float(row["eta_moves"]) == pytest.approx(end, rel=5e-4), row
        assert float(row["eta_rests"]) > end * (1 - 1e-9), row
    assert held >= 25


def test_the_end_is_that_of_two_balances_written_out() -> None:
    # Centreline weights: W = 2a of the keystone at its centroid, in units of gamma t r^2.
    arch = study.Case(7, "centreline", 155.0, 3.0)
    alpha = math.radians(155)
    a, mu = alpha / 7, arch.mu
    least = study.limit_of(arch)[0]
    end = keystone.end(arch, least)
    inner, outer = 1 - end / 2, 1 + end / 2
    c = (math.cos(a) - mu * math.sin(a)) / (math.sin(a) + mu * math.cos(a))
    borne = (
        2 * a * inner * math.sin(a)
        / ((inner + outer) * math.sin(a) + c * (outer - inner) * math.cos(a))
    )  # fmt: skip
    # The half's weight about the outer corner of the springing, against -(cF, F) at C.
    overturns = (math.cos(a) - math.cos(alpha)) - (alpha - a) * outer * math.sin(alpha)
    across, up = math.sin(alpha) - math.sin(a), math.cos(a) - math.cos(alpha)
    assert overturns == pytest.approx(borne * outer * (across - c * up), rel=1e-9)


@pytest.mark.parametrize(("n", "alpha_deg"), [(7, 155.0), (15, 152.5), (101, 157.5)])
def test_a_half_stands_alone_from_its_closed_form_on(n: int, alpha_deg: float) -> None:
    alpha = math.radians(alpha_deg)
    a = alpha / n
    closed = 2 * (math.cos(a) - math.cos(alpha)) / ((alpha - a) * math.sin(alpha)) - 2
    found = keystone.half_alone(study.Case(n, "centreline", alpha_deg, 3.0), 0.5)
    assert found == pytest.approx(closed, rel=1e-9)


def test_friction_holds_the_keystone_exactly_from_where_its_cone_has_the_vertical() -> None:
    seen = Counter[bool]()
    for n, alpha, share in product(
        (5, 7, 15), (147.5, 155.0), (0.7, 0.9, 0.99, 1.01, 1.2, 2.0)
    ):
        mu = share / math.tan(math.radians(alpha) / n)
        arch = study.Case(n, "centreline", alpha, mu)
        end = keystone.end(arch, 0.3)
        if end is None:
            continue
        key = keystone.Keystone(arch.problem(end))
        assert (key.slide.needed <= 1) is (share >= 1), arch
        if share >= 1 and alpha * (1 + 1 / n) < 180:
            assert key.overturning > 0
        seen[share >= 1] += 1
    assert min(seen[True], seen[False]) > 10


def test_a_band_may_begin_above_the_least_thickness() -> None:
    arch = study.Case(*keystone.APART[0])
    least = study.limit_of(arch)[0]
    end = keystone.end(arch, least)
    asked = [study.may_start(arch.problem(eta)).moves for eta in (0.9 * end, 0.9997 * end)]
    assert least < 0.85 * end
    assert asked == [False, True]


@pytest.mark.parametrize("n", [7, 101])
def test_the_solver_of_direct_keeps_the_motion_of_the_keystone(n: int) -> None:
    arch = study.Case(n, "centreline", 155.0, 1.2 / math.tan(math.radians(155) / n))
    end = keystone.end(arch, study.limit_of(arch)[0])
    below, above = arch.problem(0.998 * end), arch.problem(1.002 * end)
    begun = keystone.Keystone(below).solution()
    found = study.settled(below, begun, keystone.POWER)
    assert found.acceleration == pytest.approx(begun.acceleration, rel=1e-6, abs=1e-12)
    middle = n // 2
    assert found.contacts[middle].tolist() == [OPEN, SLIDES_UP]
    assert found.contacts[middle + 1, 1] == OPEN
    assert study.settled(above, begun, keystone.POWER) is None


def test_rows_of_the_keystone_agree_for_all_numbers_of_voussoirs() -> None:
    held = [row for row in rows("keystone") if row["rest_holds"] == "True"]
    for row in held:
        assert float(row["eta_followed"]) == pytest.approx(float(row["eta_end"]), rel=1e-4)
        assert float(row["eta_limit"]) < float(row["eta_end"])
        if float(row["alpha_deg"]) * (1 + 1 / int(row["voussoirs"])) < 180:
            assert float(row["eta_end"]) < float(row["eta_half"])
    wide = {
        n: max(
            float(row["eta_end"]) / float(row["eta_limit"]) - 1
            for row in held
            if row["voussoirs"] == n and row["alpha_deg"] == "155.0"
        )
        for n in ("27", "101")
    }
    # It shrinks as 1/n.
    assert wide["27"] / wide["101"] == pytest.approx(101 / 27, rel=0.15)


def test_a_block_that_slides_moves_from_its_friction_on() -> None:
    (scene,) = scenes("block_slides")
    problem = structure_of({**scene, "live": [{"body": [1, 0]}]})
    mu = float(problem.friction[0])
    law = slipping.Law(problem)
    found = law.walk(np.random.default_rng(0), np.ones(len(problem.friction)))
    assert found.factor == pytest.approx(mu, rel=1e-9)
    assert slipping.wrong(problem, found) < 1e-9


@pytest.mark.parametrize("number", [1, 3])
def test_a_wall_may_move_where_the_literature_says(number: int) -> None:
    row = walls.ask(walls.Beginning(number, 0))
    known = case(f"ferris_tinloi_{number}")["expected"]
    assert row["limit"] == pytest.approx(known["value"], rel=1e-9)
    assert row["moves"] <= known["nonassociated_upper_bound"] + 1e-6
    assert row["wrong"] < 1e-9
    assert row["direct"] == pytest.approx(row["moves"], rel=2e-4)


def test_a_wrong_motion_of_a_wall_would_be_seen() -> None:
    problem = walls.WALLS[0].problem()
    law = slipping.Law(problem)
    pressure = walls.collapse(problem).forces[..., 0].sum(axis=1)
    found = law.walk(np.random.default_rng(0), pressure)
    assert slipping.wrong(problem, found) < 1e-9
    changes = {
        "balance": replace(found, factor=0.999 * found.factor),
        "friction": replace(found, friction=1.01 * found.friction),
        "rates": replace(found, rates=found.rates * [1, -1, 1]),
        "pressure": replace(found, pressure=found.pressure[:, ::-1]),
    }
    for name, changed in changes.items():
        assert slipping.wrong(problem, changed) > 1e-4, name
    # The associated motion of the linear programme opens joints that slide.
    dilating = walls.collapse(problem).mechanism
    assert slipping.wrong(problem, replace(found, rates=dilating)) > 1e-3


def test_rows_of_the_walls_meet_what_is_known() -> None:
    kept = rows("walls_two_answers")
    for wall in walls.WALLS:
        expected = case(f"ferris_tinloi_{wall.number}")["expected"]
        mine = [row for row in kept if row["wall"] == str(wall.number) and row["moves"]]
        best = min(float(row["moves"]) for row in mine)
        assert float(mine[0]["limit"]) == pytest.approx(expected["value"], rel=1e-9)
        assert wall.known == expected["nonassociated_upper_bound"]
        assert best <= (wall.known or expected["value"]) + 1e-6
        assert max(float(row["wrong"]) for row in mine) < 1e-6


def test_the_map_has_bands_lines_and_marks() -> None:
    drawn = import_module("analysis.two_answers_map")

    def row(
        n: int, alpha: float, mu: float, end: float | None, weight: str
    ) -> dict[str, object]:
        return {"voussoirs": n, "weight": weight, "alpha_deg": alpha, "mu": mu,
                "eta_limit": 1.0, "eta_moves": end}  # fmt: skip

    asked = [row(7, 155.0, mu, 1.4 if mu > 2 else None, "centreline") for mu in (3.0, 2.0, 5.0)]
    asked += [row(15, 155.0, 6.0, 1.2, "centreline"), row(27, 151.0, 10.0, 1.1, "centreline")]
    asked += [row(8, 155.0, 3.0, None, "centreline"), row(7, 90.0, 0.6, None, "centreline")]
    asked += [row(7, 150.0, mu, 1.5, "sector") for mu in (2.0, 3.0, 5.0)]
    figure = drawn.draw(asked)
    left, right = figure.axes
    phi = [math.degrees(math.atan(mu)) for mu in (2.0, 3.0, 5.0, 6.0, 10.0)]
    lines = {line.get_label(): line for line in left.lines if "°" in str(line.get_label())}
    assert set(lines) == {"155° least", "155° end", "15 voussoirs, 155°", "27 voussoirs, 151°",
                          "8 voussoirs, 155°, none"}  # fmt: skip
    least, end = lines["155° least"], lines["155° end"]
    assert least.get_xydata().tolist() == pytest.approx(np.c_[phi[:3], [1.0, 1.0, 1.0]])
    assert end.get_xydata().tolist() == pytest.approx(np.c_[phi[:3], [1.0, 1.4, 1.4]])
    assert (least.get_linestyle(), end.get_linestyle()) == ("-", "--")
    assert least.get_color() == end.get_color() == drawn.colour_of(155.0)
    assert drawn.colour_of(155.0) != drawn.colour_of(150.0)
    marks = {label: line.get_marker() for label, line in lines.items() if "vou" in str(label)}
    assert sorted(marks.values()) == ["D", "s", "x"]
    fifteen = lines["15 voussoirs, 155°"].get_xydata().tolist()
    assert fifteen == pytest.approx(np.array([[phi[3], 1.0], [phi[3], 1.2]]))
    assert {line.get_label() for line in right.lines if "°" in str(line.get_label())} == {
        "150° least", "150° end"}  # fmt: skip
    for axes in (left, right):
        regions = {str(each.get_gid()) for each in axes.collections}
        assert {"region-rrr", "region-rrs", "region-rs", "region-ss"} <= regions
        assert {"rrr", "rrs", "rs", "ss"} <= {text.get_text() for text in axes.texts}
        assert axes.get_xlim() == (drawn.LEFT, 90.0)
    (band,) = (each for each in left.collections if each.get_gid() is None)
    assert to_rgba(band.get_facecolor()[0])[:3] == pytest.approx(drawn.colour_of(155.0)[:3])
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "150°", "155°", "15 voussoirs", "27 voussoirs", "7, single", "no band"]  # fmt: skip


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
