"""Films of structures: blocks where they are, on supports, in words of any structure."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from drawn import square
from images import turning
from recorded import drawn_words, recorded
from structure_cases import scenes

import blocksim
from blocksim import JointState, Problem, Recording, structure_of
from blocksim.view.canvas import colour, stone_tones
from blocksim.view.film import Film
from blocksim.view.stage import BESIDE, Stage
from blocksim.view.style import JOINTS, QUIET
from blocksim.view.video import to_bytes
from blocksim.view.views import PlanarView

ARCH_SAYINGS = (
    "arch", "thickness", "extrados", "intrados", "voussoir", "r)", "η",
    "\N{GREEK SMALL LETTER ALPHA}",
)  # fmt: skip


def yard(**more: Any) -> Problem:
    """An L with a triangle on it, and a hexagon, on a wide slab: far from x = 0."""
    turn = np.arange(6) * math.pi / 3
    hexagon = np.column_stack([104 + np.cos(turn), math.sin(math.pi / 3) + np.sin(turn)])
    blocks = [
        {"id": "slab", "vertices": square(50, -5, 100, 5), "fixed": True},
        {"id": "ell", "polygons": [square(100, 0, 2, 1), square(100, 1, 1, 1)]},
        {"id": "triangle", "vertices": [[101, 1], [102, 1], [102, 2]]},
        {"id": "hexagon", "vertices": hexagon.tolist()},
    ]
    return structure_of({"title": "A yard", "friction": 0.6, "blocks": blocks, **more})


def recording(problem: Problem, moved: np.ndarray) -> Recording:
    """Record given displacements at equal times up to 1."""
    return recorded(problem, moved, np.linspace(0, 1, len(moved)), engine="direct")


def lifted(problem: Problem, turn: float = 0.5) -> Recording:
    """All blocks rise and turn, each at its own speed."""
    count = len(problem.assembly.blocks)
    speeds = np.column_stack([
        np.zeros(count), 0.3 + 0.2 * np.arange(count), turn * (1 + np.arange(count))
    ])  # fmt: skip
    return recording(problem, np.linspace(0, 1, 21)[:, None, None] * speeds)


def view_of(film: Film) -> PlanarView:
    view = film.shots[0].view
    assert isinstance(view, PlanarView)
    return view


def pixel(film: Film, frame: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Colour of a frame at a point in units of the size."""
    x, y = view_of(film)._to_pixels(np.asarray(point))
    return frame[film.height - 1 - int(y), int(x), :3].astype(int)


def test_joints_are_on_parts_of_faces() -> None:
    """The triangle covers half of one of the L's faces: the mark is no longer than that."""
    problem = yard()
    stage = Stage(lifted(problem))
    size = problem.assembly.size
    moment = stage.at(0.0)
    joints = problem.assembly.joints
    for joint, pair in zip(joints, stage.faces(moment.turns, moment.places), strict=True):
        for ends in pair:
            np.testing.assert_allclose(ends * size, [joint.inner, joint.outer], atol=1e-9)
    sliding = [JointState.SLIDES] * len(joints)
    pieces = stage.solids(1.0).at(moment.turns, moment.places, sliding)
    tone = colour(JOINTS[JointState.SLIDES])
    marks = [line.points for piece in pieces for line in piece.lines if line.tone == tone]
    # In front and behind, of both blocks of a joint; supports have none.
    long = sorted(np.hypot(*(b - a)[:2]) * size for a, b in marks if a[2] == b[2])
    blocks = [joint for joint in joints for side in (joint.before, joint.after) if side >= 0]
    assert long == pytest.approx(sorted(2 * [joint.length for joint in blocks]))


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_frames_show_blocks_in_their_colours_where_they_are(share: float) -> None:
    problem = yard()
    film = Film([lifted(problem, turn=0.3)])
    stage = Stage(lifted(problem, turn=0.3))
    frame = film.frame(round(film.rate * (0.8 + share * film.seconds * film.slow)))
    tones = np.round(255 * np.array(stone_tones(3))[:, :3])
    corners = stage.corners_at(share * stage.end)[:, :2]
    # The two parts of the L, the triangle and the hexagon, near and far.
    parts = np.split(corners, np.cumsum([4, 4, 4, 4, 3, 3, 6])[:7])[::2]
    for part, tone in zip(parts, tones[[0, 0, 1, 2]], strict=True):
        assert np.abs(pixel(film, frame, part.mean(axis=0)) - tone).max() <= 2
    # No seam where the two parts of the L meet: its colour all along.
    seam = parts[1][[0, 1]]
    for part in (0.2, 0.4, 0.6, 0.8):
        point = seam[0] * (1 - part) + seam[1] * part
        assert np.abs(pixel(film, frame, point) - tones[0]).max() <= 4
    # The outer side of both is an edge.
    for part in parts[:2]:
        edge = part[[3, 0]].mean(axis=0)
        around = [
            pixel(film, frame, edge + np.array([d, 0])) for d in np.linspace(-0.02, 0.02, 41)
        ]
        assert min(colour.sum() for colour in around) < tones[0].sum() - 120


