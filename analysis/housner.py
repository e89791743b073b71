"""Which sine pulses overturn a block: `direct` against Housner's equation with impacts.

Question: does `direct` at its usual step say of each pulse what the equation says? Blocks of
1 x 4 and 1 x 2 m, half and full sines, a grid of durations by amplitudes.

Expected: the same everywhere but within 0.5 % of the amplitude at which the equation changes
its mind. The equation (Housner, Bull. Seism. Soc. Am. 53, 1963, 403-417) is solved from impact
to impact as the tests do (`tests/rocking.py`). What still rocks after `LONGEST` has survived.

    python -m analysis.housner OUT [--quick]
"""

from __future__ import annotations

import itertools
import math
import time
from pathlib import Path

import numpy as np

from analysis.command import run
from analysis.rows import write_rows
from blocksim import Verdict
from blocksim.blocks.assembly import Array
from blocksim.simulation.shaken import shake
from tests.rocking import block, on_pulse, rocks

WIDTH, HEIGHTS = 1.0, (4.0, 2.0)
SHAPES = ("half-sine", "full-sine")
MANY, FEW = 40, 3
NEAR = 0.005
"""Share of an amplitude to whose both sides the equation has to say the same."""
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


def simulated(height: float, shape: str, duration: float, amplitude: float) -> bool:
    """Tell by `direct`, at its usual step, whether a pulse overturns a block."""
    problem = on_pulse(block(WIDTH, height, 3.0), shape, amplitude, duration)
    seen = shake(problem, "direct", repeat=False, until=LONGEST / problem.seconds)
    return seen.verdict is Verdict.COLLAPSES


def asked(height: float, shape: str, count: int) -> list[dict[str, object]]:
    """Ask the pulses of a grid of one block, by the equation and by `direct`: rows."""
    rows: list[dict[str, object]] = []
    durations, amplitudes = (each.tolist() for each in grid(height, count))
    for amplitude, duration in itertools.product(amplitudes, durations):
        truth, less, more = (
            overturned(height, shape, duration, share * amplitude)
            for share in (1.0, 1 - NEAR, 1 + NEAR)
        )
        rows.append(
            {
                "height_m": height,
                "shape": shape,
                "duration_s": round(duration, 6),
                "amplitude_g": round(amplitude, 6),
                "equation": truth,
                "direct": simulated(height, shape, duration, amplitude),
                "near": not truth == less == more,
            }
        )
    return rows


def main(out: Path, *, quick: bool = False, count: int = MANY) -> list[dict[str, object]]:
    """Ask all pulses, write rows, and return how many differ for each block and shape."""
    told: list[dict[str, object]] = []
    rows: list[dict[str, object]] = []
    for height, shape in itertools.product(HEIGHTS, SHAPES):
        started = time.process_time()
        found = asked(height, shape, FEW if quick else count)
        rows += found
        write_rows(out / "housner.csv.gz", rows)
        differ = [each for each in found if each["direct"] != each["equation"]]
        told.append(
            {
                "height_m": height,
                "shape": shape,
                "pulses": len(found),
                "overturn": sum(each["equation"] is True for each in found),
                "near_the_boundary": sum(each["near"] is True for each in found),
                "differ": sum(not each["near"] for each in differ),
                "differ_near": sum(each["near"] is True for each in differ),
                "cpu_s": round(time.process_time() - started, 1),
            }
        )
    return told


if __name__ == "__main__":
    run(main, lambda told: "\n".join(map(str, told)))
