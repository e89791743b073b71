"""Drawings as they are: lines and arcs, odd layers, gaps, mortar, references, clones."""

import json
import math
from itertools import pairwise
from pathlib import Path
from typing import Any, cast

import ezdxf
import numpy as np
import pytest
import shapely
from drawn import new_dxf, on_ground, square, structure, svg_of, written
from hypothesis import given
from hypothesis import strategies as st
from own_bridge import thrusts_of_half
from running import answered, inside, ran, refused

from blocksim import (
    CircularArch,
    InputError,
    Problem,
    Reading,
    Rubble,
    Wall,
    bracket,
    load_structure,
)
from blocksim.reading.curves import arc, bezier, ellipse
from blocksim.reading.loops import loops_of

BED = {"layer": "0-Auflager"}
RIB = {"layer": "A-Mauerwerk.Rippe"}
INNER, OUTER, HALF, GAP = 4000.0, 4400.0, 2000.0, 0.5
"""Radii of a pointed arch, half its span, and the gaps between its voussoirs [mm]."""
FINE = 500
"""Chords of an arc, of which the area is right to a millionth."""


def on(radius: float, angle: float) -> tuple[float, float]:
    return HALF + radius * math.cos(angle), radius * math.sin(angle)


def pointed(path: Path, count: int = 7, unit: int = 4, mortar: float = GAP) -> np.ndarray:
    """Draw one half by lines and arcs, insert it and its mirror image.

    `mortar`: Between its voussoirs, of parallel faces, and at the crown [mm].
    Returns: Area and x of the centroid of each voussoir from the crown down, in m.
    """
    document = cast(Any, ezdxf).new("R2010", units=unit)
    half = document.blocks.new("halbe Rippe")
    rays = np.linspace(math.pi, math.acos(-HALF / INNER), count + 1)
    found = []
    for k in range(count):
        # Half the mortar beside each ray; half a gap above the bed; half the mortar at x = 0.
        beside = GAP if k == 0 else mortar / 2
        low = [rays[k] - math.asin(beside / radius) for radius in (INNER, OUTER)]
        high = [rays[k + 1] + math.asin(mortar / 2 / radius) for radius in (INNER, OUTER)]
        if k == count - 1:
            high = [math.acos((-mortar / 2 - HALF) / radius) for radius in (INNER, OUTER)]
        for radius, start, end in zip((INNER, OUTER), high, low, strict=True):
            half.add_arc((HALF, 0), radius, math.degrees(start), math.degrees(end))
        half.add_line(on(INNER, low[0]), on(OUTER, low[1]))
        half.add_line(on(OUTER, high[1]), on(INNER, high[0]))
        path_of = [on(OUTER, t) for t in np.linspace(low[1], high[1], FINE)]
        path_of += [on(INNER, t) for t in np.linspace(high[0], low[0], FINE)]
        outline = shapely.Polygon(np.array(path_of) / 1e3)
        found.append((outline.area, outline.centroid.x))
    space = document.modelspace()
    space.add_blockref("halbe Rippe", (0, 0), dxfattribs=RIB)
    space.add_blockref("halbe Rippe", (0, 0), dxfattribs={**RIB, "xscale": -1})
    for side in (-1, 1):
        bed = [(side * 1900, -500), (side * 2500, -500), (side * 2500, 0), (side * 1900, 0)]
        space.add_lwpolyline(bed, close=True, dxfattribs=BED)
    space.add_text("Rippe", dxfattribs={"layer": "Maße"})
    document.saveas(path)
    return np.array(found[::-1])


