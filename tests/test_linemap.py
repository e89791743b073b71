"""The map as lines: what is drawn of each half-angle, and which label names it (Figs 6-8)."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from arches import least
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Annotation

from blocksim.view.linemap import line_map_figure
from blocksim.view.mapshapes import ISO_DEGREES, iso_angles
from blocksim.view.style import ISO

ROUND = {"60°", "90°", "110°", "125°", "135°", "145°", "155°"}
# T, J, eta = 1 on the divide, B, alpha_l and alpha_L as the paper prints them [rad].
PRINTED = {
    "142.504°": 2.487161163767182,
    "149.156°": 2.603266515104794,
    "149.646°": 2.611810358168302,
    "158.949°": 2.774176793356034,
    "151.742°": 2.648388899151005,
    "159.655°": 2.786498150651177,
}


@pytest.fixture(scope="module")
def whole() -> Figure:
    figure = line_map_figure()
    figure.draw_without_rendering()
    return figure


def lines(figure: Figure, kind: str) -> dict[str, Line2D]:
    """Lines of equal half-angle by name, those that are drawn."""
    drawn = {str(line.get_gid()): line for line in figure.axes[0].lines}
    return {
        gid.removeprefix(f"{kind} "): line
        for gid, line in drawn.items()
        if gid.startswith(f"{kind} ")
    }


def named(figure: Figure) -> dict[str, Annotation]:
    return {
        text.get_text(): text for text in figure.axes[0].texts if text.get_text().endswith("°")
    }


def test_special_angles_are_those_printed() -> None:
    found = iso_angles()
    for published in PRINTED.values():
        assert min(abs(angle - published) for angle in found) < 1e-12
    assert len(found) == len(ROUND) + len(PRINTED)
    for degrees in ISO_DEGREES:
        assert min(abs(math.degrees(angle) - degrees) for angle in found) < 1e-3


def test_every_half_angle_has_its_line_and_its_label(whole: Figure) -> None:
    """Solid where feasible, dashed beyond; alpha_L is feasible at unbounded friction only."""
    solid, dashed = lines(whole, "feasible"), lines(whole, "infeasible")
    assert set(solid) == ROUND | set(PRINTED) - {"159.655°"}
    # At T no mode is mixed: there is nothing between turning and sliding.
    assert set(dashed) == ROUND | set(PRINTED) - {"142.504°"}
    assert {line.get_linestyle() for line in solid.values()} == {"-"}
    assert {line.get_linestyle() for line in dashed.values()} == {"--"}
    assert {to_hex(line.get_color()) for line in [*solid.values(), *dashed.values()]} == {
        ISO.lower()
    }
    assert set(named(whole)) == ROUND | set(PRINTED)


def test_lines_are_where_theory_has_them(whole: Figure) -> None:
    for name, line in lines(whole, "feasible").items():
        angle = PRINTED.get(name) or math.radians(float(name[:-1]))
        mu, eta = np.asarray(line.get_data(), dtype=float)[:, 5::97]
        for friction, height in zip(mu, eta, strict=True):
            exact = least(angle, float(friction)).eta_theory
            assert exact == pytest.approx(height, rel=1e-9)


def test_labels_are_beside_the_lines_they_name(whole: Figure) -> None:
    """On the right, each at the end of its line or led to it, none over another."""
    axes = whole.axes[0]
    shown = {**lines(whole, "infeasible"), **lines(whole, "feasible")}
    places = []
    for name, label in named(whole).items():
        end = np.asarray(shown[name].get_data())[:, -1]
        assert tuple(label.xy) == pytest.approx(tuple(end), abs=1e-12)
        box = label.get_window_extent()
        _, height = axes.transData.transform(end)
        assert abs((box.y0 + box.y1) / 2 - height) < 12
        places.append((box.y0, box.y1))
    places.sort()
    assert all(one[1] < two[0] for one, two in pairwise(places))


@pytest.mark.parametrize(("span", "above"), [((0.0, 1.0), 0), ((0.6, 2.0), 5)])
def test_zooms_draw_and_name_what_is_in_them(span: tuple[float, float], above: int) -> None:
    """Figs 7 and 8; arches that only stand upright in a picture are named above it."""
    figure = line_map_figure(span)
    figure.draw_without_rendering()
    solid = lines(figure, "feasible")
    for line in solid.values():
        eta = np.asarray(line.get_ydata(), dtype=float)
        assert eta.min() <= span[1]
        assert eta.max() >= span[0]
    labels = named(figure)
    assert set(labels) >= set(solid) - {"151.742°"}
    assert sum(label.get_rotation() == 90 for label in labels.values()) == above
