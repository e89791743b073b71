"""Random assemblies by `direct` against the linear programme, at the load it says they fall.

Question: does simulation stand just below the load factor of the linear programme, and fall
just above, for any blocks? Walls with openings, stacks, leaning blocks (contacts of corners),
unsymmetric and chipped arches with fill, rubble, columns, trilithons and portals are drawn
(`assemblies.py`) under a horizontal body force or a point load; those that rest without it and
fall at some factor are asked about at 1 % less and 1 % more: by the onset test, every fifth by
a moving run, too.

Expected: no false verdict; what is undecided is counted, with its reason. The programme itself
is held to what it has to fulfil, by sums made anew here (`residuals`). 40 assemblies mirrored,
turned with gravity, scaled and renumbered must have the same load factor and verdicts.

    python -m analysis.random_assemblies OUT [--processes N] [--quick]

Answers are kept in OUT as they come, and not asked for again; `random_assemblies.csv` has them.
"""

from __future__ import annotations

import csv
import itertools
import math
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.assemblies import KINDS, Sketch, running_bond, sketch
from analysis.command import run
from analysis.saved_answers import Row, answers
from blocksim.blocks.assembly import SUPPORT
from blocksim.blocks.problem import Problem
from blocksim.limit import Collapse, collapse, equilibrium
from blocksim.simulation.observation import observe
from blocksim.simulation.verdict import Verdict
from blocksim.view.style import FONT, QUIET, VERDICTS

SEED = 2026
SHARE = 0.01
"""How far below and above the load factor is asked."""
RANGE = 1e-3, 1e3
"""Load factors that are taken: others mean that next to nothing, or all, can be borne."""
LET_GO, CHANGED = 5, 5
"""One assembly in so many is let go, or mirrored and so on."""
QUICK = (0, 1, 5, 7, 9, 11, 12, 13, 19, 21, 22, 23)
"""Small ones whose contacts are all of faces, for a quick run."""
WALLS = {60: (10, 6), 200: (16, 12), 500: (25, 20)}
"""Courses and bricks of walls that are timed, by about how many blocks they have."""
MOST_ABOVE = 200
"""Blocks up to which it is asked above the load factor, too."""


@dataclass(frozen=True)
class Case:
    """The `index`-th assembly; `change` says what is done to it."""

    index: int
    change: str = ""
    let_go: bool = False


@dataclass(frozen=True)
class Residuals:
    """What the answer of the linear programme leaves of what it has to fulfil.

    Parameters
    ----------
    imbalance : float
        Largest force or moment left on a block [mean weights].
    outside : float
        How far a force lies outside its cone [mean weights].
    overlap : float
        Largest rate at which a joint's end closes or, with slip, opens less than friction
        times slip [largest rate of a block].
    power : float
        Power of all loads in the mechanism, over that of the live ones.
    loss : float
        Largest power of a contact force in the mechanism, over that of the live loads.
    """

    imbalance: float
    outside: float
    overlap: float
    power: float
    loss: float


@dataclass(frozen=True)
class Result:
    """Headline numbers: of the assemblies, of those changed, and of the walls."""

    assemblies: int
    right: int
    false: int
    undecided: dict[str, int]
    let_go: int
    let_go_right: int
    worst: Residuals
    changed: int
    changed_same: int
    worst_change: float
    walls: tuple[Row, ...]


@cache
def drawn(index: int) -> Sketch:
    """Draw the `index`-th assembly: one that rests, and falls at some load factor."""
    kind = list(KINDS)[index % len(KINDS)]
    for attempt in itertools.count():
        found = sketch(kind, np.random.default_rng((SEED, index, attempt)))
        problem = found.problem()
        if not equilibrium(problem).exists:
            continue
        factor = collapse(problem).load_factor
        if factor is not None and RANGE[0] < factor < RANGE[1]:
            return found
    raise AssertionError


def changed(found: Sketch, change: str, seed: int) -> Sketch:
    """Mirror, turn, scale or renumber a sketch."""
    match change:
        case "mirrored":
            return found.mirrored()
        case "rotated":
            return found.rotated(np.random.default_rng(seed).uniform(-math.pi, math.pi))
        case "small":
            return found.scaled(0.01)
        case "large":
            return found.scaled(100.0)
        case "renumbered":
            return found.renumbered(seed)
        case _:
            return found


CHANGES = ("mirrored", "rotated", "small", "large", "renumbered")


