"""What is seen of blocks in space: joints in colour, forces, models, a page to turn around."""

import base64
import csv
import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.text import Text
from recorded import accessor, parts_of
from running import inside, refused
from scipy.spatial.transform import Rotation
from windows import wait_until
from worlds import Quality

import blocksim
from blocksim import JointState, Recording, Settings
from blocksim.blocks.record import to_record
from blocksim.blocks.shaking import Shaking
from blocksim.report.sheetpage import structure_page
from blocksim.view.canvas import Panel
from blocksim.view.film import Film
from blocksim.view.models import UPRIGHT, mechanism_model, write_model
from blocksim.view.solidfigure import FOOT, HEAD, TALL, WIDE, solid_figure
from blocksim.view.solidscene import force_lines, states_at
from blocksim.view.stage import SolidStage
from blocksim.view.style import JOINTS, LIVE
from blocksim.view.turning import turning_page
from blocksim.view.video import to_bytes
from blocksim.view.views import SpatialView


def tower() -> Any:
    return blocksim.Tower(blocks=3, offset=0.1, turn_deg=0, friction=0.7).problem()


def cuboid(low: float, high: float) -> Any:
    return [[x, y, z] for x in (0, 1) for y in (0, 0.6) for z in (low, high)]


def thin_dome() -> Any:
    return blocksim.Dome(thickness=0.03, lunes=6, courses=4, friction=0.7).problem()


def recording(moved: np.ndarray, times: np.ndarray) -> Recording:
    problem = tower()
    assembly = problem.assembly
    rest = np.zeros((len(assembly.blocks), 6))
    rest[:, :3] = assembly.centres / assembly.size
    return Recording(
        problem=problem, engine="direct", engine_version="0",
        settings=Settings(step=0.01, sweeps=1, hold_sweeps=1), times=times,
        poses=rest + moved, quality=Quality(),
    )  # fmt: skip


def tipping(angle: float = 0.5) -> Recording:
    """The uppermost box turns about an edge of its bed; the others stay."""
    problem = tower()
    assembly = problem.assembly
    joint = next(each for each in assembly.joints if {each.before, each.after} == {1, 2})
    edge = joint.points[np.argsort(joint.points[:, 0])[-2:]].mean(axis=0)
    times = np.linspace(0, 1, 11)
    moved = np.zeros((11, 3, 6))
    arm = (assembly.centres[2] - edge) / assembly.size
    for at, share in enumerate(times):
        turn = np.array([0.0, angle * share, 0.0])
        moved[at, 2, :3] = Rotation.from_rotvec(turn).apply(arm) - arm
        moved[at, 2, 3:] = turn
    return recording(moved, times)


def test_joints_are_coloured_by_what_they_are_seen_to_do() -> None:
    """A box that tips has a hinge, in its colour in the last frame and not in the first."""
    run = tipping()
    assembly = run.problem.assembly
    assert set(states_at(assembly, run.poses[0])) == {JointState.CLOSED}
    last = states_at(assembly, run.poses[-1])
    assert last.count(JointState.HINGE_INTRADOS) == 1
    slid = np.zeros((3, 6))
    slid[2, 0] = 0.05
    assert JointState.SLIDES in states_at(assembly, run.poses[0] + slid)
    lifted = np.zeros((3, 6))
    lifted[2, 2] = 0.02
    assert JointState.OPEN in states_at(assembly, run.poses[0] + lifted)
    film = Film([run], height=300, slow=1)
    tone = np.array(to_bytes(JOINTS[JointState.HINGE_INTRADOS]))
    # In the shade as well: the same hue, darker.
    seen = []
    for number in (0, film.count - 1):
        # The legend below has it in every frame.
        picture = film.frame(number)[:-20, :, :3].astype(float)
        hue = picture / np.maximum(picture.max(axis=-1, keepdims=True), 1)
        seen.append(int((np.abs(hue - tone / tone.max()).max(axis=-1) < 0.04).sum()))
    assert seen[0] == 0
    assert seen[1] > 60


