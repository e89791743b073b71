"""Films decoded again: what is in their frames is what the recording says."""

import math
from dataclasses import replace
from pathlib import Path

import av
import numpy as np
import pytest
from images import turning
from numpy.typing import NDArray
from PIL import Image
from recorded import drawn_words, recorded
from rocking import on_pulse
from running import ran

import blocksim
from blocksim import JointState, Problem, Recording
from blocksim.blocks.acting import Move, push_on_all
from blocksim.view.camera import FARTHEST, zoomed
from blocksim.view.canvas import colour
from blocksim.view.drawing import words_of
from blocksim.view.film import Film
from blocksim.view.style import DEAD, JOINTS, LIVE
from blocksim.view.video import render, to_bytes

HEIGHT = 300


def frames_of(path: Path, rate: int = 30) -> list[NDArray[np.uint8]]:
    """Decode a film; of a .gif, which keeps equal frames once, as often as they stand."""
    if path.suffix == ".gif":
        found = []
        with Image.open(path) as picture:
            for number in range(picture.n_frames):
                picture.seek(number)
                stands = round(picture.info["duration"] * rate / 1000)
                found += stands * [np.asarray(picture.convert("RGB"))]
        return found
    with av.open(str(path)) as film:
        return [frame.to_ndarray(format="rgb24") for frame in film.decode(video=0)]


def filmed(run: Recording, path: Path) -> tuple[Film, list[NDArray[np.uint8]]]:
    """The film as it is written, and its frames decoded."""
    film = render([run], path, height=HEIGHT, slow=1)
    frames = frames_of(path, film.rate)
    assert len(frames) == film.count
    return film, frames


def seconds_at(film: Film, number: int) -> float:
    return film._within((number / film.rate - 0.8) / film.slow)


def seen_at(film: Film, number: int, points: np.ndarray) -> np.ndarray:
    """Columns and rows of points of space in a frame."""
    view = film.shots[0].view
    share = film.share(seconds_at(film, number))
    places = view.centre + share * (view.places(points) - view.centre)
    return np.column_stack([places[:, 0], film.height - places[:, 1]])


def time_of(film: Film, number: int) -> float:
    stage = film.shots[0].stage
    return seconds_at(film, number) / math.sqrt(stage.assembly.size / 9.81)


def moment_of(film: Film, number: int):
    return film.shots[0].stage.at(time_of(film, number))


def corners_of(film: Film, number: int) -> np.ndarray:
    return film.shots[0].stage.corners_at(time_of(film, number))


