"""Commands one after the other, each in a process of its own that is watched.

A nursery loads the libraries once. Each command is a fork of it, so that what one does to
memory, files or the process itself is seen, and concerns no other.
"""

import atexit
import contextlib
import gc
import json
import os
import resource
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

SLOW = 10.0
"""Processor time from which on a command hangs [s]."""
WAITS = 30.0
"""Time by the clock for which it may wait, without asking for a processor [s]."""
LOOK = 0.1
"""Time by the clock between two looks at it [s]."""
LARGEST = 1 << 30
"""Most memory of a command [bytes]."""
ROOM = 8 << 30
"""Most that it is given."""
LIBRARIES = (
    "blocksim.cli.app", "blocksim.cli.asking", "blocksim.cli.commands",
    "blocksim.cli.converting", "blocksim.cli.rendering", "blocksim.cli.mapping",
    "blocksim.cli.reporting", "blocksim.cli.sweeping",
    "blocksim.kinds.files", "blocksim.view.video", "clarabel", "ezdxf", "highspy", "pymunk",
    "scipy.optimize",
)  # fmt: skip
"""What most commands load."""


@dataclass(frozen=True, kw_only=True)
class Ended:
    """What became of a command.

    Parameters
    ----------
    code : int
        Its exit code; below 0 the signal that ended it.
    out, err : bytes
        What it said.
    seconds : float
        Processor time, or `SLOW` and more if it was ended because it waited.
    memory : int
        Most it had at once [bytes].
    left : tuple of str
        Files in the folder for temporary ones, and half-written ones where it ran.
    """

    code: int
    out: bytes
    err: bytes
    seconds: float
    memory: int
    left: tuple[str, ...]

    @property
    def faults(self) -> tuple[str, ...]:
        """What must never be, in words; empty if all is well."""
        found: list[str] = []
        if b"Traceback" in self.err or self.code == 70:
            found.append("traceback")
        elif b"Warning" in self.err:
            found.append("warning")
        if self.seconds > SLOW:
            found.append("hang")
        elif self.code < 0:
            found.append("killed" if self.code == -signal.SIGKILL else "abort")
        if self.memory > LARGEST:
            found.append("memory")
        if self.left:
            found.append("left")
        if self.code in {2, 74} and not _is_line(self.err):
            found.append("no line")
        if not _is_plain(self.out + self.err):
            found.append("unprintable")
        return tuple(found)


def _is_plain(said: bytes) -> bool:
    """Tell whether a terminal finds nothing in it to obey."""
    spaces = {"\n": " ", "\N{NO-BREAK SPACE}": " "}
    return said.decode(errors="replace").translate(str.maketrans(spaces)).isprintable()


def _is_line(said: bytes) -> bool:
    """Tell whether it is one line, no longer than a reader can take in."""
    whole = said.startswith(b"blocksim: ") and said.count(b"\n") == 1 and said[-1:] == b"\n"
    plain = all(byte >= 32 and byte != 127 for byte in said[:-1])
    return whole and plain and len(said) <= 1200


class Nursery:
    """Where commands are run; to be used as a context."""

    def __init__(self, path: Path) -> None:
        self._place = Path(tempfile.mkdtemp(prefix="nursery-"))
        words = [sys.executable, "-c", "import isolated; isolated.serve()"]
        where = {**os.environ, "PYTHONPATH": f"{path}:{Path(__file__).parent}"}
        where["OMP_NUM_THREADS"] = "1"
        self._process = subprocess.Popen(
            words, stdin=-1, stdout=-1, env=where, text=True, cwd=path
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate()
        shutil.rmtree(self._place, ignore_errors=True)

    def run(self, arguments: Sequence[str], cwd: Path, **more: Any) -> Ended:
        """Run a command in a folder, a file there called `stdin` piped to it, and watch it."""
        asked = {"arguments": list(arguments), "cwd": str(cwd), "place": str(self._place)}
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps({**asked, **more}) + "\n")
        self._process.stdin.flush()
        told = json.loads(self._process.stdout.readline())
        out, err = (self._place / name for name in ("out", "err"))
        half = [path.name for path in cwd.rglob("*.part")] if cwd.is_dir() else []
        kept = {name: path.read_bytes() for name, path in (("out", out), ("err", err))}
        return Ended(**kept, **{**told, "left": (*told["left"], *half)})


