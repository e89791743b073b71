"""Joints of drawings as people have them: rounded, with gaps and overlaps, or far too many."""

import json
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely
from drawn import Polygon, bricks, rounded, written
from hypothesis import given
from hypothesis import strategies as st
from running import answered, ran, refused

from blocksim import (
    InputError,
    Problem,
    Verdict,
    assembly_of_polygons,
    bracket,
    check,
    structure_of,
)


def asked(table: dict[str, Any], tmp_path: Path, *options: str) -> dict[str, Any]:
    """Ask a file by command."""
    path = written(tmp_path / "wall.json", table)
    return answered("check", path, "--method", "limit", *options, code=None)


# A wall slides where its bed is steeper than friction: tan 20 deg is 0.364, tan 33 deg 0.649.
ANGLES = [1, 10, 20, 45]


@pytest.mark.parametrize("degrees", ANGLES)
@pytest.mark.parametrize("decimals", [3, 4, 5])
def test_a_wall_of_few_decimals_is_answered(tmp_path: Path, degrees: int, decimals: int):
    said = asked(rounded(bricks(4, 4), degrees, decimals), tmp_path)
    assert said["problem"]["joints"] == 32
    assert said["verdict"] == ("stands" if degrees < 30 else "collapses")
    assert f"rounded to {10.0**-decimals:g} m" in said["reason"]
    assert "the same with blocks grown and shrunk" in said["reason"]
    gaps = [abs(joint["gap"]) for joint in said["joints"]]
    assert 0 < max(gaps) < 1.5 * 10.0**-decimals


def _answers(degrees: int, decimals: int) -> tuple[Verdict, int]:
    problem = structure_of(rounded(bricks(4, 4), degrees, decimals))
    return check(problem, method="limit").verdict, len(problem.assembly.joints)


@given(degrees=st.integers(0, 45), decimals=st.integers(3, 12))
def test_rounding_changes_no_verdict(degrees: int, decimals: int):
    assert _answers(degrees, decimals) == _answers(degrees, 15)


def spread(polygons: Sequence[Polygon], by: float) -> list[Polygon]:
    """Move each brick up and to the right by as much as its number says: gaps, no overlaps."""
    return [
        [
            (x + by * (polygon[0][0] / 0.25), y + by * (polygon[0][1] / 0.125 + 1))
            for x, y in polygon
        ]
        if at
        else polygon
        for at, polygon in enumerate(polygons)
    ]


@pytest.mark.parametrize("gap", [0.003, -0.003])
def test_gaps_and_overlaps_are_closed_as_asked_and_listed(tmp_path: Path, gap: float):
    table = rounded(spread(bricks(3, 3), gap), 7.0, 15)
    path = written(tmp_path / "wall.json", table)
    said = refused("check", path)
    assert "close the gap" in said or "--tolerance" in said
    said = asked(table, tmp_path, "--tolerance", "0.005")
    assert said["verdict"] == "stands"
    assert said["problem"]["joints"] == 16
    assert "within 0.005 m (as asked)" in said["reason"]
    level = [joint["gap"] for joint in said["joints"]]
    assert level == pytest.approx([gap] * len(level), rel=1e-6)
    assert f"{1000 * gap:+.3g} mm" in said["reason"]
    # Blocks may be told apart only as far as they are wide: a tolerance of a metre closes less.
    capped = asked(table, tmp_path, "--tolerance", "1")["reason"]
    assert "within 0.0256 m (a quarter of the narrower block; asked: 1 m)" in capped


@pytest.mark.parametrize("gap", [0.003, -0.003])
def test_closed_gaps_are_marked_in_the_still(gap: float):
    """Each joint at which one is closed; the legend has their size, others their own.

    Of a drawing merely rounded there are none.
    """
    wall = spread(bricks(3, 3), gap)
    closed = structure_of(rounded(wall, 7.0, 15, tolerance=0.005))
    marked = marks(closed)
    assert {name for name in marked if "size" not in name} == {f"gap-{k}" for k in range(16)}
    sizes = [words for name, words in marked.items() if "size" in name]
    assert not sizes
    (legend,) = closed.plot().legends
    said = [each.get_text() for each in legend.get_texts()]
    assert f"closed gap (+) or overlap (-), {1000 * gap:+.3g} mm where not said" in said
    stack, level = bricks(0, 3), 0.0
    for closed in (gap, gap / 3, gap):
        level += closed
        stack.append([(0.0, level), (0.5, level), (0.5, level + 0.2), (0.0, level + 0.2)])
        level += 0.2
    other = marks(structure_of(rounded(stack, 0.0, 15, tolerance=0.005)))
    assert [other[name] for name in other if "size" in name] == [f"{1000 * gap / 3:+.3g} mm"]
    assert not marks(structure_of(rounded(bricks(3, 3), 7.0, 5)))


