"""The speed-accuracy chart: its front, its gain, and errors that are true."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from blocksim.errors import InputError
from blocksim.report.chart import read_points, write_chart, write_points
from blocksim.workprec import Case, Point, front, gain, measure


def point(method: str, error: float, *seconds: float) -> Point:
    return Point(
        case="an arch",
        method=method,
        tol=error,
        error=error,
        undecided=0,
        work=1.0,
        seconds=seconds,
    )


POINTS = [
    point("pymunk", 1e-2, 1.0),
    point("pymunk", 2e-5, 5.0, 4.0, 90.0),
    point("direct", 1e-7, 4.0),
    point("direct", 1e-9, 9.0),
    point("pybullet", math.inf, 0.1),
]


def test_the_front_is_what_nothing_beats() -> None:
    assert front(POINTS) == [POINTS[0], POINTS[2], POINTS[3]]


def test_gain_is_taken_at_equal_time() -> None:
    """The median of the repeats counts: 5 s buy direct the error it has after 4 s."""
    assert gain(POINTS, "direct", "pymunk") == pytest.approx(200)


def test_brackets_hold_the_exact_value_and_narrow(tmp_path: Path) -> None:
    case = Case(name="small: 90 deg", half_angle=math.pi / 2, mu=0.7, voussoirs=9)
    points = measure([case], ["direct", "pymunk"], repeats=2)
    for each in points:
        # The farther end of a bracket that holds the exact value.
        assert each.tol / 8 < each.error <= each.tol
        assert len(each.seconds) == 2
        assert each.undecided == 0
    made = write_chart(points, tmp_path)
    assert {path.name for path in made} == {"chart.json", "chart.png", "chart.svg"}
    document = json.loads((tmp_path / "chart.json").read_text(), parse_constant=pytest.fail)
    assert len(document["points"]) == len(points)
    assert document["machine"]["python"]


def test_points_of_another_program_are_drawn_beside(tmp_path: Path) -> None:
    foreign = [point("elsewhere", 1e-3, 2.0), point("elsewhere", math.inf, 1.0)]
    path = tmp_path / "points.json"
    write_points(foreign, path)
    assert read_points(path) == foreign
    write_chart([*POINTS, *read_points(path)], tmp_path)
    assert "elsewhere" in (tmp_path / "chart.json").read_text()


@pytest.mark.parametrize(
    "text", ["", "[]", '{"points": [{"case": "an arch"}]}', '{"points": 1}']
)
def test_what_holds_no_points_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "points.json"
    path.write_text(text)
    with pytest.raises(InputError, match="written by blocksim chart"):
        read_points(path)
    with pytest.raises(InputError, match="file"):
        read_points(tmp_path / "none.json")
