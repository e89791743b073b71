"""The referee: its scenes, their answers by other means, and what it takes from strangers."""

import json
import math
import runpy
import subprocess
import sys
from pathlib import Path
from token import NAME, NUMBER, OP
from tokenize import generate_tokens
from typing import Any

import numpy as np
import pytest
from half_arch import by_half
from own_balance import SIDES, by_contact_forces, by_pyramids
from running import answered, inside, ran, refused
from scipy.integrate import quad
from scipy.spatial import Delaunay
from scipy.spatial.transform import Rotation
from shapely.geometry import MultiPoint, Polygon

from blocksim import check, structure_of
from blocksim.suite.export import questions
from blocksim.suite.families import LEVELS, Family, Question, families
from blocksim.suite.scene import acting, bodies_of
from blocksim.suite.timed import Motion

pytestmark = pytest.mark.usefixtures("wide_window")

G = 9.81
ENGINES = Path(__file__).parent.parent / "docs" / "examples" / "engines"
STANDING = {name: each for name, each in questions().items() if isinstance(each, Question)}
MOVING = {name: each for name, each in questions().items() if isinstance(each, Motion)}
NEAREST = [each for each in STANDING.values() if each.level == LEVELS[-1]]


def spatial(asked: Question) -> bool:
    return asked.family.spatial


def by_name(values: list[Question], every: int = 1) -> Any:
    """Ask about all, of which one in so many is in the usual run."""
    asked = [
        pytest.param(each, id=each.name, marks=[pytest.mark.long] if at % every else [])
        for at, each in enumerate(values)
    ]
    return pytest.mark.parametrize("asked", asked)


@by_name(NEAREST, every=2)
def test_answers_next_to_the_limit_are_proved(asked: Question) -> None:
    answer = check(asked.problem, method="limit")
    assert answer.verdict.value == ("stands" if asked.stands else "collapses")
    assert answer.proved


@by_name(
    [each for each in STANDING.values() if each.level in {20.0, 1.0} and not spatial(each)],
    every=3,
)
def test_a_programme_of_its_own_agrees(asked: Question) -> None:
    assert by_contact_forces(asked.scene.record()) == asked.stands


def drawn_flat(scene: dict[str, Any]) -> dict[str, Any]:
    """Draw a vault, whose blocks lie along it, as the arch that it is from the front."""
    seen: dict[Polygon, bool] = {}
    for body in scene["bodies"]:
        for shape in body["polyhedra"]:
            front = MultiPoint(np.array(shape)[:, [0, 2]]).convex_hull
            assert isinstance(front, Polygon)
            if not any(front.equals_exact(each, 1e-9, normalize=True) for each in seen):
                seen[front] = body["fixed"]
    bodies = [
        {"polygons": [each.exterior.coords[:-1]], "mass": each.area, "fixed": fixed}
        for each, fixed in seen.items()
    ]
    return scene | {"bodies": bodies}


SYMMETRIC = [
    each
    for each in NEAREST
    if (each.group.startswith("arches") and each.scene.gravity[0] == 0)
    or each.family.name in {"thin-piers", "thin-barrel"}
]


@pytest.mark.parametrize("asked", SYMMETRIC, ids=lambda each: each.name)
def test_statics_by_hand_of_half_an_arch_agrees(asked: Question) -> None:
    scene = asked.scene.record()
    assert by_half(drawn_flat(scene) if spatial(asked) else scene) == asked.stands


IN_SPACE = [each for each in STANDING.values() if spatial(each) and each.level == 1]


@pytest.mark.parametrize(
    "asked",
    [
        pytest.param(each, id=each.name, marks=[pytest.mark.long] * (each.group != "towers"))
        for each in IN_SPACE
    ],
)
def test_a_programme_of_its_own_agrees_in_space(asked: Question) -> None:
    # What stands does so with pyramids within the cones, what falls with those around them.
    grown = 1.0 if asked.stands else 1 / math.cos(math.pi / SIDES)
    assert by_pyramids(asked.scene.record(), grown) == asked.stands


@by_name(
    [
        each
        for each in STANDING.values()
        if each.level == 5 and not each.stands and not spatial(each)
    ],
    every=2,
)
def test_direct_agrees(asked: Question) -> None:
    assert check(asked.problem, method="direct").verdict.value == "collapses"


