"""Drawings and files of other programs: read as structures, or refused in one line."""

import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from drawn import (
    GROUND,
    Polygon,
    compas_of,
    new_dxf,
    on_ground,
    square,
    structure,
    svg_of,
    wall,
    write_dxf,
    written,
)
from running import answered, ran, refused

from blocksim import InputError, Problem, Reading, bracket, check, load_structure, structure_of

pytestmark = pytest.mark.usefixtures("wide_window")

WALL = wall()
"""40 polygons."""


def corners(problem: Problem) -> list[np.ndarray]:
    """Corners of all blocks and supports, each from its lowest left one on."""
    polygons = [block.vertices for block in problem.assembly.blocks]
    polygons += [part for each in problem.assembly.supports for part in each.polygons]
    firsts = [np.lexsort((each[:, 0], each[:, 1]))[0] for each in polygons]
    return [np.roll(each, -k, axis=0) for each, k in zip(polygons, firsts, strict=True)]


def answers(problem: Problem) -> np.ndarray:
    """Tilt at which it falls [deg], and its least friction tilted by 20 deg."""
    tilted = problem.tilted(math.radians(20))
    asked = bracket(problem, over="tilt"), bracket(tilted, over="mu")
    return np.array([each.limit for each in asked])


@pytest.fixture(scope="module")
def known() -> Problem:
    return structure_of(structure(WALL))


@pytest.fixture(scope="module")
def told(known: Problem) -> np.ndarray:
    return answers(known)


@pytest.mark.parametrize(
    ("version", "unit", "scale"),
    [("R12", 6, 1.0), ("R2018", 4, 1000.0)],
)
def test_forty_polylines_are_answered_as_the_same_polygons(
    tmp_path: Path, known: Problem, told: np.ndarray, version: str, unit: int, scale: float
) -> None:
    """Corners of a running bond lie on the edges of others; R12 knows no unit."""
    path = write_dxf(tmp_path / "wall.DXF", WALL, scale=scale, unit=unit, version=version)
    asked = Reading(unit="m") if version == "R12" else Reading()
    drawn = load_structure(path, friction=0.7, reading=asked)
    assert len(drawn.assembly.blocks) == 40
    # 7 courses of 9 or 10 bed joints, 4 heads in each of 8, 5 on the ground.
    assert len(drawn.assembly.joints) == len(known.assembly.joints) == 7 * 9 + 8 * 4 + 5
    for one, other in zip(corners(drawn), corners(known), strict=True):
        assert one == pytest.approx(other, abs=1e-12)
    assert answers(drawn) == pytest.approx(told, rel=1e-12)
    said = {"R12": "a unit of the file is m, as asked", "R2018": "unit mm, by"}
    assert said[version] in drawn.notes[0]
    # Which way round an outline was drawn is no matter to be told of.
    assert len(drawn.notes) == 2


def test_round_off_doubled_and_straight_corners_change_no_joint(
    tmp_path: Path, known: Problem, told: np.ndarray
) -> None:
    """As CAD leaves them: off by 1e-8 m, given twice, and on straight edges."""
    draw = np.random.default_rng(5)
    dirty = []
    for polygon in WALL:
        (ax, ay), (bx, by), *rest = [p + draw.normal(0, 1e-8, 2) for p in np.array(polygon)]
        middle = ((ax + bx) / 2, (ay + by) / 2)
        dirty.append([(ax, ay), (ax, ay), middle, (bx, by), *map(tuple, rest)])
    drawn = load_structure(write_dxf(tmp_path / "wall.dxf", dirty), friction=0.7)
    assert len(drawn.assembly.joints) == len(known.assembly.joints)
    assert answers(drawn) == pytest.approx(told, rel=1e-6)


def test_what_is_no_block_is_listed_not_guessed(tmp_path: Path) -> None:
    document = new_dxf()
    space = document.modelspace()
    block, support = {"layer": "blocks"}, {"layer": "SUPPORTS"}
    space.add_lwpolyline(GROUND, close=True, dxfattribs=support)
    space.add_lwpolyline([(0, 0), (1, 0), (1, 2), (0, 2)], close=True, dxfattribs=block)
    space.add_lwpolyline([(3, 5), (4, 5), (4, 6)], close=True, dxfattribs={"layer": "notes"})
    for at in range(3):
        space.add_text("b", dxfattribs=block).set_placement((at, 1))
    space.add_circle((0, 0), 1, dxfattribs={"layer": "notes"})
    space.add_hatch(dxfattribs={"layer": "notes"})
    document.saveas(tmp_path / "column.dxf")
    problem = load_structure(tmp_path / "column.dxf", friction=0.7)
    assert len(problem.assembly.blocks) == 1
    note = next(each for each in problem.notes if each.startswith("left out"))
    for part in (
        "3 TEXT on layer blocks",
        "1 LWPOLYLINE",
        "1 CIRCLE",
        "1 HATCH on layer notes",
    ):
        assert part in note
    assert "3 TEXT on layer blocks" in ran("check", tmp_path / "column.dxf", "--mu", "0.7")


