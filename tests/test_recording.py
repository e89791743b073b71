"""Recordings come back as they were, or are refused in one line; no half-written file."""

import json
import math
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from recorded import header_of, recorded

from blocksim import Arch, CircularArch, InputError, Recording, load_recording

ARCH = Arch(half_angle=1.2, eta=0.15, voussoirs=5, weight="sector", radius=4.0, depth=0.5)


def recording(frames: int = 4) -> Recording:
    random = np.random.default_rng(7)
    moved = random.normal(size=(frames, 5, 3))
    problem = CircularArch.of(ARCH, math.inf).problem()
    return recorded(problem, moved, np.linspace(0, 0.3, frames))


PROBLEM = header_of(recording())["problem"]
BUILT = PROBLEM["assembly"]
ON_NO_BLOCK = {"force": [0, 1], "blocks": [99], "point": None, "per_weight": False}


def test_roundtrip_is_exact(tmp_path: Path) -> None:
    one = recording()
    path = tmp_path / "run.npz"
    one.save(path)
    two = load_recording(path)
    assert np.array_equal(one.poses, two.poses)
    assert np.array_equal(one.times, two.times)
    assert (two.problem.maker.shape, two.mu, two.settings) == (ARCH, one.mu, one.settings)
    assert header_of(two) == header_of(one)
    assert (two.engine, two.engine_version) == (one.engine, one.engine_version)
    assert two.state_hash == one.state_hash
    assert [file.name for file in tmp_path.iterdir()] == ["run.npz"]


def test_hash_sees_the_last_bit() -> None:
    one = recording()
    poses = one.poses.copy()
    poses[2, 3, 1] = np.nextafter(poses[2, 3, 1], 2)
    assert replace(one, poses=poses).state_hash != one.state_hash
    assert replace(one, poses=np.asfortranarray(one.poses)).state_hash == one.state_hash


def test_displacement_in_closed_form() -> None:
    one = recording(3)
    poses = np.zeros((3, 5, 3))
    poses[1, 2, :2] = [3e-3, 4e-3]
    poses[2, 4, 2] = -1e-2
    assembly = ARCH.assembly()
    expected = [0, 5e-3, 1e-2 * assembly.reach[4] / 4.0]
    assert replace(one, poses=poses).displacement == pytest.approx(expected, rel=1e-12)
    assert assembly.displacement(poses) == pytest.approx(expected, rel=1e-12)


def refused(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        load_recording(path)
    message = str(caught.value)
    assert message.startswith(f"recording = {str(path)!r}: must be ")
    assert "\n" not in message
    return message


def test_every_damaged_byte_is_noticed_or_harmless(tmp_path: Path) -> None:
    """One byte flipped: refused, or read back as it was (zip headers repeat themselves)."""
    path = tmp_path / "run.npz"
    recording().save(path)
    whole = bytearray(path.read_bytes())
    noticed = 0
    places = range(0, len(whole), 7)
    for place in places:
        damaged = whole.copy()
        damaged[place] ^= 0x5A
        path.write_bytes(bytes(damaged))
        try:
            same = load_recording(path)
        except InputError:
            noticed += 1
        else:
            assert np.array_equal(same.poses, recording().poses)
            assert np.array_equal(same.times, recording().times)
            assert same.problem.maker.shape == ARCH
    assert noticed > len(places) / 2


def test_foreign_files(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    refused(path)
    refused(tmp_path)
    path.write_text("not a recording")
    refused(path)
    np.savez(path, other=np.zeros(3))
    refused(path)
    with path.open("wb") as file:
        np.save(file, np.zeros(3))
    refused(path)


class Trap:
    """Would run on unpickling."""

    def __reduce__(self) -> tuple:
        return (Path.touch, (Path("trap-was-run"),))


def test_pickles_are_not_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "run.npz"
    np.savez(path, header=np.array([Trap()], dtype=object), times=[0.0], poses=[0.0])
    refused(path)
    with path.open("wb") as file:
        np.save(file, np.array([Trap()], dtype=object))
    refused(path)
    assert not (tmp_path / "trap-was-run").exists()


def altered(path: Path, **changes: object) -> None:
    recording().save(path)
    with np.load(path) as archive:
        parts = dict(archive)
    header = json.loads(str(parts["header"]))
    header.update({k: v for k, v in changes.items() if k not in parts})
    parts.update({k: v for k, v in changes.items() if k in parts})
    parts["header"] = np.array(json.dumps(header))
    np.savez(path, **parts)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"format": 3}, "of format 2"),
        ({"poses": np.zeros((4, 6, 3))}, "poses of shape"),
        ({"times": np.zeros(3)}, "poses of shape"),
        ({"times": np.array(1.0)}, "poses of shape"),
        ({"poses": np.zeros((4, 5, 3))}, "undamaged"),
        ({"state_hash": "0" * 16}, "undamaged"),
        ({"problem": {"mu": "much"}}, "written by blocksim simulate"),
        ({"problem": None}, "written by blocksim simulate"),
        ({"problem": {**PROBLEM, "mu": -1.0}}, "written by blocksim simulate"),
        ({"problem": {**PROBLEM, "gravity": [0.0, "down", 0.0]}}, "written by blocksim"),
        ({"problem": {**PROBLEM, "assembly": {**BUILT, "size": 0}}}, "written by blocksim"),
        ({"problem": {**PROBLEM, "assembly": {**BUILT, "joints": [{}]}}}, "written by"),
        ({"problem": {**PROBLEM, "title": 3}}, "written by blocksim"),
        ({"problem": {**PROBLEM, "load": "much"}}, "written by blocksim"),
        ({"problem": {**PROBLEM, "origin": {"kind": "circular-arch", "half_angle": "x"}}}, ""),
        ({"problem": {**PROBLEM, "notes": 5}}, "written by blocksim"),
        ({"problem": {**PROBLEM, "gravity": [0.0, -1e300, 0.0]}}, "written by blocksim"),
        ({"problem": {**PROBLEM, "moves": [{"support": 9}]}}, "written by blocksim"),
        ({"problem": {**PROBLEM, "dead": [ON_NO_BLOCK]}}, "written by blocksim"),
        ({"problem": {**PROBLEM, "assembly": {**BUILT, "joints": BUILT["joints"][1:-1]}}},
         "of blocks that stand on something"),
        ({"settings": {"unknown": 1}}, "written by blocksim simulate"),
        ({"settings": None}, "written by blocksim simulate"),
    ],
)  # fmt: skip
def test_altered_contents(tmp_path: Path, changes: dict[str, object], words: str) -> None:
    path = tmp_path / "run.npz"
    altered(path, **changes)
    assert words in refused(path)


