"""Files are whole or not there: two writers, links, long names, and each step made to fail.

The steps are counted and made to fail one by one, as SQLite's tests do
(https://www.sqlite.org/testing.html, "I/O error testing").
"""

import ast
import io
import math
import os
import stat
import threading
from collections.abc import Callable, Iterable
from errno import EACCES, ENOSPC
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import pytest
from running import inside, refused
from sweeps import swept

import blocksim
from blocksim import (
    Arch,
    CircularArch,
    InputError,
    MachineError,
    Tower,
    check,
    simulate,
    write_csv,
    write_parquet,
)
from blocksim.cli.proving import write_proof
from blocksim.common.files import make_folder, require_place, write_folder, write_whole
from blocksim.common.sheets import write_sheet
from blocksim.report.recordings import write_recording_csv, write_recording_json
from blocksim.report.sheetpage import structure_page
from blocksim.view.drawing import save_figure
from blocksim.view.models import write_model
from blocksim.view.sheet import sheet_of
from blocksim.view.sheetdxf import write_dxf
from blocksim.view.video import write_film

ARCH = Arch(half_angle=math.pi / 2, eta=0.2, voussoirs=5)
OLD = b"what was there before"
Writers = dict[str, Callable[[Path], object]]


# Races.


def race(folder: Path, rounds: int, writers: int) -> None:
    """Let writers write one name at once, round by round; every file is one of theirs."""
    path = folder / "out.bin"
    start = threading.Barrier(writers)
    wrong: list[str] = []

    def one(number: int) -> None:
        # In pieces, so that two writers of one file would mix.
        mine = bytes([65 + number]) * 997
        for _ in range(rounds):
            start.wait()
            write_whole(path, lambda file: [file.write(mine) for _ in range(1 + number)])
            found = path.read_bytes()
            whole = len(set(found)) == 1 and len(found) == 997 * (found[0] - 64)
            wrong.extend([] if whole else [f"{len(found)} bytes of {set(found)}"])

    threads = [threading.Thread(target=one, args=(number,)) for number in range(writers)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert not wrong
    assert [each.name for each in folder.iterdir()] == ["out.bin"]


def test_of_writers_of_one_file_one_wins(tmp_path: Path) -> None:
    race(tmp_path, 10, 8)


# Names.


@pytest.mark.parametrize("name", ["a" * 250, "\N{ANGSTROM SIGN}" * 83, "\N{BRICK}" * 62])
def test_names_of_250_bytes(name: str, tmp_path: Path) -> None:
    assert 240 <= len(name.encode()) <= 255
    write_whole(tmp_path / name, lambda file: file.write(b"whole"))
    assert (tmp_path / name).read_bytes() == b"whole"
    assert len(list(tmp_path.iterdir())) == 1


def test_a_name_that_no_system_takes_is_wrong_input(tmp_path: Path) -> None:
    for name in ("a" * 256, "a\0b", "", ".", ".."):
        with pytest.raises(InputError, match="must be writable"):
            write_whole(tmp_path / name, lambda file: file.write(b""))
    assert not list(tmp_path.iterdir())


def test_a_link_is_replaced_and_what_it_leads_to_is_kept(tmp_path: Path) -> None:
    theirs, path = tmp_path / "theirs", tmp_path / "out.bin"
    theirs.write_bytes(OLD)
    path.symlink_to(theirs)
    write_whole(path, lambda file: file.write(b"mine"))
    assert (theirs.read_bytes(), path.read_bytes()) == (OLD, b"mine")
    assert not path.is_symlink()


def test_files_of_the_user_beside_it_are_kept(tmp_path: Path) -> None:
    """The one name of before, and a link of that name to a file of somebody else."""
    theirs = tmp_path / "theirs"
    theirs.write_bytes(OLD)
    (tmp_path / ".one.part").write_bytes(OLD)
    (tmp_path / ".two.part").symlink_to(theirs)
    for name in ("one", "two"):
        write_whole(tmp_path / name, lambda file: file.write(b"mine"))
    assert theirs.read_bytes() == (tmp_path / ".one.part").read_bytes() == OLD
    assert (tmp_path / ".two.part").is_symlink()


@pytest.mark.parametrize("made", ["fifo", "device", "folder"])
def test_what_is_no_file_is_not_replaced(made: str, tmp_path: Path) -> None:
    path = tmp_path / "out.png"
    if made == "fifo":
        os.mkfifo(path)
    elif made == "device":
        path.symlink_to("/dev/null")
    else:
        path.mkdir()
    before = path.stat().st_mode
    for wanted in (lambda: require_place(path), lambda: write_whole(path, lambda _: None)):
        with pytest.raises(InputError, match="must be writable"):
            wanted()
    refused("map", "--out", path)
    assert stat.S_IFMT(path.stat().st_mode) == stat.S_IFMT(before)


def test_modes_are_those_the_user_wants(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write_whole(tmp_path / "a", lambda file: file.write(b""))
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o640


# Failures of the machine.


class Machine:
    """A machine that fails once, at a step that is counted.

    Steps are each write that reaches the system, each close, each fsync, each rename and each
    creation of a file.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch, fails_at: int | None = None) -> None:
        self.steps: list[str] = []
        self._fails_at = fails_at
        opened, sync, rename = Path.open, os.fsync, Path.replace
        machine = self

        class File(io.FileIO):
            def write(self, data: Any) -> int:
                machine.step("write")
                return super().write(data)

            def close(self) -> None:
                if not self.closed:
                    super().close()
                    machine.step("close")

        def create(path: Path, mode: str = "r", *more: Any, **given: Any) -> Any:
            if mode != "xb":
                return opened(path, mode, *more, **given)
            self.step("create")
            return io.BufferedWriter(File(path, "xb"))

        def synced(number: int) -> None:
            self.step("fsync")
            sync(number)

        def renamed(path: Path, target: Path) -> Path:
            self.step("rename")
            return rename(path, target)

        monkeypatch.setattr(Path, "open", create)
        monkeypatch.setattr(os, "fsync", synced)
        monkeypatch.setattr(Path, "replace", renamed)

    def step(self, what: str) -> None:
        self.steps.append(what)
        if len(self.steps) - 1 == self._fails_at:
            raise OSError(ENOSPC, os.strerror(ENOSPC))


class Frames:
    """A film of two frames."""

    width = height = 64
    rate, count = 25, 2

    def frame(self, number: int) -> Any:
        return np.full((64, 64, 4), 40 * number, np.uint8)


@pytest.fixture(scope="module")
def writers(tmp_path_factory: pytest.TempPathFactory) -> Writers:
    """What writes a file of each kind, by the ending of its name."""
    run = simulate(CircularArch.of(ARCH, friction=0.7), method="pymunk", duration=0.02)
    problem = CircularArch.of(ARCH, 0.7).problem()
    sheet = sheet_of(problem)
    page = structure_page(check(problem), mode=None, command="blocksim report", settings="")

    def through(write: Callable[[BinaryIO], object]) -> Callable[[Path], object]:
        return lambda path: write_whole(path, write)

    figure = problem.plot()
    cells = [[number, "=1", 0.5] for number in range(2000)]
    tower = Tower(blocks=1, friction=0.6).problem().tilted(0.7)
    fall = simulate(tower, method="direct", duration=0.02)
    proof = check(problem, method="limit").proof
    rows = tmp_path_factory.mktemp("swept")
    asked = {"kind": "column", "width": [0.5, 1.0], "mu": 0.7, "method": "limit"}
    swept(asked, rows)
    return {
        "npz": run.save,
        "mp4": lambda path: write_film(Frames(), path),
        "gif": lambda path: write_film(Frames(), path),
        "glb": through(lambda file: write_model(run, file, "glb")),
        "gltf": through(lambda file: write_model(run, file, "gltf")),
        "csv": through(lambda file: write_recording_csv(run, file)),
        "sheet.csv": through(lambda file: write_sheet(file, ["a", "b", "c"], cells)),
        "dxf": through(lambda file: write_dxf(sheet, file)),
        "svg": through(lambda file: save_figure(figure, file, "svg")),
        "png": through(lambda file: save_figure(figure, file, "png")),
        "pdf": through(lambda file: save_figure(figure, file, "pdf")),
        "html": through(lambda file: file.write(page.encode())),
        "poses.json": through(lambda file: write_recording_json(run, file)),
        "space.npz": fall.save,
        "space.glb": through(lambda file: write_model(fall, file, "glb")),
        "proof.json": lambda path: write_proof("limit", [proof], path),
        "rows.csv": lambda path: write_csv(rows, path),
        "rows.parquet": lambda path: write_parquet(rows, path),
        "in a folder": lambda path: write_folder(path.parent, {path.name: page.encode()}),
    }


KINDS = (
    *("npz", "mp4", "gif", "glb", "gltf", "csv", "sheet.csv", "dxf", "svg", "png", "pdf"),
    *("html", "poses.json", "space.npz", "space.glb", "proof.json", "rows.csv"),
    *("rows.parquet", "in a folder"),
)
OWN = {
    "common/files.py": "the writer",
    "engines/bulletspace.py": "a file for its library, in a folder of its own",
    "report/printing.py": "a page for the browser, likewise",
}
"""What writes otherwise, and why it may."""


def test_all_that_is_written_is_written_by_one_function() -> None:
    top, found = Path(blocksim.__file__).parent, set[str]()
    for path in top.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            match node:
                case ast.Call(func=ast.Attribute(attr="write_text" | "write_bytes")):
                    found.add(path.relative_to(top).as_posix())
                case ast.Call(
                    func=ast.Attribute(attr="open"), args=[ast.Constant(value=str(mode)), *_]
                ) if {*mode} & {*"wxa+"}:
                    found.add(path.relative_to(top).as_posix())
                case ast.Call(func=ast.Name(id="open")):
                    found.add(path.relative_to(top).as_posix())
                case _:
                    pass
    assert found == {*OWN}


def steps_of(write: Callable[[Path], object], path: Path) -> list[str]:
    with pytest.MonkeyPatch.context() as patched:
        machine = Machine(patched)
        write(path)
    return machine.steps


def fail_each(write: Callable[[Path], object], path: Path, steps: Iterable[int]) -> None:
    """Let each step fail once: what was there stays, or all is there; nothing is beside it."""
    for fails_at in steps:
        path.write_bytes(OLD)
        with pytest.MonkeyPatch.context() as patched:
            machine = Machine(patched, fails_at)
            with pytest.raises(MachineError, match="No space left on device") as caught:
                write(path)
        assert caught.value.field == "--out"
        assert [each.name for each in path.parent.iterdir()] == [path.name]
        renamed = "rename" in machine.steps[:fails_at]
        assert (path.read_bytes() == OLD) is not renamed


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_of_step_fails_once(kind: str, writers: Writers, tmp_path: Path) -> None:
    path = tmp_path / f"out.{kind}"
    steps = steps_of(writers[kind], path)
    assert path.stat().st_size > 100
    assert (steps[0], steps[-4:]) == ("create", ["fsync", "close", "rename", "fsync"])
    assert steps.count("write") == len(steps) - 5 >= 1
    last = range(len(steps) - 5, len(steps))
    fail_each(writers[kind], path, sorted({0, 1, len(steps) // 2, *last}))


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_every_step_fails_once(kind: str, writers: Writers, tmp_path: Path) -> None:
    path = tmp_path / f"out.{kind}"
    steps = steps_of(writers[kind], path)
    print(f"{kind}: {len(steps)} steps, each failed once")  # noqa: T201
    fail_each(writers[kind], path, range(len(steps)))


# Exit codes.


@pytest.mark.parametrize("error", [PermissionError(EACCES, "Permission denied"), MemoryError()])
def test_so_have_no_permission_and_no_memory(
    error: Exception, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise error

    monkeypatch.setattr("blocksim.common.files.TemporaryFile", refuse)
    done = inside("map", "--out", tmp_path / "map.png")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (74, "", 1)


def test_a_name_that_can_be_mended_is_wrong_input(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for out in (tmp_path / "none" / "a.png", tmp_path / "file" / "a.png"):
        refused("map", "--out", out)
    with pytest.raises(InputError, match="must be a writable folder"):
        make_folder(tmp_path / "file" / "folder")
