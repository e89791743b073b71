"""blocksim as a program of its own, and the processes it starts."""

import contextlib
import csv
import io
import json
import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest import mock

import click

from blocksim import MissingPart, cli
from blocksim.cli.app import COMMANDS as COMMANDS

PROGRAM = (sys.executable, "-m", "blocksim")
ENGINES = ("direct", "pymunk", "pybullet", "mujoco")
"""Those that are shipped, of which some may not be installed."""


def blocksim(
    *arguments: str, cwd: Path | None = None, before: str = ""
) -> subprocess.CompletedProcess[str]:
    """Run it to its end; `before` are statements of Python that its process begins with."""
    then = "import sys\nsys.argv[0] = 'blocksim'\nfrom blocksim.cli import main\nmain()"
    program = (sys.executable, "-c", f"{before}\n{then}") if before else PROGRAM
    return subprocess.run(
        [*program, *arguments], capture_output=True, text=True, check=False, cwd=cwd
    )


def small_files(largest: int) -> str:
    """Statements after which no file may have more bytes; no compiled module is cut."""
    return (
        "import os, resource, sys\n"
        "sys.dont_write_bytecode, os.environ['PYTHONDONTWRITEBYTECODE'] = True, '1'\n"
        f"resource.setrlimit(resource.RLIMIT_FSIZE, ({largest}, {largest}))"
    )


def inside(*words: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run a command within this process, which has loaded its libraries once for all."""
    arguments, out, complaints = [*map(str, words)], io.StringIO(), io.StringIO()
    with (
        contextlib.chdir(cwd or Path.cwd()),
        mock.patch.object(sys, "argv", ["blocksim", *arguments]),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(complaints),
    ):
        code = cli._code()
    part, absent, remedy = complaints.getvalue().partition(" is not available here: ")
    if absent and part.removeprefix("blocksim: ") in ENGINES:
        raise MissingPart(part.removeprefix("blocksim: "), remedy)
    return subprocess.CompletedProcess(arguments, code, out.getvalue(), complaints.getvalue())


def ran(*words: object, code: int = 0, cwd: Path | None = None) -> str:
    """What a command says that ends with a code and complains of nothing."""
    done = inside(*words, cwd=cwd)
    assert (done.returncode, done.stderr) == (code, ""), done
    return done.stdout


def refused(*words: object, code: int = 2, cwd: Path | None = None) -> str:
    """What a command says of wrong input: one line that can be printed, and nothing else."""
    done = inside(*words, cwd=cwd)
    assert (done.returncode, done.stdout) == (code, ""), done
    assert re.fullmatch(r"blocksim: [^\n]{1,1000}\n", done.stderr)
    assert done.stderr[:-1].isprintable()
    return done.stderr


def parameters(command: str) -> list[click.Parameter]:
    """Return what a command takes, as click has it."""
    found = cli.app.get_command(click.Context(cli.app), command)
    return [] if found is None else found.params


def answered(*words: object, code: int | None = 0, cwd: Path | None = None) -> dict[str, Any]:
    """What a command says with `--json`, and ends with that code, or with any."""
    done = inside(*words, "--json", cwd=cwd)
    assert code is None or done.returncode == code, done.stderr
    return json.loads(done.stdout)


def csv_rows(path: Path) -> list[dict[str, str]]:
    """Rows of a table."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def started(*arguments: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [*PROGRAM, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    )


def until(true: Callable[[], bool], driver: subprocess.Popen[bytes] | None = None) -> None:
    # Ends what waits for nothing; a machine that is busy elsewhere is no fault.
    deadline = time.monotonic() + 300
    while not true():
        assert driver is None or driver.poll() is None, "ended too soon"
        assert time.monotonic() < deadline
        time.sleep(0.002)


def children(pid: int) -> list[int]:
    """Workers of a driver; a thread or a process may have ended since it was listed."""
    found = list[int]()
    for listed in Path(f"/proc/{pid}/task").glob("*/children"):
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):
            found += [int(word) for word in listed.read_text().split()]
    workers = list[int]()
    for each in found:
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):
            if b"spawn_main" in Path(f"/proc/{each}/cmdline").read_bytes():
                workers.append(each)
    return workers


def alive(pid: int) -> bool:
    path = Path(f"/proc/{pid}/stat")
    try:
        return path.read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False