@pytest.mark.parametrize("over", [-1e-3, 1e-3])
def test_a_corner_upon_a_corner_bears_nothing(over: float) -> None:
    # The intrados of this arch springs from where the skewback's tip lies on its pier's edge.
    # There the programme above lets the voussoir press the pier's corner, along the springing,
    # and finds 18.6 deg. A millimetre farther in or out both say what limit analysis says of
    # the drawing: 11.05 deg.
    arch = {"kind": "circular-arch", "radius": 2, "left_deg": 60, "right_deg": 60,
            "voussoirs": 9, "weight": "chord", "thickness": 0.5}  # fmt: skip
    sizes = {"pier_width": 1.2, "pier_height": 2, "pier_courses": 2}
    drawn = structure_of({"kind": "portal", "friction": 0.5, "arch": arch, **sizes})
    blocks: list[dict[str, Any]] = [
        {"id": 0, "fixed": True, "vertices": [[-9, -3], [9, -3], [9, -1.125], [-9, -1.125]]}
    ]  # fmt: skip
    for block in drawn.assembly.blocks:
        corners = block.vertices.copy()
        if block.name in {"left pier 2", "right pier 2"}:
            inner = np.abs(corners[:, 0]) < 2
            corners[inner, 0] -= over * np.sign(corners[inner, 0])
        blocks.append({"id": block.name, "vertices": corners.tolist()})
    moved = structure_of({"friction": 0.5, "density": 19_620, "blocks": blocks})
    for tilt, stands in ((11.0, True), (11.1, False)):
        for problem in (moved, drawn):
            tilted = problem.tilted(math.radians(tilt))
            assert (check(tilted, method="limit").verdict.value == "stands") == stands
        tilted = moved.tilted(math.radians(tilt))
        record = {
            "bodies": [each.record() for each in bodies_of(tilted)],
            "gravity": acting(tilted)[0].tolist(),
            "pushes": [],
            "friction": 0.5,
        }
        assert by_contact_forces(record) == stands


CLOSED = {
    "incline": math.tan(math.radians(20)),
    "table": math.degrees(math.atan(0.5)),
    "pushed-box": 0.6 * 9810,
    "box-on-box": 0.4 * 0.4 * 19_620,
    "slender": math.degrees(math.atan(0.5 / 1.5)),
    "pushed-pillar": 0.25 * 0.75 * 19_620 / 1.5,
    "column": math.degrees(math.atan(0.8 / 3)),
    "trapezium": (7 / 18) / (4 / 9),
    "harmonic": sum(1 / row for row in range(1, 6)) / 2,
    "stairs": 6 / 7,
    # Both posts tip: their weight and the lintel's over the lower corners.
    "trilithon": 0.6 / 1.6,
    # The lowest course, or all above it, slides.
    "low-wall": 0.4,
    # Five boxes 0.4 m high, over the edge across which they are 0.6 m wide.
    "tilted-tower": math.degrees(math.atan(0.6 / 2)),
    # The four upper of five boxes 1 m long, whose centre is 2.5 offsets from the first's.
    "even-tower": 0.2,
    # Whatever the azimuth, and however boxes are turned.
    "box-aslant": math.tan(math.radians(20)),
    "turned-boxes": math.tan(math.radians(15)),
}


@pytest.mark.parametrize("name", CLOSED)
def test_limits_of_closed_form(name: str) -> None:
    family = next(each for each in families() if each.name == name)
    assert family.critical == pytest.approx(CLOSED[name], rel=1e-9)


def test_semicircle_has_the_least_thickness_of_its_polygons() -> None:
    # 27 voussoirs with straight chords; by a programme of others 0.106721 r.
    family = next(each for each in families() if each.name == "semicircle")
    assert family.critical / 5 == pytest.approx(0.106721, abs=5e-7)


def moments_of(shapes: tuple[np.ndarray, ...]) -> tuple[float, np.ndarray, np.ndarray]:
    """Volume of hulls, and the integrals of x and of its outer square: by tetrahedra."""
    corners = np.concatenate([shape[Delaunay(shape).simplices] for shape in shapes])
    volumes = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
    sums = corners.sum(axis=1)
    squares = np.einsum("nki,nkj->nij", corners, corners) + np.einsum("ni,nj->nij", sums, sums)
    return volumes.sum(), volumes @ sums / 4, np.einsum("n,nij->ij", volumes, squares) / 20


