"""Drawings to scale: what is built, lines of thrust in balance, words where they belong."""

import io
import math
import re
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from arches import ENGINEERS
from matplotlib.figure import Figure
from matplotlib.text import Text

from blocksim import Arch, CircularArch, Problem, check, load_structure, structure_of
from blocksim.view.dimensions import force_unit
from blocksim.view.drawing import save_figure
from blocksim.view.sheet import Sheet, answer_sheet
from blocksim.view.sheetdxf import LAYERS, write_dxf
from blocksim.view.sheetfigure import sheet_figure
from blocksim.view.thrustlines import is_chained

SPAN, RISE, THICK = 8.0, 3.0, 0.45
INNER = (SPAN**2 / 4 + RISE**2) / (2 * RISE)
"""Radius of the intrados, by the chord theorem [m]."""


def arch(count: int, degrees: float, eta: float, mu: float, radius: float = 1.0) -> Problem:
    built = Arch(half_angle=math.radians(degrees), eta=eta, voussoirs=count, radius=radius)
    return CircularArch.of(built, mu).problem()


def kind(name: str, **more: Any) -> Problem:
    return structure_of({"kind": name, "friction": 0.6, **more})


CASES = {
    "engineer's": lambda: CircularArch.of(ENGINEERS, math.tan(math.radians(35))).problem(),
    "five": lambda: arch(5, 90, 0.3, 0.7),
    "many": lambda: arch(101, 60, 0.1, 0.7, 4.2),
    "horseshoe": lambda: arch(27, 140, 0.9, 1.5),
    "falls": lambda: arch(27, 90, 0.09, 0.7, 4.2),
    "flat": lambda: arch(21, 12, 0.05, 0.7, 20.0),
    "slides": lambda: arch(27, 90, 0.3, 0.30),
    "portal": lambda: kind("portal", density=20000.0),
    "arcade": lambda: kind("arcade"),
    "wall": lambda: kind("wall"),
    "column": lambda: kind("column"),
    "stack": lambda: kind("stack"),
    "pointed": lambda: kind("pointed-arch", fill=0.2),
    "flat-arch": lambda: kind("flat-arch"),
    "pushed": lambda: load_structure("oppenheim_7").with_load(0.2),
}


ALONE = {"five", "many", "flat", "stack", "pointed", "flat-arch", "arcade"}
"""Cases that are drawn for how words and scale come out on them, and like others there."""
SEEN = [pytest.param(each, marks=[pytest.mark.long] * (each in ALONE)) for each in CASES]


@cache
def drawn(name: str) -> tuple[Sheet, Figure]:
    problem = CASES[name]()
    answer = check(problem, method="limit")
    sheet = answer_sheet(answer)
    return sheet, sheet_figure(sheet)


def lines(figure: Figure, gid: str) -> list[np.ndarray]:
    """Points of all lines with a gid, in metres."""
    return [
        np.column_stack(each.get_data())
        for each in figure.axes[0].lines
        if re.fullmatch(gid, str(each.get_gid()))
    ]


def texts(figure: Figure) -> list[str]:
    found: list[Any] = figure.findobj(Text)
    return [each.get_text() for each in found if each.get_text()]


def legend(figure: Figure) -> set[str]:
    return {text.get_text() for each in figure.legends for text in each.get_texts()}


def cross(one: np.ndarray, other: np.ndarray) -> float:
    return float(one[0] * other[1] - one[1] * other[0])


def at_joints(line: np.ndarray, problem: Problem) -> tuple[np.ndarray, dict[int, np.ndarray]]:
    """Points of a line on the joints of an arch, in order, and where it bends within blocks."""
    crossed: list[np.ndarray] = []
    bends: dict[int, np.ndarray] = {}
    for point in line:
        joint = problem.assembly.joints[min(len(crossed), len(problem.assembly.blocks))]
        if abs(float((point - joint.inner) @ joint.normal)) < 1e-9:
            crossed.append(point)
        else:
            bends[len(crossed) - 1] = point
    assert len(crossed) == len(problem.assembly.joints)
    return np.array(crossed), bends