@pytest.mark.parametrize(
    ("what", "field", "value"),
    [
        ("blocks", "centre", ["inf", 0.0]),
        ("blocks", "name", 7),
        ("blocks", "centre", [0.0, 1e29]),
        ("joints", "after", True),
        ("joints", "before", 0.0),
        ("joints", "inner", [1e29, 0.0]),
        ("joints", "faces", [[[1e29, 0.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 0.0]]]),
        ("joints", "gap", "inf"),
        ("joints", "support", False),
        ("supports", "polygons", [[[0.0, 0.0], [1e29, 0.0], [0.0, 1.0]]]),
    ],
)
def test_an_assembly_of_a_stranger_is_checked(
    what: str, field: str, value: object, tmp_path: Path
) -> None:
    first, *others = BUILT[what] or [{"name": ""}]
    assembly = {**BUILT, what: [{**first, field: value}, *others]}
    altered(tmp_path / "run.npz", problem={**PROBLEM, "assembly": assembly})
    refused(tmp_path / "run.npz")


@pytest.mark.parametrize(
    "changes",
    [
        {"times": np.array([0.0, 0.1, math.nan, 0.3])},
        {"times": np.array([0.0, 0.1, 0.1, 0.3])},
        {"times": np.array([0.3, 0.2, 0.1, 0.0])},
        {"times": np.zeros(0), "poses": np.zeros((0, 5, 3))},
        {"poses": np.full((4, 5, 3), math.nan)},
        {"poses": np.full((4, 5, 3), -math.inf)},
        {"poses": np.full((4, 5, 3), 1e200)},
        {"engine": "\x1b[31mred"},
        {"engine": "x" * 5000},
    ],
)
def test_what_is_no_motion_of_an_arch_is_refused(
    tmp_path: Path, changes: dict[str, object]
) -> None:
    """Sound as a file, fingerprint and all."""
    path = tmp_path / "run.npz"
    replace(recording(), **changes).save(path)
    refused(path)


def test_arrays_that_are_no_numbers(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    for kind in (complex, int, str, "datetime64[s]"):
        altered(path, times=recording().times.astype(int).astype(kind))
        refused(path)
        altered(path, poses=recording().poses.astype(int).astype(kind))
        refused(path)


def test_too_large(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "run.npz"
    recording().save(path)
    monkeypatch.setattr("blocksim.simulation.recording.LARGEST_FILE", path.stat().st_size - 1)
    assert "bytes" in refused(path)
    monkeypatch.setattr("blocksim.simulation.recording.LARGEST_FILE", path.stat().st_size)
    load_recording(path)


def test_older_recordings_of_arches_are_still_read(tmp_path: Path) -> None:
    """Format 1 knew arches only, and called gravity's lean a tilt."""
    path = tmp_path / "run.npz"
    old = {"step": 0.1, "sweeps": 1, "hold_sweeps": 2, "tilt": 0.3, "plane_lock": False}
    altered(path, format=1, problem=None, arch=asdict(ARCH), mu=0.7, settings=old)
    found = load_recording(path)
    assert found.problem.maker.shape == ARCH
    assert found.mu == 0.7
    assert found.problem.gravity == pytest.approx([0.0, -math.cos(0.3), math.sin(0.3)])
    assert np.array_equal(found.poses, recording().poses)


@pytest.mark.parametrize("lean", [0.0, 0.3])
def test_older_recordings_that_tell_of_motion_out_of_the_plane_are_read(
    tmp_path: Path, lean: float
) -> None:
    """Blocks that gravity took out of the plane are prisms: its z was towards who looks on."""
    flat = recording()
    beyond = np.zeros_like(flat.poses)
    beyond[1:, :, 0] = 0.25
    poses, path = np.concatenate([flat.poses, beyond], axis=2), tmp_path / "old.npz"
    problem = flat.problem.leaning(lean) if lean else flat.problem
    replace(flat, problem=problem, poses=poses).save(path)
    found = load_recording(path)
    assert found.problem.in_space is bool(lean)
    places = found.poses * found.assembly.size
    expected = flat.poses[..., :2] * ARCH.radius
    assert places[..., [0, 2] if lean else [0, 1]] == pytest.approx(expected, rel=1e-12)
    if lean:
        assert places[1:, :, 1] == pytest.approx(-0.25 * ARCH.radius, rel=1e-12)
        seconds = found.times * math.sqrt(found.assembly.size / ARCH.radius)
        assert seconds == pytest.approx(flat.times, rel=1e-12)