@pytest.mark.parametrize("family", families(), ids=lambda each: each.name)
def test_nothing_overlaps_and_blocks_are_homogeneous(family: Family) -> None:
    for asked in family.questions:
        if asked.level != 20:
            continue
        if family.spatial:
            for body in asked.scene.moving:
                volume, first, second = moments_of(body.shapes)
                assert body.mass == pytest.approx(2000 * volume)
                assert body.centre == pytest.approx(first / volume, abs=1e-9)
                around = second - volume * np.outer(body.centre, body.centre)
                inertia = 2000 * (np.trace(around) * np.eye(3) - around)
                assert np.asarray(body.inertia) == pytest.approx(inertia, abs=1e-6)
            continue
        shapes = [
            (body.name, Polygon(shape)) for body in asked.scene.bodies for shape in body.shapes
        ]
        for at, (one, shape) in enumerate(shapes):
            for other, beside in shapes[:at]:
                assert one == other or shape.intersection(beside).area < 1e-9
        for body in asked.scene.moving:
            (shape,) = (Polygon(each) for each in body.shapes)
            assert body.mass == pytest.approx(2000 * shape.area)
            assert np.allclose(body.centre, shape.centroid.coords[0], atol=1e-9)


@pytest.mark.long
@by_name(
    [
        each
        for each in STANDING.values()
        # In space by towers alone: a dome's motion takes minutes.
        if not each.stands
        and each.level == 20
        and (not spatial(each) or each.group == "towers")
    ][::2]
)
def test_what_falls_has_left_by_its_end(asked: Question) -> None:
    from blocksim import simulate

    problem, scene = asked.problem, asked.scene
    seen = simulate(problem, method="direct", duration=scene.times[-1] / problem.seconds)
    assert seen.displacement[-1] * problem.assembly.size > 5 * scene.bound


def test_own_methods_say_the_same_through_files(tmp_path: Path) -> None:
    adapter = runpy.run_path(str(ENGINES / "blocksim_engines.py"))
    (tmp_path / "scenes").mkdir()
    asked = [each for each in NEAREST if each.group in {"toppling", "towers"}]
    for each in asked:
        text = json.dumps(each.scene.record())
        (tmp_path / "scenes" / f"{each.name}.json").write_text(text)
    planar = {each.name: each.problem for each in asked if not spatial(each)}
    for method, problems in (
        ("limit", {each.name: each.problem for each in asked}),
        ("direct", planar),
    ):
        for name in {each.name for each in asked} - set(problems):
            (tmp_path / "scenes" / f"{name}.json").unlink()
        out = tmp_path / f"{method}.jsonl"
        adapter["main"](tmp_path / "scenes", out, method)
        _, *lines = map(json.loads, out.read_text().splitlines())
        assert {line["scene"] for line in lines} == set(problems)
        for line in lines:
            usual = check(problems[line["scene"]], method=method).verdict.value
            assert line["verdict"] == adapter["SAYS"][usual]


def test_a_stranger_takes_part_by_files(tmp_path: Path) -> None:
    """By penalty springs in 60 lines of numpy, comments and docstrings not counted."""
    folder, answers = tmp_path / "suite", tmp_path / "answers.jsonl"
    asked = ("--level", "20", "--group", "sliding")
    ran("suite", "export", folder, *asked)
    for path in (folder / "scenes").iterdir():
        if not path.name.startswith("incline"):
            path.unlink()
    script = ENGINES / "penalty.py"
    with script.open() as file:
        tokens = list(generate_tokens(file.readline))
    assert len({each.start[0] for each in tokens if each.type in {NAME, NUMBER, OP}}) <= 60
    subprocess.run([sys.executable, script, folder / "scenes", answers], check=True)
    found = answered("suite", "score", answers)
    assert found["groups"]["sliding"]["levels"]["20"] == [2, 0, 6]


def test_what_slides_keeps_its_energy_but_for_friction() -> None:
    scene, poses = MOVING["slides-down-2"].scene, MOVING["slides-down-2"].poses
    way, seconds = poses[-1, 0, 0] - poses[0, 0, 0], scene.times[-1]
    speed = 2 * way / seconds
    pull, press = scene.gravity[0], -scene.gravity[1]
    assert speed**2 / 2 == pytest.approx((pull - 0.3 * press) * way)


