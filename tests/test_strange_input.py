"""Input that no one means: what is accepted has bounds, and they are said in one line."""

import io
import math
import os
import re
import subprocess
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from running import PROGRAM, ran, refused
from strangers import packed

from blocksim import Block, CircularArch, InputError, Load, check, load_recording
from blocksim.blocks.problem import Move
from blocksim.common.files import json_of, read_file, toml_of
from blocksim.simulation import archive as recordings
from blocksim.view import video
from blocksim.view.video import write_film

ARCH = ("--alpha", "90", "--mu", "0.7", "--voussoirs", "9", "--eta", "0.2")


# Sizes of real things.


SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]
RING = CircularArch(half_angle=1, eta=0.1, voussoirs=9, friction=0.7)
BLOCK = {"vertices": SQUARE, "centre": [0.5, 0.5], "mass": 1.0, "inertia": 1.0, "depth": 1.0}


@pytest.mark.parametrize("value", [1e308, 5e-324])
@pytest.mark.parametrize("field", ["mass", "inertia", "depth"])
def test_blocks_in_python_have_sizes_of_real_things(field: str, value: float) -> None:
    with pytest.raises(InputError, match=rf"{field} = .*: must be 1e-\d+ to 1e\+\d+ (m|kg)"):
        Block(**{**BLOCK, field: value})


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (lambda: Block(**{**BLOCK, "vertices": [[0, 0], [1e200, 0], [0, 1]]}), "1e+09 m"),
        (lambda: Load(force=np.array([1e200, 0]), blocks=(0,)), "force"),
        (lambda: Load(force=np.array([1, 0]), blocks=(0,), point=np.array([0, 1e99])), "point"),
        (lambda: Move(support=0, direction=np.array([math.nan, 0])), "direction"),
        (lambda: RING.but(friction=1e-300).problem(), "mu"),
        (lambda: RING.problem().with_load(1e99), "load"),
    ],
)
def test_so_have_loads_and_motions(made: Any, words: str) -> None:
    with pytest.raises(InputError, match=re.escape(words)):
        made()


@pytest.mark.parametrize("settings", ["step=0.1", 5, [("step", 0.1)]])
def test_settings_are_values_by_name(settings: Any) -> None:
    with pytest.raises(InputError, match=r"settings = .*: must be values by name"):
        check(RING, method="direct", settings=settings)


# One reader for all files.


@pytest.mark.parametrize("ending", ["toml", "json", "svg", "dxf", "csv", "npz"])
@pytest.mark.parametrize("what", ["fifo", "zero", "memory", "slash"])
def test_only_regular_files_are_read_and_nothing_is_waited_for(
    what: str, ending: str, tmp_path: Path
) -> None:
    path = tmp_path / f"a.{ending}"
    if what == "fifo":
        os.mkfifo(path)
    elif what == "slash":
        path.write_text("{}")
    else:
        path.symlink_to({"zero": "/dev/zero", "memory": "/proc/self/mem"}[what])
    name = f"{path}/" if what == "slash" else str(path)
    if ending == "csv":
        words = ["check", *ARCH, "--shake", name]
    elif ending == "npz":
        words = ["render", name, "--out", str(tmp_path / "o.png")]
    else:
        words = ["check", name, "--mu", "0.7"]
    # That memory cannot be read at all; readers of drawings and recordings look at ends first.
    unread = what == "memory" and ending in {"toml", "json", "svg", "csv"}
    refused(*words, code=74 if unread else 2)
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


def test_what_says_that_it_is_empty_is_read_up_to_a_bound(tmp_path: Path) -> None:
    # A file of the system says that it has no bytes.
    with pytest.raises(InputError, match="at most 10 bytes"):
        read_file("/proc/self/status", "file", "a file", 10)
    path = tmp_path / "a"
    path.write_bytes(b"0123456789")
    assert read_file(path, "file", "a file", 10) == b"0123456789"
    with pytest.raises(InputError, match="at most 9 bytes"):
        read_file(path, "file", "a file", 9)


def test_keys_of_many_parts_cost_nothing() -> None:
    text = (".".join(["a"] * 300_000) + " = 1").encode()
    # 30,000 of them took the parser 27 s and 3.6 GB.
    with pytest.raises(ValueError, match="more than 32 parts"):
        toml_of(text)
    deepest = ".".join(["a"] * 32)
    assert toml_of(f"{deepest} = 1\n{'x' * 500_000} = 'a. b. c'".encode())


def test_whole_numbers_without_end() -> None:
    assert json_of(b'{"a": [1, -2]}') == {"a": [1, -2]}
    assert json_of(b"[" + b"9" * 400 + b", -" + b"9" * 400 + b"]") == [math.inf, -math.inf]
    with pytest.raises(ValueError, match="whole number of 4000 bits"):
        toml_of(b"a = [{b = 0x" + b"f" * 1000 + b"}]")


def test_shaking_of_any_length_is_refused_without_warnings(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    for rows in ("-1e308,0\n1e308,1", "0,0\n1,1e308", "0,1e308\n1,-1e308", "0," + "1" * 300):
        path.write_text(f"time_s,acceleration_g\n{rows}\n")
        refused("check", *ARCH, "--shake", path)


# Recordings.


def claimed(path: Path, name: str, header: bytes, text: bytes = b"") -> None:
    """Write an archive of which one array says something else than it is."""
    good = zipfile.ZipFile(io.BytesIO(packed(*_good())))
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for each in ("header", "times", "poses"):
            told = header + text if each == name else good.read(f"{each}.npy")
            archive.writestr(f"{each}.npy", told)


def _good() -> tuple[Any, Any, Any]:
    from strangers import _recording

    return _recording()


def npy(shape: tuple[int, ...], kind: str = "<f8") -> bytes:
    file = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        file, {"descr": kind, "fortran_order": False, "shape": shape}
    )
    return file.getvalue()


