"""Every figure of the paper: what is drawn in it, beside what the paper prints."""

import math
import re
from functools import cache
from pathlib import Path

import derivations
import numpy as np
import pytest
from derivations import PAPER
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from running import csv_rows, ran
from windows import Windows

from blocksim import Mode, theory
from blocksim.arch.theory import equations
from blocksim.studies import paper as study
from blocksim.view.paper import paper_figure
from blocksim.view.papersketches import FRICTION_SHOWN, HALF_DEPTH, RATE, moved_block
from blocksim.view.style import FRICTION, MECHANISM, THRUST

TABLE = PAPER["table1"]
CAPTIONS = PAPER["captions"]
RED = "#c00000"
PHI = {
    13: (40.3, 42.8), 14: (40.3, 42.8), 15: (56.9, 60.4), 16: (56.9, 60.4), 17: (58.0, 42.0),
    18: (54.8, 54.8), 19: (54.8, 54.8), 20: (60.6, 60.6), 21: (60.8, 61.4), 22: (73.5, 73.5),
    23: (61.1, 61.1), 24: (69.6, 69.6), 25: (90.0, 90.0),
}  # fmt: skip
"""Friction angles of the captions, from the top down; Fig. 22 prints 73.6, a misprint."""


@cache
def drawn(number: int) -> Figure:
    return paper_figure(number)


def line(axes: object, name: str) -> np.ndarray:
    """The points of the one line of a label or gid, (k, 2)."""
    (found,) = [each for each in axes.lines if name in {each.get_label(), each.get_gid()}]  # type: ignore[attr-defined]
    return np.column_stack(found.get_data())


def at(points: np.ndarray, x: float) -> float:
    """Height of a line at x."""
    return float(np.interp(x, points[:, 0], points[:, 1]))


def arrows(figure: Figure, gid: str) -> list[tuple[np.ndarray, np.ndarray]]:
    """Tail and head of each arrow of a gid."""
    return [
        (np.array(text.xyann), np.array(text.xy))
        for text in figure.axes[0].texts
        if text.get_gid() == gid
    ]


def hinges(lines: list[Line2D]) -> np.ndarray:
    """Where hinges are marked, in order."""
    found = [each.get_xydata()[0] for each in lines if "hinge" in each.get_label()]
    return np.array(sorted(found, key=tuple))


def test_fig_1_has_the_measures_of_the_arch() -> None:
    figure = drawn(1)
    ((centre, head),) = arrows(figure, "radius")
    assert np.hypot(*centre) == 0
    assert np.hypot(*head) == pytest.approx(1)
    ((inner, outer),) = arrows(figure, "thickness")
    middle = (np.hypot(*inner) + np.hypot(*outer)) / 2
    thickness = np.hypot(*outer) - np.hypot(*inner)
    assert middle == pytest.approx(1)
    (arch,) = [each for each in figure.axes[0].patches if each.get_gid() == "arch"]
    radii = np.hypot(*np.asarray(arch.get_path().vertices).T)
    assert (radii.min(), radii.max()) == pytest.approx((1 - thickness / 2, 1 + thickness / 2))
    ((start, end),) = arrows(figure, "weight")
    assert start[0] == end[0]
    assert start[1] > end[1]
    words = " ".join(text.get_text() for text in figure.axes[0].texts)
    for symbol in (r"$\alpha$", r"$\beta$", "$r$", "$t$", r"\gamma", "$d$"):
        assert symbol in words


def test_fig_2_is_the_rotational_mode_with_its_reactions() -> None:
    """The semicircle: eta 0.107426 and beta_r 54.5 deg (Cocchetti and Rizzi 2020)."""
    figure = drawn(2)
    points = hinges(figure.axes[0].lines)
    assert len(points) == 5
    outer = 1 + 0.107426 / 2
    assert points[[0, 2, 4]] == pytest.approx(
        np.array([[-outer, 0], [0, outer], [outer, 0]]), abs=1e-6
    )
    ray = line(figure.axes[0], "ray of the inner hinge")[-1]
    assert tuple(ray) == pytest.approx(tuple(points[3]))
    assert math.degrees(math.atan2(*ray)) == pytest.approx(54.5, abs=0.05)
    for name, way in (("reaction V", (0, 1)), ("reaction H", (1, 0))):
        (left, right) = arrows(figure, name)
        assert tuple(left[1]) == pytest.approx(tuple(points[0]))
        assert tuple(right[1]) == pytest.approx(tuple(points[4]))
        # Both push: up, and towards the middle.
        for (tail, head), side in ((left, 1), (right, -1)):
            step = head - tail
            push = (side if way[0] else 1) * step
            assert push[0] * way[0] + push[1] * way[1] == pytest.approx(np.hypot(*step))
    shown = [each for each in figure.axes[0].lines if each.get_visible()]
    assert not [each for each in shown if each.get_label() == "line of friction"]