@pytest.mark.parametrize("name", ["min", "max", "safest"])
def test_every_voussoir_is_in_balance_along_a_line_of_thrust(name: str) -> None:
    """By hand: H is the same everywhere, V grows by the weight of a voussoir from half of all,
    and moments about the point at which the force leaves a voussoir balance."""
    sheet, figure = drawn("engineer's")
    (whole,) = lines(figure, f"thrust-{name}-0")
    problem = sheet.problem
    count = len(problem.assembly.blocks)
    line, bends = at_joints(whole, problem)
    # Between joints it bends below the weight of the voussoir, and leaves along its force.
    assert len(bends) > count / 2
    for index, bend in bends.items():
        assert bend[0] == pytest.approx(problem.assembly.centres[index, 0], abs=1e-6)
    # From areas of sectors, not from the code: gamma t r d 2 alpha/n.
    radius = INNER + THICK / 2
    weight = 20_000.0 * THICK * radius * 2 * math.asin(SPAN / 2 / INNER) / count
    carried = sheet.carried
    (words,) = [
        each for each in legend(figure) if each.startswith(f"line of thrust: {SAID[name]}")
    ]
    across = {"min": carried.least, "max": carried.greatest}.get(name)
    told = float(re.findall(r"([\d.]+) kN/m", words)[0])
    thrust = told * 1e3 if across is None else across.thrust * problem.unit_force
    assert thrust == pytest.approx(told * 1e3, rel=2e-4)
    assert len(line) == count + 1
    for index in range(count):
        up = weight * (count / 2 - index)
        way = bends.get(index, line[index]) - line[index]
        assert cross(way, np.array([thrust, up])) == pytest.approx(0, abs=2e-4 * thrust)
        lever = line[index] - line[index + 1]
        turn = cross(lever, np.array([thrust, up]))
        turn -= cross(
            problem.assembly.centres[index] - line[index + 1], np.array([0.0, weight])
        )
        assert turn == pytest.approx(0.0, abs=2e-4 * thrust * THICK)


SAID = {"min": "least thrust", "max": "greatest thrust", "safest": "greatest margin"}


def test_lines_of_least_and_greatest_thrust_touch_the_edges_and_the_safest_does_not() -> None:
    """Heyman: least thrust meets the extrados at the crown and the intrados at the haunches,
    the greatest the intrados between them and the extrados at the springings."""
    sheet, figure = drawn("engineer's")
    outer = INNER + THICK
    shift = INNER - RISE  # the centre lies below the springings; it is the origin here
    assert shift > 0
    far = {}
    for name in SAID:
        (whole,) = lines(figure, f"thrust-{name}-0")
        far[name] = np.hypot(*at_joints(whole, sheet.problem)[0].T)
    middle = len(far["min"]) // 2
    assert far["min"][middle] == pytest.approx(outer, abs=1e-6)
    assert far["min"].min() == pytest.approx(INNER, abs=1e-6)
    assert far["max"].min() == pytest.approx(INNER, abs=1e-6)
    assert far["max"][0] == far["max"].max() == pytest.approx(outer, abs=1e-6)
    used = 2 * np.abs(far["safest"] - INNER - THICK / 2).max() / THICK
    assert used == pytest.approx(sheet.carried.strength_used, abs=1e-6)


def test_dimensions_are_those_it_was_built_with() -> None:
    sheet, figure = drawn("engineer's")
    said = texts(figure)
    assert "span 8.000 m (intrados)" in said
    assert "rise 3.000 m (intrados)" in said
    assert "thickness 0.450 m" in said
    alpha = math.degrees(math.asin(4 / (25 / 6)))
    assert f"\N{GREEK SMALL LETTER ALPHA} = {alpha:.4g}°" in said
    (span,) = lines(figure, "dimension-span")
    assert np.ptp(span, axis=0) == pytest.approx([8.0, 0.0], abs=1e-12)
    (rise,) = lines(figure, "dimension-rise")
    assert np.ptp(rise, axis=0) == pytest.approx([0.0, 3.0], abs=1e-12)
    (thickness,) = lines(figure, "dimension-thickness")
    assert np.hypot(*np.ptp(thickness, axis=0)) == pytest.approx(0.45, abs=1e-12)
    assert sheet.unit.name == "kN/m"


def test_reactions_bear_the_weight_and_the_thrust() -> None:
    sheet, figure = drawn("engineer's")
    radius = INNER + THICK / 2
    half = 20.0 * THICK * radius * math.asin(SPAN / 2 / INNER)
    (left,) = [each for each in texts(figure) if each.startswith("↑") and "→" in each]
    up, across = (float(each) for each in re.findall(r"([\d.]+) kN/m", left))
    assert up == pytest.approx(half, rel=2e-4)
    (words,) = [each for each in legend(figure) if "greatest margin, " in each]
    assert f"{across:.2f} kN/m" in words
    (told,) = [each for each in texts(figure) if each.startswith("thrust ")]
    unit = sheet.problem.unit_force / 1e3
    low, high = re.findall(r"[\d.]+\d", told)
    assert float(low) == pytest.approx(sheet.carried.least.thrust * unit, rel=2e-4)
    assert float(high) == pytest.approx(sheet.carried.greatest.thrust * unit, rel=2e-4)


