"""Vehicles that cross, held against linear programmes of a bridge put together apart."""

import csv
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from own_bridge import Bridge
from running import answered, inside, ran
from scipy.integrate import quad

from blocksim import CircularArch, crossing, vehicle_of
from blocksim.blocks.road import with_dispersal
from blocksim.view.curvefigure import envelope_figure

EIGHT = Bridge(span=8.0, rise=3.0, thick=0.45, count=31, fill=0.5)
"""Eight metres clear under half a metre of fill."""
NEAR = 1e-9
"""How far beside a joint an axle is put, to stand on one voussoir alone [m]."""


def asked(bridge: Bridge, vehicle: str, *more: str) -> dict[str, Any]:
    return answered("bracket", *bridge.options(), "--vehicle", vehicle, *more)


def at(bridge: Bridge, axles: Any, weights: Any) -> float:
    """Load factor of axles straight down, by the bridge's own programme."""
    live = sum(weight * bridge.wheel(x) for x, weight in zip(axles, weights, strict=True))
    return bridge.factor(live) if np.any(live) else math.inf


def test_the_bogie_that_was_worked_out_by_hand() -> None:
    """10 kN and 10 kN, 1.2 m apart, at -1 and -2.2 m: 5.7439; a worse place is near."""
    assert at(EIGHT, (-2.2, -1.0), (10, 10)) == pytest.approx(5.7439, abs=5e-5)
    found = asked(EIGHT, "10@0,10@1.2")
    assert found["low"] == pytest.approx(found["high"], rel=1e-9)
    assert found["high"] < 5.7439
    axles = np.array(found["worst"]["axles_m"])
    beside = [at(EIGHT, axles + shift, (10, 10)) for shift in (-NEAR, NEAR)]
    assert min(beside) == pytest.approx(found["high"], rel=1e-7)


def test_which_axle_stands_where() -> None:
    """Places are those of the axles as they were given, whichever way the vehicle goes."""
    bridge = Bridge(span=4.0, rise=1.5, thick=0.4, count=9, fill=0.5)
    given = "4@0,25@1.3,9@3.1"
    found, weights = asked(bridge, given), (4, 25, 9)
    ways = {
        each["heading"]: each for each in found["places"] if float(each["load_factor"]) < 1e3
    }
    assert set(ways) == {"left", "right"}
    for place in ways.values():
        axles = np.array(place["axles_m"])
        beside = min(at(bridge, axles + shift, weights) for shift in (-NEAR, NEAR))
        assert beside == pytest.approx(place["load_factor"], rel=1e-6)
    said = inside("bracket", *bridge.options(), "--vehicle", given).stdout.split()
    wheel = said.index("25")
    assert float(said[wheel + 3]) == pytest.approx(found["worst"]["axles_m"][1], abs=1e-5)


def test_strength_without_bound_on_friction() -> None:
    """A wheel that has hardly come is small beside what crushes; no joint slides at mu 2."""
    sizes = {"span": 4, "rise": 1.5, "thickness": 0.45, "voussoirs": 5, "fill": 0.5}
    arches = (CircularArch(**sizes, density=22_000, friction=mu) for mu in (math.inf, 2.0))
    at_will, rough = (
        crossing(
            with_dispersal(replace(each.problem(), strength=10e6), "boussinesq"),
            vehicle_of("147@0"),
        ).load_factor
        for each in arches
    )
    assert at_will == pytest.approx(rough, rel=1e-6)


def scan(bridge: Bridge, offsets: Any, weights: Any, places: int) -> float:
    """The least load factor of so many places, evenly and beside every joint, by scipy."""
    tops = bridge.high[:, 0]
    even = np.linspace(tops[0], tops[-1], places)
    beside = (tops[:, None] - np.array(offsets)).ravel()
    every = np.concatenate([even, beside - NEAR, beside + NEAR])
    return min(at(bridge, x + np.array(offsets), weights) for x in every)


