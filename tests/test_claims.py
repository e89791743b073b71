"""What pictures claim: what is drawn is where it says, and what has parted looks parted."""

from collections.abc import Callable
from pathlib import Path
from runpy import run_path

import numpy as np
import pytest
from running import ran

from blocksim import (
    Check,
    CircularArch,
    EllipticArch,
    Portal,
    Problem,
    check,
    load,
    load_recording,
)

DOCS = Path(__file__).parents[1] / "docs"


def test_supports_that_have_spread_bear_the_blocks_where_they_are(tmp_path: Path) -> None:
    """Each springing lies on the face of its support, 1 % of the span further apart."""
    name, run = "spread_90_12_20", str(tmp_path / "run.npz")
    asked = ("simulate", name, "--spread", "0.01", "--seconds", "0.01", "--out", run)
    ran(*asked)
    known, moved = load(name), load_recording(run).problem
    for problem, span in ((known, 0.94), (moved, 0.95)):
        left, right = (np.concatenate(each.polygons) for each in problem.assembly.supports)
        assert right[:, 0].min() - left[:, 0].max() == pytest.approx(span, abs=1e-9)
    for joint in moved.assembly.springings:
        corners = np.concatenate(moved.assembly.supports[joint.support or 0].polygons)
        near = np.abs(corners[:, None] - [joint.inner, joint.outer]).max(axis=-1).min(axis=0)
        assert near.max() < 1e-6


def safest_lines(answer: Check) -> list[np.ndarray]:
    """Lines of thrust of greatest margin as they are drawn."""
    (axes,) = answer.plot().axes
    return [
        each.get_xydata()
        for each in axes.lines
        if str(each.get_gid()).startswith("thrust-safest-")
    ]


def test_a_line_of_thrust_leaves_a_gable_along_its_reaction() -> None:
    answer = check(load("gable"))
    (path,) = safest_lines(answer)
    path = path if path[0, 0] < path[-1, 0] else path[::-1]
    told = answer.to_dict()["reactions"][0]
    ways = path[1] - path[0], (told["horizontal_kN"], told["vertical_kN"])
    angles = [np.degrees(np.arctan2(y, x)) for x, y in ways]
    assert angles[0] == pytest.approx(angles[1], abs=1e-6)


def test_the_band_along_a_line_of_thrust_is_as_wide_as_the_force() -> None:
    """Of an arch under its own weight: thrust, the same everywhere, and weight above."""
    arch = CircularArch(half_angle_deg=70, eta=0.25, friction=0.7, voussoirs=14)
    answer = check(arch, method="limit")
    (axes,) = answer.plot().axes
    (band,) = [each for each in axes.collections if each.get_gid() == "force-band-0"]
    widths = np.asarray(band.get_linewidths())
    told = answer.to_dict()
    weight, horizontal = told["weight_kN"], abs(told["reactions"][0]["horizontal_kN"])
    middles = np.array([each.mean(axis=0) for each in band.get_segments()])
    # At each end of the line half of all weight is borne; at the crown's joint none.
    ends = np.hypot(horizontal, weight / 2), horizontal
    crown = widths[np.abs(middles[:, 0]).argmin()]
    assert widths.max() / crown == pytest.approx(ends[0] / ends[1], rel=1e-6)
    assert widths[0] == widths[-1] == widths.max()


def test_the_sketch_points_at_its_line_of_thrust() -> None:
    (axes,) = run_path(str(DOCS / "sketch.py"))["figure"]().axes
    (line,) = [each.get_xydata() for each in axes.lines if each.get_gid() == "thrust"]
    (words,) = [each for each in axes.texts if each.get_text() == "line of thrust"]
    assert np.hypot(*(line - words.xy).T).min() < 1e-12


def mirrored(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """Which block and joint lies where another does in a mirror, by brute force."""
    centres = problem.assembly.built[:-1, :2]
    middles = problem.assembly.joint_arrays.ends.mean(axis=1)
    axis = (centres[:, 0].min() + centres[:, 0].max()) / 2
    return tuple(
        np.abs(each[:, None] - (each - [axis, 0]) * [-1, 1] - [axis, 0])
        .max(axis=-1)
        .argmin(axis=0)
        for each in (centres, middles)
    )


def thin_portal() -> Problem:
    arch = CircularArch(half_angle_deg=90, radius=1, thickness=0.2, voussoirs=15)
    return Portal(arch=arch, pier_width=0.3, pier_height=3, friction=0.7).problem()


SYMMETRIC: dict[str, Callable[[], Problem]] = {
    "pointed arch": lambda: load("pointed_e0_25"),
    "two spans": lambda: load("two_spans_load_b9"),
    "upright joints": lambda: load("semicircle_vertical_joints"),
    "thin ellipse": EllipticArch(
        span=2.0, rise=0.7, thickness=0.03, voussoirs=21, friction=0.7
    ).problem,
    "thin portal": thin_portal,
}


@pytest.mark.parametrize("made", SYMMETRIC.values(), ids=SYMMETRIC)
def test_what_is_drawn_of_a_symmetric_structure_is_symmetric(
    made: Callable[[], Problem],
) -> None:
    """Lines of thrust, mechanism, joint states and reactions, not a corner of a programme."""
    problem = made()
    answer = check(problem, method="limit")
    blocks, joints = mirrored(problem)
    # Which end of a pier's joint is the inner one differs from side to side.
    states = [joint.state.value.split("-")[0] for joint in answer.joints]
    assert states == [states[each] for each in joints]
    if answer.mechanism is not None:
        moved = answer.mechanism
        assert moved == pytest.approx(moved[blocks] * [-1, 1, -1], abs=1e-9)
    lines = safest_lines(answer) if answer.verdict == "stands" else []
    if lines:
        points = np.concatenate(lines)
        axis = problem.assembly.built[:-1, 0].mean() * problem.assembly.size
        image = (points - [axis, 0]) * [-1, 1] + [axis, 0]
        assert np.abs(points[:, None] - image).max(axis=-1).min(axis=0).max() < 1e-7
