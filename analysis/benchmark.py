"""What common tasks cost on this machine, against the last time they were measured.

Question: has anything become slower? A handful of tasks is repeated, and the median of the
processor time kept in one file for each kind of machine; the ratio to what the file held before
is printed. Processor time hardly depends on what else runs, but caches do: a busy machine
shows up to half more.

    python -m analysis.benchmark [--out FOLDER]

FOLDER is by default `analysis/timings`, which is kept with the code. Takes about two minutes.

Commands are run as processes, loading and all. `direct` is asked at 27, 301 and 1000 voussoirs,
and the onset of walls that fall, tilted 30 % beyond what they bear.
"""

from __future__ import annotations

import json
import math
import os
import platform
import re
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from statistics import median

import numpy as np

from analysis.command import run
from blocksim import Arch, bracket, check
from blocksim.arch.limit import least_thickness
from blocksim.arch.limit.bulk import which_stand
from blocksim.arch.theory.arrays import least_thicknesses
from blocksim.ask.simulate import simulate
from blocksim.common.files import make_folder, write_whole
from blocksim.engines import ENGINES
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.files import structure_of
from blocksim.report.tables import processor
from blocksim.simulation.observation import hold
from blocksim.view.film import Film

TIMINGS = Path(__file__).parent / "timings"
LIBRARIES = ("numpy", "scipy", "pymunk", "pybullet", "matplotlib")
REPEATS = 5
BUDGET = 6.0
"""A task is not repeated once its repeats have taken that long [s]."""
ALPHA, THIN, MU = math.radians(90), math.radians(30), 0.7
MANY = (301, 1000)
"""Voussoirs of larger arches."""
WALLS = {(3.0, 8): 38.643, (10.0, 20): 33.431}
"""Walls by length [m] and courses, with 1.3 times the angle [deg] at which they cannot rest."""
COLLAPSE = 3.0
"""What is watched of a collapse [s]."""
TOLERANCES = {"direct": 1e-8, "pymunk": 1e-3}
"""Widths of the brackets; `COARSE` for any other engine."""
COARSE = 4e-3

Task = Callable[[], object]


@dataclass(frozen=True)
class Record:
    """What was measured, and where: seconds of processor time by task, medians."""

    cpu: str
    cores: int
    python: str
    libraries: dict[str, str]
    blocksim: str
    seconds: dict[str, float]

    @property
    def machine(self) -> str:
        """Name of the machine's kind, fit for a file."""
        name = re.sub(r"\((r|tm)\)", "", self.cpu.lower())
        return re.sub(r"[^a-z0-9]+", "-", f"{name} {self.cores} cores").strip("-")


@dataclass(frozen=True)
class Result:
    """What was measured now, and its ratio to the last time by task; empty the first time."""

    record: Record
    ratios: dict[str, float]
    path: Path


def main(out: Path = TIMINGS, *, quick: bool = False) -> Result:
    """Measure, compare with what the folder holds for this machine, and store."""
    done: dict[str, float] = {}
    for name, task in tasks(quick=quick).items():
        sys.stderr.write(f"{name}\n")
        done[name] = measured(task, 1 if quick else REPEATS)
    record = Record(
        cpu=processor(),
        cores=os.cpu_count() or 1,
        python=platform.python_version(),
        libraries={name: found for name in LIBRARIES if (found := _version(name))},
        blocksim=version("blocksim"),
        seconds=done,
    )
    make_folder(out)
    path = out / f"{record.machine}.json"
    before = stored(path)
    text = json.dumps(asdict(record), indent=2) + "\n"
    write_whole(path, lambda file: file.write(text.encode()))
    ratios = {name: done[name] / before[name] for name in done if before.get(name)}
    return Result(record=record, ratios=ratios, path=path)


def stored(path: Path) -> dict[str, float]:
    """Return the seconds by task that a file holds; none if it is not there."""
    if not path.exists():
        return {}
    return json.loads(path.read_text(encoding="utf-8"))["seconds"]


def measured(task: Task, repeats: int) -> float:
    """Return the median processor time of a task, after a first go that is not counted."""
    task()
    seconds: list[float] = []
    while len(seconds) < repeats and sum(seconds) < BUDGET:
        started = _spent()
        task()
        seconds.append(_spent() - started)
    return median(seconds)


