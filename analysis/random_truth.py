"""Ten thousand random problems by every method, each answer held to a proof.

Question: is any answer of `limit`, `direct`, pymunk or pybullet false, how many are open, and
does an answer hang on anything but the question? Arches of the map, all kinds of structures,
walls and assemblies of polygons (`tests/random_problems.py`) are asked about at 0.5 to 2 times
the load, tilt, friction, thickness or overhang at which they fall, 0.1 % from it at least.

Truth is none of the methods' own: `tests/certificates.py` proves by plain statics that forces
of equilibrium exist, or that none do. That they exist means that blocks *can* rest: where
joints slide friction may let them move, too. So "collapses" is counted as false where they
exist, and what was then seen to move is counted apart ("moves too"). The ratio only says where
to ask.

Critical values of arches of the map come from the statics of voussoirs, those of columns and
stacks from closed forms, others from the linear programme; `expected` says on which side of it
a problem is. Where this is not what is proved, the study says so.

Every 50th round of 20 is asked again: by this process after all the others, by new processes in
another order with other seeds of hashes and numbers of threads, mirrored, and renumbered;
the first of them by a process each.

    python -m analysis.random_truth OUT [--quick]

Rows are kept in OUT/random_truth.jsonl as they come, and not asked for again.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from analysis.command import run
from analysis.rows import provenance, write_rows
from analysis.saved_answers import Row, answers
from blocksim import BlocksimError, CircularArch, Problem, check
from blocksim import check as check_problem
from tests.certificates import certificate
from tests.images import mirrored, renumbered
from tests.random_problems import GROUPS, Case, drawn

PROBLEMS = 10_000
MOST = {"": 24, "pymunk": 20, "pybullet": 12}
"""Most blocks of a problem, and of one that an impulse engine is asked about, too."""
EVERY = {"pymunk": (10, 0), "pybullet": (50, 25), "again": (50, 0)}
"""One round of `GROUPS` in so many is asked by an engine, or asked again, and from which on."""
METHODS = ("limit", "direct", "pymunk", "pybullet")
BATCHES = ((1, 1), (2, 2), (12345, 1))
"""Seeds of hashes, and threads, of the processes that are asked again."""
ALONE = 20
"""Problems that are asked by a process each."""
QUICK = range(0, len(GROUPS), 3)
"""Problems of a quick run, some of each group."""
ROOT = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Result:
    """Headline numbers.

    Parameters
    ----------
    problems, unproved : int
    unexpected : int
        Proved to do other than the critical value says.
    told : dict of str to Counter
        For each method, answers where what is right is proved: right, false, open; of them,
        where something was seen to move that can rest ("moves too").
    same : dict of str to (int, int)
        For each way of asking again, answers that are the same, of how many.
    """

    problems: int
    unproved: int
    unexpected: int
    told: dict[str, Counter[str]]
    same: dict[str, tuple[int, int]]


def case(index: int) -> Case:
    """Return a case; those that engines are asked about have fewer blocks."""
    least = [MOST[name] for name in MOST if not name or is_of(index, name)]
    return Case(index, min(least))


def is_of(index: int, name: str) -> bool:
    """Tell whether a problem is asked by an engine, or again."""
    every, first = EVERY[name]
    return index // len(GROUPS) % every == first


def methods_of(index: int) -> list[str]:
    """Return the methods a problem is asked of."""
    return [name for name in METHODS if name not in EVERY or is_of(index, name)]


def said(index: int, method: str, change: str = "") -> tuple[str, str]:
    """Return verdict and reason of a problem, mirrored or renumbered first."""
    asked = drawn(case(index))
    try:
        if asked.arch is not None and not change:
            arch, mu = asked.arch
            found = check(CircularArch.of(arch, friction=mu), method=method)
        else:
            found = check_problem(changed(asked.problem, change, index), method=method)
    except BlocksimError as error:
        return "error", str(error)
    return str(found.verdict), f"{found.reason} ({found.rest})"


def changed(problem: Problem, change: str, seed: int) -> Problem:
    """Mirror or renumber a problem."""
    if change == "mirrored":
        return mirrored(problem)
    return renumbered(problem, seed) if change else problem


def ask(one: Case) -> Row:
    """Ask every method about one problem, and prove what is right."""
    asked, began = drawn(one), time.process_time()
    question, problem = asked.question, asked.problem
    proved = certificate(problem)
    row: Row = {
        "index": one.index,
        "kind": question.kind,
        "over": question.over,
        "known": question.known,
        "blocks": len(problem.assembly.blocks),
        "mu": f"{problem.mu:.4g}",
        "ratio": f"{asked.ratio:.5g}",
        "expected": word(stands=asked.stands),
        "proved": "" if proved.stands is None else word(stands=proved.stands),
        "left": f"{proved.left:.0e}",
    }
    notes: list[str] = []
    asks = methods_of(one.index)
    for method in METHODS:
        verdict, reason = said(one.index, method) if method in asks else ("", "")
        row[method] = verdict
        if verdict and verdict != row["proved"]:
            notes.append(f"{method}: {reason}")
        elif reason.endswith("(can)"):
            notes.append(f"{method}: moves too")
    row["note"] = "; ".join(notes)
    row["cpu_s"] = round(time.process_time() - began, 2)
    return row


def word(*, stands: bool) -> str:
    """Say what is proved in the word of a verdict."""
    return "stands" if stands else "collapses"


def again(index: int, change: str) -> Row:
    """Ask the static method and `direct` again, in this process or in another form."""
    return {method: said(index, method, change)[0] for method in ("limit", "direct")}


def elsewhere(indices: Sequence[int], seed: int, threads: int) -> list[list[str]]:
    """Return the verdicts of a new process, by each problem's methods, in the order given."""
    counts = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), str(threads))
    asked = subprocess.run(
        [sys.executable, "-c", "from analysis.random_truth import reply; reply()"],
        input=json.dumps(list(indices)),
        capture_output=True,
        check=True,
        cwd=ROOT,
        env={**os.environ, **counts, "PYTHONHASHSEED": str(seed)},
        text=True,
    )
    return json.loads(asked.stdout)