@pytest.mark.parametrize("name", SEEN)
def test_no_words_cover_others_or_leave_the_page(name: str) -> None:
    _, figure = drawn(name)
    figure.draw_without_rendering()
    found: list[Any] = [each for each in figure.findobj(Text) if each.get_text().strip()]
    boxes = [(each.get_text(), each.get_window_extent()) for each in found]
    wide, tall = figure.get_size_inches() * figure.dpi
    for at, (words, box) in enumerate(boxes):
        assert box.x0 > 0, words
        assert box.y0 > 0, words
        assert box.x1 < wide, words
        assert box.y1 < tall, words
        for others, other in boxes[at + 1 :]:
            assert not box.overlaps(other), (words, others)


@pytest.mark.parametrize("name", SEEN)
def test_the_scale_that_is_told_is_true_on_paper(name: str) -> None:
    """Measured in the svg: corners of a block in points."""
    sheet, figure = drawn(name)
    (note,) = [each for each in texts(figure) if "true where printed" in each]
    match = re.match(r"1:([\d.]+) on A4", note)
    scale = float(match[1])
    assert round(scale / 10 ** math.floor(math.log10(scale)), 9) in {1, 2, 2.5, 5, 7.5}
    svg = io.BytesIO()
    save_figure(figure, svg, "svg")
    root = ET.fromstring(svg.getvalue())  # noqa: S314 - ours
    (block,) = [each for each in root.iter() if each.get("id") == "block-0"]
    path = next(each for each in block.iter() if each.get("d"))
    numbers = re.findall(r"[ML] ([\d.]+) ([\d.]+)", str(path.get("d")))
    on_paper = np.array(numbers, dtype=float)[:2] / 72 * 25.4
    corners = sheet.problem.assembly.blocks[0].polygons[0][:2]
    true = float(np.hypot(*(corners[1] - corners[0])))
    assert np.hypot(*(on_paper[1] - on_paper[0])) * scale / 1e3 == pytest.approx(true, rel=1e-4)
    (bar,) = lines(figure, "scale")
    assert f"{np.ptp(bar[:, 0]):g} m" in texts(figure)


def test_a_page_is_a4_upright_or_across() -> None:
    pages = []
    for name in ("column", "wall"):
        pdf = io.BytesIO()
        save_figure(drawn(name)[1], pdf, "pdf")
        page = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+)", pdf.getvalue())
        pages.append([float(each) / 72 * 25.4 for each in page.groups()])
    assert pages[0] == pytest.approx([210.0, 297.0], abs=0.05)
    assert pages[1] == pytest.approx([297.0, 210.0], abs=0.05)


def test_a_legend_is_of_what_is_there() -> None:
    little = "joint, up to 50 % used"
    assert legend(drawn("wall")[1]) == {"support", "contact force, largest 0.48 N", little}
    assert legend(drawn("column")[1]) == {
        "support", "line of thrust: greatest margin", "reaction at greatest margin",
        "force along it: this wide at 3.600 N/m", little,
    }  # fmt: skip
    falls = legend(drawn("falls")[1])
    assert falls == {
        "support", "mechanism, enlarged", "hinge extrados", "hinge intrados",
        "line of thrust that lacks least strength",
    }  # fmt: skip
    assert "slides" in legend(drawn("slides")[1])
    stands = legend(drawn("engineer's")[1])
    assert len(stands) == 7
    assert not [each for each in stands if "hinge" in each or "mechanism" in each]


def test_a_line_of_thrust_meets_every_joint_of_a_column() -> None:
    """Of level joints in their middle, with the weight above in the one below all."""
    sheet, figure = drawn("column")
    (line,) = lines(figure, "thrust-safest-0")
    heights = [joint.inner[1] for joint in sheet.problem.assembly.joints]
    assert sorted(line[:, 1]) == pytest.approx(sorted(heights))
    assert line[:, 0] == pytest.approx(0.0, abs=1e-9)


def test_lines_meet_in_the_pier_between_two_arches() -> None:
    sheet, figure = drawn("arcade")
    paths = lines(figure, r"thrust-min-\d")
    feet = [tuple(np.round(end, 6)) for path in paths for end in (path[0], path[-1])]
    shared = [foot for foot in set(feet) if feet.count(foot) == 2]
    assert len(shared) == 1
    assert is_chained(sheet.problem)
    assert not is_chained(CASES["wall"]())


