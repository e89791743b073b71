"""Films show where the blocks are, in the order they hide each other, and are written whole."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Literal

import av
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from images import turning
from matplotlib.colors import to_rgb
from PIL import Image
from recorded import drawn_words, recorded
from running import inside, ran, refused
from scipy.spatial.transform import Rotation
from worlds import classify

from blocksim import Arch, CircularArch, InputError, JointState, Recording, load_recording
from blocksim.engines.ground import DEPTH
from blocksim.view.camera import painting_order
from blocksim.view.film import Film
from blocksim.view.stage import Stage
from blocksim.view.style import JOINTS, THRUST
from blocksim.view.timeline import SEEN
from blocksim.view.video import render

pytestmark = pytest.mark.usefixtures("wide_window")

ARCH = Arch(half_angle=math.pi / 2, eta=0.3, voussoirs=6, radius=2.0, depth=1.0)


def rest(arch: Arch = ARCH) -> np.ndarray:
    assembly = arch.assembly()
    return np.column_stack([assembly.centres / assembly.size, np.zeros(arch.voussoirs)])


def recording(moved: np.ndarray, times: np.ndarray, arch: Arch = ARCH) -> Recording:
    """Record given displacements, (frames, blocks, 3)."""
    return recorded(CircularArch.of(arch, 0.7).problem(), moved, times)


def turned_about(point: np.ndarray, angle: float, blocks: list[int]) -> np.ndarray:
    """Displacements of blocks that turn as one piece about a point."""
    moved = np.zeros((ARCH.voussoirs, 3))
    for block in blocks:
        arm = rest()[block, :2] - point
        moved[block, :2] = turning(angle) @ arm - arm
        moved[block, 2] = angle
    return moved


def falling() -> Recording:
    """Record how the two blocks at the crown fall freely, to the ground."""
    times = np.linspace(0, 1.6, 40)
    moved = np.zeros((len(times), ARCH.voussoirs, 3))
    moved[:, [2, 3], 1] = -(times**2)[:, None] / 2
    return recording(moved, times)


def test_corners_are_those_of_rigid_bodies() -> None:
    """Against scipy's rotations; halfway between equal frames nothing changes."""
    random = np.random.default_rng(3)
    moved = random.normal(size=(ARCH.voussoirs, 3))
    vectors, shift = moved * [0, 0, 1], moved * [1, 1, 0]
    stage = Stage(recording(np.array([moved, moved]), np.array([0.0, 1.0])))
    assembly = ARCH.assembly()
    for block, seen in enumerate(stage.corners_at(0.0).reshape(-1, 2, 4, 3)):
        arms = (assembly.blocks[block].vertices - assembly.blocks[block].centre) / 2.0
        for end, z in ((0, 0.25), (1, -0.25)):
            local = np.column_stack([arms, np.full(len(arms), z)])
            centre = np.append(rest()[block, :2], 0.0) + shift[block]
            expected = Rotation.from_rotvec(vectors[block]).apply(local) + centre
            np.testing.assert_allclose(seen[end], expected, atol=1e-12)


def test_between_frames_blocks_turn_at_constant_speed_and_stay_rigid() -> None:
    moved = turned_about(np.zeros(2), 0.2, [2, 3])
    stage = Stage(recording(np.array([0 * moved, moved]), np.array([0.0, 1.0])))
    stage.end = 1.0
    start, half = (stage.corners_at(at).reshape(-1, 2, 4, 3)[2, 0] for at in (0.0, 0.5))
    angles = [math.atan2(*(each[1] - each[0])[1::-1]) for each in (start, half)]
    assert angles[1] - angles[0] == pytest.approx(0.1, abs=1e-9)
    sides = [np.hypot(*np.diff(each[:, :2], axis=0).T) for each in (start, half)]
    np.testing.assert_allclose(sides[0], sides[1], rtol=1e-12)


def test_turns_beyond_half_a_turn_go_the_short_way() -> None:
    """A rotation vector that jumps from pi to -pi is hardly a motion."""
    moved = np.zeros((2, ARCH.voussoirs, 3))
    moved[:, 2, 2] = [math.pi - 0.01, -math.pi + 0.01]
    stage = Stage(recording(moved, np.array([0.0, 1.0])))
    stage.end = 1.0
    way = [stage.corners_at(t) - stage.corners_at(0.0) for t in (0.5, 1.0)]
    assert np.abs(way[1]).max() < 0.01
    assert np.abs(way[0]).max() < 0.01