def test_what_falls_back_takes_the_time_of_the_elliptic_integral() -> None:
    # t = integral of dlean / speed, by the energy of a block on its corner.
    asked = MOVING["falls-back-2"]
    width, height = 0.5, 1.5
    alpha, radius = math.atan(width / height), math.hypot(width, height) / 2
    lean = alpha / 2
    now = lean + asked.poses[-1, 0, 2] * -1 - lean
    end = lean - asked.poses[-1, 0, 2]

    def pace(share: float) -> float:
        # The substitution lean - share**2 takes the root at the start away.
        at = lean - share**2
        fallen = math.cos(alpha - at) - math.cos(alpha - lean)
        return 2 * share / math.sqrt(2 * 3 * G / (4 * radius) * abs(fallen))

    assert now < 0 < end
    seconds, _ = quad(pace, 1e-9, math.sqrt(lean - end))
    assert seconds == pytest.approx(asked.scene.times[-1], rel=1e-6)


def test_what_rocks_on_keeps_the_share_of_housner() -> None:
    asked = MOVING["rocks-on-2"]
    alpha = math.atan(1 / 3)
    sides = [
        math.cos(alpha - lean) - math.cos(alpha)
        for lean in (alpha / 2, float(asked.poses[:, 0, 2].max()) - alpha / 2)
    ]
    # Energy at the far side over that at the start, if it has turned there.
    assert sides[1] <= (1 - 1.5 * math.sin(alpha) ** 2) ** 2 * sides[0]


def test_boxes_that_meet_keep_their_momentum() -> None:
    asked = MOVING["meets-1"]
    mass = np.array([body.mass for body in asked.scene.moving])
    first, last = asked.poses[0], asked.poses[-1]
    way = mass @ (last - first)[:, 0]
    speed = asked.scene.moving[0].velocity
    assert speed is not None
    assert way == pytest.approx(mass[0] * speed[0] * asked.scene.times[-1])