@pytest.mark.parametrize("panel", range(3))
def test_fig_3_tells_both_branches_apart(panel: int) -> None:
    axes = drawn(3).axes[panel]
    upper, lower = line(axes, "eq. (7), upper signs"), line(axes, "eq. (7), lower signs")
    colours = {to_hex(each.get_color()) for each in axes.lines if "eq" in str(each.get_label())}
    assert len(colours) == 2
    assert axes.get_xlim() == pytest.approx((0, math.pi))
    constants = PAPER["constants"]
    assert upper[0, 0] == 0
    assert lower[-1, 0] == pytest.approx(constants["alpha_l"], rel=1e-12)
    # They meet where the term under the root vanishes, and so its round-off is a root.
    assert tuple(upper[-1]) == pytest.approx(tuple(lower[0]), rel=1e-7)
    assert upper[-1, 0] == pytest.approx(constants["alpha_sbeta"], rel=1e-12)
    name = ("beta_r", "eta", "thrust")[panel]
    ends = {"beta_r": (0, 0), "eta": (0, 1), "thrust": (1, 0)}[name]
    assert (upper[0, 1], lower[-1, 1]) == ends
    if name == "beta_r":
        assert upper[-1, 1] == pytest.approx(constants["beta_sbeta"], rel=1e-12)
    symbol = {"beta_r": "beta_r_T", "eta": "eta_T", "thrust": "h_T"}[name]
    assert at(lower, constants["alpha_T"]) == pytest.approx(constants[symbol], rel=1e-3)
    # The solver of least thickness knows nothing of eq. (7).
    for alpha, value in [*upper[40::31], *lower[5:-5:31]]:
        found = getattr(theory.least_thickness(float(alpha), math.inf), name)
        assert found == pytest.approx(value, rel=1e-6, abs=1e-9)


def test_fig_4_begins_without_friction() -> None:
    thrust, angle = drawn(4).axes
    for axes, symbol, first in ((thrust, "h", 1.0), (angle, "beta_s", 0.0)):
        (curve,) = [np.column_stack(each.get_data()) for each in axes.lines]
        assert to_hex(axes.lines[0].get_color()) == RED
        assert tuple(curve[0]) == (0.0, first)
        assert axes.get_xlim()[0] == 0
        assert axes.get_ylim()[0] == 0
        for mark in TABLE.values():
            assert at(curve, mark["mu"]) == pytest.approx(mark[symbol], rel=1e-3)
    # beta_s = sqrt(h (1 - h)) is at most a half.
    assert angle.lines[0].get_ydata().max() == pytest.approx(0.5, abs=1e-4)


def test_fig_5_goes_from_0_to_pi_and_is_dashed_beyond_eta_2() -> None:
    figure = drawn(5)
    for axes, symbol in zip(figure.axes, ("beta_s", "mu", "h"), strict=True):
        solid = line(axes, "purely sliding")
        dashed = line(axes, "purely sliding, beyond η = 2")
        assert axes.get_xlim() == pytest.approx((0, math.pi))
        assert solid[0, 0] == 0
        assert dashed[-1, 0] == pytest.approx(math.pi)
        end = TABLE["B"]["alpha"]
        assert solid[-1, 0] <= end <= dashed[0, 0]
        assert dashed[0, 0] - solid[-1, 0] < 0.02
        for mark in TABLE.values():
            whole = np.concatenate([solid, dashed])
            assert at(whole, mark["alpha"]) == pytest.approx(mark[symbol], rel=2e-3)
        styles = {
            str(each.get_label()): (each.get_linestyle(), to_hex(each.get_color()))
            for each in axes.lines
        }
        assert styles["purely sliding"] == ("-", RED)
        assert styles["purely sliding, beyond η = 2"] == ("--", RED)
    ends = {"beta_s": (0, 0), "h": (1, 0)}
    for place, symbol in ((0, "beta_s"), (2, "h")):
        axes = figure.axes[place]
        assert line(axes, "purely sliding")[0, 1] == ends[symbol][0]
        assert line(axes, "purely sliding, beyond η = 2")[-1, 1] == ends[symbol][1]


