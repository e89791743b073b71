"""Ctrl-C and the request to end: at any moment one line, and the exit code of a shell.

A terminal sends Ctrl-C to every process of the command, so these tests do, too.
"""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from itertools import product
from multiprocessing import active_children
from pathlib import Path

import pytest
from running import PROGRAM, alive, children, until
from sweeps import SIMULATED, written

from blocksim.common.processes import Hands

ARCH = ("--alpha", "90", "--mu", "0.7", "--voussoirs", "301")
SLOW = ("--method", "pymunk", "--no-reduce", "--tol", "1e-4")
LINE = b"blocksim: interrupted\n"
CODES = {signal.SIGINT: 130, signal.SIGTERM: 143}


def imports(pid: int) -> bool:
    """Whether it has come to its first library, with most of its imports to come."""
    return "numpy" in Path(f"/proc/{pid}/maps").read_text()


def interrupted(
    since: Callable[[int], object], delay: float, sent: signal.Signals, *asked: str
) -> None:
    """Start a command, send the signal to all its processes, and hold it to its word."""
    with subprocess.Popen(
        [*PROGRAM, *asked], stdout=-1, stderr=-1, start_new_session=True
    ) as driver:
        until(lambda: bool(since(driver.pid)), driver)
        time.sleep(delay)
        assert driver.poll() is None, "ended too soon"
        workers = children(driver.pid)
        os.killpg(driver.pid, sent)
        said, error = driver.communicate()
        assert (said, error, driver.returncode) == (b"", LINE, CODES[sent])
    until(lambda: not any(alive(pid) for pid in workers))


@pytest.mark.parametrize(
    ("delay", "sent"),
    [
        pytest.param(delay, sent, marks=[] if sent is usual else pytest.mark.long)
        for delay, usual in (
            (0.0, signal.SIGTERM),
            (0.05, signal.SIGINT),
            (0.2, signal.SIGTERM),
            (0.6, signal.SIGINT),
        )
        for sent in CODES
    ],
)
def test_while_it_starts(delay: float, sent: signal.Signals) -> None:
    interrupted(imports, delay, sent, "bracket", *ARCH, *SLOW)


CALLS_BACK = """
    class Thing: pass
    thing = Thing()
    kept = weakref.ref(thing, lambda _: os.kill(os.getpid(), 15))
    del thing
    while True: pass
"""


@pytest.mark.parametrize(
    "work",
    [
        # Python would end by SIGINT, whichever signal came.
        pytest.param("exec('import os; os.kill(os.getpid(), 15)')", id="a string runs"),
        # Python drops what is raised there, and says so in four lines.
        pytest.param(CALLS_BACK, id="Python calls back"),
    ],
)
def test_while(work: str, tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(
        "import blocksim.cli as cli, os, sys, weakref\n"
        f"def work(): {work}\n"
        "cli.run = work\n"
        "sys.argv, sys.orig_argv = ['blocksim'], ['blocksim']\n"
        "cli.main()"
    )
    ended = subprocess.run(
        [sys.executable, "-m", "program"], cwd=tmp_path, capture_output=True, check=False
    )
    assert (ended.returncode, ended.stderr) == (CODES[signal.SIGTERM], LINE)


MOMENT = ("sweep", 0.5, signal.SIGINT)
"""Of `validate` there is one below, with workers that are at work."""
OTHERS = [
    *(("validate", delay, sent) for delay, sent in zip((0.0, 0.1), CODES, strict=True)),
    *(("sweep", delay, sent) for delay, sent in product((0.0, 0.5), CODES)),
]


@pytest.mark.parametrize(
    ("command", "delay", "sent"),
    [pytest.param(*each, marks=[] if each == MOMENT else pytest.mark.long) for each in OTHERS],
)
def test_while_workers_start(
    command: str, delay: float, sent: signal.Signals, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    asked = {
        "validate": ("validate", "--full", "--out", str(out)),
        "sweep": (*written(tmp_path, SIMULATED.replace("count = 20", "count = 4000")),),
    }
    interrupted(children, delay, sent, *asked[command])
    assert not list(tmp_path.rglob("*.part"))


def test_an_interrupt_that_a_library_swallows_still_counts() -> None:
    code = "\n".join(
        [
            "import os, signal, sys",
            "import blocksim.cli as cli",
            "def run(**_):",
            "    try:",
            "        os.kill(os.getpid(), signal.SIGINT)",
            "    except KeyboardInterrupt as error:",
            "        raise ImportError('half a module') from error",
            "cli.run = run",
            "cli.main()",
        ]
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, b"", LINE)


def test_a_library_leaves_signals_alone() -> None:
    code = (
        "import signal; both = signal.SIGINT, signal.SIGTERM; "
        "before = [signal.getsignal(each) for each in both]; "
        "import blocksim; "
        "assert before == [signal.getsignal(each) for each in both]"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_work_that_is_broken_off_ends_at_once() -> None:
    with pytest.raises(KeyboardInterrupt), Hands(2) as hands:  # noqa: PT012
        long = [hands.submit(time.sleep, 3600) for _ in range(5)]
        until(lambda: long[0].running() and len(active_children()) == 2)
        raise KeyboardInterrupt
    until(lambda: not active_children())
    until(lambda: not any(each.running() for each in long[2:]))