def still(problem: Problem, until: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """So many times, and the displacements at each of blocks that stay where they are."""
    return np.linspace(0, until, count), np.zeros((count, len(problem.assembly.blocks), 3))


COLUMN = blocksim.load("column", friction=0.7)
TOP = len(COLUMN.assembly.blocks) - 1


def far_slider() -> Recording:
    """Three courses of a column; the uppermost goes off to the side, far and on the ground."""
    times, moved = still(COLUMN, 2, 41)
    way = np.maximum(0, times - 0.5)
    moved[:, -1, 0] = 6.0 * way
    ground = COLUMN.assembly.built[0, 1] - COLUMN.assembly.built[TOP, 1]
    moved[:, -1, 1] = np.maximum(ground, -4 * way**2)
    return recorded(COLUMN, moved, times)


@pytest.mark.parametrize("view", ["2d", "3d"])
def test_every_block_is_in_every_frame(view: str, tmp_path: Path) -> None:
    """The camera draws back with a block that leaves, smoothly, and never comes nearer."""
    run = far_slider()
    film = Film([run], height=HEIGHT, slow=1, view=view)  # type: ignore[arg-type]
    low, high = 0.0, film.height - 0.0
    shares = []
    for number in range(0, film.count, 12):
        corners = corners_of(film, number)
        places = seen_at(film, number, corners)
        assert (places > [0, low]).all()
        assert (places < [film.width, high]).all()
        shares.append(film.share(film._within(number / film.rate - 0.8)))
    assert FARTHEST < shares[-1] < 0.7 < shares[0] <= 1
    steps = np.diff([film.share(each) for each in np.arange(0, film.seconds, 1 / film.rate)])
    assert -0.05 < steps.min() < 0 >= steps.max()
    # Blocks are seen where they should be: decoded, not only reckoned.
    if view == "2d":
        render([run], tmp_path / "far.mp4", height=HEIGHT, slow=1)
        decoded = frames_of(tmp_path / "far.mp4")
        for number in (0, len(decoded) // 2, len(decoded) - 1):
            centres = moment_of(film, number).places
            for x, y in seen_at(film, number, centres).round().astype(int).tolist():
                stone = decoded[number][y, x].astype(int)
                assert stone[0] > stone[2] + 8  # no paper, no ground


FILMED = {
    "arch": "--alpha 90 --ratio 0.97 --mu 0.7 --voussoirs 9 --seconds 0.6",
    "pymunk": "--alpha 90 --ratio 0.97 --mu 0.7 --voussoirs 9 --seconds 0.6 --method pymunk",
    "wall": "wall --with length=1.2 --with courses=3 --mu 0.3 --tilt 25 --seconds 1",
    "portal": "portal --with pier_width=0.25 --mu 0.6 --seconds 1",
    "arcade": "arcade --with pier_width=0.45 --mu 0.6 --push 0.3 --seconds 0.5",
    "rubble": "rubble --with stones=12 --mu 0.4 --tilt 30 --seconds 0.8",
    "pushed": "oppenheim_7 --load 0.45 --seconds 2.2",
    "shaken": "column --with drums=1 --with width=0.5 --with drum_height=3 --mu 0.7 "
    "--shake half-sine --amplitude 0.4 --duration 0.8",
    "spread": "spread_90_20_20 --over spread",
}
"""What is simulated of each kind of film; by `direct` but for one."""
USUAL = ("arch",)


@pytest.mark.parametrize(
    "kind",
    [each if each in USUAL else pytest.param(each, marks=pytest.mark.long) for each in FILMED],
)
def test_frames_show_what_the_recording_says(kind: str, tmp_path: Path) -> None:
    """Every block is in every frame; along joints are the colours of their states.

    A .gif has the very colours; .mp4 has a quarter of them. The end is a still, and words say
    whether blocks still move, as the last two frames of the recording have it.
    """
    out = tmp_path / "run.npz"
    method = () if "--method" in FILMED[kind] else ("--method", "direct")
    ran("simulate", *FILMED[kind].split(), *method, "--out", out)
    run = blocksim.load_recording(out)
    film, frames = filmed(run, tmp_path / "film.gif")
    stage = film.shots[0].stage
    seen: set[JointState] = set()
    for number in np.linspace(0, film.count - 1, 8).astype(int).tolist():
        moment, picture = moment_of(film, number), frames[number].astype(int)
        places = seen_at(film, number, corners_of(film, number))
        assert ((places > 0) & (places < [film.width, film.height])).all()
        for x, y in seen_at(film, number, moment.places).round().astype(int):
            near_centre = picture[y - 3 : y + 4, x - 3 : x + 4].reshape(-1, 3)
            assert (near_centre[:, 0] > near_centre[:, 2] + 4).any()  # no paper, no ground
        seen |= joints_seen(film, number, picture, is_arch=stage.is_arch)
    assert seen - {JointState.CLOSED}
    ends = frames[-round(film.rate)].astype(int)
    assert np.abs(frames[-1] - ends).max() < 3
    steps = np.diff(run.times)[-1]
    moved = np.abs(np.diff(run.poses[-2:, :, :2], axis=0)).max() / steps
    words = next(each for each in drawn_words(film) if "direct" in each or "pymunk" in each)
    assert ("still moving as it ends" in words) is bool(moved > 1e-3)


def joints_seen(
    film: Film, number: int, picture: NDArray[np.int64], *, is_arch: bool
) -> set[JointState]:
    """Compare colours along joints with their states, and return those that were told apart."""
    tones = {state: np.array(to_bytes(words_of(state, is_arch=is_arch)[1])) for state in JOINTS}
    # The grey of what is open is nearly that of edges.
    del tones[JointState.OPEN]
    found: set[JointState] = set()
    moment = moment_of(film, number)
    marks = drawn_marks(film, number)
    carried = film.shots[0].stage.faces(moment.turns, moment.places)  # type: ignore[union-attr]
    for state, faces in zip(moment.joints, carried, strict=True):
        along = faces[0][0] + np.linspace(0.3, 0.7, 9)[:, None] * (faces[0][1] - faces[0][0])
        if np.abs(faces[0] - faces[1]).max() <= 0.02:
            inner, outer = faces.mean(axis=0)
            along = inner + np.linspace(0.3, 0.7, 9)[:, None] * (outer - inner)
        places = seen_at(film, number, along)
        if state is JointState.CLOSED:
            # What is marked belongs to joints beside it.
            apart = np.linalg.norm(places[:, None] - marks[None, :, :2], axis=2)
            places = places[(apart > marks[:, 2]).all(axis=1)]
        count = dict.fromkeys(tones, 0)
        for x, y in places.round().astype(int).tolist():
            patch = picture[y - 1 : y + 2, x - 1 : x + 2].reshape(-1, 3)
            for each, tone in tones.items():
                count[each] += int((np.abs(patch - tone).max(axis=1) < 12).any())
        if state is JointState.CLOSED:
            assert max(count.values()) == 0
        elif state is not JointState.OPEN:
            assert count[state] == max(count.values()) > 0
        found.add(state)
    return found


def drawn_marks(film: Film, number: int) -> NDArray[np.float64]:
    """Points along all marks of joints in a frame: column, row, and how far they reach."""
    share = film.share(seconds_at(film, number))
    view = film.shots[0].view
    found = [np.empty((0, 3))]
    for shape in zoomed(view._joints(moment_of(film, number)), share, view.centre):
        start, end = shape.points, np.roll(shape.points, -1, axis=0)
        points = (start + np.linspace(0, 1, 200)[:, None, None] * (end - start)).reshape(-1, 2)
        points[:, 1] = film.height - points[:, 1]
        # Beyond its line there is a pixel of its edge, and the corner of a patch.
        reach = np.full((len(points), 1), shape.width / 2 + 1 + math.sqrt(2))
        found.append(np.hstack([points, reach]))
    return np.concatenate(found)


def near(picture: NDArray[np.uint8], tone: str, x: float, y: float, reach: int) -> bool:
    """Whether a colour is found near a place."""
    rows, columns = (slice(max(0, int(v) - reach), int(v) + reach + 1) for v in (y, x))
    patch = picture[rows, columns].reshape(-1, 3).astype(int)
    return bool((np.abs(patch - to_bytes(tone)).max(axis=1) < 50).any())


def test_loads_are_drawn_where_they_act_and_go_with_their_blocks(tmp_path: Path) -> None:
    """A push on the top of a column that turns over; in no other place its colour."""
    corners = COLUMN.assembly.blocks[TOP].vertices
    corner = corners[corners[:, 0].argmin()]
    push = blocksim.Load(force=np.array([5e3, 0.0]), blocks=(TOP,), point=corner)
    problem = replace(COLUMN, live=(push,), load=1.0)
    times, moved = still(COLUMN, 1, 21)
    moved[:, TOP] = np.column_stack([0.3 * times, 0.2 * times, -0.8 * times])
    film, frames = filmed(recorded(problem, moved, times), tmp_path / "push.mp4")
    arm = (corner - COLUMN.assembly.centres[TOP]) / COLUMN.assembly.size
    for number in (0, len(frames) - 1):
        turn = 0.0 if number == 0 else -0.8
        way = np.zeros(2) if number == 0 else np.array([0.3, 0.2])
        place = COLUMN.assembly.built[TOP, :2] + way + turning(turn) @ arm
        ((x, y),) = seen_at(film, number, np.append(place, 0.0)[None]).tolist()
        assert near(frames[number], LIVE, x - 8, y, 4)
        assert not near(frames[number], LIVE, x + 40, y, 12)
    assert near(frames[0], LIVE, film.width - 150, film.height - 10, 120)  # the legend
    quiet = Film([recorded(replace(problem, load=0.0), 0 * moved, times)], height=HEIGHT)
    assert all(shot.acting.entries == [] for shot in quiet.shots)
    assert DEAD not in {tone for shot in film.shots for _, tone in shot.acting.entries}


def test_a_push_is_one_arrow_in_a_corner_with_its_share_of_the_weight() -> None:
    """On Oppenheim's arch 0.45 to the right, live; dead and to the left on a wall."""
    arch = replace(blocksim.load("oppenheim_7"), load=0.45)
    wall = blocksim.load("wall", friction=0.7)
    wall = replace(wall, dead=(push_on_all(wall, [-0.25, 0.0]),))
    for problem, words, tone, way in (
        (arch, "push 0.45 g", LIVE, 1), (wall, "push 0.25 g", DEAD, -1),
    ):  # fmt: skip
        times, moved = still(problem, 1, 2)
        film = Film([recorded(problem, moved, times)], height=720)
        stage, _, _, acting, _ = film.shots[0]
        moment = stage.at(0.0)
        assert acting.entries == []
        assert acting.shapes(moment) == []
        shapes, (label,) = acting.aside(moment, 1.0)
        assert label.words == words
        line, head = (each.points for each in shapes)
        assert way * (line[-1, 0] - line[0, 0]) > 20
        assert way * (head[:, 0].mean() - line[:, 0].mean()) > 10
        assert (shapes[0].edge, shapes[1].fill) == (colour(tone), colour(tone))


def test_the_pulse_has_its_mark_at_the_time_shown() -> None:
    """A half sine of 0.4 g for a second: the words say its value, the marks stand still."""
    problem = on_pulse(COLUMN, "half-sine", 0.4, 1.0)
    unit = math.sqrt(problem.assembly.size / 9.81)
    times, moved = still(problem, 1.6 / unit, 33)
    film = Film([recorded(problem, moved, times)], height=720)
    stage, _, _, acting, _ = film.shots[0]
    for seconds, value in ((0.25, 0.4 * math.sin(math.pi / 4)), (0.5, 0.4), (1.2, 0.0)):
        shapes, labels = acting.aside(stage.at(seconds / unit), 1.0)
        (said,) = [label.words for label in labels]
        assert float(said.split()[1]) == pytest.approx(value, abs=0.011)
        assert len(shapes) > 5
    # Marks of what stands still go left by the way of the ground: in 1 s 0.4 g (1 s)^2 / pi.
    way = 0.4 * 9.81 / math.pi / stage.assembly.size
    view = film.shots[0].view
    ends = view.places(np.array([[0.0, 0, 0], [1.0, 0, 0]]))
    pixels = float(ends[1, 0] - ends[0, 0])
    firsts = [
        min(s.points[0, 0] for s in acting._marks(problem.shaking, at, 1.0))
        for at in (0.0, 1.0)
    ]
    apart = 0.25 * pixels
    gone = (firsts[0] - way * pixels - firsts[1]) / apart
    assert gone == pytest.approx(round(gone), abs=0.02)


def test_the_amount_of_a_spread_is_told_in_every_frame() -> None:
    """Two supports, 1 m/s of span between them, half of it each: 30 mm after 30 ms."""
    moves = tuple(Move(support=0, direction=np.array([way, 0.0])) for way in (-0.5, 0.5))
    times, moved = still(COLUMN, 1, 5)
    for block, way in ((TOP - 1, -0.5), (TOP, 0.5)):
        moved[:, block, 0] = way * 0.1 * times / COLUMN.assembly.size
    film = Film([recorded(replace(COLUMN, moves=moves), moved, times)], height=HEIGHT)
    stage, _, _, acting, _ = film.shots[0]
    for time in (0.0, 0.3, 1.0):
        _, (label,) = acting.aside(stage.at(time), 1.0)
        assert label.words == f"supports moved {100 * time:.1f} mm"
    assert stage.carriers == {TOP - 1, TOP}
    assert stage.speed == 0  # supports that move do not say that blocks still do


def test_side_by_side_begins_near_and_keeps_every_block() -> None:
    """Two falls in half a frame each: blocks take most of it, and none ever leaves it."""
    film = Film([far_slider(), far_slider()], height=HEIGHT, slow=1)
    alone = Film([far_slider()], height=HEIGHT, slow=1)

    def wide(of: Film) -> float:
        rest = of.shots[0].stage.corners_at(0.0)
        return float(np.ptp(of.shots[0].view.places(rest)[:, 0])) / of.shots[0].panel.width

    assert wide(film) > 1.5 * wide(alone)
    for seconds in np.linspace(0, film.seconds, 9).tolist():
        share = film.share(seconds)
        for stage, view, panel, *_ in film.shots:
            corners = stage.corners_at(seconds / math.sqrt(stage.assembly.size / 9.81))
            places = view.places(corners)
            places = view.centre + share * (places - view.centre)
            assert (places[:, 0] > panel.x).all()
            assert (places[:, 0] < panel.x + panel.width).all()


def test_what_rounding_moves_does_not_still_move() -> None:
    """A way of 1e-14 of the size from frame to frame is no motion; one of 1e-6 is."""
    times, moved = still(COLUMN, 2, 21)
    moved[:10, -1, 0] = 0.02 * np.arange(10)
    for way, rests in ((1e-14, True), (1e-6, False)):
        moved[10:, -1, 0] = 0.2 + way * np.arange(11)
        stage = Film([recorded(COLUMN, moved, times)], height=HEIGHT).shots[0].stage
        assert (stage.speed == 0) is rests


def test_what_falls_has_no_line_of_thrust_at_rest() -> None:
    """On a table tilted by 20 deg the column falls: its line is the nearest one."""
    times, moved = still(COLUMN, 1, 3)
    for tilt, words in ((0.0, "line of thrust"), (math.radians(20), "nearest line of thrust")):
        film = Film([recorded(COLUMN.tilted(tilt), moved, times)], height=HEIGHT)
        stage = film.shots[0].stage
        assert len(stage.thrust) == 1
        assert [told for told, _ in film._entries([set()], thrust=True)] == [f"{words} at rest"]


def test_a_film_ends_with_the_last_block_in_sight(tmp_path: Path) -> None:
    """All blocks slide away together: in the last frame one is still seen."""
    problem = blocksim.load("wall", friction=0.7)
    times, moved = still(problem, 5, 81)
    moved[..., 0] = 12.0 * times[:, None]
    run = recorded(problem, moved, times)
    film = Film([run], height=HEIGHT, slow=1)
    stage = film.shots[0].stage
    assert film.seconds < stage.end * math.sqrt(stage.assembly.size / 9.81)
    assert film.speed > 0
    last = film.count - 1
    places = seen_at(film, last, corners_of(film, last))
    assert ((places > 0) & (places < [film.width, film.height])).all(axis=1).any()
    # The camera draws back no farther, and half a moment later nothing would be seen.
    assert film.share(film.seconds) == pytest.approx(FARTHEST, rel=0.01)
    render([run], tmp_path / "away.mp4", height=HEIGHT, slow=1)
    drawn, empty = frames_of(tmp_path / "away.mp4")[-1], film.frame(last)[..., :3]
    assert np.abs(drawn.astype(int) - empty).mean() < 3