def residuals(problem: Problem, found: Collapse) -> Residuals:
    """Hold forces and mechanism to their laws, joint by joint and end by end."""
    assembly, factor = problem.assembly, found.load_factor
    if found.forces is None or found.mechanism is None or factor is None:
        return Residuals(math.inf, math.inf, math.inf, math.inf, math.inf)
    size = assembly.size
    dead = problem.with_load(0.0).pull()
    live = problem.with_load(1.0).pull() - dead
    left, rates = dead + factor * live, found.mechanism
    power = float((live * rates).sum())
    outside = overlap = loss = 0.0
    for joint, mu, ends in zip(assembly.joints, problem.friction, found.forces, strict=True):
        for point, (pressure, friction) in zip((joint.inner, joint.outer), ends, strict=True):
            force = pressure * joint.normal + friction * joint.tangent
            apart = np.zeros(2)
            for sign, block in ((1.0, joint.after), (-1.0, joint.before)):
                if block == SUPPORT:
                    continue
                x, y = (point - assembly.blocks[block].centre) / size
                left[block] += sign * np.array([*force, x * force[1] - y * force[0]])
                turn = rates[block, 2]
                apart += sign * (rates[block, :2] + turn * np.array([-y, x]))
            opens, slips = float(apart @ joint.normal), abs(float(apart @ joint.tangent))
            bound = mu * pressure if mu < math.inf else math.inf
            outside = max(outside, -pressure, abs(friction) - bound)
            # By normality a joint that slips opens, and one without slip only opens.
            overlap = max(overlap, slips if mu == math.inf else mu * slips - opens, -opens)
            loss = max(loss, abs(float(force @ apart)))
    total = float(((dead + factor * live) * rates).sum())
    return Residuals(
        imbalance=float(np.abs(left).max()),
        outside=outside,
        overlap=overlap,
        power=abs(total) / power if power > 0 else math.inf,
        loss=loss / power if power > 0 else math.inf,
    )


def ask(case: Case) -> Row:
    """Ask the linear programme and `direct` about one assembly."""
    found = changed(drawn(case.index), case.change, case.index)
    problem = found.problem()
    started = time.process_time()
    most = collapse(problem)
    row: Row = {
        "index": case.index,
        "kind": found.kind,
        "change": case.change,
        "blocks": len(problem.assembly.blocks),
        "joints": len(problem.assembly.joints),
        "corners": sum(joint.is_corner for joint in problem.assembly.joints),
        "mu": found.mu,
        "own": len(found.own),
        "live": "body" if found.on is None else "point",
        "load_factor": most.load_factor,
        "limit_s": time.process_time() - started,
    }
    left = residuals(problem, most)
    row |= {each.name: getattr(left, each.name) for each in fields(left)}
    row |= verdicts(problem, most.load_factor or 0.0, let_go=case.let_go)
    return row


def verdicts(
    problem: Problem,
    factor: float,
    *,
    let_go: bool,
    sides: tuple[str, ...] = ("below", "above"),
) -> Row:
    """Ask `direct` on both sides of a load factor."""
    row: Row = {}
    for side in sides:
        sign = 1 if side == "above" else -1
        loaded = problem.with_load(factor * (1 + sign * SHARE))
        started = time.process_time()
        answer = observe(loaded, "direct", moving=let_go)
        row[side] = answer.onset.verdict
        row[f"{side}_reason"] = answer.reason if answer.verdict is Verdict.UNDECIDED else ""
        row[f"{side}_let_go"] = answer.motion.verdict if answer.motion else ""
        row[f"{side}_s"] = time.process_time() - started
    return row


def wall(blocks: int) -> Problem:
    """Return a wall of about so many blocks under a horizontal body force."""
    polygons = running_bond(*WALLS[blocks])
    plain = Sketch(
        kind="wall",
        polygons=tuple(polygons),
        fixed=frozenset({0}),
        mu=0.6,
        own={},
        gravity=np.array([0.0, -1.0]),
        force=np.array([1.0, 0.0]),
    )
    return plain.problem()


def time_wall(blocks: int) -> Row:
    """Time the linear programme, and the onset test on both sides of its load factor."""
    problem = wall(blocks)
    started = time.process_time()
    found = collapse(problem)
    row: Row = {
        "blocks": len(problem.assembly.blocks),
        "joints": len(problem.assembly.joints),
        "load_factor": found.load_factor,
        "limit_s": time.process_time() - started,
    }
    # Above it, `direct` takes a hundred times longer, and more than blocks squared.
    sides = ("below", "above") if blocks <= MOST_ABOVE else ("below",)
    return row | verdicts(problem, found.load_factor or 0.0, let_go=False, sides=sides)


RIGHT = {"below": Verdict.STANDS, "above": Verdict.COLLAPSES}


def outcome(row: Row, side: str, asked: str = "") -> str:
    """Tell whether an answer is right, false or undecided."""
    said = row[side + asked]
    if said == Verdict.UNDECIDED:
        return "undecided"
    return "right" if said == RIGHT[side] else "false"