def test_forces_are_drawn_where_they_balance_the_weights() -> None:
    """From the bottom to the top of a tower: three, two and one boxes' weight."""
    answer = blocksim.check(tower())
    assert answer.resultants is not None
    lines, shares = force_lines(answer.problem.assembly, answer.resultants)
    ways = lines[:, 1] - lines[:, 0]
    assert np.abs(ways[:, :2]).max() < 1e-6 * np.abs(ways).max()
    assert sorted(shares) == pytest.approx([1 / 3, 2 / 3, 1])
    for joint, line in zip(answer.problem.assembly.joints, lines, strict=True):
        above = [each for each in (joint.before, joint.after) if each >= 0]
        borne = answer.problem.assembly.centres[max(above) :].mean(axis=0)
        assert line.mean(axis=0)[:2] == pytest.approx(borne[:2], abs=1e-6)


def arrow_in(figure: Any) -> np.ndarray:
    """What has the colour of live loads, from the tail on, without the legend [pixels]."""
    of_loads = to_rgba(LIVE)
    found = []
    for drawn in figure.findobj(PolyCollection):
        edges, fills = drawn.get_edgecolors(), drawn.get_facecolors()
        for path, edge, fill in zip(drawn.get_paths(), edges, fills, strict=True):
            if tuple(edge) == of_loads or tuple(fill) == of_loads:
                found += path.vertices.tolist()
    return np.array([each for each in found if each[1] > FOOT])


def test_a_picture_shows_what_acts_on_blocks_and_all_of_it() -> None:
    """A load on the top of a tower points down to where it acts; a push points across."""
    bare = tower()
    assembly = bare.assembly
    top = assembly.centres[2] + [0, 0, 0.5 * np.ptp(assembly.blocks[2].hulls[0].corners[:, 2])]
    load = blocksim.Load(force=np.array([0.0, 0.0, -3.0]), blocks=(2,), point=top)
    loaded = replace(bare, live=(load,), load=1.0)
    assert arrow_in(solid_figure(blocksim.check(bare))).size == 0
    figure = solid_figure(blocksim.check(loaded))
    seen = arrow_in(figure)
    assert len(seen) > 4
    assert "live load" in {each.get_text() for each in figure.findobj(Text)}
    # The camera looks down on it: upright stays upright, and lines meet below.
    (x, high), (tip, low) = seen[0], seen[seen[:, 1].argmin()]
    assert high - low > 30
    assert abs(x - tip) < 0.05 * (high - low)
    assert seen[:, 1].max() <= TALL - HEAD
    # It is seen from -60 degrees.
    for azimuth, way in ((30, (1, 0)), (120, (0, 1)), (-150, (-1, 0)), (-60, (0, -1))):
        push = np.array([math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth)), 0])
        act = blocksim.Load(force=push, blocks=(0, 1, 2), per_weight=True)
        pushed = replace(bare, live=(act,), load=0.15)
        figure = solid_figure(blocksim.check(pushed))
        assert "push 0.15 g" in {each.get_text() for each in figure.findobj(Text)}
        seen = arrow_in(figure)
        along = seen[seen.dot(way).argmax()] - seen[0]
        assert along @ way > 0.9 * np.hypot(*along) > 0
        assert (seen.max(axis=0) < [WIDE, TALL - HEAD]).all()
    both = replace(bare, live=(act, replace(act, force=push[[1, 0, 2]])), load=0.15)
    words = solid_figure(blocksim.check(both)).findobj(lambda each: "push" in text_of(each))
    assert len(words) == 2
    assert abs(np.diff([each.get_position()[1] for each in words])) > words[0].get_fontsize()


def test_a_picture_names_the_version_of_the_library_that_answered() -> None:
    """Not that of blocksim, unless it is blocksim itself."""
    pytest.importorskip("pybullet")
    answer = blocksim.check(tower())
    for method, number in (("limit", blocksim.__version__), ("pybullet", version("pybullet"))):
        words = map(text_of, solid_figure(replace(answer, method=method)).findobj(Text))
        assert any(each.endswith(f"   {method} {number}") for each in words)