STRANGE: dict[str, Callable[[Any], object]] = {
    "LINE": lambda space: space.add_line((3, 0), (4, 0)),
    "ARC": lambda space: space.add_arc((3, 0), 1, 0, 90),
    "CIRCLE": lambda space: space.add_circle((3, 0), 1),
    "SPLINE": lambda space: space.add_spline([(3, 0), (4, 0), (4, 1), (3, 1)]),
    "HATCH": lambda space: space.add_hatch(),
    "open LWPOLYLINE": lambda space: space.add_lwpolyline([(3, 0), (4, 0), (4, 1)]),
    "INSERT": lambda space: space.add_blockref("nothing", (0, 0)),
}


@pytest.mark.parametrize("layer", ["blocks", "Supports"])
@pytest.mark.parametrize("kind", STRANGE)
def test_nothing_on_a_layer_of_blocks_is_left_out(tmp_path: Path, kind: str, layer: str):
    document, space = on_ground()
    space.add_lwpolyline(SQUARE, close=True, dxfattribs={"layer": "blocks"})
    cast(Any, STRANGE[kind](space)).dxf.layer = layer
    document.saveas(tmp_path / "strange.dxf")
    with pytest.raises(InputError, match=rf"{kind} \w+ on layer {layer}"):
        load_structure(tmp_path / "strange.dxf", friction=0.7)


def test_blocks_that_are_inserted_are_blocks(tmp_path: Path) -> None:
    """A stone drawn once, inserted thrice within another block, turned and mirrored."""
    document, space = on_ground()
    stone, pile = document.blocks.new("stone"), document.blocks.new("pile")
    stone.add_lwpolyline([(0, 0), (2, 0), (2, 1), (0, 1)], close=True)
    pile.add_blockref("stone", (0, 0), dxfattribs={"layer": "0"})
    pile.add_blockref("stone", (2, 2), dxfattribs={"layer": "0", "rotation": 180})
    pile.add_blockref("stone", (2, 2), dxfattribs={"layer": "0", "xscale": -1})
    space.add_blockref("pile", (0, 0), dxfattribs={"layer": "blocks"})
    document.saveas(tmp_path / "pile.dxf")
    problem = load_structure(tmp_path / "pile.dxf", friction=0.7)
    assert len(problem.assembly.blocks) == len(problem.assembly.joints) == 3
    middles = np.array([block.centre for block in problem.assembly.blocks])
    assert middles == pytest.approx(np.array([(1, 0.5), (1, 1.5), (1, 2.5)]))


@pytest.mark.parametrize(
    "strange",
    ['<use href="#b"/>', '<circle r="1"/>', '<path d="M0 0A1 1 0 0 1 2 2"/>', "<svg/>",
     '<line x2="1"/>', '<polyline points="0,0 1,1 2,0"/>', "<image/>", "<unknown/>",
     '<rect width="1" height="1" style="transform: rotate(9deg)"/>'],
)  # fmt: skip
def test_nothing_in_a_group_of_blocks_is_left_out(tmp_path: Path, strange: str) -> None:
    inside_it = f'<g id="supports"><rect id="a" width="4" height="1"/>{strange}</g>'
    blocks = '<g id="blocks"><rect y="-1" width="1" height="1"/></g>'
    path = written(tmp_path / "strange.svg", svg_of(inside_it + blocks))
    name = re.findall(r"\w+", strange)[0]
    with pytest.raises(InputError, match=name):
        load_structure(path, friction=0.7)