def main(
    out: Path, *, quick: bool = False, assemblies: int = 200, processes: int = 1
) -> Result:
    """Run the study, write its rows and figure and return its numbers."""
    chosen = QUICK if quick else range(assemblies)
    plain = [Case(index, let_go=index % LET_GO == 0) for index in chosen]
    others = [Case(index, change) for index in chosen[::CHANGED] for change in CHANGES]
    others = others[: 5 if quick else None]
    rows = answers(out / "random_assemblies.jsonl", [*plain, *others], ask, processes)
    sizes = [60] if quick else list(WALLS)
    walls = answers(out / "random_assemblies_walls.jsonl", sizes, time_wall, 1)
    _write(rows, out / "random_assemblies.csv")
    asked, after = rows[: len(plain)], rows[len(plain) :]
    _figure(asked, after, out / "random_assemblies.png")
    return _summary(asked, after, walls)


def _summary(asked: Sequence[Row], after: Sequence[Row], walls: Sequence[Row]) -> Result:
    sides = [(row, side) for row in asked for side in RIGHT]
    told = Counter(outcome(row, side) for row, side in sides)
    let_go = [(row, side) for row, side in sides if row[f"{side}_let_go"]]
    for row, side in sides:
        bad = outcome(row, side) != "right"
        bad |= bool(row[f"{side}_let_go"]) and outcome(row, side, "_let_go") != "right"
        if bad:
            sys.stderr.write(f"{side}: {row}\n")
    errors = changes(asked, after)
    return Result(
        assemblies=len(asked),
        right=told["right"],
        false=told["false"],
        undecided=Counter(
            str(row["kind"]) for row, side in sides if outcome(row, side) == "undecided"
        ),
        let_go=len(let_go),
        let_go_right=sum(outcome(row, side, "_let_go") == "right" for row, side in let_go),
        worst=Residuals(
            *(max(float(row[each.name] or 0) for row in asked) for each in fields(Residuals))
        ),
        changed=len(after),
        changed_same=sum(same for _, same in errors),
        worst_change=max((error for error, _ in errors), default=0.0),
        walls=tuple(walls),
    )


def changes(asked: Sequence[Row], after: Sequence[Row]) -> list[tuple[float, bool]]:
    """Compare load factors (relative) and verdicts of what was changed with what was not."""
    plain = {row["index"]: row for row in asked}
    found: list[tuple[float, bool]] = []
    for row in after:
        was = plain[row["index"]]
        factor = float(was["load_factor"] or 0)
        error = abs(float(row["load_factor"] or 0) / factor - 1)
        same = all(row[side] == was[side] for side in RIGHT)
        if not same or error > 1e-9:
            sys.stderr.write(f"changed by {error:.1e}: {row}\n")
        found.append((error, same))
    return found


def _write(rows: Sequence[Row], path: Path) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        table.writeheader()
        for row in rows:
            table.writerow(
                {k: f"{v:.12g}" if isinstance(v, float) else v for k, v in row.items()}
            )


def _figure(asked: Sequence[Row], after: Sequence[Row], path: Path) -> None:
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(9, 4), layout="constrained")
        left, right = figure.subplots(1, 2)
        kinds = list(KINDS)
        for verdict in Verdict:
            for shift, side in ((0.2, "below"), (-0.2, "above")):
                counts = [
                    sum(row["kind"] == kind and row[side] == verdict for row in asked)
                    for kind in kinds
                ]
                start = [
                    sum(
                        row["kind"] == kind
                        and list(Verdict).index(Verdict(str(row[side])))
                        < list(Verdict).index(verdict)
                        for row in asked
                    )
                    for kind in kinds
                ]
                left.barh(
                    np.arange(len(kinds)) + shift,
                    counts,
                    0.36,
                    left=start,
                    color=VERDICTS[verdict],
                    label=str(verdict) if side == "below" else None,
                )
        left.set_yticks(range(len(kinds)), kinds)
        left.invert_yaxis()
        left.set_xlabel("assemblies: upper bars 1 % above, lower 1 % below the load factor")
        left.set_title("What direct says")
        left.legend(fontsize=7, ncols=3, loc="upper center", bbox_to_anchor=(0.5, -0.16))
        floor = 1e-17
        blocks = [float(row["blocks"] or 0) for row in asked]
        right.plot(
            blocks, [max(floor, float(row["power"] or 0)) for row in asked], "o", ms=3,
            color="#0072B2", label="of the mechanism against that of the forces",
        )  # fmt: skip
        right.plot(
            [float(row["blocks"] or 0) for row in after],
            [max(floor, error) for error, _ in changes(asked, after)], "^", ms=3,
            color="#D55E00", label="mirrored, turned, scaled, renumbered",
        )  # fmt: skip
        right.axhline(1e-9, color=QUIET, lw=0.8)
        right.set_yscale("log")
        right.set_xlabel("blocks")
        right.set_title("Load factor: relative difference")
        right.legend(fontsize=7)
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=150)


if __name__ == "__main__":
    run(main)
