"""Random arches of every kind by `direct`, 0.5 % to both sides of what limit analysis says.

Question: does `direct` fall just below the least thickness of limit analysis and stand just
above it, whatever the shape of the arch? Arches of all seven kinds are drawn over their shape,
friction (from 0.35; one of five without slip), number of voussoirs, joints (normal, vertical,
radial), weight and fill. Those that stand however thin, and half of the others, are asked
about at the load factor of a push to the right instead, in units of their weight. Each is
held at rest and let go.

Expected: no false verdict. What is undecided is listed with its reason.

    python -m analysis.random_kinds OUT [--arches N] [--quick]

Rows are kept in OUT/random_kinds.jsonl as they come, and not asked for again; they are written
as OUT/random_kinds.csv, too.
"""

from __future__ import annotations

import csv
import itertools
import json
import math
import time
from collections import Counter
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from analysis.command import run
from analysis.saved_answers import Row, answers
from blocksim.ask.check import check
from blocksim.ask.families import Family, family_of
from blocksim.common.errors import InputError
from blocksim.evidence.verdict import Verdict
from blocksim.kinds import KINDS
from blocksim.kinds.files import structure_of

SEED = 17
ARCHES = 300
ASIDE = 0.005
ARCH_KINDS = tuple(name for name, kind in KINDS.items() if kind.is_arch)
PUSH = [{"body": [1, 0]}]
RANGE = 1e-3, 10.0
"""Thicknesses over the span, and load factors, that are taken."""


@dataclass(frozen=True)
class Case:
    """The `index`-th arch, of at most so many voussoirs."""

    index: int
    most: int = 40


@dataclass(frozen=True)
class Result:
    """Headline numbers: of the questions asked, and which were left open, with reasons."""

    arches: int
    over: dict[str, int]
    right: int
    false: int
    undecided: dict[str, str]
    cpu_s: float


def sketch(kind: str, generator: np.random.Generator, most: int) -> dict[str, Any]:
    """Draw the parameters of an arch, of which some may not go together."""
    between, choice = generator.uniform, generator.choice
    table: dict[str, Any] = {
        "kind": kind,
        "voussoirs": int(generator.integers(3, most // 2)) * 2 + int(kind == "flat-arch"),
        "friction": "inf" if generator.random() < 0.2 else round(float(between(0.35, 2.5)), 3),
    }
    shape: dict[str, float] = {}
    match kind:
        case "circular-arch":
            shape = {"left_deg": between(20, 120), "right_deg": between(20, 120)}
        case "pointed-arch":
            shape = {"radius": between(1.0, 2.5)}
        case "elliptic-arch":
            shape = {"rise": between(0.35, 2.0)}
        case "basket-handle-arch":
            shape = {"rise": between(0.4, 1.0), "side_deg": between(30, 70)}
        case "flat-arch":
            shape = {"skew_deg": between(5, 45), "thickness": between(0.2, 0.6)}
        case _:
            shape = {"rise": between(0.3, 2.0)}
    table |= {name: round(float(value), 3) for name, value in shape.items()}
    if kind == "flat-arch":
        table["joints"] = str(choice(["fanned", "inclined"]))
    else:
        table["joints"] = str(choice(["normal", "vertical", "radial"], p=[0.6, 0.2, 0.2]))
        table["weight"] = str(choice(["curved", "chord"]))
        table["thickness"] = round(float(between(0.08, 0.3)), 3)
    if generator.random() < 0.25:
        table["fill"] = round(float(between(0, 0.5)), 3)
    return table


@cache
def drawn(case: Case) -> tuple[dict[str, Any], Family, float]:
    """Draw an arch, its question and the answer of limit analysis."""
    kind = ARCH_KINDS[case.index % len(ARCH_KINDS)]
    for attempt in itertools.count():
        table = sketch(kind, np.random.default_rng((SEED, case.index, attempt)), case.most)
        pushed = case.index // len(ARCH_KINDS) % 2 == 1
        for over in ("load",) if pushed else ("thickness", "load"):
            found = asked(table, over)
            if found is not None:
                return table, *found
    raise AssertionError


def asked(table: dict[str, Any], over: str) -> tuple[Family, float] | None:
    """Return the question about an arch and the exact answer; None where there is none."""
    try:
        problem = structure_of({**table, "live": PUSH} if over == "load" else table)
        family = family_of(problem, over)
        exact = family.exact()
        if exact is None or not RANGE[0] < exact < RANGE[1]:
            return None
        for side in (-1, 1):
            family.at(exact * (1 + side * ASIDE))
    except InputError:
        return None
    return family, exact


def ask(case: Case) -> Row:
    """Ask `direct` on both sides of limit analysis's answer."""
    table, family, exact = drawn(case)
    begin = time.process_time()
    row: Row = {
        "over": family.name,
        "stands": family.stands,
        "limit": exact,
        "arch": json.dumps(table),
        "reason": "",
    }
    for name, side in (("low", -1), ("high", 1)):
        seen = check(family.at(exact * (1 + side * ASIDE)), method="direct")
        row[name] = str(seen.verdict)
        if seen.verdict is not expected(family.stands, name):
            row["reason"] = seen.reason
    return row | {"cpu_s": round(time.process_time() - begin, 3)}


def expected(stands: object, end: str) -> Verdict:
    """Return what it has to do at an end of the interval around the limit."""
    return Verdict.STANDS if stands == end else Verdict.COLLAPSES


def main(out: Path, *, quick: bool = False, arches: int = ARCHES) -> Result:
    """Run the study, write its rows and return its numbers."""
    cases = [Case(index, 12) for index in range(14)] if quick else []
    cases = cases or [Case(index) for index in range(arches)]
    rows = answers(out / "random_kinds.jsonl", cases, ask, 1)
    with (out / "random_kinds.csv").open("w", newline="", encoding="utf-8") as file:
        written = csv.DictWriter(file, list(rows[0]))
        written.writeheader()
        written.writerows(rows)
    return summary(rows)


def summary(rows: list[Row]) -> Result:
    """Count what was answered."""
    said = [
        (row, row[end], expected(row["stands"], end)) for row in rows for end in ("low", "high")
    ]
    return Result(
        arches=len(rows),
        over=dict(Counter(str(row["over"]) for row in rows)),
        right=sum(verdict == want for _, verdict, want in said),
        false=sum(verdict not in {want, Verdict.UNDECIDED} for _, verdict, want in said),
        undecided={
            str(row["arch"]): str(row["reason"])
            for row, verdict, _ in said
            if verdict == Verdict.UNDECIDED
        },
        cpu_s=math.fsum(float(row["cpu_s"] or 0) for row in rows),
    )


if __name__ == "__main__":
    run(main)
