"""Recordings as glTF, CSV and JSON: what others read in them is what was recorded."""

import json
import math
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from filelock import FileLock
from recorded import accessor, parts_of
from running import csv_rows, inside, ran, refused
from scipy.spatial.transform import Rotation
from windows import new_page

from blocksim import Recording, load_recording, simulate, structure_of

HERE = Path(__file__).parent / "gltf"
SIZE, G = 2.0, 9.81
STACK = {
    "title": "A stack that topples",
    "friction": 0.6,
    "size": SIZE,
    "blocks": [
        {"id": "floor", "vertices": [[-2, -1], [4, -1], [4, 0], [-2, 0]], "fixed": True},
        {"id": "low", "vertices": [[0, 0], [1, 0], [1, 0.5], [0, 0.5]], "depth": 2},
        {"id": "ell", "vertices": [[0.2, 0.5], [1.2, 0.5], [1.2, 1.5], [0.9, 1.5], [0.9, 1],
                                   [0.2, 1]]},
        {"id": "last, top", "vertices": [[0.4, 1], [0.9, 1], [0.9, 1.5], [0.4, 1.5]]},
    ],
}  # fmt: skip
NAMES = ["low", "ell", "last, top"]


@pytest.fixture(scope="module")
def fall() -> Recording:
    """It topples to the right and turns by more than half a turn before it lies."""
    problem = structure_of(STACK).tilted(math.radians(30))
    return simulate(problem, method="direct", duration=2.0 / problem.seconds)


