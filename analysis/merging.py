"""Structures of which an engine gets few bodies, against all their blocks: answers, and time.

Question: what does it save to merge blocks that do not part (`blocksim.simulation.merging`),
and does it ever change an answer? The structures are those of which answers are known
(`structure_cases.py`), and walls in running bond (`WALLS`), pushed by a share of their weight,
whose load factor the linear programme knows. Each is asked 1 % to either side, held at rest
and, unless `--held`, let go, with all blocks and merged, one after the other. Rows are kept as
they come, the smallest first: a run that is stopped goes on where it was.

Expected: the same verdicts, or one where all blocks leave it open, in less time.

    python -m analysis.merging OUT [--engine NAME] [--most BLOCKS] [--held] [--quick]
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from analysis.command import run
from analysis.rows import write_rows
from analysis.saved_answers import Row, answers
from analysis.structure_cases import COARSE, questions
from blocksim import Problem, Wall
from blocksim.ask.families import Family, family_of
from blocksim.simulation.merging import LEAST, Merging
from blocksim.simulation.observation import Observation, observe
from tests.structure_cases import names

WALLS = ((1.6, 7), (2.4, 10), (3.6, 14))
"""Lengths [m] and courses of blocks of 0.4 by 0.2 m: 31, 65 and 133 blocks."""
QUICK = ("oppenheim_28",)
Asked = tuple[str, str, str]
"""Name, question, and the side: inside or outside of what stands."""


def wall(length: float, courses: int) -> Family:
    """Make a wall that is pushed, by shares of its weight."""
    made = Wall(
        friction=0.7, length=length, courses=courses, block_length=0.4, block_height=0.2
    )
    return family_of(made.problem(), "push")


def cases(*, quick: bool) -> Iterator[tuple[Asked, Problem]]:
    """Return what is asked, with the problem."""
    for length, courses in WALLS[:1] if quick else WALLS:
        pushed = wall(length, courses)
        name = f"wall of {len(pushed.problem.assembly.blocks)}"
        for side, share in (("inside", 1 - COARSE), ("outside", 1 + COARSE)):
            yield (name, "push", side), pushed.at(share * (pushed.exact() or 0.0))
    for name in QUICK if quick else names():
        for question in questions(name):
            for side, problem in question.sides(COARSE).items():
                yield (name, question.name, side), problem


def ask(asked: Asked, *, problems: dict[Asked, Problem], engine: str, held: bool) -> Row:
    """Ask with all blocks, and merged."""
    problem = problems[asked]

    def timed(*, merge: bool) -> tuple[Observation, float]:
        started = time.process_time()
        reduction = Merging.of(problem) if merge else None
        found = observe(problem, engine, moving=not held, reduction=reduction)
        return found, round(time.process_time() - started, 3)

    whole, whole_s = timed(merge=False)
    merged, merged_s = timed(merge=True)
    return {
        "case": asked[0],
        "question": asked[1],
        "side": asked[2],
        "all_blocks": whole.blocks,
        "bodies": merged.blocks,
        "splits": merged.splits,
        "whole": str(whole.verdict),
        "merged": str(merged.verdict),
        "whole_s": whole_s,
        "merged_s": merged_s,
    }


def main(
    out: Path,
    *,
    quick: bool = False,
    engine: str = "pymunk",
    most: int = 70,
    held: bool = False,
) -> list[Row]:
    """Run the study, and write its rows.

    Parameters
    ----------
    out : Path
        Folder of `merging_ENGINE.csv`.
    quick : bool
        One wall and one arch.
    engine : str
    most : int
        Blocks of the largest structure asked of; of walls twice that.
    held : bool
        Let nothing go.
    """
    problems = {
        asked: problem
        for asked, problem in cases(quick=quick)
        if LEAST <= len(problem.assembly.blocks) <= most * (2 if asked[1] == "push" else 1)
    }
    order = sorted(problems, key=lambda asked: len(problems[asked].assembly.blocks))
    # What is loaded when it is first asked for is nobody's time.
    ask(order[0], problems=problems, engine=engine, held=held)
    rows = answers(
        out / f"merging_{engine}.jsonl",
        order,
        partial(ask, problems=problems, engine=engine, held=held),
        1,
    )
    write_rows(out / f"merging_{engine}.csv", rows)
    return rows


if __name__ == "__main__":
    run(main, lambda rows: "\n".join(map(str, rows)))
