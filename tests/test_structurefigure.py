"""Stills of structures: what is drawn is what is there, and forces are those of statics."""

import io
import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from drawn import square
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, PathPatch
from shapely import Polygon, box
from structure_cases import names, scenes

from blocksim import (
    CircularArch,
    JointState,
    Problem,
    check,
    collapse,
    equilibrium,
    structure_of,
)
from blocksim.blocks.regions import rings
from blocksim.blocks.road import fill_of
from blocksim.view import sheetlayout
from blocksim.view.arrows import pressures_of
from blocksim.view.drawing import save_figure
from blocksim.view.sheet import answer_sheet, scale_for, sheet_of
from blocksim.view.sheetfigure import SCREEN, sheet_figure
from blocksim.view.structure import fill_outlines
from blocksim.view.style import DEAD, LIVE, use_of

GROUND = {"id": "g", "vertices": square(-3, -1, 8, 1), "fixed": True}


def stack(**more: Any) -> Problem:
    """Three blocks of 2000, 1000 and 500 N on each other."""
    weights = (2000.0, 1000.0, 500.0)
    blocks = [
        {"id": place, "vertices": square(0.1 * place, place), "weight": weight}
        for place, weight in enumerate(weights)
    ]
    return structure_of(
        {"title": "Three blocks", "friction": 0.6, "blocks": [GROUND, *blocks], **more}
    )


def problem_figure(problem: Problem, **known: Any) -> Figure:
    return sheet_figure(sheet_of(problem, **known), column=SCREEN)


def of(figure: Figure, kind: str) -> dict[int, Any]:
    """Artists whose gid says that they are of a kind, by their number."""
    found = [each for each in figure.axes[0].get_children() if each.get_gid()]
    return {
        int(match[1]): each
        for each in found
        if (match := re.fullmatch(rf"{kind}-(\d+)", str(each.get_gid())))
    }


def line_of(artist: Any) -> np.ndarray:
    """Start and end of a bar or an arrow."""
    if isinstance(artist, FancyArrowPatch):
        return np.array(artist._posA_posB)
    return np.column_stack(artist.get_data())


def legend(figure: Figure) -> set[str]:
    return {text.get_text() for text in figure.legends[0].get_texts()}


def words(figure: Figure) -> list[str]:
    return [text.get_text() for text in [*figure.texts, *figure.axes[0].texts]]


def corners(artist: PathPatch) -> set[tuple[float, float]]:
    return {
        (float(x), float(y)) for x, y in np.round(np.asarray(artist.get_path().vertices), 9)
    }


@pytest.mark.parametrize("weight", ["chord", "curved"])
def test_fill_is_drawn_as_the_area_that_weighs(weight: str) -> None:
    """Its area times depth and unit weight is what it weighs; curves are chords."""
    problem = CircularArch(
        span=8.0, rise=3.0, thickness=0.45, voussoirs=31, weight=weight, fill=0.5,
        fill_density=0.8, depth=1.5, friction=0.7, density=2e4,
    ).problem()  # fmt: skip
    ((outline, is_backing),) = fill_outlines(problem)
    # What lies over the supports weighs on them.
    left, right = (float(problem.assembly.joints[k].outer[0]) for k in (0, -1))
    over = Polygon(outline).intersection(box(left, -1e3, right, 1e3))
    area = over.area * 1.5 * 0.8 * 2e4
    fill = fill_of(problem)
    assert not is_backing
    assert area == pytest.approx(fill.weight, rel=1e-9 if weight == "chord" else 2e-2)
    drawn = problem_figure(problem)
    assert set(of(drawn, "fill")) == {0}
    assert not of(drawn, "dead")


def test_pressures_along_joints_sum_to_the_forces_at_their_points() -> None:
    """A block of stress about the resultant: as much force, and no moment about it."""
    problem = CircularArch(
        span=8.0, rise=3.0, thickness=0.45, voussoirs=15, depth=2.0, friction=0.7
    ).problem()
    sheet = answer_sheet(check(problem, method="limit")).pressures
    carried = sheet.carried and sheet.carried.resultants
    found = pressures_of(problem, carried)
    assert len(found) == 16
    drawn = of(sheet_figure(sheet, column=SCREEN), "pressure")
    used = of(sheet_figure(sheet, column=SCREEN), "used")
    heights = {}
    for index, (part, stress) in found.items():
        long = float(np.hypot(*(part[1] - part[0])))
        assert stress * long * 2.0 == pytest.approx(carried.normal[index], rel=1e-9)
        assert part.mean(axis=0) == pytest.approx(carried.point[index], abs=1e-9)
        corner = np.asarray(drawn[index].get_xy())
        assert corner[:2] == pytest.approx(part)
        heights[index] = float(np.hypot(*(corner[3] - corner[0]))) / stress
        assert used[index].get_color() == use_of(float(carried.used[index]))[1]
    assert np.ptp(list(heights.values())) <= 1e-9 * max(heights.values())