def marks(problem: Problem) -> dict[str, str]:
    """Artists of gaps in the still, by their gid, with their words."""
    artists = problem.plot().findobj()
    named = {str(each.get_gid()): getattr(each, "get_text", str)() for each in artists}
    return {name: words for name, words in named.items() if name.startswith("gap-")}


@pytest.mark.parametrize("method", ["limit", "direct", "pymunk"])
def test_the_answer_names_what_closing_can_do(method: str):
    """A brick on the edge of a bed: its weight is 2 mm beyond the edge, or within it."""
    bed = [(-1.0, -0.2), (0.1231, -0.2), (0.1231, 0.0), (-1.0, 0.0)]
    brick = [(0.0, 0.003), (0.25, 0.003), (0.25, 0.128), (0.0, 0.128)]
    problem = structure_of(rounded([bed, brick], 0.0, 15, tolerance=0.005))
    found = check(problem, method=method)
    assert found.verdict is Verdict.COLLAPSES
    assert "leaves it open: stands with blocks grown" in found.reason
    assert method != "limit" or "3 mm at most" in found.reason


def test_tolerances_are_those_of_the_blocks_at_the_joint():
    """A pebble's gap of a hundredth of it is a gap, however large the pier beside it."""
    pier: Polygon = [(2.0, 0.0), (12.0, 0.0), (12.0, 10.0), (2.0, 10.0)]
    bed: Polygon = [(-1.0, -1.0), (13.0, -1.0), (13.0, 0.0), (-1.0, 0.0)]
    size, gap = 1e-3, 1 / 3e6
    pebble: Polygon = [(0.0, gap), (size, gap), (size, gap + size), (0.0, gap + size)]
    with pytest.raises(InputError, match="block 2 = 'held by nothing'"):
        assembly_of_polygons([bed, pier, pebble], fixed=[0])
    larger = [(x / size, y - gap) for x, y in pebble]
    assert len(assembly_of_polygons([bed, pier, larger], fixed=[0]).joints) == 2


def test_the_first_overlap_is_enough(monkeypatch: pytest.MonkeyPatch):
    """2,000 squares on one place overlap in two million pairs, of which few are looked at."""
    pairs: list[int] = []
    intersection: Any = shapely.intersection

    def counted(one: Any, other: Any) -> Any:
        pairs.append(len(one))
        return intersection(one, other)

    monkeypatch.setattr(shapely, "intersection", counted)
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    with pytest.raises(InputError, match="overlap of blocks 0 and 1"):
        assembly_of_polygons([square] * 2000, fixed=[0])
    assert sum(pairs) <= 4 * 2000


def test_closed_gaps_are_marked_in_dxf(tmp_path: Path):
    """A line and a size for each joint that closes one; it is read as the same structure."""
    drawing = tmp_path / "wall.json"
    drawing.write_text(
        json.dumps(rounded(spread(bricks(3, 3), 0.003), 7.0, 15, tolerance=0.005))
    )
    written = tmp_path / "wall.dxf"
    ran("render", drawing, "--out", written)
    space = ezdxf.readfile(written).modelspace()
    kinds = Counter(each.dxftype() for each in space.query('*[layer=="gaps"]'))
    assert kinds == {"LINE": 16, "TEXT": 16}
    assert {each.dxf.text for each in space.query('TEXT[layer=="gaps"]')} == {"+3 mm"}


@pytest.mark.parametrize("method", ["limit", "direct"])
def test_a_bracket_says_what_closing_can_do(method: str):
    """A brick 3 mm above its bed is pushed, and tips about an end of its joint.

    That is 3 mm farther out with blocks grown, and nearer with blocks shrunk.
    """
    bed = [(-1.0, -0.2), (1.0, -0.2), (1.0, 0.0), (-1.0, 0.0)]
    brick = [(0.0, 0.003), (0.1, 0.003), (0.1, 0.303), (0.0, 0.303)]
    table = rounded([bed, brick], 0.0, 15, tolerance=0.005, live=[{"body": [1, 0]}])
    found = bracket(structure_of(table), over="load", method=method)
    assert found.limit
    arm = 0.05 / found.limit  # of the centre above the joint, which is within the gap
    assert 0.15 < arm < 0.153
    said = found.reason.split("the drawing leaves ")[1]
    values = [float(each) for each in re.findall(r"0\.\d+", said)[:3]]
    assert values == pytest.approx([0.05 / arm, 0.053 / arm, 0.047 / arm], rel=1e-5)