def test_a_mirrored_polyline_is_where_it_is_seen(tmp_path: Path) -> None:
    """CAD keeps what was mirrored in coordinates of its own, x to the left."""
    document, space = on_ground()
    attributes = {"layer": "blocks", "extrusion": (0, 0, -1)}
    space.add_lwpolyline([(-3, 0), (-2, 0), (-2, 1)], close=True, dxfattribs=attributes)
    document.saveas(tmp_path / "mirrored.dxf")
    found = corners(load_structure(tmp_path / "mirrored.dxf", friction=0.7))[0]
    assert {tuple(each) for each in found} == {(3.0, 0.0), (2.0, 0.0), (2.0, 1.0)}


@pytest.mark.parametrize("command", ["check", "bracket", "simulate", "render"])
def test_every_question_takes_a_drawing(tmp_path: Path, command: str) -> None:
    path = str(write_dxf(tmp_path / "pier.dxf", [[(0, 0), (1, 0), (1, 4), (0, 4)]]))
    more = {
        "check": [],
        "bracket": ["--over", "tilt", "--json"],
        "simulate": ["--tilt", "20", "--out", str(tmp_path / "run.npz")],
        "render": ["--out", str(tmp_path / "pier.svg")],
    }
    done = ran(command, path, "--mu", "0.7", *more[command])
    if command == "bracket":
        assert json.loads(done)["limit"] == pytest.approx(math.degrees(math.atan(0.25)))


SHAPES = """
<defs><rect id="hidden" x="0" y="0" width="9" height="9"/></defs>
<rect width="100%" height="100%"/>
<g id="supports"><rect x="-1000" y="0" width="8000" height="1000"/></g>
<g transform="translate(1000 0)"><g class="stone Blocks">
  <g transform="matrix(1 0 0 1 0 -300) scale(2,1)">
    <polygon id="low" points="0,0 500,0 500,300 0,300"/></g>
  <rect id="mid" x="-1000" y="-600" width="1000" height="300"
        transform="rotate(180) translate(0,900)"/>
  <path id="top" d="m 0-600 h 1e3 v-3e2 l-1000 0z"/>
  <circle r="3"/><text>one</text>
</g></g>
"""


def test_svg_with_transforms_units_and_layers(tmp_path: Path) -> None:
    """Three courses of 1 by 0.3 m at x = 1 m, each drawn by another element."""
    head = 'viewBox="-1000 -2000 8000 3000" width="8000mm" height="3000mm"'
    path = written(
        tmp_path / "courses.svg", svg_of(SHAPES.replace('<circle r="3"/>', ""), head)
    )
    problem = load_structure(path, friction=0.5)
    names = [block.name for block in problem.assembly.blocks]
    assert names == ["low", "mid", "top"]
    for at, found in enumerate(corners(problem)[:3]):
        low, top = 0.3 * at, 0.3 * (at + 1)
        expected = [(1, low), (2, low), (2, top), (1, top)]
        assert found == pytest.approx(np.array(expected), abs=1e-12)
    assert "0.001 m, by the width" in problem.notes[0]
    assert "1 rect" in problem.notes[1]
    assert "1 text on layer Blocks" in problem.notes[1]


HEAD = 'viewBox="-1000 -2000 8000 3000" width="8000mm" height="3000mm"'
READ = ["utf-8", "utf-8-sig", "utf-16", "us-ascii", "iso-8859-1", "windows-1252", "koi8-r"]
NOT_READ = [
    "utf-32", "utf-7", "shift_jis", "gb18030", "cp037", "rot13", "hex", "idna", "none", "",
]  # fmt: skip


@pytest.mark.parametrize("encoding", [*READ, *NOT_READ])
def test_svg_of_any_encoding_is_read_or_refused_in_a_line(
    tmp_path: Path, encoding: str
) -> None:
    drawing = svg_of(SHAPES.replace('<circle r="3"/>', ""), HEAD)
    drawing = drawing[drawing.index("<svg") :]
    said = encoding.removesuffix("-sig")
    text = f'<?xml version="1.0" encoding="{said}"?>{drawing}'
    path = tmp_path / "courses.svg"
    path.write_bytes(text.encode(encoding if encoding in {*READ, *NOT_READ[:5]} else "ascii"))
    if encoding in READ:
        assert len(load_structure(path, friction=0.5).assembly.blocks) == 3
        return
    with pytest.raises(InputError) as refused:
        load_structure(path, friction=0.5)
    assert "a valid SVG file" in str(refused.value)
    assert "\n" not in str(refused.value)