def test_a_block_too_far_away_to_have_a_width_casts_no_shadow() -> None:
    fallen = falling()
    assembly = fallen.problem.assembly
    far = replace(assembly.blocks[-1], centre=np.array([0.7, 1e16]))
    lost = replace(assembly, blocks=(*assembly.blocks[:-1], far))
    seen = replace(fallen, problem=replace(fallen.problem, assembly=lost))
    frames = [Film([each], view="3d", height=120).frame(0) for each in (seen, fallen)]
    assert frames[0].std() > 1
    assert (frames[0] != frames[1]).any()


def slid(way: float) -> Recording:
    """The last block slides along the ground, by a way to the right of its place."""
    moved = np.zeros((2, ARCH.voussoirs, 3))
    moved[1, -1] = way, -DEPTH / 2, 0.0
    return recording(moved, np.array([0.0, 1.0]))


@pytest.mark.parametrize("view", ["2d", "3d"])
def test_films_beside_each_other_have_one_scale(view: Literal["2d", "3d"]) -> None:
    """At rest they are the same picture, whichever goes farther; alone they are not."""
    near, far = slid(0.2), slid(1.2)
    films = [Film([near], view=view, beside=[far]), Film([far], view=view, beside=[near])]
    one, other, alone = (
        film.frame(0)[100:600].astype(int) for film in (*films, Film([near], view=view))
    )
    assert np.abs(one - other).max() == 0
    assert (np.abs(one - alone).max(axis=2) > 60).mean() > 0.01