def test_a_legend_has_the_words_of_each_of_two_recordings() -> None:
    """Of an arch beside a tower: hinges of the arch are told by their side."""
    arch = blocksim.CircularArch(half_angle_deg=90, eta=0.08, friction=1, voussoirs=7)
    run = blocksim.simulate(arch, method="direct", duration=0.5)
    film = Film([tipping(), run], height=300)
    words = set(map(text_of, film.figure().findobj(Text)))
    assert {"hinge", "hinge intrados", "hinge extrados"} <= words


def text_of(drawn: Any) -> str:
    return drawn.get_text() if isinstance(drawn, Text) else ""


def test_a_model_moves_blocks_as_the_recording_does(tmp_path: Path) -> None:
    """Corners of each node, carried by its animation, are those of the blocks, y upwards."""
    run = tipping()
    path = tmp_path / "tower.glb"
    with path.open("wb") as file:
        write_model(run, file, "glb")
    document, data = parts_of(path.read_bytes())
    assembly = run.problem.assembly
    channels = document["animations"][0]["channels"]
    samplers = document["animations"][0]["samplers"]
    for at, block in enumerate(assembly.blocks):
        tracks = {
            each["target"]["path"]: samplers[each["sampler"]]
            for each in channels
            if each["target"]["node"] == at
        }
        places = accessor(document, data, tracks["translation"]["output"])
        turns = accessor(document, data, tracks["rotation"]["output"])
        part = document["meshes"][at]["primitives"][0]
        corners = accessor(document, data, part["attributes"]["POSITION"])
        for frame in (0, 5, 10):
            shown = Rotation.from_quat(turns[frame]).apply(corners) + places[frame]
            pose = run.poses[frame, at]
            arms = np.concatenate([hull.corners for hull in block.hulls]) - block.centre
            true = Rotation.from_rotvec(pose[3:]).apply(arms) + pose[:3] * assembly.size
            true = true @ UPRIGHT.T
            apart = np.abs(shown[:, None] - true).max(axis=-1).min(axis=0)
            assert apart.max() < 1e-5 * assembly.size
        # Triangles look outwards.
        order = accessor(document, data, part["indices"]).reshape(-1, 3)
        one, two, three = corners[order].swapaxes(0, 1)
        out = np.cross(two - one, three - one)
        assert (np.einsum("ij,ij->i", out, (one + two + three) / 3) > 0).all()


def test_a_page_holds_the_mechanism_and_asks_for_nothing() -> None:
    """A dome that falls: its blocks go and come back, its hinges are painted."""
    answer = blocksim.check(thin_dome())
    assert answer.verdict.value == "collapses"
    page = turning_page(answer)
    assert "collapses, by limit" in page
    # From where pictures look: they show as one point what is on the way to the eye.
    turned, raised = map(float, re.search(r'orbit="(\S+)deg (\S+)deg auto"', page).groups())  # type: ignore[union-attr]
    around, down = math.radians(turned), math.radians(raised)
    level = np.array([math.sin(around), 0.0, math.cos(around)])
    eye = math.sin(down) * level + [0.0, math.cos(down), 0.0]
    stage = SolidStage(tipping())
    view = SpatialView(stage, Panel(0, 0, 900, 900), np.array([[-0.5] * 3, [0.5] * 3]))
    middle = np.array([stage.middle, (stage.ground + 0.5) / 2, 0.0])
    here, nearer, right = view.places(
        middle + 0.1 * np.array([0 * eye, eye, np.cross([0, 1, 0], level)])
    )
    assert nearer == pytest.approx(here, abs=0.1)
    assert right[0] - here[0] > 10
    assert right[1] == pytest.approx(here[1], abs=0.1)
    model = base64.b64decode(re.search(r"base64,([A-Za-z0-9+/=]+)", page)[1])  # type: ignore[index]
    assert model == mechanism_model(answer)
    document, data = parts_of(model)
    sampler = document["animations"][0]["samplers"]
    moves = [accessor(document, data, each["output"]) for each in sampler]
    assert all(np.abs(each[0] - each[-1]).max() < 1e-6 for each in moves)
    assert max(float(np.ptp(each, axis=0).max()) for each in moves) > 0.01
    looks = {each["name"] for each in document["materials"]}
    assert f"joint {JOINTS[JointState.HINGE_INTRADOS]}" in looks
    assert not re.search(r"""(src|href)=["']?https?:""", page)
    assert "default-src 'none'" in page