def test_svg_and_dxf_of_a_wall_are_one_problem(tmp_path: Path, told: np.ndarray) -> None:
    def polygon(each: Polygon) -> str:
        return f'<polygon points="{" ".join(f"{x!r},{-y!r}" for x, y in each)}"/>'

    body = f'<g id="supports">{polygon(GROUND)}</g>'
    body += f'<g id="blocks">{"".join(map(polygon, WALL))}</g>'
    path = written(tmp_path / "wall.svg", svg_of(body))
    drawn = load_structure(path, friction=0.7, reading=Reading(unit=1.0))
    assert answers(drawn) == pytest.approx(told, rel=1e-12)
    with pytest.raises(InputError, match=r"unit is missing.*it is 8 by 3\.4 units large"):
        load_structure(path, friction=0.7)


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_an_assembly_of_compas_is_its_section(
    tmp_path: Path, told: np.ndarray, turn: float
) -> None:
    """Also where it was built askew in plan; its depth is kept."""
    table = compas_of([GROUND, *WALL], [0])
    for node in table["data"]["graph"]["data"]["node"].values():
        for p in node["block"]["data"]["vertex"].values():
            x, y = p["x"], p["y"]
            p["x"] = x * math.cos(turn) - y * math.sin(turn)
            p["y"] = x * math.sin(turn) + y * math.cos(turn)
    drawn = load_structure(written(tmp_path / "wall.json", table), friction=0.7)
    assert [block.depth for block in drawn.assembly.blocks] == pytest.approx([0.5] * 40)
    assert answers(drawn) == pytest.approx(told, rel=1e-9)


def test_least_friction_of_the_bridge_of_compas_cra(tmp_path: Path) -> None:
    """Its own file (MIT, see the licence beside it), with the supports and the weights of its
    example: blocks 11 to 15 are 3.51 times as heavy. An independent linear programme found
    0.06956349629.
    """
    scene = Path(__file__).parent / "structures" / "scenes" / "compas_cra_bridge.json"
    out = tmp_path / "bridge.json"
    ran("convert", scene, "--mu", "0.9", "--fixed", "0,1", "--out", out)
    table = json.loads(out.read_text())
    bare = load_structure(out).assembly.blocks
    weights = {block.name: block.mass * 9.81 for block in bare}
    for block in table["blocks"]:
        if int(block["id"]) >= 11:
            block["weight"] = 3.51 * weights[block["id"]]
    found = bracket(structure_of(table), over="mu").limit
    assert found == pytest.approx(0.06956349629, rel=2e-8)


def test_a_converted_drawing_is_the_same_problem(tmp_path: Path, told: np.ndarray) -> None:
    path = write_dxf(tmp_path / "wall.dxf", WALL, scale=100, unit=0)
    out = tmp_path / "wall.json"
    done = ran("convert", path, "--mu", "0.7", "--unit", "0.01", "--out", out)
    assert "40 blocks, 1 support, 100 joints" in done
    written_ = load_structure(out)
    assert answers(written_) == pytest.approx(told, rel=1e-12)
    assert "0.01 m, as asked" in written_.notes[0]
    # People add to it: a line for each block.
    table = json.loads(out.read_text())
    assert out.read_text().count('{"id"') == 41
    table["live"] = [{"body": [1, 0]}]
    out.write_text(json.dumps(table))
    assert answered("check", out)["load_factor"] == (
        pytest.approx(
            check(structure_of(structure(WALL) | {"live": table["live"]})).load_factor
        )
    )


def test_supports_of_an_assembly_are_named_when_it_is_converted(tmp_path: Path) -> None:
    path = written(tmp_path / "wall.json", compas_of([GROUND, *WALL], []))
    out = str(tmp_path / "held.json")
    ran("convert", path, "--mu", "0.7", "--fixed", "0", "--out", out)
    assert len(load_structure(out).assembly.supports) == 1


SQUARE = square(0.0, 0.0)


def _dxf(tmp_path: Path, *polygons: object, layer: str = "blocks", **more: object) -> str:
    document, space = on_ground()
    for polygon in polygons:
        space.add_lwpolyline(
            polygon, **({"close": True, "dxfattribs": {"layer": layer}} | more)
        )
    document.saveas(tmp_path / "made.dxf")
    return (tmp_path / "made.dxf").read_text()


def _recursive(tmp_path: Path) -> str:
    document = new_dxf()
    one, two = document.blocks.new("one"), document.blocks.new("two")
    one.add_blockref("two", (0, 0))
    two.add_blockref("one", (0, 0))
    document.modelspace().add_blockref("one", (0, 0), dxfattribs={"layer": "blocks"})
    document.saveas(tmp_path / "made.dxf")
    return (tmp_path / "made.dxf").read_text()