def test_supports_stand_in_the_frame_near_the_blocks() -> None:
    """A slab 100 m wide shows up to a little beyond the blocks, at the level it has."""
    problem = yard()
    stage = Stage(recording(problem, np.zeros((2, 3, 3))))
    size = problem.assembly.size
    (footing,) = stage.footings
    assert footing[:, 1].max() == 0.0
    # Blocks may turn within their circles.
    widest = 2 * problem.assembly.reach.max() / size
    assert 100 / size - BESIDE - widest < footing[:, 0].min() < 100 / size
    assert 105 / size < footing[:, 0].max() < 105 / size + BESIDE + widest
    film = Film([stage.recording])
    frame = film.frame(0)
    below = pixel(film, frame, np.array([102.5 / size, -0.05]))
    above = pixel(film, frame, np.array([102.6 / size, 0.05]))
    assert np.abs(below - above).max() > 20
    # Framed in the middle, wherever it was built.
    shown = footing[:, 0].min(), footing[:, 0].max()
    left, right = (float(view_of(film)._to_pixels(np.array([x, 0.0]))[0]) for x in shown)
    assert (left + right) / 2 == pytest.approx(film.width / 2, abs=1e-6)
    assert right - left > film.width / 5


def test_what_slides_far_is_seen_to_lie_on_its_support() -> None:
    """Of a slab of 100 m as much is drawn as blocks are followed on it, and in view."""
    problem = yard()
    size = problem.assembly.size
    way = np.zeros((11, len(problem.assembly.blocks), 3))
    way[:, 2, 0] = np.linspace(0, 3.5, 11) / size  # the hexagon, to x = 108.5 m at its right
    film = Film([recording(problem, way)], height=360)
    frame = film.frame(film.count - 1)
    (slab,) = film.shots[0].stage.footings
    assert slab[:, 0].max() > 108.5 / size
    for x in (100.0, 104.0, 108.4):
        under = pixel(film, frame, np.array([x, -0.15]) / size)
        np.testing.assert_allclose(under, pixel(film, frame, slab.mean(axis=0)), atol=2)


