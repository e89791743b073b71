"""From which push on walls may move, as friction does not dilate: six walls of the literature.

Question: the linear programme gives the largest push at which a wall can rest. By how much less
can it already begin to move? Ferris and Tin-Loi (2001) asked that of six walls of blocks that
are pushed by a part of their weight.

`slipping.py` searches for forces and rates that satisfy Coulomb's law at the least push. Each
answer is held to the law by a check that knows nothing of the search. So it is an upper bound
of the least push at which a wall may move, and nothing tells how far it is above that.

A little above it the wall also moves: with what contacts do in that motion a linear programme
finds accelerations, and `direct`'s solver, begun with them, keeps them.

Expected: at most what is known: 0.6390 for the first wall, 0.3558 for the third.

    python -m analysis.walls_two_answers OUT [--quick]

Rows are kept in OUT/walls_two_answers.jsonl as they come, and written as walls_two_answers.csv.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.command import run
from analysis.rows import write_rows
from analysis.saved_answers import Row, answers
from analysis.slipping import Law, Motion, wrong
from analysis.two_answers import begun, settled
from blocksim.blocks.problem import Problem
from blocksim.kinds.files import structure_of
from blocksim.limit import collapse

LEAST = 0.75
"""Least push, over the largest at which it can rest, of a state of rest to begin with."""
FRICTION, HEIGHT = 0.65, 0.175
"""Of all six walls; the height of a course in block lengths of 0.4."""
ABOVE = 1e-2, 3e-3, 1e-3, 3e-4, 1e-4
"""How far above the factor found, over it, `direct`'s solver begins with a motion."""
POWER = 1e-12
"""Power of the loads, over that of the fall, up to which nothing moves."""
Opening = tuple[float, float, int, int]


@dataclass(frozen=True)
class Wall:
    """A wall of Ferris and Tin-Loi, and what is known of it.

    Parameters
    ----------
    number : int
    length : float
    courses : int
    first : float
        Length of its first block, in blocks.
    openings : tuple of (float, float, int, int)
        Left and right side, lowest and highest course.
    known : float or None
        The least factor known at which it may move, as `tests/structures/cases` has it.
    """

    number: int
    length: float
    courses: int
    first: float
    openings: tuple[Opening, ...] = ()
    known: float | None = None

    def problem(self) -> Problem:
        """Return the wall, pushed sideways by a factor times its weight."""
        names = "left", "right", "from_course", "to_course"
        return structure_of(
            {
                "kind": "wall",
                "friction": FRICTION,
                "length": self.length,
                "courses": self.courses,
                "block_height": HEIGHT,
                "first": self.first,
                "openings": [dict(zip(names, each, strict=True)) for each in self.openings],
                "live": [{"body": [1, 0]}],
            }
        )


WALLS = (
    Wall(1, 2.0, 6, 0.5, (), 0.638982),
    Wall(2, 2.0, 10, 0.5, (), 0.55831),
    Wall(3, 1.6, 11, 1.0, ((0.6, 1.0, 4, 8),), 0.355817),
    Wall(4, 2.0, 11, 0.5, ((0.4, 0.8, 4, 8), (1.2, 1.6, 4, 8)), 0.263736),
    Wall(5, 1.2, 19, 0.5, ((0.4, 0.8, 4, 8), (0.4, 0.8, 12, 16)), 0.213637),
    Wall(6, 2.8, 21, 0.5,
         tuple((x, x + 0.4, low, low + 4) for x in (0.6, 1.8) for low in (5, 13))),
)  # fmt: skip


@dataclass(frozen=True)
class Beginning:
    """A wall and the number of a random beginning."""

    wall: int
    seed: int


def ask(beginning: Beginning) -> Row:
    """Find a factor at which a wall may move, from one beginning."""
    wall = WALLS[beginning.wall - 1]
    problem = wall.problem()
    limit = collapse(problem)
    if limit.load_factor is None or limit.forces is None:
        raise ValueError("no forces of equilibrium")
    rng, law = np.random.default_rng((beginning.seed, wall.number)), Law(problem)
    pressure = limit.forces[..., 0].sum(axis=1)
    if beginning.seed:
        pressure = law.at_rest(rng, limit.load_factor * rng.uniform(LEAST, 1.0))
    found = law.walk(rng, pressure)
    return {
        "wall": wall.number,
        "blocks": len(problem.assembly.blocks),
        "joints": len(problem.assembly.joints),
        "seed": beginning.seed,
        "limit": limit.load_factor,
        "known": wall.known,
        "moves": None if found is None else found.factor,
        "wrong": None if found is None else wrong(problem, found),
        "direct": None if found is None else kept(problem, law, found),
    }


def kept(problem: Problem, law: Law, motion: Motion) -> float | None:
    """Return the least factor tried at which `direct`'s solver keeps a motion; None without."""
    least = None
    for above in ABOVE:
        factor = motion.factor * (1 + above)
        start = law.started(motion, factor)
        if start is None:
            continue
        if settled(problem.with_load(factor), begun(problem, start), POWER) is not None:
            least = factor
    return least


def main(out: Path, *, beginnings: int = 12, processes: int = 2, quick: bool = False) -> str:
    """Search each wall for the least push at which it may move."""
    asked = [Beginning(wall.number, seed) for seed in range(beginnings) for wall in WALLS]
    if quick:
        asked = [Beginning(1, 0)]
    rows = answers(out / "walls_two_answers.jsonl", asked, ask, processes)
    write_rows(out / "walls_two_answers.csv", rows)
    return summary(rows)


def summary(rows: list[Row]) -> str:
    """Say the least factors of each wall."""
    lines: list[str] = []
    for number in sorted({int(row["wall"]) for row in rows}):
        mine = [row for row in rows if row["wall"] == number]
        moves = min(float(row["moves"]) for row in mine if row["moves"])
        direct = min((float(row["direct"]) for row in mine if row["direct"]), default=None)
        known = "unknown" if mine[0]["known"] is None else f"{mine[0]['known']:.6f}"
        end = "none" if direct is None else f"{direct:.6f}"
        lines.append(
            f"wall {number}: rests to {mine[0]['limit']:.6f}, may move from {moves:.6f}, "
            f"known {known}, direct moves at {end}"
        )
    worst = max(float(row["wrong"]) for row in rows if row["moves"])
    return "\n".join([*lines, f"laws broken by {worst:.1e} at most"])


if __name__ == "__main__":
    run(main)