def bridges(count: int) -> list[Bridge]:
    """Bridges of all shapes that stand; seeds that fall under their fill are passed over."""
    draw, found = np.random.default_rng(39), list[Bridge]()
    while len(found) < count:
        span = float(draw.uniform(2, 20))
        each = Bridge(
            span=span,
            rise=span * float(draw.uniform(0.12, 0.5)),
            thick=span * float(draw.uniform(0.05, 0.12)),
            count=int(draw.integers(7, 40)),
            fill=float(draw.uniform(0, 0.1)) * span,
            mu=float(draw.uniform(0.4, 1.0)),
            heavy_fill=float(draw.uniform(12, 22)),
        )
        if each.factor(np.zeros((each.count, 3))) == math.inf:
            found.append(each)
    return found


def test_the_worst_place_of_a_wheel_is_found_not_sampled() -> None:
    for bridge in bridges(2):
        found = asked(bridge, "10@0")
        assert found["high"] == pytest.approx(scan(bridge, [0.0], [10.0], 40), rel=1e-6)


@pytest.mark.long
def test_ten_bridges_agree_with_a_scan_of_five_thousand_places() -> None:
    """Of five thousand places none is worse, by few programmes that bound them all.

    A wheel's force and moment on one voussoir are linear in its place x, and the forces that
    balance are a cone. So the reciprocal of the load factor is convex in x there: mixed by
    factors, forces for two places balance the wheel between them. Between the ends of a
    voussoir it is at most the chord, which some places drawn at random are held to.
    """
    draw = np.random.default_rng(5000)
    for bridge in bridges(10):
        tops = bridge.high[:, 0]
        ends = np.stack([tops[:-1] + NEAR, tops[1:] - NEAR], axis=1)
        asks = [[1 / at(bridge, (x,), (10,)) for x in pair] for pair in ends.tolist()]
        places = np.linspace(ends[0, 0], ends[-1, 1], 5000)
        on = np.clip(np.searchsorted(tops, places) - 1, 0, bridge.count - 1)
        chords = [np.interp(x, ends[k], asks[k]) for x, k in zip(places, on, strict=True)]
        for k in draw.choice(5000, 8, replace=False):
            assert 1 / at(bridge, (places[k],), (10,)) <= chords[k] * (1 + 1e-7)
        found = asked(bridge, "10@0")
        assert found["high"] == pytest.approx(1 / np.max(asks), rel=1e-6)
        assert 1 / max(chords) >= found["high"] * (1 - 1e-6)


def test_a_lopsided_vehicle_goes_both_ways() -> None:
    bridge = Bridge(span=5.0, rise=1.4, thick=0.4, count=9, fill=0.2)
    found = asked(bridge, "30@0,10@1.5")
    assert {place["heading"] for place in found["places"]} == {"right", "left"}
    ahead = scan(bridge, [0.0, 1.5], [30.0, 10.0], 60)
    behind = scan(bridge, [0.0, -1.5], [30.0, 10.0], 60)
    assert found["high"] == pytest.approx(min(ahead, behind), rel=1e-6)
    # The bridge is symmetric: neither way is worse.
    assert ahead == pytest.approx(behind, rel=1e-6)


DENSITIES = {
    "1:2": (lambda _: 1.0, 0.5),
    "boussinesq": (lambda t: 2 / math.pi / (1 + t * t) ** 2, math.tan(math.pi / 6)),
}
"""Share of a load along rays of each slope, before it is scaled to carry all of it."""


@pytest.mark.parametrize("dispersal", ["1:2", "boussinesq"])
def test_fill_spreads_a_wheel(dispersal: str) -> None:
    """The bound holds wherever one looks, and the place that was found is as bad as said."""
    bridge = Bridge(span=6.0, rise=1.5, thick=0.4, count=11, fill=0.6)
    density, most = DENSITIES[dispersal]
    whole = quad(density, -most, most)[0]

    def factor(x: float) -> float:
        live = 10 * bridge.spread(x, lambda t: density(t) / whole, most)
        return bridge.factor(live)

    found = asked(bridge, "10@0", "--dispersal", dispersal)
    (x,) = found["worst"]["axles_m"]
    assert factor(x) == pytest.approx(found["high"], rel=1e-7)
    assert found["high"] / found["low"] == pytest.approx(1.0, abs=1.1e-6)
    places = np.concatenate([np.linspace(-2.5, 2.5, 8), x + np.linspace(-0.01, 0.01, 3)])
    assert min(map(factor, places)) >= found["low"] * (1 - 1e-8)
    assert found["high"] > asked(bridge, "10@0")["high"]


