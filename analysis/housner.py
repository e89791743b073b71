"""Which sine pulses overturn a block: an engine against Housner's equation with impacts.

Question: does `direct`, shaken once at its usual step, say of each pulse what the equation
says? Do others, which are shaken as often as they ask for and may leave it open? Blocks of
1 x 4 and 1 x 2 m, half and full sines, a grid of durations by amplitudes.

Expected: the same everywhere but within 0.5 % of the amplitude at which the equation changes
its mind. The equation (Housner, Bull. Seism. Soc. Am. 53, 1963, 403-417) is solved from impact
to impact as the tests do (`tests/rocking.py`). What still rocks after `LONGEST` has survived.

    python -m analysis.housner OUT [--engine direct|pymunk] [--count N] [--quick]
"""

from __future__ import annotations

import itertools
import math
import time
from functools import partial
from pathlib import Path

import numpy as np

from analysis.command import run
from analysis.rows import write_rows
from analysis.saved_answers import Row, answers
from blocksim import Verdict
from blocksim.blocks.assembly import Array
from blocksim.simulation.shaken import shake
from tests.rocking import block, on_pulse, rocks

WIDTH, HEIGHTS = 1.0, (4.0, 2.0)
SHAPES = ("half-sine", "full-sine")
MANY, FEW = 40, 3
NEAR = 0.005
"""Share of an amplitude within which the equation has to say what `direct` says."""
LONGEST = 20.0
"""Time after which what still rocks has survived [s]."""


def grid(height: float, count: int) -> tuple[Array, Array]:
    """Durations [s] and amplitudes [g], from what just lifts a block."""
    least = WIDTH / height
    return np.geomspace(0.2, 2.0, count), least * np.geomspace(1.02, 5.0, count)


def overturned(height: float, shape: str, duration: float, amplitude: float) -> bool:
    """Tell by the equation whether a pulse overturns a block."""
    turns = math.pi * (2 if shape == "full-sine" else 1)

    def ground(at: float) -> float:
        inside = 0 <= at <= duration
        return amplitude * math.sin(turns * at / duration) if inside else 0.0

    return rocks(WIDTH, height, ground, shaken=duration, until=LONGEST).overturns


def simulated(
    engine: str, height: float, shape: str, duration: float, amplitude: float
) -> bool | None:
    """Tell by an engine whether a pulse overturns a block; None where that is left open."""
    problem = on_pulse(block(WIDTH, height, 3.0), shape, amplitude, duration)
    until, repeat = LONGEST / problem.seconds, engine != "direct"
    said = shake(problem, engine, repeat=repeat, until=until).verdict
    return None if said is Verdict.UNDECIDED else said is Verdict.COLLAPSES


def asked(case: tuple[float, str, float, float], engine: str) -> Row:
    """Ask the equation and an engine about a height, shape, duration and amplitude.

    Returns: `near` tells that the engine says what the equation says of an amplitude `NEAR` it.
    """
    height, shape, duration, amplitude = case
    truth = overturned(height, shape, duration, amplitude)
    started = time.process_time()
    found = simulated(engine, height, shape, duration, amplitude)
    spent = time.process_time() - started
    beside = [
        overturned(height, shape, duration, share * amplitude)
        for share in (1 - NEAR, 1 + NEAR)
        if found is not None and found != truth
    ]
    return {
        "height_m": height,
        "shape": shape,
        "duration_s": round(duration, 6),
        "amplitude_g": round(amplitude, 6),
        "equation": truth,
        engine: found,
        "near": found in beside,
        f"{engine}_cpu_s": round(spent, 3),
    }


def main(
    out: Path,
    *,
    quick: bool = False,
    engine: str = "direct",
    count: int = MANY,
    processes: int = 1,
) -> list[dict[str, object]]:
    """Ask what is not yet on disk, write rows, and return how many differ for each block."""
    cases = [
        (height, shape, duration, amplitude)
        for height, shape in itertools.product(HEIGHTS, SHAPES)
        for durations, amplitudes in [grid(height, FEW if quick else count)]
        for amplitude, duration in itertools.product(amplitudes.tolist(), durations.tolist())
    ]
    name = "housner" if engine == "direct" else f"housner_{engine}"
    rows = answers(out / f"{name}.jsonl", cases, partial(asked, engine=engine), processes)
    write_rows(out / f"{name}.csv.gz", rows)
    return [told(rows, engine, *each) for each in itertools.product(HEIGHTS, SHAPES)]


def told(rows: list[Row], engine: str, height: float, shape: str) -> dict[str, object]:
    """Count what differs for one block and one shape."""
    found = [row for row in rows if (row["height_m"], row["shape"]) == (height, shape)]
    known = [row for row in found if row[engine] is not None]
    differ = [row for row in known if row[engine] != row["equation"]]
    return {
        "height_m": height,
        "shape": shape,
        "pulses": len(found),
        "overturn": sum(row["equation"] is True for row in found),
        "open": len(found) - len(known),
        "differ": sum(not row["near"] for row in differ),
        "differ_near": sum(row["near"] is True for row in differ),
        "cpu_s": round(sum(float(row[f"{engine}_cpu_s"] or 0) for row in found), 1),
    }


if __name__ == "__main__":
    run(main, lambda told: "\n".join(map(str, told)))