def test_blocks_are_where_they_are_and_supports_are_hatched() -> None:
    problem = stack()
    figure = problem_figure(problem, verdict="stands")
    blocks = of(figure, "block")
    assert len(blocks) == 3
    for index, block in enumerate(problem.assembly.blocks):
        expected = {(float(x), float(y)) for x, y in np.round(block.vertices, 9)}
        assert corners(blocks[index]) == expected
        assert not blocks[index].get_hatch()
    (support,) = of(figure, "support").values()
    assert support.get_hatch() == "////"
    shown = np.asarray(support.get_path().vertices)
    # The face that bears is whole; far from the blocks nothing is shown.
    assert shown[:, 1].max() == 0
    assert shown[:, 0].min() < 0 < 1.2 < shown[:, 0].max()
    assert shown[:, 0].min() > -1
    assert legend(figure) == {"support"}
    assert words(figure)[0] == "Three blocks"
    assert "stands" in words(figure)
    assert "3 blocks, μ = 0.6 (30.96°), unit weight 1 kN/m³, depth 1 m" in words(figure)


def test_thrust_in_a_stack_is_the_weight_above() -> None:
    """500, 1500 and 3500 N upright, at the centre of mass of what is above."""
    problem = stack()
    figure = problem_figure(problem, forces=equilibrium(problem).forces)
    drawn = of(figure, "force")
    places = of(figure, "centre")
    weights = np.array([2000.0, 1000.0, 500.0])
    centres = np.array([0.5, 0.6, 0.7])
    lengths = {}
    for index, joint in enumerate(problem.assembly.joints):
        above = [k for k in range(3) if k + 0.5 > joint.inner[1]]
        line = line_of(drawn[index])
        way = line[1] - line[0]
        assert way[0] == pytest.approx(0, abs=1e-9)
        lengths[weights[above].sum()] = abs(way[1])
        x, y = np.column_stack(places[index].get_data())[0]
        assert x == pytest.approx(np.average(centres[above], weights=weights[above]), abs=1e-7)
        assert y == pytest.approx(joint.inner[1])
        if -1 in (joint.before, joint.after):
            # From the support an arrow, up, to where it acts.
            assert isinstance(drawn[index], FancyArrowPatch)
            assert line[1] == pytest.approx([x, y])
            assert way[1] > 0
    assert sorted(lengths) == [500, 1500, 3500]
    assert lengths[500] / lengths[3500] == pytest.approx(1 / 7, abs=1e-8)
    assert lengths[1500] / lengths[3500] == pytest.approx(3 / 7, abs=1e-8)
    assert legend(figure) == {"support", "contact force, largest 3.5 kN"}


@pytest.mark.parametrize("tilt", [20.0, -20.0])
def test_on_a_slope_the_reaction_is_against_gravity_through_the_centre(tilt: float) -> None:
    problem = structure_of(
        {"friction": 0.5, "blocks": [GROUND, {"id": 0, "vertices": square(0, 0, 2, 1)}]}
    ).tilted(math.radians(tilt))
    figure = problem_figure(problem, forces=equilibrium(problem).forces)
    line = line_of(of(figure, "force")[0])
    way = (line[1] - line[0]) / np.hypot(*(line[1] - line[0]))
    assert way == pytest.approx(-problem.gravity[:2], abs=1e-8)
    to_centre = problem.assembly.centres[0] - line[1]
    assert way[0] * to_centre[1] - way[1] * to_centre[0] == pytest.approx(0, abs=1e-8)
    (arrow,) = [each for each in figure.axes[0].patches if each.get_gid() == "gravity"]
    pull = line_of(arrow)[1] - line_of(arrow)[0]
    assert pull / np.hypot(*pull) == pytest.approx(problem.gravity[:2], abs=1e-9)
    assert any(
        word.endswith("tilted 20°" + " to the left" * (tilt < 0)) for word in words(figure)
    )
    assert "gravity" in legend(figure)


def test_loads_are_arrows_that_end_where_they_act() -> None:
    problem = stack(
        dead=[{"body": [0, -1]}, {"block": 2, "point": [0.7, 3.0], "force": [0, -1000]}],
        live=[{"block": 0, "point": [0.0, 0.8], "force": [500, 0]}],
    )
    for load, factor in ((0.0, 1.0), (0.5, 0.5)):
        figure = problem_figure(problem.with_load(load))
        (dead,), (live,) = of(figure, "dead").values(), of(figure, "live").values()
        down, push = line_of(dead), line_of(live)
        assert down[1] == pytest.approx([0.7, 3.0])
        assert push[1] == pytest.approx([0.0, 0.8])
        assert (down[1] - down[0])[0] == 0
        assert (push[1] - push[0])[1] == 0
        ratio = (push[1] - push[0])[0] / -(down[1] - down[0])[1]
        assert ratio == pytest.approx(factor * 500 / 1000)
        assert {dead.get_edgecolor(), live.get_edgecolor()} == {
            to_rgba(tone) for tone in (DEAD, LIVE)
        }
        told = legend(figure)
        assert "dead load, largest 1 kN" in told
        at = "load factor 0.5, largest 250" if load else "factor 1 (not on it), largest 500"
        assert f"live load at {at} N" in told