@pytest.mark.parametrize("mortar", [GAP, 10.0])
def test_a_pointed_rib_by_lines_and_arcs_thrusts_as_its_half_does(
    tmp_path: Path, mortar: float
) -> None:
    """Layers of their own names, mm, gaps or mortar, mirrored references, text: one command.

    Weights and both thrusts are those of half the rib, by an own programme.
    """
    voussoirs = pointed(tmp_path / "rippe.dxf", mortar=mortar)
    layers = ("--layer", "blocks=A-Mauerwerk.Rippe", "--layer", "supports=0-Auflager")
    more = ("--mu", "0.6", "--unit-weight", "22", "--depth", "0.3")
    close = ("--tolerance", repr(1.05e-3 * max(mortar, 2 * GAP)))
    told = answered("check", tmp_path / "rippe.dxf", *layers, *close, *more)
    assert (told["problem"]["blocks"], len(told["joints"])) == (14, 15)
    weights = 22 * 0.3 * voussoirs[:, 0]
    for each in told["reactions"]:
        assert each["vertical_kN"] == pytest.approx(weights.sum(), rel=1e-6)
    assert "areas are exact" in told["reason"]
    assert "1 TEXT on layer Maße" in told["reason"]
    # Joints are midway in the mortar: along the rays, and at x = 0.
    rays = np.linspace(math.pi, math.acos(-HALF / INNER), 8)[::-1]
    ends = [[np.array(on(radius, ray)) / 1e3 for radius in (INNER, OUTER)] for ray in rays]
    aside = HALF + mortar / 2
    ends[0] = [np.array([0.0, math.sqrt(r**2 - aside**2) / 1e3]) for r in (INNER, OUTER)]
    parts = [(0.0, 0.0), *zip(weights, voussoirs[:, 1], strict=True)]
    thrusts = thrusts_of_half([(low, high) for low, high in ends], parts, 0.6)
    assert (told["thrust_min_kN"], told["thrust_max_kN"]) == pytest.approx(thrusts, rel=1e-4)


def test_a_rib_without_a_unit_is_asked_for_one(tmp_path: Path) -> None:
    pointed(tmp_path / "rippe.dxf", unit=0)
    asked = ("check", str(tmp_path / "rippe.dxf"), "--mu", "0.6", "--tolerance", "0.001")
    layers = ("--layer", "blocks=A-Mauerwerk.Rippe", "--layer", "supports=0-Auflager")
    bare = refused(*asked, *layers)
    assert "unit is missing" in bare
    assert "it is 5000 by 4" in bare
    ran(*asked, *layers, "--unit", "mm")
    for wrong, words in (
        (("--layer", "blocks=Ripe"), "layer = 'Ripe': must be one of the file's: 0-Auf"),
        (("--layer", "stones=Rippe"), "--layer = 'stones=Rippe': must be blocks=NAME"),
        (("--unit", "ell"), "--unit = 'ell': must be m, mm, cm"),
    ):
        assert words in refused(*asked, *wrong)


@pytest.mark.parametrize("mortar", [0.0, 0.010])
def test_bricks_with_mortar_are_joined_across_it(tmp_path: Path, mortar: float) -> None:
    """A stack of one brick on another: it tips about the edge at atan(240 / height).

    Mortar has no weight, and is as high as it is drawn.
    """
    document = cast(Any, new_dxf(unit=4))
    brick = document.blocks.new("brick")
    for at, corner in enumerate(corners := [(0, 0), (240, 0), (240, 65), (0, 65)]):
        brick.add_line(corner, corners[(at + 1) % 4])
    space = document.modelspace()
    high = 65 + 1000 * mortar
    for k in range(8):
        # Turned by half a turn, each second.
        at, turn = ((240, k * high + 65), 180) if k % 2 else ((0, k * high), 0)
        space.add_blockref("brick", at, dxfattribs={"layer": "blocks", "rotation": turn})
    bed = [(-500, -300), (900, -300), (900, -1000 * mortar), (-500, -1000 * mortar)]
    space.add_lwpolyline(bed, close=True, dxfattribs={"layer": "supports"})
    document.saveas(tmp_path / "bricks.dxf")
    read = {"friction": 3.0, "tolerance": mortar or None}
    problem = load_structure(tmp_path / "bricks.dxf", **read)  # type: ignore[arg-type]
    assert len(problem.assembly.joints) == 8
    # Joints lie midway in the mortar: the lowest one is half of it below the bricks.
    lever = (7 * high + 65) / 2 + 500 * mortar
    found = bracket(problem, over="tilt").limit
    assert found == pytest.approx(math.degrees(math.atan(120 / lever)), rel=1e-6)


