"""How errors of motion fall with the step, by each engine, in the plane and in space.

Question: of which order is each by each engine, and how far off is it at the usual step?

Expected of `direct`: second order, and no more than 0.1 % off at the usual step of
0.025 sqrt(size/g).

Truth: closed forms and integrated equations, in `known_motions.py`.

`direct` takes five steps. All engines take twice their usual step, the usual one and half of
it, in the plane and of prisms in space, where they can: only `direct` and pymunk let blocks
begin in motion, and in the plane only. Lengths are in units of the size, times in those
of sqrt(size/g).

    python -m analysis.convergence OUT [--quick]
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from pathlib import Path

from analysis.command import run
from analysis.known_motions import (
    Motion,
    falling,
    framed,
    hinged,
    rocking,
    sliding,
    stopped,
    thrown,
    toppling,
    world,
)
from analysis.rows import write_rows

STEPS, QUICK = (0.1, 0.05, 0.025, 0.0125, 0.00625), (0.05, 0.025)
OTHERS, HALVES = ("pymunk", "pybullet", "mujoco"), (2.0, 1.0, 0.5)
"""Other engines, and their steps over the usual one."""
IMPACTS, LEANS = (1, 3, 10), (0.11, 0.13, 0.15, 0.17, 0.19)
"""Of rocking: impacts before the top, and how far the block leans at first [rad]. All engines
are asked from several leans, as it is chance where in a step an impact falls."""
ROUND_OFF = 1e-12


def main(out: Path, *, quick: bool = False) -> list[dict[str, object]]:
    """Let every motion go in steps of each length, write rows, and return them."""
    rows: list[dict[str, object]] = []
    for motion in motions():
        rows += followed(motion, "direct", QUICK if quick else STEPS)
    write_rows(out / "convergence.csv", rows)
    if quick:
        return rows
    others: list[dict[str, object]] = []
    for motion, engine, in_space in by_engines():
        _, usual = world(motion.problem, engine, in_space=in_space)
        steps = tuple(usual * half for half in HALVES)
        others += followed(motion, engine, steps, in_space=in_space)
        write_rows(out / "convergence_engines.csv.gz", others)
    return rows + others


def by_engines() -> Iterator[tuple[Motion, str, bool]]:
    """Give the cheaper motions with each engine that takes them, in the plane and in space."""
    rocks = (rocking(1, lean) for lean in LEANS)
    for motion in (falling(), thrown(), stopped(), sliding(), *rocks, hinged()):
        for engine in ("direct", *OTHERS):
            for in_space in (False, True):
                if motion.is_of(engine, in_space=in_space):
                    yield motion, engine, in_space


def followed(
    motion: Motion, engine: str, steps: tuple[float, ...], *, in_space: bool = False
) -> Iterator[dict[str, object]]:
    """Give a row of a motion by an engine for each step."""
    last = 0.0
    for step in steps:
        started = time.process_time()
        value = motion.seen(step, engine, in_space=in_space)
        error = abs(value / motion.truth - 1)
        yield {
            "motion": motion.name,
            "engine": engine,
            "in_space": in_space,
            "step": step,
            "truth": motion.truth,
            "seen": value,
            "error": error,
            "order": round(math.log2(last / error), 2) if min(last, error) > ROUND_OFF else "",
            "cpu_s": round(time.process_time() - started, 3),
        }
        last = error


def motions() -> tuple[Motion, ...]:
    """Return every motion."""
    rocks = map(rocking, IMPACTS)
    return (thrown(), stopped(), *rocks, hinged(), toppling(), *map(framed, (1, 3)))


if __name__ == "__main__":
    run(main, lambda rows: "\n".join(map(str, rows)))
