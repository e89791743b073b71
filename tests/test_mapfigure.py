"""The mode map with arches on it: where marks are, which are named, what the legend says."""

import math
from itertools import combinations, pairwise

import numpy as np
import pytest
from arches import least
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Annotation, Text

from blocksim import Mode, theory
from blocksim.view.linemap import line_map_figure
from blocksim.view.mapfigure import LARGEST_MU, MapPoint, map_figure
from blocksim.view.mapshapes import ISO_DEGREES, iso_angles, map_shapes
from blocksim.view.style import ISO, MISS, MODES

# As published: figures 20 to 25, Table 1, and an arch that slides at any thickness.
ARCHES = {
    "8": (1.7772, 0.9652, Mode.RS),
    "9": (1.833, 0.9563, Mode.RRS),
    "10": (1.79, 0.9631, Mode.RSR),
    "11": (3.386, 0.8679, Mode.RRS),
    "12": (1.8096, 0.9999, Mode.RS),
    "13": (2.69, 1.964, Mode.RS),
    "14": (math.inf, 1.0, Mode.R),
    "15": (math.inf, 2.0, Mode.R),
    "16": (0.6, 0.2981, Mode.SRR),
    "18": (0.6, 0.031, Mode.RRR),
    "19": (0.7, 0.107, Mode.RRR),
    "20": (0.3, 2.0, Mode.SS),
    "21": (0.35, 0.1529, Mode.SRR),
    "24": (1.7659, 0.9533, Mode.RRS),
}
CROWD = {"8", "9", "10", "12", "24"}


@pytest.fixture(scope="module")
def drawn() -> Figure:
    points = [
        MapPoint(
            mu=mu,
            eta=eta,
            mode=mode,
            label=label,
            miss=label in {"10", "15"},
            note=f"arch {label}",
            engine="pymunk",
            none_stands=label == "20",
        )
        for label, (mu, eta, mode) in ARCHES.items()
    ]
    figure = map_figure(points)
    figure.draw_without_rendering()
    return figure


def labels(axes: Axes) -> dict[str, Text]:
    return {text.get_text(): text for text in axes.texts if text.get_text().isdigit()}


def marks(axes: Axes, mode: Mode) -> list[tuple[float, float]]:
    return [
        (float(line.get_xdata()[0]), float(line.get_ydata()[0]))
        for line in axes.lines
        if line.get_marker() == MODES[mode].marker and len(line.get_xdata()) == 1
        and to_hex(line.get_markerfacecolor()) == MODES[mode].colour.lower()
    ]  # fmt: skip


def parts(figure: Figure) -> tuple[Axes, Axes]:
    """The map, and its enlarged part."""
    (axes,) = figure.axes
    (near,) = axes.child_axes
    return axes, near


def test_arches_near_j_are_named_where_they_are_enlarged(drawn: Figure) -> None:
    axes, near = parts(drawn)
    assert set(labels(near)) == CROWD
    assert set(labels(axes)) == set(ARCHES) - CROWD