def test_a_mechanism_is_drawn_as_its_blocks_move() -> None:
    """500 N and a lever of 0.4 m to the edge below against a push of 1 m lever."""
    problem = stack(live=[{"block": 2, "point": [0.2, 3.0], "force": [1, 0]}])
    found = collapse(problem)
    assert found.load_factor == pytest.approx(500 * 0.4)
    states = [
        JointState.HINGE_INTRADOS if 1 in (joint.before, joint.after) and 2 in (
            joint.before, joint.after) else JointState.CLOSED
        for joint in problem.assembly.joints
    ]  # fmt: skip
    figure = problem_figure(problem, mechanism=found.mechanism, joint_states=states)
    moved = of(figure, "moved")
    assert list(moved) == [2]
    shown = np.array(sorted(corners(moved[2])))
    # Its lower face turns about the edge of the block below, where the hinge is marked.
    lower = shown[np.argsort(shown[:, 1])[:2]]
    at_edge = np.interp(
        1.1, lower[np.argsort(lower[:, 0]), 0], lower[np.argsort(lower[:, 0]), 1]
    )
    assert at_edge == pytest.approx(2.0, abs=1e-6)
    assert lower[:, 1].max() > 2.1
    (hinge,) = of(figure, "hinge").values()
    assert np.column_stack(hinge.get_data())[0] == pytest.approx([1.1, 2.0])
    assert len(of(figure, "joint")) == len(of(figure, "hinge")) == 1
    # Loads are drawn at factor 1 beside it.
    assert legend(figure) == {
        "support", "hinge", "mechanism, enlarged",
        "live load at factor 1 (not on it), largest 1 N",
    }  # fmt: skip


def test_parts_of_a_block_are_one_body_without_seams() -> None:
    """An L of two rectangles: five of its eight sides are seen whole, one of them in part."""
    ell = [np.array(square(0, 0, 2, 1)), np.array(square(0, 1, 1, 1))]
    (rim,) = rings(ell)
    sides = np.stack([rim, np.roll(rim, -1, axis=0)], axis=1)
    assert float(np.hypot(*(sides[:, 1] - sides[:, 0]).T).sum()) == pytest.approx(8.0)
    assert not any(np.allclose(side[:, 1], 1.0) and side[:, 0].min() < 0.9 for side in sides)
    problem = structure_of(
        {"friction": 0.5, "blocks": [GROUND, {"id": 0, "polygons": [e.tolist() for e in ell]}]}
    )
    figure = problem_figure(problem)
    assert len(of(figure, "block")) == 1
    assert len(of(figure, "block")[0].get_path().to_polygons()) == 2


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.long if at % 3 else [])
        for at, name in enumerate(names()[::6])
    ],
)
def test_structures_of_the_corpus_are_framed(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every block, force and moved block is inside the axes; a bar tells lengths."""
    rooms: list[np.ndarray] = []

    def scale(span: np.ndarray, room: np.ndarray) -> float:
        rooms.append(room.copy())
        return scale_for(span, room)

    monkeypatch.setattr(sheetlayout, "scale_for", scale)
    problem = structure_of(scenes(name)[0])
    found = equilibrium(problem)
    figure = problem_figure(problem, forces=found.forces, mechanism=found.mechanism)
    axes = figure.axes[0]
    assert len(of(figure, "block")) == len(problem.assembly.blocks)
    drawn = [np.asarray(each.get_path().vertices) for each in of(figure, "block").values()]
    drawn += [np.asarray(each.get_path().vertices) for each in of(figure, "moved").values()]
    drawn += [line_of(each) for each in of(figure, "force").values()]
    points, supports = np.concatenate(drawn), of(figure, "support").values()
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    assert left < points[:, 0].min() <= points[:, 0].max() < right
    assert bottom < points[:, 1].min() <= points[:, 1].max() < top
    # Half of the room is filled at least: at the next larger usual scale it would not fit.
    (room,) = rooms
    paper = 25.4 * figure.get_size_inches() / [right - left, top - bottom]
    shown = np.concatenate([points, *(each.get_path().vertices for each in supports)])
    assert (np.ptp(shown, axis=0) * paper / room).max() > 0.5
    (bar,) = [line for line in axes.lines if line.get_gid() == "scale"]
    length = float(np.ptp(bar.get_xdata()))
    assert f"{length:g} m" in words(figure)


@pytest.mark.parametrize(
    ("kind", "magic"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")]
)
def test_figures_are_reproducible(kind: str, magic: bytes) -> None:
    problem = replace(stack(), title="A & B <x>")
    files = []
    for _ in range(2):
        file = io.BytesIO()
        save_figure(problem_figure(problem, forces=equilibrium(problem).forces), file, kind)
        files.append(file.getvalue())
    assert files[0] == files[1]
    assert files[0].startswith(magic)
    if kind == "svg":
        ids = {each.get("id") for each in ET.fromstring(files[0]).iter()}  # noqa: S314 - ours
        assert {"block-0", "block-1", "block-2", "support-0", "force-0", "scale"} <= ids