def reply() -> None:
    """Answer a list of problems on standard input."""
    told = [[said(i, m)[0] for m in methods_of(i)] for i in json.load(sys.stdin)]
    json.dump(told, sys.stdout)


def main(out: Path, *, quick: bool = False, problems: int = PROBLEMS) -> Result:
    """Run the study, write its rows and return its numbers.

    Parameters
    ----------
    out : Path
        Folder of `random_truth.csv.gz` and `random_truth_again.csv.gz`.
    quick : bool
        Seven problems.
    problems : int
        How many; rows of those asked before are kept.
    """
    # What takes longest is asked last.
    indices = QUICK if quick else range(problems)
    order = sorted(indices, key=lambda index: is_of(index, "pybullet"))
    rows = answers(out / "random_truth.jsonl", [case(each) for each in order], ask, 1)
    write_rows(out / "random_truth.csv.gz", rows)
    for row in rows:
        if row["note"] or row["expected"] != row["proved"]:
            sys.stderr.write(f"{row}\n")
    found = compare(out, rows, *((BATCHES[:1], 1) if quick else (BATCHES, ALONE)))
    write_rows(out / "random_truth_again.csv.gz", found)
    return summary(rows, found)


def compare(
    out: Path, rows: Sequence[Row], batches: Sequence[tuple[int, int]], alone: int
) -> list[Row]:
    """Ask again in other ways; each row has what was said first, and then."""
    first = {int(row["index"] or 0): row for row in rows}
    # Those asked first before are asked last.
    chosen = [index for index in first if is_of(index, "again")][::-1]
    made, found = provenance(), list[Row]()

    def told(way: str, index: int, method: str, verdict: object) -> None:
        was = first[index][method]
        row: Row = {"way": way, "index": index, "method": method, "first": was}
        found.append({**row, "again": str(verdict), **made})

    for change in ("", "mirrored", "renumbered"):
        way = change or "after others"
        file = out / f"random_truth_{way.replace(' ', '_')}.jsonl"
        asked = answers(file, chosen, partial(again, change=change), 1)
        for index, row in zip(chosen, asked, strict=True):
            for method in ("limit", "direct"):
                told(way, index, method, row[method])
    ways = [(f"hash seed {seed}, threads {threads}", chosen, seed, threads)
            for seed, threads in batches]  # fmt: skip
    ways += [("fresh process", [index], index, 1) for index in chosen[-alone:]]
    for way, indices, seed, threads in ways:
        for index, verdicts in zip(indices, elsewhere(indices, seed, threads), strict=True):
            for method, verdict in zip(methods_of(index), verdicts, strict=True):
                told(way, index, method, verdict)
    return found


def summary(rows: Sequence[Row], compared: Sequence[Row]) -> Result:
    """Count what was answered."""
    proved = [row for row in rows if row["proved"]]
    same: dict[str, tuple[int, int]] = {}
    for row in compared:
        right, of = same.get(str(row["way"]), (0, 0))
        same[str(row["way"])] = right + (row["first"] == row["again"]), of + 1
    return Result(
        problems=len(rows),
        unproved=len(rows) - len(proved),
        unexpected=sum(row["expected"] != row["proved"] for row in proved),
        told={method: told_by(method, proved) for method in METHODS},
        same=same,
    )


def told_by(method: str, proved: Sequence[Row]) -> Counter[str]:
    """Count the answers of a method."""
    told = Counter[str]()
    for row in proved:
        verdict = str(row[method] or "")
        if verdict:
            is_open = verdict in {"undecided", "error"}
            told["right" if verdict == row["proved"] else "open" if is_open else "false"] += 1
            told["moves too"] += f"{method}: moves too" in str(row["note"])
    return told


if __name__ == "__main__":
    run(main)