def boxes(centres: np.ndarray, half: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corners, normals and offsets of axis-parallel boxes."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    corners = centres[:, None] + signs * half[:, None]
    normals = np.concatenate([np.eye(3), -np.eye(3)])
    offsets = centres @ normals.T + np.concatenate([half, half], axis=1)
    return corners, np.broadcast_to(normals, (len(centres), 6, 3)), offsets


def entry(start: np.ndarray, way: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
    """Where a ray enters a box; inf where it misses (slab method)."""
    with np.errstate(divide="ignore"):
        one, two = (low - start) / way, (high - start) / way
    near, far = np.minimum(one, two).max(), np.maximum(one, two).min()
    return float(near) if near < far else math.inf


@given(st.integers(0, 10_000))
@settings(max_examples=20)
def test_what_is_painted_later_is_nearer_along_every_ray(seed: int) -> None:
    """Boxes in cells of a grid that do not meet, against rays cast through them."""
    random = np.random.default_rng(seed)
    cells = random.choice(27, size=9, replace=False)
    places = np.stack(np.unravel_index(cells, (3, 3, 3)), axis=1) - 1.0
    half = random.uniform(0.1, 0.5, size=(9, 3))
    centres = places + random.uniform(-1, 1, size=(9, 3)) * (0.5 - half)
    corners, normals, offsets = boxes(centres, half)
    eye = random.normal(size=3)
    eye *= 6 / np.linalg.norm(eye)
    everywhere = np.tile([[-np.inf, -np.inf], [np.inf, np.inf]], (9, 1, 1))
    order = painting_order(corners, normals, offsets, eye, everywhere)
    assert sorted(order) == list(range(9))
    for _ in range(60):
        way = random.uniform(-1.5, 1.5, size=3) - eye
        seen = [entry(eye, way, c - h, c + h) for c, h in zip(centres, half, strict=True)]
        along = [seen[body] for body in order if seen[body] < math.inf]
        assert along == sorted(along, reverse=True)


def test_bodies_that_hide_each_other_in_a_ring_are_all_painted() -> None:
    """Three bars, each over the next: no order is right, but none may be lost."""
    centres = np.array([[0.0, 1.0, 0.0], [0.9, -0.5, 0.0], [-0.9, -0.5, 0.0]])
    corners, normals, offsets = boxes(centres, np.full((3, 3), 0.4))
    shifted = offsets - 10.0  # planes that claim everything is in front of everything
    everywhere = np.tile([[-np.inf, -np.inf], [np.inf, np.inf]], (3, 1, 1))
    order = painting_order(corners, normals, shifted, np.array([0.0, 0.0, 9.0]), everywhere)
    assert sorted(order) == [0, 1, 2]


@pytest.mark.parametrize("view", ["2d", "3d"])
def test_frames_depend_on_the_recording_alone(view: str, tmp_path: Path) -> None:
    one = falling()
    one.save(tmp_path / "run.npz")
    films = [
        Film([r], view=view, height=240) for r in (one, load_recording(tmp_path / "run.npz"))
    ]
    for number in (0, 40, films[0].count - 1):
        later = films[1].frame(number)
        assert np.array_equal(films[0].frame(number), later)
        films[1].frame(7)
        assert np.array_equal(films[1].frame(number), later)


def test_slow_motion_and_length() -> None:
    """The release shows for 0.8 s, the end for 1.2 s, the motion as many times slower."""
    seconds = Stage(falling()).end * math.sqrt(2.0 / 9.81)
    film = Film([falling()], slow=10, rate=20, height=240)
    assert film.seconds == pytest.approx(seconds, rel=1e-12)
    assert film.count == 1 + round(20 * (2.0 + 10 * seconds))
    # 8.7 times slower it would take six seconds.
    assert Film([falling()], height=240).slow == 8
    assert not np.array_equal(film.frame(15)[:200], film.frame(100)[:200])


def test_mp4_can_be_read_back(tmp_path: Path) -> None:
    out = tmp_path / "film.mp4"
    told: list[float] = []
    film = render(
        [falling()], out, slow=1, height=180, progress=lambda share, _: told.append(share)
    )
    assert told == sorted(told)
    assert told[-1] == 1.0
    with av.open(str(out)) as container:
        stream = container.streams.video[0]
        assert (stream.width, stream.height) == (film.width, film.height) == (320, 180)
        assert stream.average_rate == 30
        frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]
    assert len(frames) == film.count
    for number in (0, film.count // 2, film.count - 1):
        drawn = film.frame(number)[..., :3].astype(int)
        assert np.abs(frames[number] - drawn).mean() < 4
    again = tmp_path / "again.mp4"
    render([falling()], again, slow=1, height=180)
    assert out.read_bytes() == again.read_bytes()


def test_an_interrupted_film_leaves_nothing(tmp_path: Path) -> None:
    out = tmp_path / "film.mp4"
    out.write_bytes(b"kept")

    def interrupt(share: float, _: str) -> None:
        if share > 0.2:
            raise KeyboardInterrupt

    for name in ("film.mp4", "new.mp4", "new.gif"):
        with pytest.raises(KeyboardInterrupt):
            render([falling()], tmp_path / name, slow=1, height=180, progress=interrupt)
    assert [path.name for path in tmp_path.iterdir()] == ["film.mp4"]
    assert out.read_bytes() == b"kept"
    with pytest.raises(InputError, match="writable"):
        render([falling()], tmp_path / "none" / "film.png", height=240)


def test_command_films_recordings(tmp_path: Path) -> None:
    run = str(tmp_path / "run.npz")
    falling().save(Path(run))
    ran("render", run, "--view", "3d", "--time", "0.2", "--out", tmp_path / "a.png")
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.size == (1280, 720)
    # 1.6 sqrt(r/g) in metres are 0.72 s: the blocks at the crown are on the ground by then.
    late = inside("render", run, "--height", "180", "--time", "99", "--out", tmp_path / "c.png")
    end = Film([falling()]).seconds
    said = re.search(r": 99 is after the end, so it shows the end, ([\d.]+) s$", late.stdout)
    assert float(said[1]) == pytest.approx(end, abs=6e-4)
    as_shown = ("--time", said[1], "--out", f"{tmp_path}/c.png")
    done = inside("render", run, "--height", "180", *as_shown)
    assert done.stdout == f"wrote {tmp_path}/c.png\n"
    small = ("--beside", run, "--height", "180", "--slow", "1")
    ran("render", run, *small, "--out", tmp_path / "b.gif")
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"a.png", "b.gif", "c.png", "run.npz"}


def test_a_film_says_that_blocks_still_move_as_it_ends(tmp_path: Path) -> None:
    """A slab slides down a slope: g (sin phi - mu cos phi) t after a time t."""
    floor = {"id": 0, "vertices": [[-4, -1], [4, -1], [4, 0], [-4, 0]], "fixed": True}
    slab = {"id": 1, "vertices": [[0, 0], [1, 0], [1, 0.2], [0, 0.2]]}
    problem = {"friction": 0.2, "blocks": [floor, slab]}
    (tmp_path / "slab.json").write_text(json.dumps(problem))
    asked = ("render", str(tmp_path / "slab.json"), "--height", "180")
    done = ran(*asked, "--tilt", "30", "--slow", "1", "--out", tmp_path / "slides.mp4")
    said = re.search(r": ([\d.]+) s of motion.* still move as it ends, at ([\d.]+) m/s", done)
    speed = 9.81 * (math.sin(math.pi / 6) - 0.2 * math.cos(math.pi / 6)) * float(said[1])
    assert float(said[2]) == pytest.approx(speed, rel=0.06)
    # The film ends before the slab has left the picture.
    with av.open(str(tmp_path / "slides.mp4")) as container:
        frames = [each.to_ndarray(format="gray") for each in container.decode(video=0)]
    assert np.abs(frames[-1].astype(int) - frames[0]).max() > 20


def hinged() -> Recording:
    """The left half turns about its springing's extrados, the right one about its intrados.

    Slowly at first: the line of thrust still is there while the hinges are seen.
    """
    times = np.linspace(0, 1.6, 40)
    ends = [ARCH.assembly().joints[0].outer / 2.0, ARCH.assembly().joints[-1].inner / 2.0]
    moved = np.array(
        [
            turned_about(ends[0], 0.1 * t, [0, 1, 2])
            + turned_about(ends[1], 0.1 * t, [3, 4, 5])
            for t in times
        ]
    )
    return recording(moved, times)


def test_gif_keeps_the_colours_that_say_something(tmp_path: Path) -> None:
    """Hinges at either end and the line of thrust: each its own colour in every frame.

    Frames that are equal are one that stands longer.

    In perspective: there hundreds of shades of stone and ground want a place, too.
    """
    film = render([hinged()], tmp_path / "film.gif", view="3d", slow=1, height=360)
    lasts = 0
    told = {
        "extrados": JOINTS[JointState.HINGE_EXTRADOS],
        "intrados": JOINTS[JointState.HINGE_INTRADOS],
        "thrust": THRUST,
    }
    seen = dict.fromkeys(told, 0)
    with Image.open(tmp_path / "film.gif") as picture:
        for number in range(picture.n_frames):
            picture.seek(number)
            lasts += picture.info["duration"]
            decoded = np.asarray(picture.convert("RGB")).astype(int)
            legend = decoded[-24:]
            for name, tone in told.items():
                wanted = np.array(to_rgb(tone)) * 255
                off = np.abs(legend - wanted).max(axis=-1)
                seen[name] += int((off <= 6).sum() >= 20)
    assert set(seen.values()) == {picture.n_frames}
    assert lasts == pytest.approx(1000 * film.count / film.rate, abs=1)


def test_lengths_and_times_have_units_where_a_radius_was_given() -> None:
    """One of 1 m stands for none given: then lengths are in r, times in sqrt(r/g)."""
    metric = drawn_words(Film([falling()], slow=10), 0.3)
    assert "t = 0.300 s" in metric
    assert "1 m" in metric
    assert "10 times slower" in metric
    free = replace(
        falling(), problem=CircularArch.of(replace(ARCH, radius=1.0, depth=0.5), 0.7).problem()
    )
    film = Film([free], slow=10)
    words = drawn_words(film, 0.3)
    assert "t = 0.30 √(r/g)" in words
    assert "0.5 r" in words
    assert "10 times slower if r = 1 m" in words
    assert not any(word.endswith((" s", " m")) and "=" not in word for word in words)


def test_a_still_has_a_legend_of_what_is_in_it() -> None:
    at_rest = drawn_words(Film([hinged()]), 0.0)
    moving = drawn_words(Film([hinged()]))
    assert "line of thrust at rest" in at_rest
    assert not any(word.startswith(("hinge", "slides", "open")) for word in at_rest)
    assert {"hinge extrados", "hinge intrados"} <= set(moving)
    assert not any(word.startswith("line of thrust") for word in moving)


def test_the_title_says_what_the_motion_shows() -> None:
    still = recording(np.zeros((2, ARCH.voussoirs, 3)), np.array([0.0, 10.0]))
    titles = [
        next(word for word in drawn_words(Film([each])) if "factor of safety" in word)
        for each in (falling(), still)
    ]
    told = "geometrical factor of safety 2.856"
    assert titles[0].startswith(f"collapses, still moving as it ends, {told}")
    assert titles[1].startswith(f"at rest, {told}")


def test_rubble_on_the_floor_is_no_hinge() -> None:
    """A block that fell beside another, touching it at a corner, is no joint with it.

    The two at the crown fall by DEPTH and more and come to lie side by side, turned a little.
    """
    times = np.linspace(0, 4, 81)
    lowest = ARCH.assembly().blocks[2].vertices[:, 1].min() / 2.0
    way = np.minimum(times**2 / 2, lowest + DEPTH - 1e-3)
    moved = np.zeros((81, ARCH.voussoirs, 3))
    moved[:, [2, 3], 1] = -way[:, None]
    moved[:, 2, 2] = np.minimum(0.02 * times, 0.05)
    run = recording(moved, times)
    states = classify(ARCH.assembly(), run.poses[-1], least=SEEN)
    assert "hinge" in states[3].state  # taken for itself it looks like one
    stage = Stage(run)
    assert stage.end == times[-1]
    assert set(stage.at(0.5).joints[2:5]) != {JointState.CLOSED}
    assert set(stage.at(4.0).joints) == {JointState.CLOSED}


def test_the_line_of_thrust_is_whole_or_not_there() -> None:
    """From springing to springing, however thin the arch; none where it goes far out."""
    for degrees, eta, whole in ((90, 0.3, True), (90, 0.005, True), (165, 0.3, False)):
        arch = replace(ARCH, half_angle=math.radians(degrees), eta=eta, voussoirs=27)
        stage = Stage(recording(np.zeros((2, 27, 3)), np.array([0.0, 1.0]), arch))
        assert len(stage.thrust) == whole
        for line in stage.thrust:
            assert line[0] == pytest.approx(line[-1] * [-1, 1], abs=1e-9)
            assert abs(line[0, 1]) < 1e-9
            # A corner at each joint.
            # One below the weight of most voussoirs, too.
            assert 28 < len(line) <= 2 * 27 + 1


def test_command_draws_a_leaning_arch_as_check_answers(tmp_path: Path) -> None:
    """tan(lean) > (d/2)/(2r/pi): it overturns, and nothing may say that it stands."""
    out = tmp_path / "lean.svg"
    done = ran("render", "semicircle_tilted_overturns", "--out", out)
    words = re.findall(r"<!-- (.*?) -->", out.read_text(encoding="utf-8"))
    title = next(word for word in words if "tilted" in word)
    assert title.startswith("COLLAPSES, ")
    assert "tilted 38.4°" in title
    assert {"gravity", "hinge"} <= {*words}
    assert not any("stands" in word.lower() for word in [*words, done])


def test_side_by_side_of_short_recordings_says_how_to_see_more(tmp_path: Path) -> None:
    """As README has it: recordings that go on show the fall; those until a verdict say so."""
    for name, eta in (("below", "0.1005"), ("above", "0.1035")):
        for way, more in (("short", ()), ("long", ("--seconds", "0.9"))):
            out = f"{tmp_path}/{way}_{name}.npz"
            asked = ("semicircle", "--voussoirs", "9", "--eta", eta, "--method", "direct")
            ran("simulate", *asked, *more, "--out", out)
    said = {}
    for way in ("short", "long"):
        pair = (f"{tmp_path}/{way}_below.npz", "--beside", f"{tmp_path}/{way}_above.npz")
        small = ("--height", "180", "--slow", "1", "--out", f"{tmp_path}/{way}.gif")
        said[way] = inside("render", *pair, *small).stdout
    assert "simulate --seconds 2 records how it falls" in said["short"]
    assert "simulate --seconds" not in said["long"]
    assert "η = 0.1035, direct): it is at rest" in said["long"]
    with Image.open(tmp_path / "long.gif") as picture:
        first = np.asarray(picture.convert("RGB")).astype(int)
        picture.seek(picture.n_frames - 1)
        last = np.asarray(picture.convert("RGB")).astype(int)
    changed = (np.abs(last - first).max(axis=-1) > 40)[20:160]
    left, right = np.split(changed, 2, axis=1)
    assert left.sum() > 300
    assert right.sum() == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("RUN", "--mu", "1"), "--mu = 1.0: must be left out"),
        (("RUN", "--height", "241"), "--height = 241: must be an even number"),
        (("RUN", "--slow", "0"), "--slow = 0.0: must be above 0"),
        (("RUN", "--method", "direct"), "--method = 'direct': must be left out"),
        (("RUN", "--time", "1"), "--time = 1.0: must be left out of a film"),
        (("RUN", "--time", "-1"), "--time = -1.0: must be 0 or more"),
        (("RUN", "--beside", "none.npz"), "an existing .npz file"),
    ],
)
def test_wrong_input_is_one_line(
    arguments: tuple[str, ...], words: str, tmp_path: Path
) -> None:
    run = tmp_path / "run.npz"
    falling().save(run)
    given_ = [str(run) if each == "RUN" else each for each in arguments]
    assert words in refused("render", *given_, "--out", tmp_path / "film.mp4")
    assert [path.name for path in tmp_path.iterdir()] == ["run.npz"]