def test_fig_5_has_the_rotational_thrust_which_crosses_at_t() -> None:
    figure, mark = drawn(5), TABLE["T"]
    names = [[str(each.get_label()) for each in axes.lines] for axes in figure.axes]
    assert ["purely rotational" in each for each in names] == [False, False, True]
    slides = line(figure.axes[2], "purely sliding")
    (turns,) = [
        np.column_stack(each.get_data())
        for each in figure.axes[2].lines
        if each.get_label() == "_" and len(each.get_xdata()) > 2
    ]
    above = at(turns, mark["alpha"] - 0.01) - at(slides, mark["alpha"] - 0.01)
    below = at(turns, mark["alpha"] + 0.01) - at(slides, mark["alpha"] + 0.01)
    assert above > 1e-4
    assert below < -1e-4
    (point,) = [
        each.get_xydata()[0] for each in figure.axes[2].lines if each.get_marker() == "o"
    ]
    assert tuple(point) == pytest.approx((mark["alpha"], mark["h"]))


@pytest.mark.parametrize(("number", "span"), [(6, (0, 2)), (7, (0, 1)), (8, (0.6, 2))])
def test_figs_6_to_8_have_their_range_and_eta_1(number: int, span: tuple) -> None:
    axes = drawn(number).axes[0]
    assert axes.get_ylim() == pytest.approx(span)
    assert set(line(axes, "asymptote")[:, 1]) == {1.0}
    names = {text.get_text() for text in axes.texts}
    assert names >= {name for name in "TSJB" if span[0] <= TABLE[name]["eta"] <= span[1]}
    told = {text.get_text() for text in drawn(number).legends[0].get_texts()}
    assert {r"$\mu=\mu_{ss}=\mu_{is}$", r"$\beta_r=\beta_s$", r"$\beta_r=0$"} <= told


# An arch of each region off its lines: half-angle and friction.
SAMPLES = {
    Mode.RRR: (2.0, 2.0), Mode.SRR: (math.radians(125), 0.9),
    Mode.RRS: (math.radians(145), 1.6), Mode.RSR: (TABLE["J"]["alpha"], 1.79),
    Mode.RS: (2.7, 3.0),
}  # fmt: skip


@pytest.mark.parametrize("mode", [*SAMPLES])
def test_fig_9_says_the_equations_that_rule(mode: Mode) -> None:
    """Those written into a region hold there, and the others do not."""
    alpha, mu = SAMPLES[mode]
    found = theory.least_thickness(alpha, mu)
    assert found.modes == (mode,)
    eta, h, beta = found.eta, found.thrust, found.beta_r
    thrusts = {
        "h_L": derivations.lower_thrust(beta, eta),
        "h_U": derivations.upper_thrust(alpha, beta, eta),
        "h_2": derivations.whole_thrust(alpha, eta),
        "h_e": derivations.tangency_thrust(beta or 1e-9, eta),
    }
    frictions = {
        r"\mu_{ss}": equations.shoulder_friction(alpha, h),
        r"\mu_{is}": equations.inner_friction(h),
    }
    holds = {name for name, value in thrusts.items() if abs(value - h) < 1e-10}
    holds |= {name for name, value in frictions.items() if abs(value - mu) < 1e-10}
    (note,) = [text for text in drawn(9).axes[0].texts if text.get_gid() == f"equations {mode}"]
    said = note.get_text()
    assert {name for name in (*thrusts, *frictions) if name in said} == holds
    order = {r"\geq": beta >= (found.beta_s or 0), r"\leq": beta <= (found.beta_s or 9)}
    for sign, true in order.items():
        assert true or sign not in said
    assert (r"\beta_r=0" in said) is (beta == 0)