def test_units_are_those_of_the_weights() -> None:
    assert force_unit(CASES["portal"]()).name == "kN/m"
    unit = force_unit(CASES["wall"]())
    assert (unit.name, unit.newtons) == ("N/m", 1.0)
    assert unit.note == "weights are for 1 N/m³: no unit weight was given"
    assert unit.note in texts(drawn("wall")[1])
    deep = kind("portal", density=20000.0, arch={"kind": "circular-arch", "depth": 2.0})
    assert force_unit(deep).newtons == 2000.0
    assert force_unit(deep).words(5000.0) == "2.500 kN/m"
    blocks = [
        {"id": "g", "vertices": [[-1, -1], [3, -1], [3, 0], [-1, 0]], "fixed": True},
        {"id": 0, "vertices": [[0, 0], [1, 0], [1, 1], [0, 1]], "depth": 0.5},
        {"id": 1, "vertices": [[0, 1], [1, 1], [1, 2], [0, 2]], "depth": 0.25},
    ]
    mixed = structure_of({"friction": 0.5, "density": 24000.0, "blocks": blocks})
    assert force_unit(mixed).name == "kN"


def test_a_heavy_arch_thrusts_as_much_on_any_depth() -> None:
    """Per metre of depth the answer does not change."""
    said = []
    for depth in (1.0, 3.0):
        built = Arch(half_angle=1.0, eta=0.15, voussoirs=9, radius=4.0, depth=depth)
        sheet = answer_sheet(check(CircularArch.of(built, 0.7)))
        said.append(sheet.thrust[1])
    assert said[0] == said[1]


def read(sheet: Sheet, tmp_path: Path) -> Any:
    path = tmp_path / "sheet.dxf"
    with path.open("wb") as file:
        write_dxf(sheet, file)
    return ezdxf.readfile(path)


def polygons(document: Any, layer: str) -> list[np.ndarray]:
    found = document.modelspace().query(f'LWPOLYLINE[layer=="{layer}"]')
    return [np.array([(x, y) for x, y, *_ in each.get_points()]) for each in found]


@pytest.mark.parametrize("name", ["engineer's", "falls", "portal", "wall", "arcade"])
def test_dxf_has_the_blocks_it_was_drawn_from(name: str, tmp_path: Path) -> None:
    sheet, _ = drawn(name)
    document = read(sheet, tmp_path)
    audit = document.audit()
    assert (audit.errors, audit.fixes) == ([], [])
    assert document.header["$INSUNITS"] == 6
    assembly = sheet.problem.assembly
    for layer, bodies in (
        ("blocks", [block.polygons[0] for block in assembly.blocks]),
        ("supports", [each.polygons[0] for each in assembly.supports]),
    ):
        found = polygons(document, layer)
        assert len(found) == (len(bodies) or 2)  # springings of an arch stand on strips
        for one, other in zip(found, bodies, strict=False):
            assert np.abs(one - other).max() < 1e-9
        closed = document.modelspace().query(f'LWPOLYLINE[layer=="{layer}"]')
        assert all(each.closed for each in closed)
    joints = document.modelspace().query('LINE[layer=="joints"]')
    assert len(joints) == len(assembly.joints)
    for line in sheet.lines:
        found = polygons(document, f"thrust-{line.name}")
        assert [each.tolist() for each in found] == [each.tolist() for each in line.paths]
    assert {each.dxf.layer for each in document.modelspace()} <= set(LAYERS)


def test_dxf_has_true_dimensions(tmp_path: Path) -> None:
    """Dimension entities: what they measure, and what they show."""
    document = read(drawn("engineer's")[0], tmp_path)
    found = {
        each.dxf.text.split()[0]: each for each in document.modelspace().query("DIMENSION")
    }
    assert set(found) == {"span", "rise", "thickness", "\N{GREEK SMALL LETTER ALPHA}"}
    assert found["span"].get_measurement() == pytest.approx(8.0, abs=1e-9)
    assert found["rise"].get_measurement() == pytest.approx(3.0, abs=1e-9)
    assert found["thickness"].get_measurement() == pytest.approx(0.45, abs=1e-9)
    alpha = math.degrees(math.asin(4 / (25 / 6)))
    assert found["\N{GREEK SMALL LETTER ALPHA}"].get_measurement() == pytest.approx(
        alpha, abs=1e-9
    )
    shown = {
        re.sub(r"[{}]|\\[^;]*;", "", each.text)
        for dimension in found.values()
        for each in dimension.get_geometry_block().query("MTEXT")
    }
    assert shown == {
        "span 8.000 m (intrados)", "rise 3.000 m (intrados)", "thickness 0.450 m",
        "\N{GREEK SMALL LETTER ALPHA} = 73.74°"
    }  # fmt: skip