@pytest.mark.long
def test_the_page_is_shown_in_a_browser(windows: Any, tmp_path: Path) -> None:
    """The model is loaded, moves and turns; whatever the page complains about fails.

    That a frame took over half a second is the machine's (`rAF timed out`).
    """
    path = tmp_path / "dome.html"
    path.write_text(turning_page(blocksim.check(thin_dome())), encoding="utf-8")
    page = windows.open(path.as_uri(), 420, 420)
    wait_until(page, lambda: page.evaluate("document.getElementById('model').loaded"))
    assert page.evaluate("document.getElementById('model').availableAnimations") == ["motion"]
    assert [
        each
        for each in windows.wrong(path.as_uri())
        if not each.startswith(("blob:", "[.WebGL", "rAF timed out"))
    ] == []


def test_a_report_tells_what_a_structure_in_space_carries() -> None:
    """Reactions balance weight and push, a joint carries both; how it falls is told beyond."""
    box = blocksim.Solid(parts=(cuboid(0, 2),), name="block")
    bed = blocksim.Solid(parts=(cuboid(-1, 0),), fixed=True, name="bed")
    push = blocksim.Load(force=[1, 0, 0], blocks=(0,), per_weight=True)
    assembly = blocksim.assembly_in_space([bed, box], density=1e3)
    problem = blocksim.Problem(assembly=assembly, mu=0.6, live=(push,), load=0.25)
    page = structure_page(blocksim.check(problem))
    cells = re.findall(r">([^<>]+)</t[dh]>", page[page.index("<h2>Reactions [kN]") :])
    at = cells.index("bed")
    assert cells[at + 1 : at + 4] == ["-0.3000", "0", "1.200"]
    at = cells.index("bed-block")
    # Of 0.6 times the weight a quarter of it is friction.
    assert cells[at + 1 : at + 5] == ["1.200", "0.3000", "250", "41.7\N{NO-BREAK SPACE}%"]
    assert "how it would start to fall at load factor 0.5" in page
    assert "<iframe" in page
    assert "wasm-unsafe-eval" in page
    falling = structure_page(blocksim.check(thin_dome()))
    assert re.search(r"Joints that take part: \d+ of 48 hinge", falling)


def test_a_recording_in_space_comes_back_as_it_was(tmp_path: Path) -> None:
    """Poses, blocks, joints, loads and the maker; so do its model and its table."""
    run = tipping()
    run.save(tmp_path / "run.npz")
    back = blocksim.load_recording(tmp_path / "run.npz")
    assert back.state_hash == run.state_hash
    assert back.problem.maker.origin() == run.problem.maker.origin()
    one, two = run.problem, back.problem
    assert to_record(one) == to_record(two)
    assert np.array_equal(one.applied_forces(), two.applied_forces())
    assert back.displacement.tolist() == run.displacement.tolist()
    models: list[bytes] = []
    for each in (run, back):
        made = BytesIO()
        write_model(each, made, "glb")
        models.append(made.getvalue())
    assert models[0] == models[1]


