"""Random pulses: verdicts of `direct` at its usual accuracy, and at a hundredth of it.

Question: ten structures under pulses and records at random; is the verdict the same?

Expected: the same, or `undecided`; never the opposite. What is asked is `check`'s answer, which
shakes at two steps; at a hundredth of the accuracy blocks are shaken once.

    python -m analysis.random_pulses OUT [--count 1000] [--processes 1] [--quick]
"""

from __future__ import annotations

import time
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from analysis.command import run
from analysis.known_motions import blocks, box
from analysis.rows import write_rows
from analysis.saved_answers import Row, answers
from analysis.shaking import ARCH
from blocksim import Problem, structure_of
from blocksim.blocks.shaking import Shaking, table_of
from blocksim.simulation.shaken import shake

STRUCTURES = (
    "block 1 x 4",
    "block 1 x 2",
    "flat block that slides",
    "two drums",
    "five drums",
    "frame",
    "frame of slender legs",
    "two towers of blocks",
    "arch of seven voussoirs",
    "wall of bricks",
)


def structure(name: str) -> tuple[Problem, float]:
    """Return a structure, and the acceleration from which on it moves [g], about."""

    def drums(count: int, width: float, height: float, at: float = 0.0) -> list[Any]:
        return [box(at, height * row, width, height) for row in range(count)]

    made: dict[str, tuple[Problem, float]] = {
        "block 1 x 4": (blocks(2.0, box(0, 0, 1, 4)), 0.25),
        "block 1 x 2": (blocks(1.0, box(0, 0, 1, 2)), 0.5),
        "flat block that slides": (blocks(0.3, box(0, 0, 2, 1)), 0.3),
        "two drums": (blocks(0.7, *drums(2, 1, 2)), 0.25),
        "five drums": (blocks(0.7, *drums(5, 1, 0.8)), 0.25),
        "frame": (blocks(0.7, box(0, 0, 1, 4), box(5, 0, 1, 4), box(0, 4, 6, 1)), 0.25),
        "frame of slender legs": (
            blocks(0.7, box(0, 0, 0.5, 4), box(3, 0, 0.5, 4), box(0, 4, 3.5, 1)),
            0.125,
        ),
        "two towers of blocks": (blocks(0.6, *drums(3, 1, 1), *drums(2, 0.8, 1.2, 1.5)), 0.33),
        "arch of seven voussoirs": (
            structure_of({**ARCH, "friction": 0.8}),
            0.3705,
        ),
        "wall of bricks": (
            blocks(
                0.6,
                *(
                    box(x, 0.5 * row, 1, 0.5)
                    for row in range(4)
                    for x in ((0, 1) if row % 2 == 0 else (0.5,))
                ),
            ),
            0.4,
        ),
    }
    return made[name]


def shaking(draw: np.random.Generator, least: float) -> Shaking:
    """Draw a pulse, or a record of some sines, from what just moves a structure on."""
    shape = str(draw.choice(["half-sine", "full-sine", "constant", "record"]))
    duration = float(np.exp(draw.uniform(np.log(0.1), np.log(2.0))))
    amplitude = least * float(np.exp(draw.uniform(np.log(0.9), np.log(4.0))))
    if shape != "record":
        return Shaking(shape=shape, amplitude=amplitude, duration=duration)
    times = np.linspace(0.0, 2 * duration, 400)
    ground = np.zeros_like(times)
    for _ in range(5):
        phase = 2 * np.pi * draw.uniform(0.5, 4) * times / duration + draw.uniform(0, 6.3)
        ground += draw.normal() * np.sin(phase)
    ground *= amplitude / np.abs(ground).max()
    return table_of(times, ground)


def asked(case: tuple[str, int], finer: float) -> Row:
    """Ask about a structure and a seed, at the usual accuracy and at a finer one."""
    name, seed = case
    problem, least = structure(name)
    problem = replace(problem, shaking=shaking(np.random.default_rng(seed), least))
    started = time.process_time()
    usual = shake(problem, "direct")
    between = time.process_time()
    accuracy = usual.recording.settings.accuracy * finer
    fine = shake(problem, "direct", repeat=False, settings={"accuracy": accuracy})
    assert problem.shaking is not None  # noqa: S101
    return {
        "structure": name,
        "seed": seed,
        "shape": problem.shaking.shape,
        "amplitude_over_least": problem.shaking.amplitude / least,
        "duration_s": problem.shaking.duration,
        "verdict": usual.verdict.value,
        "fine": fine.verdict.value,
        "rotation": usual.rocking.rotation,
        "fine_rotation": fine.rocking.rotation,
        "usual_cpu_s": round(between - started, 2),
        "fine_cpu_s": round(time.process_time() - between, 2),
    }


def main(out: Path, *, quick: bool = False, count: int = 1000, processes: int = 1) -> list[Row]:
    """Ask so many pulses, structures in turn; write rows, and return them."""
    count = 3 if quick else count
    cases = [(STRUCTURES[seed % len(STRUCTURES)], seed) for seed in range(count)]
    ask = partial(asked, finer=0.1 if quick else 0.01)
    rows = answers(out / "random_pulses.jsonl", cases, ask, processes)
    write_rows(out / "random_pulses.csv.gz", rows)
    return rows


def told(rows: list[Row]) -> str:
    """Say how many are the same, open and opposite."""
    said = {"stands", "collapses"}
    both = [row for row in rows if {row["verdict"], row["fine"]} <= said]
    false = [row for row in both if row["verdict"] != row["fine"]]
    words = [f"{len(rows)} pulses: {len(both) - len(false)} the same, {len(false)} false"]
    words += [f"{len(rows) - len(both)} open at one accuracy or both", *map(str, false)]
    return "\n".join(words)


if __name__ == "__main__":
    run(main, told)