@pytest.mark.parametrize(("tilt", "way"), [(25.0, 1), (-25.0, -1), (0.0, 0)])
@pytest.mark.parametrize("view", ["2d", "3d", "space"])
def test_where_gravity_pulls_is_shown_on_a_tilted_table(
    view: str, tilt: float, way: int
) -> None:
    """An arrow down and towards the side that goes down, by its pixels beyond the words."""
    run = lifted(yard().tilted(math.radians(tilt)))
    if view == "space":
        tower = blocksim.Tower(blocks=3, friction=0.7).problem().tilted(math.radians(tilt))
        poses = np.zeros((len(run.times), 3, 6))
        poses[..., :3] = tower.assembly.centres / tower.assembly.size
        run = replace(run, problem=tower, poses=poses)
    film = Film([run], height=720, view="2d" if view == "2d" else "3d")
    assert ("gravity" in drawn_words(film)) is bool(way)
    corner = film.frame(0)[74:150, 20:110, :3].astype(int)
    quiet = np.array(to_bytes(QUIET))
    rows, columns = np.nonzero(np.abs(corner - quiet).max(axis=-1) < 12)
    if not way:
        assert not len(rows)
        return
    slope = np.polyfit(rows, columns, 1)[0]
    across, down = math.sin(math.radians(25)), math.cos(math.radians(25))
    if view != "2d":  # from 30 deg aside, and 22 deg above
        across, down = across * math.cos(math.radians(30)), down * math.cos(math.radians(22))
    assert slope == pytest.approx(way * across / down, abs=0.08)
    # The head is wider than the shaft, and below.
    widths = [np.ptp(columns[rows == row]) for row in (rows.min() + 8, rows.max() - 6)]
    assert widths[1] > widths[0] + 3


def test_films_are_the_same_wherever_a_structure_is_built() -> None:
    """Shifted by 100 m along: the same pixels, but for round-off."""
    one = structure_of(scenes("trilithon")[0])
    scene = scenes("trilithon")[0]
    for block in scene["blocks"]:
        block["vertices"] = [[x + 100, y] for x, y in block["vertices"]]
    other = structure_of(scene)
    for view in ("2d", "3d"):
        frames = [
            Film([lifted(problem, 0.2)], view=view, height=240).frame(60)
            for problem in (one, other)
        ]
        assert np.abs(frames[0].astype(int) - frames[1]).mean() < 0.05


def test_titles_say_what_it_is_and_nothing_of_arches() -> None:
    live = [{"body": [1, 0]}]
    problem = yard(live=live).with_load(0.3).tilted(math.radians(12))
    words = drawn_words(Film([lifted(problem)]))
    assert "A yard" in words
    title = next(word for word in words if word.startswith("collapses"))
    against = "tilted 12°, load factor 0.3"
    known = f"collapses, still moving as it ends, 3 blocks, μ = 0.6, {against}   direct 1.0"
    assert title == known
    nameless = drawn_words(Film([lifted(replace(problem, title=""))]))
    assert "3 blocks   μ = 0.6" in nameless
    for word in [*words, *nameless]:
        assert not any(saying in word for saying in ARCH_SAYINGS)
    long = drawn_words(Film([lifted(replace(problem, title="long " * 39))] * 2))
    assert sum(word.startswith("long long") and word.endswith("…") for word in long) == 2


def test_hinges_at_either_end_are_one_thing() -> None:
    """One box turns about its right corner, one about its left: one word, one colour."""
    blocks = [
        {"id": "slab", "vertices": square(-5, -1, 20, 1), "fixed": True},
        {"id": "one", "vertices": square(0, 0)},
        {"id": "two", "vertices": square(2, 0)},
    ]
    problem = structure_of({"friction": 0.6, "blocks": blocks})
    moved = np.zeros((2, 3))
    for box, (corner, turn) in enumerate(((1.0, -0.05), (2.0, 0.05))):
        arm = problem.assembly.centres[box] - [corner, 0.0]
        way = turning(turn) @ arm - arm
        moved[box] = [*(way / problem.assembly.size), turn]
    run = recording(problem, np.linspace(0, 1, 11)[:, None, None] * moved)
    stage = Stage(run)
    assert {JointState.HINGE_INTRADOS, JointState.HINGE_EXTRADOS} <= set(stage.states)
    film = Film([run])
    words = drawn_words(film)
    assert words.count("hinge") == 1
    frame = film.frame(film.count - 1)[..., :3].astype(int)

    def pixels(tone: str) -> int:
        return int((np.abs(frame - to_bytes(tone)).max(axis=-1) < 3).sum())

    assert pixels(JOINTS[JointState.HINGE_INTRADOS]) > 200
    assert pixels(JOINTS[JointState.HINGE_EXTRADOS]) == 0