def _count(text: str, count: int) -> str:
    """Say that the last polyline has another number of corners."""
    head, tail = text.rsplit("\n 90\n4\n", 1)
    return f"{head}\n 90\n{count}\n{tail}"


RECT = '<rect width="1" height="1"/>'
UNITS = "$INSUNITS\n 70\n6"
BROKEN = {
    # DXF
    "rubbish.dxf": (lambda _: bytes(range(256)) * 40, "valid DXF"),
    "empty.dxf": (lambda _: b"", "not empty"),
    "text.dxf": (lambda _: "an arch, 8 m wide\n" * 9, "valid DXF"),
    "truncated.dxf": (lambda path: _dxf(path, SQUARE)[:-2000], "valid DXF"),
    "shuffled.dxf": (lambda path: _dxf(path, SQUARE).replace("SECTION", "TCES", 3), "DXF"),
    "binary.dxf": (lambda _: b"AutoCAD Binary DXF\r\n\x1a\x00" + bytes(500), "valid DXF"),
    "nan.dxf": (lambda path: _dxf(path, [(0, 0), (1, 0), (1, 7.125)]).replace("7.125", "nan"),
                "must be -1e+09 to 1e+09 m"),
    "words.dxf": (lambda path: _dxf(path, [(0, 0), (1, 0), (1, 7.125)]).replace("7.125", "up"),
                  "valid DXF"),
    "far.dxf": (lambda path: _dxf(path, [(0, 0), (1e300, 0), (1, 1)]), "within 1e+09 m"),
    "layers.dxf": (lambda path: _dxf(path, SQUARE, layer="Mauerwerk"),
                   "1 LWPOLYLINE on layer Mauerwerk"),
    "open.dxf": (lambda path: _dxf(path, SQUARE, close=False),
                 "on layer blocks at (0, 0) = 'ends there, and meets no other line (ends"),
    "recursive.dxf": (_recursive, "block references without a loop"),
    "steep.dxf": (lambda path: _dxf(path, SQUARE, dxfattribs={"layer": "blocks",
                  "extrusion": (0, 1, 0)}), "not in the xy plane"),
    "crossing.dxf": (lambda path: _dxf(path, [(0, 0), (1, 1), (1, 0), (0, 1)]), "cross itself"),
    "overlap.dxf": (lambda path: _dxf(path, SQUARE, [(0.5, 0), (1.5, 0), (1.5, 1), (0.5, 1)]),
                    "overlap of blocks"),
    "flat.dxf": (lambda path: _dxf(path, [(0, 0), (1, 0), (2, 0)]), "block "),
    "two.dxf": (lambda path: _dxf(path, [(0, 0), (1, 0), (0, 0)]), "at least three"),
    "floating.dxf": (lambda path: _dxf(path, [(0, 3), (1, 3), (1, 4)]), "held by nothing"),
    "miles.dxf": (lambda path: _dxf(path, SQUARE).replace(UNITS, UNITS[:-1] + "3"), "INSUNITS"),
    # Of SVG and of assemblies of compas others are rows of refused.json.
    "deep.svg": (lambda _: svg_of("<g>" * 10_000 + RECT + "</g>" * 10_000), "at most 256 deep"),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_broken_files_are_refused_in_one_line(tmp_path: Path, name: str) -> None:
    make, said = BROKEN[name]
    path = written(tmp_path / name, make(tmp_path))
    done = refused("check", path, "--mu", "0.7")
    assert said in done
    assert name in done
    assert len(done) < 700 + len(str(path))


def test_a_number_of_corners_that_is_a_lie_costs_nothing(tmp_path: Path) -> None:
    """The corners are those that follow, whatever number was said."""
    text = _count(_dxf(tmp_path, SQUARE), 2_000_000_000)
    problem = load_structure(written(tmp_path / "count.dxf", text), friction=0.7)
    assert len(problem.assembly.blocks) == 1


def test_a_large_drawing_is_not_read(tmp_path: Path) -> None:
    for name in ("large.dxf", "large.svg"):
        with (tmp_path / name).open("wb") as file:
            file.truncate(20_000_001)
        with pytest.raises(InputError, match="at most 20000000 bytes"):
            load_structure(tmp_path / name, friction=0.7)