@pytest.mark.parametrize("number", [9, 10, 11])
def test_figs_9_to_11_have_the_six_regions_in_their_order(number: int) -> None:
    axes = drawn(number).axes[0]
    fills = {
        str(each.get_gid()).removeprefix("region-"): each.get_paths()[0]
        for each in axes.collections
        if str(each.get_gid()).startswith("region")
    }
    assert set(fills) == {"rrr", "ss", "srr", "rrs", "rsr", "rs"}

    def upwards(mu: float) -> list[str]:
        points = np.column_stack([np.full(2000, mu), np.linspace(0.001, 1.999, 2000)])
        within = np.array([path.contains_points(points) for path in fills.values()])
        # Each point is in one region, but for round-off on the lines between.
        assert (within.sum(axis=0) == 1).mean() > 0.995
        order = [[*fills][place] for place in within.argmax(axis=0)]
        return [
            name for name, before in zip(order, ["", *order], strict=False) if name != before
        ]

    # From rotational in the south-east to sliding in the north-west, as the paper has it.
    assert upwards(0.7001) == ["rrr", "srr", "ss"]
    assert upwards(1.6001) == ["rrr", "rrs", "ss"]
    assert upwards(1.7701) == ["rrr", "rrs", "rsr", "ss"]
    assert upwards(2.3001) == ["rrr", "rrs", "rsr", "rs", "ss"]
    assert upwards(3.5001) == ["rrr", "rrs", "rsr", "rs"]
    visible = {text.get_text() for text in axes.texts if text.get_visible()}
    if number == 9:
        assert visible >= {"rrr", "ss", "srr", "rrs", "rsr", "rs", "r"}
    else:
        assert visible <= set("TSJB")
        told = " ".join(text.get_text() for text in drawn(number).legends[0].get_texts())
        assert all(f"{name}  " in f"{told}  " for name in fills)
    if number == 11:
        assert axes.get_xlim()[0] > 1
        assert axes.get_ylim() == pytest.approx((0.6, 1.2))


def test_fig_12_is_what_a_joint_can_carry_and_how_it_moves() -> None:
    figure = drawn(12)
    moment, shear, *joints = figure.axes
    for axes, slope in ((moment, 1.0), (shear, FRICTION_SHOWN)):
        rises = [np.polyfit(*np.array(each.get_data()), 1)[0] for each in axes.lines[:2]]
        assert rises == pytest.approx([slope, -slope])
    words = [str(each.get_label()) for axes in (moment, shear) for each in axes.lines[:2]]
    assert [re.findall(r"varphi_(\d)", each)[0] for each in words] == ["1", "2", "3", "4"]
    # Slip, turn and closing are as the gradient of the strength condition (associated).
    strength = np.array([[0, 1, -1], [0, -1, -1], [1, 0, -FRICTION_SHOWN],
                         [-1, 0, -FRICTION_SHOWN]])  # fmt: skip
    for kind, axes in enumerate(joints):
        (patch,) = [each for each in axes.patches if str(each.get_gid()) == f"rate {kind + 1}"]
        assert isinstance(patch, Polygon)
        face = np.array([[0, -HALF_DEPTH], [0, HALF_DEPTH]])
        moved = moved_block(kind, face)
        corners = patch.get_xy()
        assert all(np.abs(corners - point).sum(axis=1).min() < 1e-12 for point in moved)
        step = moved - face
        opening = step[:, 0].mean() / RATE
        slip = step[:, 1].mean() / RATE
        turn = (step[0, 0] - step[1, 0]) / (2 * HALF_DEPTH) / RATE
        wanted = strength[kind] * [1, 1, -1]
        size = np.array([1.0, 1.0, HALF_DEPTH if kind < 2 else 1.0])
        # To the first order in the rate.
        assert [slip, turn, opening] == pytest.approx(wanted * size, abs=0.16)
        assert (step[:, 0] >= -1e-12).all()
        words = axes.get_xlabel()
        assert ("slides" in words and "opens" in words) is (kind >= 2)


def captions(number: int) -> list[dict]:
    """Captions of a figure, from the top down; one of each arch."""
    found = [each for each in CAPTIONS if each["place"].startswith(f"Fig. {number} ")]
    return found[:2]


@pytest.mark.parametrize(
    "number",
    [
        pytest.param(each, marks=[] if each in {13, 17, 22, 25} else pytest.mark.long)
        for each in study.ARCHES
    ],
)
def test_figs_13_to_25_are_the_arches_of_their_captions(number: int) -> None:
    figure = drawn(number)
    closed, built = figure.axes[::2], figure.axes[1::2]
    assert len(closed) == len(built) == 2
    for axes, printed, phi in zip(closed, captions(number), PHI[number], strict=True):
        title = axes.get_title(loc="left") or axes.get_title()
        alpha = math.degrees(printed.get("alpha") or math.radians(printed["alpha_deg"]))
        assert f"[{printed['mode']}]" in title
        assert float(re.search(r"= ([\d.]+)°, μ", title)[1]) == pytest.approx(alpha, rel=1e-5)
        assert float(re.search(r"φ = ([\d.]+)°", title)[1]) == phi
        assert float(re.search(r"η = ([\d.]+)", title)[1]) == pytest.approx(
            printed["eta"], rel=1e-3
        )
        mu = re.search(r"μ = ([\d.]+|∞)", title)[1]
        assert (
            mu == "∞"
            if math.isinf(printed["mu"])
            else float(mu) == pytest.approx(printed["mu"], rel=1e-3)
        )
    for left, right, printed in zip(closed, built, captions(number), strict=True):
        title = right.get_title(loc="left") or right.get_title()
        assert f"[{printed['mode']}]" in title
        assert "eqs (15) and (16)" in title
        agree(left, right)