def test_labels_are_beside_their_marks_and_hide_none(drawn: Figure) -> None:
    for axes in parts(drawn):
        boxes = {name: text.get_window_extent() for name, text in labels(axes).items()}
        for one, two in combinations(boxes.values(), 2):
            assert not one.overlaps(two)
        places = {name: axes.transData.transform(labels(axes)[name].xy) for name in boxes}
        for name, box in boxes.items():
            middle = (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2
            near = {other: math.dist(middle, place) for other, place in places.items()}
            assert min(near, key=near.__getitem__) == name


def test_no_label_is_on_the_axis_below(drawn: Figure) -> None:
    for axes in parts(drawn):
        bottom = axes.get_window_extent().y0
        assert all(text.get_window_extent().y0 > bottom for text in labels(axes).values())


def test_no_label_and_no_name_is_on_a_line(drawn: Figure) -> None:
    shapes = map_shapes()
    for axes in parts(drawn):
        names = [text for text in axes.texts if text.get_text() in set(Mode)]
        assert len(names) > 3
        boxes = [text.get_window_extent() for text in [*labels(axes).values(), *names]]
        # In the strip of unbounded friction there are no lines.
        right = axes.transData.transform((LARGEST_MU, 0))[0]
        for curve in shapes.lines.values():
            order = np.argsort(curve.mu)
            mu = np.linspace(curve.mu.min(), curve.mu.max(), 20_000)
            eta = np.interp(mu, curve.mu[order], curve.eta[order])
            points = axes.transData.transform(np.column_stack([mu, eta]))
            for box in boxes:
                on = (points > (box.x0, box.y0)) & (points < (box.x1, box.y1))
                assert box.x0 > right or not on.all(axis=1).any()


def test_the_enlarged_part_keeps_off_the_rest(drawn: Figure) -> None:
    """Numbers on its axes are right of the map's own axis, and off the map's letters."""
    axes, near = parts(drawn)
    ticks = [text for axis in (near.xaxis, near.yaxis) for text in axis.get_ticklabels()]
    letters = [text.get_window_extent() for text in axes.texts if text.get_text() in "TSJB"]
    assert {text.get_text() for text in ticks} >= {"1.7", "1.9", "0.92", "1.02"}
    for box in (text.get_window_extent() for text in ticks):
        assert box.x0 > axes.get_window_extent().x0 + 2
        assert not any(box.overlaps(letter) for letter in letters)


def test_rsr_can_be_read(drawn: Figure) -> None:
    """Its name lies within the region, which is higher there than the name."""
    _, near = parts(drawn)
    (name,) = [text for text in near.texts if text.get_text() == "rsr"]
    box = near.transData.inverted().transform(name.get_window_extent())
    mark = theory.landmarks()["S"]
    assert mark.eta < box[0][1] < box[1][1] < 0.9705


def test_no_mark_is_cut_at_the_frame(drawn: Figure) -> None:
    axes, _ = parts(drawn)
    single = [line for line in axes.lines if len(line.get_xdata()) == 1]
    assert len(single) > len(ARCHES)
    assert not any(line.get_clip_on() for line in single)


def test_unbounded_friction_has_its_own_place(drawn: Figure) -> None:
    axes, _ = parts(drawn)
    ticks = {tick.get_text(): x for tick, x in zip(axes.get_xticklabels(), axes.get_xticks(),
                                                   strict=True)}  # fmt: skip
    assert ticks["∞"] > LARGEST_MU
    assert marks(axes, Mode.R) == [(ticks["∞"], 1.0), (ticks["∞"], 2.0)]


def test_what_never_stands_is_said_to(drawn: Figure) -> None:
    """An arrow upwards from the frame, and a word in the legend."""
    axes, _ = parts(drawn)
    arrows = [text for text in axes.texts if text.get_text() == "" and text.arrow_patch]
    assert [tuple(arrow.xy) for arrow in arrows] == [(0.3, 2.0)]
    words = [text.get_text() for text in drawn.legends[0].get_texts()]
    assert "20  arch 20: no thickness stands" in words
    assert sum("no thickness" in word for word in words) == 1
    assert "bracket" not in drawn.legends[0].get_title().get_text()


def test_misses_are_ringed(drawn: Figure) -> None:
    rings = {
        (round(float(line.get_xdata()[0]), 3), float(line.get_ydata()[0]))
        for axes in parts(drawn)
        for line in axes.lines
        if to_hex(line.get_markeredgecolor()) == MISS and line.get_markersize() > 15
    }
    assert {eta for _, eta in rings} == {0.9631, 2.0}


def test_the_legend_names_modes_that_are_there() -> None:
    point = MapPoint(mu=1.0, eta=0.3, mode=Mode.RRR, label="1", miss=False, note="one")
    figure = map_figure([point])
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert [word.split()[0] for word in words] == ["rrr", "1"]
    assert not figure.axes[0].child_axes


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