def ring(count: int, *, twice: bool) -> list[list[tuple[float, float]]]:
    """Lines of voussoirs side by side, those between two of them once or twice."""
    lines: list[list[tuple[float, float]]] = []
    for k in range(count):
        low, high = math.pi * k / count, math.pi * (k + 1) / count
        inner, outer = ([(r * math.cos(t), r * math.sin(t)) for t in (low, high)]
                        for r in (2, 3))  # fmt: skip
        lines += [inner, outer, [inner[0], outer[0]]]
        if twice or k == count - 1:
            lines.append([inner[1], outer[1]])
    return lines


def test_voussoirs_that_share_lines_are_told_from_the_opening() -> None:
    """Also where lines lie on a part of others, and beside a hole that they leave."""
    loops, wrong = loops_of(ring(7, twice=True))
    assert not wrong
    assert [len(loop.corners) for loop in loops] == [4] * 7
    square = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)]
    # Four blocks around an opening, each longer than the side of the one it meets.
    turns = [np.exp(0.5j * math.pi * k) for k in range(4)]
    blocks = [[((complex(x, y) + 1j * 1 - 0) * turn) for x, y in square] for turn in turns]
    lines = [
        [(p.real, p.imag) for p in (block[k], block[(k + 1) % 4])]
        for block in blocks
        for k in range(4)
    ]
    loops, wrong = loops_of(lines)
    assert not wrong
    areas = [abs(area([complex(*each) for each in loop.corners])) for loop in loops]
    assert areas == pytest.approx([2.0] * 4)


