"""How far friction lets arches move that can rest: a closed form, rows, figure."""

from __future__ import annotations

import csv
import math
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from scipy.optimize import brentq

study = import_module("analysis.two_answers")
FIGURES = Path(__file__).parent.parent / "analysis" / "figures"


def rows(name: str) -> list[dict[str, str]]:
    """Rows of a study as they are kept."""
    with (FIGURES / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


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