def _spent() -> float:
    """Processor time of this process and of those it has waited for [s]."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def tasks(*, quick: bool) -> dict[str, Task]:
    """Return what is measured, by name; all of it small if quick."""
    count, voussoirs = (1000, 9) if quick else (100_000, 27)
    random = np.random.default_rng(1)
    alpha = np.radians(random.uniform(30, 155, count))
    mu, eta = random.uniform(0.3, 3, count), random.uniform(0.01, 0.5, count)
    least = least_thickness(ALPHA, MU, voussoirs).eta or 0.1
    below, above = (
        Arch(half_angle=ALPHA, eta=least * ratio, voussoirs=voussoirs) for ratio in (0.99, 1.01)
    )
    asked = ("--alpha", "90", "--eta", "0.12", "--mu", "0.7", "--voussoirs", "27")
    found: dict[str, Task] = {
        "blocksim --help": lambda: _command("--help"),
        "blocksim check by limit": lambda: _command("check", *asked, "--method", "limit"),
        f"theory, {count} arches": lambda: least_thicknesses(alpha, mu),
        f"limit, {count} arches": lambda: which_stand(alpha, eta, mu, voussoirs),
        "limit, 10 least thicknesses": lambda: [
            least_thickness(ALPHA, MU, voussoirs) for _ in range(10)
        ],
    }
    for name, engine in ENGINES.items():
        if not engine.missing:
            found |= _of_engine(name, below, above)
    found |= _large(quick=quick)
    found[f"direct, collapse of {COLLAPSE:g} s"] = lambda: simulate(
        CircularArch.of(below, friction=MU),
        method="direct",
        duration=COLLAPSE / CircularArch.of(below, MU).problem().seconds,
    )
    falling = simulate(CircularArch.of(below, friction=MU), method="direct", duration=2.0)
    frames = 2 if quick else 50
    film = Film([falling], height=480)
    found[f"film, {frames} frames"] = lambda: [
        film.frame(film.rate + number) for number in range(frames)
    ]
    return found


def _of_engine(engine: str, below: Arch, above: Arch) -> dict[str, Task]:
    tol = TOLERANCES.get(engine, COARSE)
    return {
        f"{engine}, onset test": lambda: hold(CircularArch.of(above, MU).problem(), engine),
        f"{engine}, check": lambda: check(CircularArch.of(below, friction=MU), method=engine),
        f"{engine}, bracket to {tol:g}": lambda: bracket(
            CircularArch(
                half_angle=ALPHA, friction=MU, voussoirs=below.voussoirs, weight="centreline"
            ),
            method=engine,
            tol=tol,
        ),
    }


def _large(*, quick: bool) -> dict[str, Task]:
    """Return tasks of many blocks, and of thin ones."""
    found: dict[str, Task] = {}
    for count in (31,) if quick else MANY:
        least = least_thickness(ALPHA, MU, count).eta or 0.1
        arch = Arch(half_angle=ALPHA, eta=1.01 * least, voussoirs=count)
        found[f"direct, onset test at n = {count}"] = lambda arch=arch: hold(
            CircularArch.of(arch, MU).problem(), "direct"
        )
    for (length, courses), tilt in list(WALLS.items())[: 1 if quick else None]:
        table = {"kind": "wall", "length": length, "courses": courses, "friction": MU}
        wall = structure_of(table).tilted(math.radians(tilt))
        count = len(wall.assembly.blocks)
        found[f"direct, wall of {count} blocks"] = lambda wall=wall: hold(wall, "direct")
    if not ENGINES["pymunk"].missing:
        voussoirs = 5 if quick else 27
        least = least_thickness(THIN, MU, voussoirs).eta or 0.1
        thin = Arch(half_angle=THIN, eta=1.01 * least, voussoirs=voussoirs)
        found["pymunk, check at 30 deg"] = lambda: check(
            CircularArch.of(thin, friction=MU), method="pymunk"
        )
    return found


def _command(*arguments: str) -> None:
    """Run a command as users do."""
    run_module = (sys.executable, "-m", "blocksim", *arguments)
    subprocess.run(run_module, check=False, capture_output=True)  # noqa: S603


def table(result: Result) -> str:
    """Set out what was measured, and the ratios to the last time."""
    record = result.record
    lines = [f"{record.cpu}, {record.cores} cores, Python {record.python}; processor time"]
    for name, seconds in record.seconds.items():
        ratio = result.ratios.get(name)
        said = "new" if ratio is None else f"{ratio:.2f} of the last"
        lines.append(f"  {name:32} {seconds:9.4f} s   {said}")
    return "\n".join([*lines, f"stored in {result.path}"])


def _version(library: str) -> str | None:
    try:
        return version(library)
    except PackageNotFoundError:
        return None


if __name__ == "__main__":
    run(main, table)