def serve() -> None:
    """Run the commands that are asked for, line by line."""
    import importlib

    from running import inside

    for name in LIBRARIES:
        importlib.import_module(name)
    with tempfile.TemporaryDirectory() as folder:
        inside("map", "--out", "map.html", cwd=Path(folder))
    gc.freeze()
    for line in sys.stdin:
        asked = json.loads(line)
        told = _watched(asked)
        if told is None:
            return
        sys.stdout.write(json.dumps(told) + "\n")
        sys.stdout.flush()


def _watched(asked: dict[str, Any]) -> dict[str, Any] | None:
    """Fork, and watch what becomes of it; None in the child, which ends as a program does."""
    place = Path(asked["place"])
    temporary = place / "tmp"
    temporary.mkdir(exist_ok=True)
    child = os.fork()
    if child == 0:
        _become(asked, place, temporary)
        return None
    waits = 0.0
    end = os.pidfd_open(child)
    while not select.select([end], [], [], LOOK)[0]:
        asleep, spent = _seen(child)
        waits = waits + LOOK if asleep else 0.0
        if waits > WAITS or spent > SLOW + 1:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(child, signal.SIGKILL)
    os.close(end)
    _, status, usage = os.wait4(child, 0)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    spent = usage.ru_utime + usage.ru_stime
    left = sorted(str(path.relative_to(temporary)) for path in temporary.rglob("*"))
    shutil.rmtree(temporary, ignore_errors=True)
    return {
        "code": os.waitstatus_to_exitcode(status),
        "seconds": spent + SLOW if waits > WAITS else spent,
        "memory": usage.ru_maxrss * 1024,
        "left": left,
    }


def _seen(pid: int) -> tuple[bool, float]:
    """Whether nothing of a process wants a processor or a disk now, and what it has had [s].

    One that has to wait for a processor asks for it, however long others keep it busy.
    """
    spent, asleep = 0.0, True
    with contextlib.suppress(OSError):
        words = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        spent = (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")
        for thread in Path(f"/proc/{pid}/task").iterdir():
            state = (thread / "stat").read_text().rpartition(")")[2].split()[0]
            others = map(int, (thread / "children").read_text().split())
            asleep = asleep and state == "S" and all(_seen(each)[0] for each in others)
    return asleep, spent


def _become(asked: dict[str, Any], place: Path, temporary: Path) -> None:
    """Be the command."""
    os.setsid()
    os.chdir(asked["cwd"])
    os.environ["TMPDIR"] = str(temporary)
    tempfile.tempdir = None
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (ROOM, ROOM))
    for number, name, flags in (
        (0, "stdin" if Path("stdin").is_file() else os.devnull, os.O_RDONLY),
        (1, str(place / "out"), os.O_WRONLY | os.O_CREAT | os.O_TRUNC),
        (2, str(place / "err"), os.O_WRONLY | os.O_CREAT | os.O_TRUNC),
    ):
        opened = os.open(name, flags)
        os.dup2(opened, number)
        os.close(opened)
    sys.argv = ["blocksim", *asked["arguments"]]
    # Warnings of numpy, which the program keeps from its users, are errors here.
    sys.warnoptions.append("error::RuntimeWarning")
    warnings.filterwarnings("error", category=RuntimeWarning)
    from blocksim.cli import main

    code = 1
    try:
        main()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    # Without taking apart all that was loaded, which a fork pays for page by page.
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)


def listed(folder: Path) -> Iterator[str]:
    """Names of files in a folder, however deep."""
    return (str(path.relative_to(folder)) for path in folder.rglob("*"))
