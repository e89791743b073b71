"""Random problems at the edges of what is asked: every verdict is held to its proof.

Random problems (`tests/random_problems.py`) and piles of boxes up to a million times unlike
each other are changed: their coordinates are rounded to 3 to 12 decimals, weights spread over
nine decades, joints get a friction of their own from 0 to without bound, and dead loads that
do not turn act off centre. Each verdict by limit analysis has to have a proof that
`blocksim.verify` accepts, which shares no code with what found it. Engines are asked about some
of few blocks, and held to what is proved.

`python -m analysis.random_proofs OUT` writes `random_proofs.csv.gz`, a row a problem. Rows are
kept in OUT/random_proofs.jsonl as they come, and not asked for again.
"""

from __future__ import annotations

import itertools
import json
import math
import time
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator

from analysis.command import run
from analysis.rows import write_rows
from analysis.saved_answers import answers
from blocksim import (
    Arch,
    Assembly,
    Block,
    CircularArch,
    InputError,
    Joint,
    Load,
    Problem,
    check,
)
from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.limit.proof import Proof, proof_record
from blocksim.verify import verify
from tests.random_problems import Case, drawn

SEED = 35
MOST = 16
"""Blocks of a problem, at most."""
EVERY = {"direct": 19, "pymunk": 97, "pybullet": 197, "mujoco": 199}
"""Of so many problems an engine is asked about one: primes, so that all kinds come."""
FEW = 6
"""Blocks of such a problem, at most."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """What was said of a problem, and whether its proof holds."""

    index: int
    kind: str
    blocks: int
    verdict: str
    proved: bool
    verified: bool
    margin: float
    seconds: float
    direct: str = ""
    pymunk: str = ""
    pybullet: str = ""
    mujoco: str = ""


def edge(index: int) -> tuple[str, Problem]:
    """Draw a problem at the edges of what is asked."""
    for attempt in itertools.count():
        random = np.random.default_rng((SEED, index, attempt))
        try:
            kind, problem = _begun(index, random)
            return kind, _changed(problem, random)
        except InputError:
            continue  # rounded away
    raise AssertionError


def _begun(index: int, random: Generator) -> tuple[str, Problem]:
    group = index % 4
    if group == 0:
        return "pile", pile(random)
    if group == 1 and random.random() < 0.3:
        arch = Arch(
            half_angle=math.radians(random.uniform(15, 160)),
            eta=float(10 ** random.uniform(-2, 0)),
            voussoirs=3,
        )
        return "three voussoirs", CircularArch.of(arch, _friction(random) or 0.5).problem()
    asked = drawn(Case(int(random.integers(10**6)), MOST))
    return asked.question.kind, asked.problem


def pile(random: Generator) -> Problem:
    """Boxes of 1 m to a thousandth of a millimetre, on the ground or on each other."""
    blocks, joints, tops = list[Block](), list[Joint](), [(SUPPORT, -1e3, 1e3, 0.0)]
    for index in range(int(random.integers(2, 12))):
        width, slender = 10 ** random.uniform(-6, 0), random.uniform(0.2, 4)
        below, left, right, low = tops[random.integers(len(tops))]
        # Each bears one at most: what stands beside another on it might meet it.
        if below != SUPPORT:
            tops.remove((below, left, right, low))
            x = random.choice([left, right]) + random.uniform(-0.7, 0.7) * width
            x = min(max(x, left - width / 3), right + width / 3)
        else:
            x = 3.0 * index
        start, end = max(left, x - width / 2), min(right, x + width / 2)
        if end - start < width / 100:
            continue
        height = width * slender
        corners = np.array(
            [[x - width / 2, low], [x + width / 2, low],
             [x + width / 2, low + height], [x - width / 2, low + height]]
        )  # fmt: skip
        mass = width * height
        blocks.append(
            Block(
                vertices=corners,
                centre=np.array([x, low + height / 2]),
                mass=mass,
                inertia=mass * (width**2 + height**2) / 12,
                depth=1.0,
            )
        )
        joints.append(
            Joint(
                before=below,
                after=len(blocks) - 1,
                inner=np.array([end, low]),
                outer=np.array([start, low]),
            )
        )
        tops.append((len(blocks) - 1, x - width / 2, x + width / 2, low + height))
    assembly = Assembly(blocks=tuple(blocks), joints=tuple(joints), size=1.0)
    problem = Problem(assembly=assembly, mu=float(random.uniform(0, 1)))
    return problem.tilted(float(random.choice([0.0, random.uniform(-0.6, 0.6)])))


def _friction(random: Generator) -> float:
    kind = random.random()
    if kind < 0.1:
        return 0.0
    return math.inf if kind < 0.25 else float(10 ** random.uniform(-2, 1))


def _changed(problem: Problem, random: Generator) -> Problem:
    """Round it, and change weights, friction and loads, each in one case of three."""
    assembly = problem.assembly
    blocks, joints = list(assembly.blocks), list(assembly.joints)
    if random.random() < 1 / 3:
        decimals = int(random.integers(3, 13))
        if min(np.ptp(each.vertices, axis=0).min() for each in blocks) > 20 * 10.0**-decimals:
            blocks = [_rounded(each, decimals) for each in blocks]
            joints = [
                replace(
                    each,
                    inner=np.round(each.inner, decimals),
                    outer=np.round(each.outer, decimals),
                )
                for each in joints
            ]
            joints = [each for each in joints if each.is_corner or each.length > 0]
    if random.random() < 1 / 3:
        heavy = 10 ** random.uniform(-9, 0, len(blocks))
        blocks = [
            replace(each, mass=each.mass * times, inertia=each.inertia * times)
            for each, times in zip(blocks, heavy.tolist(), strict=True)
        ]
    if random.random() < 1 / 3:
        joints = [replace(each, friction=_friction(random)) for each in joints]
    dead = list(problem.dead)
    if random.random() < 1 / 3:
        on = int(random.integers(len(blocks)))
        share = float(10 ** random.uniform(-3, 1)) * blocks[on].mass * 9.81
        angle = random.uniform(-math.pi, math.pi)
        corners: Array = blocks[on].vertices
        point = random.dirichlet(np.ones(len(corners))) @ corners
        force = share * np.array([math.cos(angle), math.sin(angle)])
        dead.append(Load(force=force, blocks=(on,), point=point))
    made = replace(assembly, blocks=tuple(blocks), joints=tuple(joints))
    return replace(problem, assembly=made, dead=tuple(dead), maker=None)


def _rounded(block: Block, decimals: int) -> Block:
    return replace(
        block,
        vertices=np.round(block.vertices, decimals),
        centre=np.round(block.centre, decimals),
        parts=tuple(np.round(part, decimals) for part in block.parts),
    )


def asked(index: int) -> Row:
    """Ask about a problem, and check the proof."""
    kind, problem = edge(index)
    started = time.process_time()
    found = check(problem, method="limit")
    proof = found.proof
    seconds = time.process_time() - started
    holds = proof is not None and is_accepted(proof) and proof.claim == found.verdict.value
    return Row(
        index=index,
        kind=kind,
        blocks=len(problem.assembly.blocks),
        verdict=found.verdict.value,
        proved=proof is not None,
        verified=holds,
        margin=math.nan if found.static is None else float(f"{found.static.margin:.3g}"),
        seconds=round(seconds, 4),
        **{name: _said(problem, name) for name in engines_of(index)},
    )


def is_accepted(proof: Proof) -> bool:
    """Tell whether the checker accepts a proof, as it is written to a file."""
    try:
        verify(json.loads(json.dumps(proof_record(proof))))
    except ValueError:
        return False
    return True


def engines_of(index: int) -> list[str]:
    """Return the engines that are asked about a problem, too."""
    return [name for name, every in EVERY.items() if index % every == every // 2]


def _said(problem: Problem, engine: str) -> str:
    """Return the verdict of an engine, `refused`, or nothing where there are many blocks."""
    if len(problem.assembly.blocks) > FEW:
        return ""
    try:
        return check(problem, method=engine).verdict.value
    except InputError:
        return "refused"


def main(out: Path, *, quick: bool = False, problems: int = 10_000) -> list[dict[str, Any]]:
    """Ask 10,000 problems, or 40; what engines are asked about comes last."""
    indices = sorted(range(40 if quick else problems), key=lambda at: (len(engines_of(at)), at))
    rows: list[dict[str, Any]] = answers(
        out / "random_proofs.jsonl", indices, lambda index: vars(asked(index)), 1
    )
    rows.sort(key=lambda row: row["index"])
    write_rows(out / "random_proofs.csv.gz", rows)
    return rows


def counted(rows: list[dict[str, Any]]) -> str:
    """Count what was said."""
    refused = sum(row["proved"] and not row["verified"] for row in rows)
    proved = sum(row["verified"] for row in rows)
    lines = [f"{len(rows)} asked, {proved} proved, {refused} refused: "
             f"{Counter(row['verdict'] for row in rows)}"]  # fmt: skip
    for name in EVERY:
        told = Counter(f"{row[name]} of {row['verdict']}" for row in rows if row[name])
        lines.append(f"{name}: {told}")
    return "\n".join(lines)


if __name__ == "__main__":
    run(main, counted)