@given(kind=st.sampled_from(["wall", "rubble", "arch"]), seed=st.integers(0, 10**6))
def test_blocks_drawn_around_by_polylines_and_lines_are_put_together(
    kind: str, seed: int
) -> None:
    """Each a polyline of some of its sides, from anywhere, and the others as lines."""
    random = np.random.default_rng(seed)
    many = int(random.integers(3, 20))
    problem: Problem = {
        "wall": lambda: Wall(friction=0.7, courses=2 + many // 4),
        "rubble": lambda: Rubble(friction=0.7, stones=5 + many, seed=seed),
        "arch": lambda: CircularArch(friction=0.7, left_deg=80, right_deg=70, voussoirs=many),
    }[kind]().problem()
    blocks = [each.vertices for each in problem.assembly.blocks if random.random() < 0.8]
    lines = []
    for corners in blocks:
        turned = np.roll(corners, int(random.integers(len(corners))), axis=0).tolist()
        around = [(x, y) for x, y in [*turned, turned[0]]]
        first = int(random.integers(1, len(corners)))
        lines.append(around[: first + 1])
        sides = list(pairwise(around[first:]))
        lines += [list(sides[k]) for k in random.permutation(len(sides))]
    loops, wrong = loops_of(lines) if lines else ([], [])
    assert not wrong
    areas = sorted(shapely.Polygon(loop.corners).area for loop in loops)
    assert areas == pytest.approx(sorted(shapely.Polygon(each).area for each in blocks))


def area(path: list[complex]) -> float:
    """Return the area of a polygon of complex corners."""
    return (
        sum((a.conjugate() * b).imag for a, b in zip(path, path[1:] + path[:1], strict=True))
        / 2
    )


def test_a_line_drawn_once_between_two_blocks_is_refused_with_its_place(tmp_path: Path) -> None:
    """Nobody could tell a block from an opening."""
    loops, wrong = loops_of(ring(7, twice=False))
    assert not loops
    assert any(each.at == pytest.approx((2 * math.cos(math.pi / 7), 2 * math.sin(math.pi / 7)))
               for each in wrong)  # fmt: skip
    document, space = on_ground()
    for line in (((0, 0), (1, 0)), ((1, 0), (1, 1)), ((1, 1), (0.1, 1)), ((0, 0.9), (0, 0))):
        space.add_line(*line, dxfattribs={"layer": "blocks"})
    document.saveas(tmp_path / "open.dxf")
    with pytest.raises(InputError, match=r"LINE \w+ on layer blocks at \(0.1, 1\) = 'ends"):
        load_structure(tmp_path / "open.dxf", friction=0.6)
    snapped = load_structure(tmp_path / "open.dxf", friction=0.6, tolerance=0.0,
                             reading=Reading(snap=0.2))  # fmt: skip
    assert len(snapped.assembly.blocks) == 1
    assert any("apart are one corner" in note for note in snapped.notes)


INK = """<g xmlns:i="http://www.inkscape.org/namespaces/inkscape" i:label="Stones of the pier"
 id="layer1" transform="translate(10,0)">
<rect id="one" width="40" height="20" x="60" y="180"/>
<use xmlns:x="http://www.w3.org/1999/xlink" x:href="#one" id="two"
 transform="translate(0,-20)"/>
<use href="#deep" id="three" transform="matrix(-1 0 0 1 160 -60)"/>
<path id="cap" d="m 60,140 a 20,{b} 0 0 1 40,0 z"/>
<g id="deep"><path id="four" d="M60 200 60 220 100 220 100 200Z"/></g></g>
<g id="Ground"><rect id="bed" width="120" height="30" x="30" y="220"/></g>"""


@pytest.mark.parametrize("high", [20.0, 8.0])
def test_clones_and_arcs_of_inkscape(tmp_path: Path, high: float) -> None:
    head = 'viewBox="0 0 210 297" width="210mm" height="297mm"'
    path = written(tmp_path / "pier.svg", svg_of(INK.replace("{b}", f"{high:g}"), head))
    layers = {"blocks": ["stones of the pier"], "supports": ["ground"]}
    problem = load_structure(path, friction=0.6, reading=Reading(layers=layers))
    found = {block.name: block for block in problem.assembly.blocks}
    assert [*found] == ["one", "two", "three", "cap", "four"]
    assert found["three"].centre == pytest.approx([0.09, -0.15])
    brick = found["one"].mass
    # Half an ellipse of 20 by `high` mm, on bricks of 40 by 20.
    cap = math.pi * 20 * high / 2
    assert found["cap"].mass / brick == pytest.approx(cap / 800, rel=1e-12)
    # It tips about the edge of its bed: half its width over the height of its centroid, which
    # chords of the same area move by some hundredths of a millimetre.
    centroid = (3200 * 40 + cap * (80 + 4 * high / (3 * math.pi))) / (3200 + cap)
    found_tilt = math.radians(bracket(problem, over="tilt").limit or 0.0)
    assert math.tan(found_tilt) == pytest.approx(20 / centroid, rel=5e-5)


@given(st.floats(0.01, 5.0), st.sampled_from([-1.0, 1.0]), st.floats(-3, 3), st.floats(0.1, 9))
def test_chords_of_an_arc_have_its_area_and_its_ends(
    bulge: float, sign: float, turn: float, long: float
) -> None:
    start, end = 1 - 2j, 1 - 2j + long * np.exp(1j * turn)
    found = arc(start, end, sign * bulge)
    path = [start, *[complex(*each) for each in found.corners], end]
    beside = area([each - start for each in path])
    angle = 4 * math.atan(bulge)
    radius = long / 2 / math.sin(angle / 2)
    segment = sign * radius**2 / 2 * (angle - math.sin(angle))
    assert beside == pytest.approx(segment, rel=1e-9)
    # The arc is on the right of its chord where it turns counter-clockwise.
    assert found.stray <= 0.02 * abs(radius)
    middle = (start + end) / 2 - 1j * (end - start) / 2 * sign * bulge
    assert min(abs(each - middle) for each in path) < 0.3 * abs(radius)


def test_curves_of_svg_have_the_area_they_enclose() -> None:
    # 3/20 of the sum of cross products, by integrating a cubic by hand: here 0.6 * 0.75 * 4/3.
    found = bezier([0j, 1j, 1 + 1j, 1 + 0j])
    path = [0, *[complex(*each) for each in found.corners], 1]
    assert area(path) == pytest.approx(-0.6, rel=1e-12)
    assert bezier([0j, 1 + 0j, 2 + 0j, 3 + 0j]).corners == []
    assert bezier([0j, 1 + 1j, 2 - 1j, 3 + 0j]).wrong is not None
    large = ellipse(0j, 1 + 0j, (1.0, 1.0), 0.0, large=True, rising=True)
    swept = area([0, *[complex(*each) for each in large.corners], 1])
    sweep = 2 * math.pi - math.pi / 3
    assert swept == pytest.approx((sweep - math.sin(sweep)) / 2, rel=1e-9)


def test_what_is_refused_is_drawn_where_it_is(tmp_path: Path) -> None:
    """Each refusal has a ring with its number, also where blocks are refused later."""
    document, space = on_ground()
    space.add_circle((3, 2), 0.5, dxfattribs={"layer": "blocks"})
    space.add_line((0, 0), (1, 1), dxfattribs={"layer": "blocks"})
    document.saveas(tmp_path / "wrong.dxf")
    picture, out = tmp_path / "wrong.svg", tmp_path / "wrong.json"
    asked = ("convert", str(tmp_path / "wrong.dxf"), "--mu", "0.6", "--picture", str(picture))
    said = inside(*asked, "--out", out)
    assert said.returncode == 2
    assert "CIRCLE 33 on layer blocks at (3, 2)" in said.stderr
    assert not out.exists()
    text = picture.read_text("utf-8")
    assert text.count('id="refused-') == 3
    # A block that nothing holds is marked.
    document, space = on_ground()
    space.add_lwpolyline(square(0, 2), close=True, dxfattribs={"layer": "blocks"})
    document.saveas(tmp_path / "wrong.dxf")
    said = inside(*asked)
    assert "held by nothing" in said.stderr
    assert 'id="marked-' in picture.read_text("utf-8")
    # Of what is no drawing there is no picture, and it is named as without one.
    (tmp_path / "wrong.dxf").write_text("no drawing")
    said, plain = inside(*asked), inside(*asked[:-2], "--out", out)
    assert said.stderr == plain.stderr
    assert "wrong.dxf: file" in said.stderr


def test_depth_is_of_any_structure_in_the_plane(tmp_path: Path) -> None:
    """Twice as deep, twice as heavy; what has a depth of its own is refused."""
    for subject in (("wall",), ("portal",), (str(stack(tmp_path)),)):
        asked = ("check", *subject, "--mu", "0.6", "--unit-weight", "20")
        weights = [answered(*asked, "--depth", depth)["weight_kN"] for depth in ("0.5", "1")]
        assert weights[1] == pytest.approx(2 * weights[0], rel=1e-12)
    table = json.loads(stack(tmp_path).read_text())
    table["blocks"][1]["depth"] = 2.0
    (tmp_path / "own.json").write_text(json.dumps(table))
    deep = refused("check", tmp_path / "own.json", "--depth", "0.5")
    assert "blocks[1].depth = 2.0" in deep


def stack(folder: Path) -> Path:
    return written(folder / "stack.json", structure([[(0, 0), (1, 0), (1, 2), (0, 2)]]))


def test_a_tilted_table_is_borne_by_the_world(tmp_path: Path) -> None:
    """A wall of 24 kN on a table at 5 deg: its supports bear 24 kN up, and nothing sideways."""
    for subject in (("wall",), (str(stack(tmp_path)),)):
        asked = ("check", *subject, "--mu", "0.7", "--unit-weight", "10", "--tilt", "5")
        said = answered(*asked)
        up = sum(each["vertical_kN"] for each in said["reactions"])
        across = [each["horizontal_kN"] for each in said["reactions"]]
        assert up == pytest.approx(said["weight_kN"], rel=1e-9)
        assert abs(sum(across)) < 1e-9 * up
        assert "to the" not in inside(*asked).stdout.split("bears", 1)[1].split("\n")[0]
