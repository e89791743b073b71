"""All cases in space with known answers, by every engine, a little to either side.

Question: which engine is right near the limit, in space, and how often? Each case of
`tests/structures/space` is asked whether it stands; one with a load factor at a share less and
at the same share more of it. Asked are the onset test and the moving run, as `check` does. Rows
of each question are kept in OUT/space_cases.jsonl as they are found, and not asked for again.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import blocksim
from analysis.command import run
from analysis.random_space import judged
from analysis.rows import write_rows
from analysis.saved_answers import Row, answers
from blocksim import Problem, Verdict
from tests.space_cases import NAMES, asked, case

BESIDE = {
    "limit": (0.01, 0.001),
    "direct": (0.01, 0.001),
    "pybullet": (0.01,),
    "mujoco": (0.01,),
}
QUICK = ("block_topples_20", "tower_113")


def questions(name: str, method: str) -> Iterator[tuple[float, Problem[Any], Verdict]]:
    """Give the share, the problem and what is known of it, of each question on a case."""
    if case(name)["question"] == "stands":
        ((problem, known),) = asked(name, 0.0)
        yield 0.0, problem, known
        return
    for beside in BESIDE[method]:
        for side, (problem, known) in zip((-beside, beside), asked(name, beside), strict=True):
            yield side, problem, known


def ask(of: tuple[str, str, int]) -> Row:
    """Ask one question: of a method, about a case, by its number.

    Returns: `beside` is the share by which the load is beside the load factor, below 0 less, 0
        for a verdict; `known` and `found` are verdicts; `right` is "right", "open" or "false".
    """
    method, name, number = of
    beside, problem, known = list(questions(name, method))[number]
    began = time.process_time()
    answer = blocksim.check(problem, method=method)
    seconds = time.process_time() - began
    return {
        "case": name,
        "method": method,
        "beside": beside,
        "blocks": len(problem.assembly.blocks),
        "known": str(known),
        "found": str(answer.verdict),
        "right": judged(answer.verdict, known),
        "seconds": round(seconds, 2),
        "evidence": answer.reason,
    }


def table(rows: list[Row]) -> str:
    """Count what is right, open and false, by method and share, as lines of Markdown.

    A verdict has no share: it counts with each.
    """
    lines = ["| method | beside | right | open | false | time |", "|---|---|---|---|---|---|"]
    for method, shares in BESIDE.items():
        for beside in shares:
            near = [each for each in rows if abs(float(each["beside"] or 0)) in (0.0, beside)]
            mine = [each for each in near if each["method"] == method]
            if not mine:
                continue
            right, left_open, wrong = (
                sum(each["right"] == word for each in mine)
                for word in ("right", "open", "false")
            )
            spent = sum(float(each["seconds"] or 0) for each in mine)
            counts = f"{right} | {left_open} | {wrong} | {spent:,.0f} s"
            lines.append(f"| {method} | {beside:.1%} | {counts} |")
    return "\n".join(lines)


def main(out: Path, *, quick: bool = False, method: str = "", only: str = "") -> str:
    """Ask what is not yet on disk; return the table.

    Parameters
    ----------
    out : Path
        Folder for what is found.
    quick : bool, optional
        Two small cases only.
    method : str, optional
        The method that is asked; by default all.
    only : str, optional
        Cases whose names hold this.
    """
    asked = [
        (each, name, number)
        for each, name in itertools.product(
            [method] if method else BESIDE, QUICK if quick else NAMES
        )
        if only in name
        for number, _ in enumerate(questions(name, each))
    ]
    rows = answers(out / "space_cases.jsonl", asked, ask, 1)
    write_rows(out / "space_cases.csv.gz", rows)
    return table(rows)


if __name__ == "__main__":
    run(main)
