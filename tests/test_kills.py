"""Commands that are killed at random moments: nothing is lost, and no process is left.

A few kills in every long run. For more:

    BLOCKSIM_KILLS=200 pytest -n 0 -s -m long tests/test_kills.py
"""

import json
import os
import random
import shutil
import signal
import subprocess
import time
from collections import Counter
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from threading import Timer

import pytest
from running import PROGRAM, children, ran, until
from sweeps import SIMULATED, Rows, rows_of, written
from test_sweep_survives import cluster

KILLS = int(os.environ.get("BLOCKSIM_KILLS", "19"))
SEED = os.environ.get("BLOCKSIM_SEED", "1")
OLD = b"what was there before\n"
KILL = signal.SIGKILL
ENDED = {KILL: -9, signal.SIGTERM: 143, signal.SIGINT: 130}
ARCH = ("--alpha", "90", "--mu", "0.7", "--voussoirs", "9")
MOVES = ("simulate", *ARCH, "--eta", "0.08", "--seconds", "0.3", "--out", "OUT")
COMMANDS = {
    "run.npz": MOVES,
    "sheet.svg": ("render", "oppenheim_7", "--out", "OUT"),
    "sheet.dxf": ("render", "oppenheim_7", "--out", "OUT"),
    **{f"film.{kind}": ("render", "run.npz", "--out", "OUT") for kind in ("mp4", "glb")},
    "poses.csv": ("render", "run.npz", "--out", "OUT"),
    "report.html": ("report", "oppenheim_7", "--out", "OUT"),
    "map.html": ("map", "--out", "OUT"),
    "read.json": ("convert", "drawn.svg", "--mu", "0.7", "--out", "OUT"),
    "validate": ("validate", "--quick", "--methods", "direct", "--out", "OUT"),
    "chart": ("chart", "--quick", "--out", "OUT"),
    "paper": ("paper", "OUT", "--figure", "4"),
    "scenes": ("suite", "export", "OUT"),
    "check": ("check", *ARCH, "--eta", "0.12", "--method", "direct"),
    "bracket": ("bracket", *ARCH, "--method", "pymunk"),
    "check a folder": ("check", "many"),
    "doctor": ("doctor",),
}
"""By the file or folder that they write, or by name."""
EACH = -(-KILLS // (len(COMMANDS) + 2))
"""Kills of a command, and of a sweep here and by dask."""
DRAWN = """<svg xmlns="http://www.w3.org/2000/svg"
width="1000mm" height="1000mm" viewBox="0 0 1 1">
<g id="supports"><rect x="0" y="0.9" width="1" height="0.1"/></g>
<g id="blocks"><rect x="0.2" y="0.6" width="0.5" height="0.3"/></g></svg>"""


@dataclass(frozen=True)
class Ended:
    """What became of a command that was sent a signal, or of one that was left alone."""

    code: int
    error: bytes
    sent: signal.Signals | None

    @property
    def is_over(self) -> bool:
        """Whether it ended by itself; else it says in one line that it was interrupted."""
        if self.sent is not None and self.code == ENDED[self.sent]:
            # Python's own tracker of what processes share may complain of the one killed.
            assert self.sent is KILL or self.error == b"blocksim: interrupted\n"
            return False
        assert self.code in {0, 1, 3}, self.error
        assert self.error == b""
        return True


def of_session(leader: int) -> list[int]:
    """Processes that are alive of all that a command has started, however."""
    found = list[int]()
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, session = path.read_text().rpartition(")")[2].split()[:4]
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(session) == leader and state != "Z":
            found.append(int(path.parent.name))
    return found


def is_up(pid: int) -> bool:
    """Tell whether its signals are its own: Python has come to its first library, or ended."""
    try:
        return "numpy" in Path(f"/proc/{pid}/maps").read_text() or not of_session(pid)
    except (FileNotFoundError, ProcessLookupError):
        return True


def run(
    words: tuple[str, ...], folder: Path, draw: random.Random, longest: float | None = None
) -> Ended:
    """Run a command, kill it at a random moment, and wait until all of it is gone."""
    sent = None if longest is None else draw.choice([KILL, KILL, signal.SIGTERM, signal.SIGINT])
    (temporary := folder / "tmp").mkdir(exist_ok=True)
    where = {**os.environ, "SOURCE_DATE_EPOCH": "1700000000", "TMPDIR": str(temporary)}
    with subprocess.Popen(
        [*PROGRAM, *words],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=-1,
        env=where,
        start_new_session=True,
    ) as driver:
        if sent is not None:
            if sent is not KILL:
                until(lambda: is_up(driver.pid))
            time.sleep(draw.uniform(0, longest))
            driver.send_signal(sent)
        _, error = driver.communicate()
    until(lambda: not of_session(driver.pid))
    left = [*folder.rglob("*.part"), *temporary.iterdir()]
    assert sent is KILL or not left
    for path in folder.rglob("*.part"):
        path.unlink()
    shutil.rmtree(temporary)
    return Ended(driver.returncode, error, sent)


def is_whole(path: Path) -> bool:
    """Tell whether a file that says when it was made, or how long it took, goes to its end."""
    held = path.read_bytes()
    if path.suffix == ".json":
        return bool(json.loads(held))
    ends = {
        ".html": b"</html>\n",
        ".svg": b"</svg>\n",
        ".png": b"IEND\xaeB`\x82",
        ".csv": b"\n",
        ".dxf": b"EOF\n",
    }
    return path.suffix in ends and held.endswith(ends[path.suffix])


@pytest.fixture(scope="module")
def given(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a recording, a drawing, and a folder of structures."""
    folder = tmp_path_factory.mktemp("given")
    (folder / "drawn.svg").write_text(DRAWN)
    (folder / "many").mkdir()
    for number in range(500):
        blocks = [
            {"id": level, "vertices": [[x, level], [x + 1, level], [x + 1, level + 1],
                                       [x, level + 1]], "fixed": not level}
            for level, x in enumerate((0, 0.001 * number))
        ]  # fmt: skip
        table = json.dumps({"friction": 0.7, "blocks": blocks})
        (folder / "many" / f"{number}.json").write_text(table)
    ran(*(str(folder / "run.npz") if each == "OUT" else each for each in MOVES))
    return folder


@pytest.mark.long
@pytest.mark.parametrize("name", COMMANDS)
def test_what_is_killed_leaves_what_was_there_or_all_of_it(
    name: str, given: Path, tmp_path: Path
) -> None:
    draw, ends = random.Random(f"{SEED} {name}"), Counter[str]()  # noqa: S311
    out = tmp_path / "run" / name
    shutil.copytree(given, out.parent)
    words = tuple(str(out) if each == "OUT" else each for each in COMMANDS[name])
    if "OUT" in COMMANDS[name]:
        out.unlink(missing_ok=True)
    began = time.monotonic()
    assert run(words, out.parent, draw).is_over
    longest = time.monotonic() - began
    whole = {path: path.read_bytes() for path in [out, *out.rglob("*")] if path.is_file()}
    for _ in range(EACH):
        for path in whole:
            path.write_bytes(OLD)
        seen = run(words, out.parent, draw, longest)
        ends["over" if seen.is_over else seen.sent.name] += 1
        for path, wanted in whole.items():
            held = path.read_bytes()
            assert held in {OLD, wanted} or is_whole(path), path
            assert held != OLD or not seen.is_over
        made = {path for path in out.rglob("*") if path.is_file()}
        assert seen.sent is KILL or out.is_file() or made == {*whole}
    print(f"\n{name}, of {longest:.0f} s: {dict(ends)}")  # noqa: T201


@pytest.mark.long
@pytest.mark.parametrize("where", ["here", "dask"])
def test_a_sweep_that_is_killed_again_and_again_comes_to_its_end(
    where: str, tmp_path: Path, uninterrupted: Rows
) -> None:
    """Its driver, or a worker of the cluster while it goes on."""
    draw, ends = random.Random(f"{SEED} {where}"), Counter[str]()  # noqa: S311
    asked, out = written(tmp_path, SIMULATED), tmp_path / "out"
    kept: Rows = {}
    with cluster(tmp_path, 2) if where == "dask" else nullcontext(("", 0)) as (address, owner):
        asked = (*asked, *(("--scheduler", address) if address else ("--workers", "2")))
        for number in range(EACH):
            workers = children(owner) if owner else []
            # One that is killed as it starts is not started again.
            if number % 3 == 2 and len(workers) == 2:
                worker = draw.choice(workers)
                timer = Timer(draw.uniform(0, 5), os.kill, (worker, KILL))
                timer.start()
                assert run(asked, tmp_path, draw).is_over
                timer.join()
                ends["worker"] += 1
                shutil.rmtree(out)
                kept = {}
                continue
            seen = run(asked, tmp_path, draw, 10)
            ends["over" if seen.is_over else seen.sent.name] += 1
            found = rows_of(out) if out.exists() else {}
            assert {name: found[name] for name in kept} == kept
            kept = found
        assert run(asked, tmp_path, draw).is_over
    assert rows_of(out) == uninterrupted
    print(f"\n{where}: {dict(ends)}")  # noqa: T201