@pytest.mark.parametrize(
    "change",
    [
        pytest.param(
            lambda made: made["blocks"][0]["hulls"][0].update(corners=[[0, 0, 0]] * 5),
            id="flat",
        ),
        pytest.param(lambda made: made["blocks"][0].update(centre=[0, 0, 1e300]), id="far"),
        pytest.param(lambda made: made["blocks"][0].update(weight=0.0), id="weightless"),
        pytest.param(lambda made: made.update(supports=[]), id="no support"),
        pytest.param(lambda made: made["joints"][0].update(after=7), id="no such block"),
        pytest.param(lambda made: made["joints"][0].update(normal=[0, 0, 0]), id="no way"),
        pytest.param(lambda made: made["joints"][0].update(points=[]), id="no point"),
        pytest.param(lambda made: made["joints"][0].update(points=[[0, 0]]), id="in the plane"),
    ],
)
def test_a_strange_recording_in_space_is_refused_in_one_line(
    tmp_path: Path, change: Callable[[Any], None]
) -> None:
    """Its arrays are sound; what is said beside them is not."""
    path = tmp_path / "run.npz"
    tipping().save(path)
    with np.load(path) as held:
        kept = {name: held[name] for name in held.files}
    header = json.loads(str(kept["header"]))
    change(header["problem"]["assembly"])
    np.savez_compressed(path, **{**kept, "header": np.array(json.dumps(header))})
    with pytest.raises(blocksim.InputError) as caught:
        blocksim.load_recording(path)
    assert str(caught.value).startswith("recording = ")
    assert "\n" not in str(caught.value)


def test_commands_show_a_recording_in_space(tmp_path: Path) -> None:
    """Written by `simulate`, shown by `render`: a table has a row for each block and frame."""
    kept = tmp_path / "fall.npz"
    asked = "tower --mu 0.6 --with blocks=1 --tilt 40 --method direct --seconds 0.05"
    done = inside("simulate", *asked.split(), "--out", str(kept))
    assert done.returncode == 0, done.stderr
    run = blocksim.load_recording(kept)
    assert f"L = {run.problem.assembly.size:g} m" in done.stdout
    for kind in ("csv", "json", "png", "glb"):
        out = tmp_path / f"fall.{kind}"
        done = inside("render", str(kept), "--out", str(out))
        assert done.returncode == 0, done.stderr
    for kind in ("html", "dxf"):
        done = refused("render", kept, "--out", tmp_path / f"fall.{kind}")
        assert f"must be another kind: a .{kind} is of no recorded motion" in done
        assert not (tmp_path / f"fall.{kind}").exists()
    rows = list(csv.DictReader((tmp_path / "fall.csv").read_text().splitlines()))
    size = run.problem.assembly.size
    places = [[float(row[key]) for key in ("x_m", "y_m", "z_m")] for row in rows]
    assert np.allclose(places, run.poses[:, 0, :3] * size, rtol=1e-12, atol=1e-15)
    told = json.loads((tmp_path / "fall.json").read_text())
    assert len(told["blocks"][0]["polyhedra_m"][0]) == 8
    assert told["time_s"] == [float(row["time_s"]) for row in rows]
    done = refused("simulate", *asked.split(), "--over", "spread", "--out", kept)
    assert "supports stay in space" in done


def test_a_film_is_told_with_what_it_shows_falsely(tmp_path: Path) -> None:
    """Blocks in each other, by a share of the smallest, and energy from nowhere."""
    kept, out = tmp_path / "fall.npz", tmp_path / "fall.gif"
    run = replace(tipping(), quality=Quality(penetration=0.1, gain=0.02))
    run.save(kept)
    done = inside("render", str(kept), "--height", "180", "--slow", "1", "--out", str(out))
    assert done.returncode == 0, done.stderr
    width = math.cbrt(1.0 * 0.6 * 0.3) / run.problem.assembly.size
    assert f"blocks overlap by {0.1 / width:.1%} of the smallest" in done.stdout
    assert "energy rose again, by 2.00%" in done.stdout


def test_a_film_in_space_has_the_pulse_of_the_ground_and_no_marks_in_it() -> None:
    """Marks go along the ground of the plane, which is a line; here they crossed the blocks."""
    run = tipping()
    pulse = Shaking(shape="half-sine", amplitude=0.4, duration=1.0)
    shaken = replace(run, problem=replace(run.problem, shaking=pulse))
    stage, _, _, acting, _ = Film([shaken], height=360).shots[0]
    shapes, labels = acting.aside(stage.at(0.1), 1.0)
    assert [each.words.startswith("ground +") for each in labels] == [True]
    # The pulse: its line of rest, its curve and its mark.
    assert len(shapes) == 3