@pytest.fixture(scope="module")
def saved(fall: Recording, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("fall") / "fall.npz"
    fall.save(path)
    return path


@pytest.fixture(scope="module")
def spatial(fall: Recording) -> Recording:
    """The same with motion out of the plane, as engines in three dimensions record it."""
    aside = np.zeros_like(fall.poses)
    aside[..., 0] = 0.1 * fall.times[:, None]
    aside[..., 1], aside[..., 2] = 2 * aside[..., 0], -aside[..., 0]
    return replace(fall, poses=np.concatenate([fall.poses, aside], axis=-1))


@pytest.fixture(scope="session")
def modules(pytestconfig: pytest.Config) -> Path:
    """three.js and the validator, fetched once by npm as the lock file says.

    Only long tests ask the network, and none waits for it for long.
    """
    npm = shutil.which("npm")
    if npm is None:
        pytest.skip("no npm here (apt-get install npm)")
    folder = Path(pytestconfig.cache.mkdir("gltf"))
    with FileLock(folder / "lock"):
        for name in ("package.json", "package-lock.json"):
            shutil.copy(HERE / name, folder)
        if not (folder / "node_modules" / "three" / "build").is_dir():
            quiet = ("--ignore-scripts", "--no-audit", "--no-fund")
            fetch = [npm, "ci", *quiet, "--fetch-retries=1", "--fetch-timeout=60000"]
            done = subprocess.run(fetch, cwd=folder, capture_output=True, check=False)
            if done.returncode:
                pytest.skip("npm fetches nothing here")
    return folder / "node_modules"


def places(recording: Recording, point: np.ndarray) -> np.ndarray:
    """Where a point of each block, from its centre, is [m], (frames, blocks, 3)."""
    poses = recording.poses
    vectors, centres = np.zeros((2, *poses.shape[:2], 3))
    vectors[..., 2], centres[..., :2] = poses[..., 2], poses[..., :2]
    arms = Rotation.from_rotvec(vectors.reshape(-1, 3)).apply(point).reshape(centres.shape)
    return centres * recording.assembly.size + arms


def test_csv_has_a_row_for_each_block_at_each_time(
    tmp_path: Path, fall: Recording, saved: Path
) -> None:
    out = tmp_path / "fall.csv"
    done = ran("render", saved, "--out", out)
    assert f"3 blocks, {len(fall.times)} frames, 2.01 s" in done
    rows = csv_rows(out)
    assert list(rows[0]) == ["time_s", "block", "x_m", "y_m", "rotation_rad"]
    assert [row["block"] for row in rows] == NAMES * len(fall.times)
    read = np.array([[float(row[key]) for key in rows[0] if key != "block"] for row in rows])
    read = read.reshape(len(fall.times), 3, 4)
    # One unit of time is sqrt(size/g), of length the size.
    seconds = fall.times * math.sqrt(SIZE / G)
    assert read[..., 0] == pytest.approx(np.tile(seconds[:, None], 3), abs=1e-12)
    scaled = fall.poses * [SIZE, SIZE, 1]
    assert read[..., 1:] == pytest.approx(scaled, abs=1e-12)


def test_json_has_geometry_and_poses(tmp_path: Path, fall: Recording, saved: Path) -> None:
    out = tmp_path / "fall.json"
    ran("render", saved, "--out", out)
    said = json.loads(out.read_text())
    assert (said["format"], said["version"]) == ("blocksim recording", 1)
    assert said["title"] == "A stack that topples"
    read = np.stack([np.array(said[key]) for key in ("x_m", "y_m", "rotation_rad")], axis=-1)
    assert read == pytest.approx(fall.poses * [SIZE, SIZE, 1], abs=1e-12)
    assert said["time_s"] == pytest.approx(fall.times * math.sqrt(SIZE / G), abs=1e-12)
    assert [block["name"] for block in said["blocks"]] == NAMES
    low, ell, _ = said["blocks"]
    assert low["polygons_m"] == [STACK["blocks"][1]["vertices"]]
    assert (low["depth_m"], low["centre_m"]) == (2, [0.5, 0.25])
    # 1 N/m^3 where no density is given.
    assert low["weight_N"] == pytest.approx(1.0)
    assert ell["weight_N"] == pytest.approx(0.65)
    assert len(ell["polygons_m"]) == 2
    assert said["supports"] == [
        {"name": "floor", "polygons_m": [STACK["blocks"][0]["vertices"]]}
    ]
    assert {(each["a"], each["b"]) for each in said["joints"]} >= {("floor", "low")}
    tilt = math.radians(30)
    gravity = [math.sin(tilt), -math.cos(tilt), 0]
    assert said["gravity_g"] == pytest.approx(gravity)


def written(recording: Recording, kind: str = "glb") -> bytes:
    with TemporaryDirectory() as folder:
        run, out = Path(folder) / "run.npz", Path(folder) / f"run.{kind}"
        recording.save(run)
        ran("render", run, "--out", out)
        return out.read_bytes()


def test_meshes_are_the_blocks_closed_and_seen_from_outside(fall: Recording) -> None:
    """Volume and centre by the divergence theorem: of every triangle's own corners."""
    document, numbers = parts_of(written(fall))
    for block, node in zip(fall.assembly.blocks, document["nodes"], strict=False):
        part = document["meshes"][node["mesh"]]["primitives"][0]
        corners = accessor(document, numbers, part["attributes"]["POSITION"]).astype(float)
        normals = accessor(document, numbers, part["attributes"]["NORMAL"])
        a, b, c = corners[accessor(document, numbers, part["indices"]).reshape(-1, 3).T]
        sixth = (a * np.cross(b, c)).sum(axis=1) / 6
        volume = block.mass * G
        assert sixth.sum() == pytest.approx(volume, rel=1e-6)
        centre = ((a + b + c) / 4 * sixth[:, None]).sum(axis=0) / volume
        assert centre == pytest.approx(np.zeros(3), abs=1e-6)
        # Triangles wind as their normals say.
        out = np.cross(b - a, c - a)
        first = accessor(document, numbers, part["indices"]).reshape(-1, 3)[:, 0]
        out /= np.linalg.norm(out, axis=1)[:, None]
        assert (out * normals[first]).sum(axis=1) == pytest.approx(np.ones(len(out)))
    names = [node["name"] for node in document["nodes"]]
    assert names == [*NAMES, "support 0", "ground"]
    moved = {channel["target"]["node"] for channel in document["animations"][0]["channels"]}
    assert moved == {0, 1, 2}


def test_times_that_a_float_cannot_tell_apart_are_left_out(fall: Recording) -> None:
    times = fall.times.copy()
    times[1:] = np.sort(np.append(times[2:], np.nextafter(times[-1], 0)))
    document, numbers = parts_of(written(replace(fall, times=times)))
    sampler = document["animations"][0]["samplers"][0]
    kept = accessor(document, numbers, sampler["input"])
    assert len(kept) == len(times) - 1
    assert (np.diff(kept) > 0).all()


@pytest.mark.long
def test_the_validator_finds_nothing(
    tmp_path: Path, modules: Path, fall: Recording, spatial: Recording
) -> None:
    paths = [tmp_path / name for name in ("a.glb", "b.gltf", "c.glb", "d.glb", "bad.glb")]
    resting = replace(fall, times=fall.times[:1], poses=fall.poses[:1])
    for path, recording in zip(paths, (fall, fall, spatial, resting), strict=False):
        path.write_bytes(written(recording, path.suffix[1:]))
    # It would say so if times went back.
    document, _ = parts_of(paths[0].read_bytes())
    place = document["animations"][0]["samplers"][0]["input"]
    start = document["bufferViews"][document["accessors"][place]["bufferView"]]["byteOffset"]
    data = bytearray(paths[0].read_bytes())
    start += len(data) - document["buffers"][0]["byteLength"]
    data[start + 4 : start + 8] = np.float32(9).tobytes()
    paths[-1].write_bytes(data)
    node = shutil.which("node") or ""
    said = subprocess.run(
        [node, str(HERE / "validate.js"), str(modules), *map(str, paths)],
        capture_output=True,
        check=True,
    )
    *good, bad = json.loads(said.stdout)
    for report in good:
        assert report["messages"] == []
        assert report["animationCount"] == 1
        # Faces and edges of three blocks and the support, and the ground.
        assert report["drawCallCount"] == 9
    assert bad["numErrors"] > 0


@pytest.fixture
def viewer(browser: Any, modules: Path) -> Iterator[Any]:
    """A page with three.js, which shows a model; everything comes from the disk."""
    page = new_page(browser, viewport={"width": 640, "height": 400})
    wrong: list[str] = []
    page.on("pageerror", lambda error: wrong.append(str(error)))

    def show(model: bytes) -> Any:
        def serve(route: Any) -> None:
            path = route.request.url.partition("://gltf.test")[2]
            kinds = {".html": "text/html", ".js": "text/javascript"}
            kind = kinds.get(Path(path).suffix, "application/octet-stream")
            if path == "/model.glb":
                route.fulfill(body=model, content_type=kind)
            elif path == "/viewer.html":
                route.fulfill(path=HERE / "viewer.html", content_type=kind)
            else:
                route.fulfill(path=modules / path[1:], content_type=kind)

        page.route("**/*", serve)
        page.goto("http://gltf.test/viewer.html")
        page.wait_for_function("window.ready")
        assert wrong == []
        return page

    yield show
    page.context.close()


@pytest.mark.long
@pytest.mark.parametrize("kind", ["planar", "spatial"])
def test_blocks_are_in_three_js_where_they_were_recorded(
    viewer: Any, fall: Recording, spatial: Recording, kind: str
) -> None:
    """At frames, to the digits of a float; also after a block has turned over."""
    recording = fall if kind == "planar" else spatial
    page = viewer(written(recording))
    seconds = recording.seconds(G)
    assert page.evaluate("window.clip") == pytest.approx(seconds[-1], rel=1e-6)
    assert np.abs(recording.poses[-1, :, 2]).max() > math.pi / 2
    point = np.array([0.3, 0.2, 0.4])
    expected = places(recording, point)
    for frame in range(0, len(seconds), 9):
        # The time as the file has it.
        time = float(np.float32(seconds[frame]))
        asked = [time, NAMES, point.tolist()]
        seen = page.evaluate("([time, names, point]) => window.at(time, names, point)", asked)
        assert np.array(seen) == pytest.approx(expected[frame], abs=1e-6)


def test_a_scene_is_simulated_first_and_options_of_films_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "stack.json"
    path.write_text(json.dumps(STACK))
    out = tmp_path / "stack.glb"
    ran("render", path, "--tilt", "30", "--method", "direct", "--out", out)
    document, numbers = parts_of(out.read_bytes())
    samplers = document["animations"][0]["samplers"]
    top = accessor(document, numbers, samplers[4]["output"])
    assert np.linalg.norm(top[-1] - top[0]) > 0.5
    for option, value in (("--slow", "3"), ("--at", "1"), ("--height", "480")):
        assert f"{option} = " in refused("render", path, option, value, "--out", out)


def test_an_arch_without_a_radius_says_so(tmp_path: Path) -> None:
    run = str(tmp_path / "arch.npz")
    arch = ("--alpha", "90", "--eta", "0.1", "--mu", "0.7", "--voussoirs", "9")
    ran("simulate", *arch, "--method", "direct", "--out", run)
    done = inside("render", run, "--out", tmp_path / "arch.csv")
    assert "if r = 1 m" in done.stdout
    assert len(load_recording(run).assembly.blocks) == 9