def test_a_curve_of_thrust_ends_where_it_falls() -> None:
    """It went on straight, over the places at which there is none."""
    arch = CircularArch(span=8, rise=3, thickness=0.45, voussoirs=15, friction=0.6)
    heavy = crossing(arch.problem(), vehicle_of("60@0"))
    falls = [place.load_factor < 1 for place in heavy.places]
    assert any(falls)
    assert not all(falls)
    figure = envelope_figure(heavy)
    curves = {each.get_gid(): each for axes in figure.axes for each in axes.lines}
    drawn = np.asarray(curves["thrust-max-right"].get_ydata())
    assert np.isnan(drawn).tolist() == falls


KINDS = [
    ("pointed-arch", "--with", "fill=0.1"),
    pytest.param(("arcade",), marks=pytest.mark.long),
    ("portal",),
    ("elliptic-arch",),
]


def is_as_bad_as_said(*subject: str) -> None:
    """At the worst place the load factor is that of the same axle as point loads beside it."""
    found = answered("bracket", *subject, "--vehicle", "5@0")
    (x,) = found["worst"]["axles_m"]
    factors = []
    for place in (x - 1e-7, x + 1e-7):
        point = ("--point-load", repr(place), "5")
        said = inside("bracket", *subject, "--over", "load", *point, "--json")
        if said.returncode == 0:
            factors.append(json.loads(said.stdout)["limit"])
    assert min(factors) == pytest.approx(found["high"], rel=1e-5)


@pytest.mark.parametrize("subject", KINDS, ids=lambda each: each[0])
def test_every_kind_is_crossed(subject: tuple[str, ...]) -> None:
    is_as_bad_as_said(*subject, "--mu", "0.7", "--unit-weight", "20")


def test_files_are_written_in_one_call(tmp_path: Path) -> None:
    done = ran(
        *("bracket", *EIGHT.options(), "--vehicle", "lm1", "--along", "road"),
        *("--out", "e.csv", "--out", "e.svg", "--out", "e.dxf"),
        cwd=tmp_path,
    )
    rows = list(csv.DictReader((tmp_path / "e.csv").read_text().splitlines()))
    assert min(float(row["load_factor"]) for row in rows) == pytest.approx(
        asked(EIGHT, "lm1")["high"], rel=1e-9
    )
    picture = (tmp_path / "e.svg").read_text()
    assert all(name in picture for name in ('id="factor-right"', 'id="worst"', "moved-"))
    assert "least" in done
    assert "EN 1991-2" in done
    assert (tmp_path / "e.dxf").stat().st_size > 1000


@pytest.mark.parametrize("vehicle", ["10@0,10@1.2", "30@0,100@2", "hb30"])
def test_a_picture_shows_all_axles_and_hides_no_curve(vehicle: str) -> None:
    """Legends lie above the curves, and the title within the figure."""
    arch = CircularArch(span=4, rise=1, thickness=0.45, voussoirs=7, friction=0.6)
    figure = envelope_figure(crossing(arch.problem(), vehicle_of(vehicle)))
    figure.draw_without_rendering()
    *curves, drawn = figure.axes
    for axes in curves:
        legend = axes.get_legend().get_window_extent()
        assert legend.y0 >= axes.get_window_extent().y1
        assert legend.y1 <= figure.bbox.y1
    (axles,) = (each for each in drawn.lines if each.get_gid() == "axles")
    (left, right), (low, high) = drawn.get_xlim(), drawn.get_ylim()
    x, y = np.asarray(axles.get_data())
    assert left < x.min() <= x.max() < right
    assert low < y.min() <= y.max() < high
    assert figure.texts[0].get_window_extent().x1 <= figure.bbox.x1