def agree(left: object, right: object) -> None:
    """What is drawn by closed form and by the complementary problem is the same."""
    for name, colour in (("line of thrust", THRUST), ("line of friction", FRICTION)):
        pair = []
        for axes in (left, right):
            (found,) = [
                each
                for each in axes.lines  # type: ignore[attr-defined]
                if str(each.get_label()).startswith(name)
            ]
            assert to_hex(found.get_color()) == colour.lower()
            pair.append(found.get_xydata())
        seen = np.isfinite(pair[0]).all(axis=1) & np.isfinite(pair[1]).all(axis=1)
        assert seen.sum() > 700
        assert np.abs(pair[0] - pair[1])[seen].max() < 1e-6
    assert hinges(left.lines) == pytest.approx(hinges(right.lines), abs=1e-6)  # type: ignore[attr-defined]
    pieces = []
    for axes in (left, right):
        outlines = [
            each.get_xy()
            for each in axes.patches  # type: ignore[attr-defined]
            if each.get_label() == "mechanism"
        ]
        assert outlines
        pieces.append(sorted((tuple(each.min(axis=0)), tuple(each.max(axis=0)))
                             for each in outlines))  # fmt: skip
        assert {to_hex(each.get_edgecolor()) for each in axes.patches  # type: ignore[attr-defined]
                if each.get_label() == "mechanism"} == {MECHANISM.lower()}  # fmt: skip
    # The same pieces move to the same places.
    assert np.array(pieces[0]) == pytest.approx(np.array(pieces[1]), abs=1e-4)


@pytest.mark.parametrize("number", study.ARCHES)
def test_sliding_is_said_to_dilate(number: int) -> None:
    told = " ".join(text.get_text() for text in drawn(number).legends[0].get_texts())
    slides = any("s" in printed["mode"] for printed in captions(number))
    assert ("sliding joint: it opens, too (dilatancy)" in told) is slides


def test_the_command_writes_figures_numbers_and_a_page(tmp_path: Path) -> None:
    out = tmp_path / "out"
    ran("paper", out, "--figure", "4", "--figure", "1", "--format", "png")
    names = {"fig01.png", "fig04.png", "index.html", "numbers.csv"}
    assert {path.name for path in out.iterdir()} == names
    page = (out / "index.html").read_text("utf-8")
    assert re.findall(r'src="([^"]+)"', page) == ["fig01.png", "fig04.png"]
    assert "<b>Fig. 4.</b> Sliding of an inner joint" in page
    rows = csv_rows(out / "numbers.csv")
    assert len(rows) == 45
    assert max(float(row["relative_difference"]) for row in rows) <= 1e-13
    values = {row["name"]: float(row["printed"]) for row in rows}
    assert values["Table 1 eta_T"] == TABLE["T"]["eta"]


def test_the_page_fits_a_phone_and_is_dark_in_the_dark(
    windows: Windows, tmp_path: Path
) -> None:
    ran("paper", tmp_path, "--figure", "1")
    address = (tmp_path / "index.html").as_uri()
    page = windows.open(address, 390, 800, color_scheme="dark")
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    assert "invert" in page.evaluate("getComputedStyle(document.querySelector('img')).filter")
    # It loads its picture, and nothing else.
    assert windows.wrong(address) == [(tmp_path / "fig01.svg").as_uri()]


def test_a_number_that_is_not_met_is_an_exit_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wrong = {**study.TABLE_1, "T": (0.6796047320989, *study.TABLE_1["T"][1:])}
    monkeypatch.setattr(study, "TABLE_1", wrong)
    ran("paper", tmp_path, "--figure", "1")
    wrong["T"] = (0.67960473, *study.TABLE_1["T"][1:])
    assert "MISSES" in ran("paper", tmp_path, "--figure", "1", code=1)