@pytest.mark.parametrize("name", ["times", "poses", "header"])
@pytest.mark.parametrize("shape", [(10**30,), (2**61, 3, 3), (-1, 3, 3), (10**9,), (5,)])
def test_an_array_is_as_long_as_it_says(
    name: str, shape: tuple[int, ...], tmp_path: Path
) -> None:
    path = tmp_path / "a.npz"
    claimed(path, name, npy(shape, "<U9" if name == "header" else "<f8"), bytes(24))
    with pytest.raises(InputError, match="of arrays as long as they say"):
        load_recording(path)


def test_what_would_fill_the_memory_is_not_unpacked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.npz"
    assert recordings.LARGEST_INSIDE == 1 << 28
    monkeypatch.setattr(recordings, "LARGEST_INSIDE", 1 << 23)
    count = recordings.LARGEST_INSIDE // 72 + 1
    # A million zeros are packed into a thousandth.
    claimed(path, "poses", npy((count, 3, 3)), bytes(72 * count))
    assert path.stat().st_size < recordings.LARGEST_INSIDE / 500
    with pytest.raises(InputError, match="of at most 8388608 bytes unpacked"):
        load_recording(path)


def test_an_archive_of_many_files_is_not_listed(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    with zipfile.ZipFile(path, "w") as archive:
        for number in range(2000):
            archive.writestr(str(number), b"")
    with pytest.raises(InputError, match="written by blocksim simulate"):
        load_recording(path)


def test_no_recording_is_written_that_would_not_be_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.npz"
    path.write_bytes(packed(*_good()))
    run = load_recording(path)
    most = "blocksim.simulation.recording.LARGEST_INSIDE"
    monkeypatch.setattr(most, run.poses.nbytes)
    with pytest.raises(InputError, match="a shorter time, or fewer blocks"):
        run.save(tmp_path / "b.npz")
    assert [each.name for each in tmp_path.iterdir()] == ["a.npz"]


@pytest.mark.parametrize("kind", ["mp4", "gif"])
def test_a_film_is_bounded_before_it_is_begun(kind: str, tmp_path: Path) -> None:
    header, times, poses = _good()
    (tmp_path / "a.npz").write_bytes(packed(header, times * 10, poses))
    out = str(tmp_path / f"o.{kind}")
    said = refused("render", tmp_path / "a.npz", "--out", out, "--slow", "1000")
    assert "must be at most 600 s long: less slow, or of a shorter recording" in said
    assert [each.name for each in tmp_path.iterdir()] == ["a.npz"]


def test_a_film_of_many_pixels_names_its_frames(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Frames:
        width, height, rate, count = 40, 20, 10, 12

        def frame(self, number: int) -> Any:
            return np.full((20, 40, 4), number, dtype=np.uint8)

    monkeypatch.setattr(video, "MOST_PIXELS", {"gif": 40 * 20 * 12})
    write_film(Frames(), tmp_path / "a.gif")
    monkeypatch.setattr(video, "MOST_PIXELS", {"gif": 40 * 20 * 12 - 1})
    allowed = "film = '12 frames': must be at most 11 frames of 40 x 20 as .gif"
    with pytest.raises(InputError, match=allowed):
        write_film(Frames(), tmp_path / "b.gif")
    assert [each.name for each in tmp_path.iterdir()] == ["a.gif"]


def test_a_table_of_a_long_recording_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.npz").write_bytes(packed(*_good()))
    monkeypatch.setattr("blocksim.cli.rendering.MOST_NUMBERS", 10)
    for kind in ("csv", "json", "glb", "gltf"):
        out = str(tmp_path / f"o.{kind}")
        assert "at most 10 as" in refused("render", tmp_path / "a.npz", "--out", out)


# Names.

NAMES = [
    "",
    "x" * 100_000,
    "x" * 100_000 + ".png",
    "\udcff.png",
    "a.png/",
    "x/" * 5000 + "a.png",
]


@pytest.mark.parametrize("name", NAMES, ids=range(len(NAMES)))
@pytest.mark.parametrize("command", [("render", *ARCH), ("map",), ("simulate", *ARCH)])
def test_names_of_files_that_cannot_be(
    command: tuple[str, ...], name: str, tmp_path: Path
) -> None:
    if command[0] == "simulate":
        name = name.replace(".png", ".npz")
    refused(*command, "--out", name, cwd=tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("in_this_process")
def test_a_folder_may_be_named_with_a_slash(tmp_path: Path) -> None:
    design = tmp_path / "a.toml"
    design.write_text('half_angle_deg = [90]\nmu = [0.7]\nmethod = "limit"\n')
    ran("sweep", design, "--out", tmp_path / "rows/", "--workers", "1")
    assert list((tmp_path / "rows").glob("rows-*.jsonl"))


def test_no_warning_reaches_a_user() -> None:
    script = (
        "import sys, warnings; sys.argv = ['blocksim', 'doctor'];"
        "import numpy, blocksim.cli as cli;"
        "cli.run = lambda: numpy.float64(1e308) * 10 > 0 and warnings.warn('a', stacklevel=1);"
        "cli.main()"
    )
    done = subprocess.run([PROGRAM[0], "-c", script], capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