@pytest.fixture(scope="module")
def suite(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("suite")
    ran("suite", "export", folder, "--group", "sliding", "--group", "impact")
    return folder


def test_export_fits_its_schema(suite: Path) -> None:
    schema = json.loads((suite / "scene.schema.json").read_text())
    paths = [*(suite / "scenes").iterdir()]
    assert len(paths) == 4 * 12 + 9
    for path in paths:
        scene = json.loads(path.read_text())
        assert set(scene) == set(schema["required"])
        assert scene["level"] in schema["properties"]["level"]["enum"]
        assert "stands" not in scene
        for body in scene["bodies"]:
            assert set(body) <= set(schema["$defs"]["body"]["properties"])


def test_mujoco_reads_what_is_exported(suite: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    paths = [*(suite / "mjcf").iterdir()]
    # What is pushed is left out.
    assert len(paths) == 2 * 12 + 9
    for path in paths:
        scene = json.loads((suite / "scenes" / f"{path.stem}.json").read_text())
        model = mujoco.MjModel.from_xml_path(str(path))
        moving = [each for each in scene["bodies"] if not each["fixed"]]
        assert model.nv == 3 * len(moving)
        assert model.opt.gravity[:2] == pytest.approx(scene["gravity"])
        for body in moving:
            assert model.body(body["name"]).mass[0] == pytest.approx(body["mass"])
            assert model.body(body["name"]).pos[:2] == pytest.approx(body["centre"])


HEAD = {"format": "blocksim answers 1", "engine": "mine", "version": "1", "settings": "none"}


def written(path: Path, lines: list[Any]) -> str:
    path.write_text(
        "\n".join(each if isinstance(each, str) else json.dumps(each) for each in lines)
    )
    return str(path)


def test_right_answers_are_right_and_their_opposites_false(tmp_path: Path) -> None:
    lines: list[Any] = [HEAD]
    for asked in STANDING.values():
        said = "stands" if asked.stands == (asked.level > 1) else "falls"
        lines.append({"scene": asked.name, "seconds": 0.5, "verdict": said})
    for asked in MOVING.values():
        poses = asked.poses.tolist()
        lines.append({"scene": asked.name, "seconds": 0.5, "poses": poses})
    found = answered("suite", "score", written(tmp_path / "a.jsonl", lines))
    assert found["nearest_level"] == 2
    assert found["groups"]["rocking"]["levels"]["0.1"] == [6, 0, 0]
    assert found["groups"]["stacks"]["levels"]["1"] == [0, 6, 0]
    assert found["groups"]["stacks"]["nearest_level"] == 2
    assert found["seconds"] == 0.5 * len(questions())


def test_poses_are_judged_by_their_last_corner(tmp_path: Path) -> None:
    asked = next(
        each for each in STANDING.values() if each.name.startswith("incline") and each.stands
    )
    scene = asked.scene
    x, y = scene.moving[0].centre.tolist()
    counts: list[Any] = []
    for share in (0.99, 1.01):
        frames = [[[x, y, 0.0]] for _ in scene.times[1:]]
        frames.append([[x + share * scene.bound, y, 0.0]])
        line = {"scene": scene.name, "seconds": 0, "poses": frames}
        path = written(tmp_path / "a.jsonl", [HEAD, line])
        found = answered("suite", "score", path)
        counts.append(found["groups"]["sliding"]["levels"][f"{asked.level:g}"])
    assert counts == [[1, 0, 7], [0, 1, 7]]


def test_a_page_is_written_and_a_lost_level_told(tmp_path: Path) -> None:
    lines: list[Any] = [HEAD]
    lines += [
        {"scene": name, "seconds": 0, "verdict": "stands" if each.stands else "falls"}
        for name, each in STANDING.items()
        if each.group == "sliding"
    ]
    out = tmp_path / "out"
    ran("suite", "score", written(tmp_path / "a.jsonl", lines), "--out", out)
    assert {path.name for path in out.iterdir()} == {"score.html", "score.json", "rows.csv"}
    lines[1]["verdict"] = "falls" if lines[1]["verdict"] == "stands" else "stands"
    path = written(tmp_path / "b.jsonl", lines)
    done = inside("suite", "score", path, "--expect", out / "score.json")
    assert done.returncode == 1
    assert done.stderr.startswith("blocksim: sliding: right to 0.1 % was expected")


@pytest.mark.parametrize("name", ["semicircle-01", "turned-boxes-01"])
def test_a_replay_has_the_poses_that_were_said(name: str, tmp_path: Path) -> None:
    """By its table, in metres and seconds, where turns are rotation vectors."""
    scene = questions()[name].scene
    frames, count = len(scene.times), len(scene.moving)
    centres = np.array([body.centre for body in scene.moving])
    moved = np.random.default_rng(1).normal(size=(frames, count, centres.shape[1]))
    moved[0] = 0.0
    angle = np.linspace(0.0, 3.0, frames)[:, None, None]
    axis = np.array([1.0] if scene.dimensions == 2 else [2 / 3, -2 / 3, 1 / 3])
    turn = np.broadcast_to(angle * axis, (frames, count, len(axis)))
    half = np.broadcast_to(angle / 2, (frames, count, 1))
    said = turn if len(axis) == 1 else np.concatenate([np.cos(half), np.sin(half) * axis], -1)
    poses = np.concatenate([centres + moved, said], axis=-1).tolist()
    path = written(tmp_path / "a.jsonl", [HEAD, {"scene": name, "seconds": 1, "poses": poses}])
    recording, table = str(tmp_path / "run.npz"), tmp_path / "run.json"
    done = ran("suite", "replay", path, name, "--out", recording)
    arms = np.concatenate(
        [corner - body.centre for body in scene.moving for corner in body.shapes]
    )
    owner = np.repeat(range(count), [sum(map(len, body.shapes)) for body in scene.moving])
    turned = Rotation.from_rotvec((angle[-1, 0, 0] * axis) if len(axis) == 3 else [0, 0, 3.0])
    level = np.zeros((len(arms), 3))
    level[:, : scene.dimensions] = arms
    shift = turned.apply(level)[:, : scene.dimensions] - arms + moved[-1, owner]
    assert f"a corner has moved {np.linalg.norm(shift, axis=1).max():.3g} m" in done
    ran("render", recording, "--out", table)
    found = json.loads(table.read_text())
    np.testing.assert_allclose(found["time_s"], scene.times, atol=1e-12)
    columns = ["x_m", "y_m", "z_m"][: scene.dimensions]
    places = np.stack([found[each] for each in columns], -1)
    np.testing.assert_allclose(places, centres + moved, atol=1e-9)
    columns = ["rotation_rad"] if len(axis) == 1 else [f"rotation_{x}_rad" for x in "xyz"]
    turns = np.stack([found[each] for each in columns], -1)
    np.testing.assert_allclose(turns, turn, atol=1e-9)


def test_files_that_cannot_be_read_are_one_line(tmp_path: Path) -> None:
    (tmp_path / "binary").write_bytes(bytes(range(256)))
    refused("suite", "score", "binary", cwd=tmp_path)
