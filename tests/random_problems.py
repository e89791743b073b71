"""Random problems: arches, the shipped kinds, walls, assemblies.

A `Question` is a problem for each value of one parameter (thickness, load, tilt, friction,
overhang), and the value from which on it falls, or stands. `drawn` draws one.
"""

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from numpy.random import Generator

from blocksim import Arch, CircularArch, InputError, Load, Problem, equilibrium, structure_of
from blocksim.arch.limit import least_thickness
from blocksim.ask.families import family_of
from tests.assemblies import KINDS as ASSEMBLIES
from tests.assemblies import sketch

SEED = 22
ARCH_KINDS = (
    *("circular-arch", "pointed-arch", "elliptic-arch", "parabolic-arch", "catenary-arch"),
    *("basket-handle-arch", "flat-arch"),
)
OTHER_KINDS = ("portal", "arcade", "wall", "column", "stack", "rubble", "wall")
"""Walls are drawn twice as often."""
GROUPS = ("ring", "arch") * 5 + ("kind",) * 5 + ("assembly",) * 5
"""What the problems are of, in turn: arches of the map, other arches, kinds, polygons."""
STEEPEST = 85.0
"""Largest tilt that is asked about [deg]."""
RANGES = {
    "thickness": (1e-3, 10.0), "load": (1e-3, 1e3), "tilt": (0.1, STEEPEST), "mu": (0.02, 5.0),
    "overhang": (1e-3, 1e3),
}  # fmt: skip
"""Values that are taken: others mean that next to nothing, or all, can be borne."""
OVER = {"load": 0.6, "tilt": 0.27, "mu": 0.13}
"""Parameters that any problem has, and how often they are asked about."""


@dataclass(frozen=True, kw_only=True)
class Question:
    """A problem for each value of a parameter.

    Parameters
    ----------
    kind, over : str
        What it is of, and the parameter.
    at : callable
        Value to problem.
    critical : float
        The value at which it changes.
    stands : {"low", "high"}
        To which side of that it stands.
    known : str
        Where the critical value comes from, if not from the linear programme.
    arch : callable or None
        Value to arch, where it is one of the map.
    """

    kind: str
    over: str
    at: Callable[[float], Problem]
    critical: float
    stands: Literal["low", "high"]
    known: str = ""
    arch: Callable[[float], tuple[Arch, float]] | None = None


@dataclass(frozen=True)
class Case:
    """The `index`-th problem, of at most about so many blocks."""

    index: int
    most: int = 40


@dataclass(frozen=True, kw_only=True)
class Asked:
    """A question at one value: its ratio to the critical one, and on which side it stands."""

    question: Question
    ratio: float
    problem: Problem
    stands: bool

    @property
    def arch(self) -> tuple[Arch, float] | None:
        """The arch of the map that is asked about and its friction; None for anything else."""
        question = self.question
        return question.arch and question.arch(self.ratio * question.critical)


@lru_cache(maxsize=8)
def drawn(case: Case) -> Asked:
    """Draw a problem at a ratio of its critical value: 0.1 % from it in one case of five."""
    ratio = _ratio(np.random.default_rng((SEED, case.index)))
    for attempt in itertools.count():
        random = np.random.default_rng((SEED, case.index, attempt))
        try:
            question = _question(case, random)
            if question is None:
                continue
            value = ratio * question.critical
            if question.over == "tilt" and value > STEEPEST:
                continue
            problem = question.at(value)
        except InputError:
            continue  # parameters that do not go together, or a value out of range
        if len(problem.assembly.blocks) > case.most:
            continue
        stands = (ratio < 1) == (question.stands == "low")
        return Asked(question=question, ratio=ratio, problem=problem, stands=stands)
    raise AssertionError


def _ratio(random: Generator) -> float:
    aside = 1e-3 if random.random() < 0.2 else None
    if random.random() < 0.5:
        return 1 - (aside or float(10 ** random.uniform(-3, math.log10(0.5))))
    return 1 + (aside or float(10 ** random.uniform(-3, 0)))


def _question(case: Case, random: Generator) -> Question | None:
    turn, place = divmod(case.index, len(GROUPS))
    group = GROUPS[place]
    if group == "ring":
        return _ring(random, case.most)
    if group == "assembly":
        kind = _among(tuple(ASSEMBLIES), turn + place)
        problem = sketch(kind, random).problem()
        return _over(problem, f"random {kind}", random)
    if group == "arch":
        kind = _among(ARCH_KINDS, turn + place // 2)
        table = arch_table(kind, random, case.most)
        over = "thickness" if random.random() < 0.1 else ""
    else:
        kind = _among(OTHER_KINDS, turn + place)
        table, over = _structure(kind, random, case.most), ""
        if kind == "stack" and table["pattern"] in {"harmonic", "even"}:
            over = str(random.choice(["overhang", "load", "mu"]))
    problem = structure_of(table)
    if over == "overhang":
        return _stack(problem, table)
    if over == "thickness":
        return _family(problem, kind, over)
    return _over(_loaded(problem, random), kind, random)


def _among(names: tuple[str, ...], turn: int) -> str:
    """Take each in turn: one that is often drawn anew is not asked about less often."""
    return names[turn % len(names)]


def _ring(random: Generator, most: int) -> Question | None:
    """Draw an arch of the map; its least thickness is that of the statics of voussoirs."""
    half_angle = math.radians(random.uniform(20, 159))
    voussoirs = int(random.integers(3, most + 1))
    weight = "centreline" if random.random() < 0.5 else "sector"
    mu = math.inf if random.random() < 0.15 else math.exp(random.uniform(math.log(0.2), 1.2))
    eta = least_thickness(half_angle, mu, voussoirs, weight).eta
    if not eta or eta < RANGES["thickness"][0]:
        return None

    def arch(value: float) -> tuple[Arch, float]:
        made = Arch(half_angle=half_angle, eta=value, voussoirs=voussoirs, weight=weight)
        return made, mu

    return Question(
        kind="arch of the map",
        over="thickness",
        at=lambda value: CircularArch.of(arch(value)[0], mu).problem(),
        critical=eta,
        stands="high",
        known="statics",
        arch=arch,
    )


def arch_table(kind: str, random: Generator, most: int) -> dict[str, Any]:
    """Draw the parameters of an arch, of which some may not go together."""
    between, choice = random.uniform, random.choice
    table: dict[str, Any] = {
        "kind": kind,
        "voussoirs": int(random.integers(3, most // 2)) * 2 + int(kind == "flat-arch"),
        "friction": _friction(random),
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
    if random.random() < 0.25:
        table["fill"] = round(float(between(0, 0.5)), 3)
    return table


def _friction(random: Generator) -> float | str:
    return "inf" if random.random() < 0.15 else round(float(random.uniform(0.25, 1.5)), 3)


def _structure(kind: str, random: Generator, most: int) -> dict[str, Any]:
    """Draw the parameters of what is no arch alone."""
    between, whole = random.uniform, random.integers
    few = max(2, most // 8)
    table: dict[str, Any] = {"kind": kind, "friction": _friction(random)}
    match kind:
        case "portal" | "arcade":
            table |= {
                "arch": {
                    "kind": str(random.choice(["circular-arch", "elliptic-arch"])),
                    "voussoirs": 2 * int(whole(2, few + 2)),
                    "thickness": between(0.1, 0.3),
                },
                "pier_width": between(0.4, 1.2),
                "pier_height": between(0.3, 2.0),
                "pier_courses": int(whole(1, few)),
            }
        case "wall":
            table |= {
                "length": between(1.0, 2.4),
                "courses": int(whole(2, 3 + few)),
                "block_height": between(0.1, 0.4),
                "bond": between(0.25, 0.75),
            }
            if random.random() < 0.3:
                left = between(0.2, 0.6)
                table["openings"] = [{"left": left, "right": left + between(0.2, 0.5)}]
        case "column":
            table |= {"drums": int(whole(1, 12)), "drum_height": between(0.2, 1.0)}
            if random.random() < 0.5:
                table["top_width"] = between(0.5, 1.2)
        case "stack":
            patterns = ["harmonic", "even", "inverted-triangle", "diamond"]
            table |= {
                "pattern": str(random.choice(patterns)),
                "rows": int(whole(2, few + 3)),
                "height": between(0.1, 0.6),
                "overhang": between(0.05, 0.6),
            }
        case _:
            table |= {
                "width": between(1.0, 3.0),
                "stones": int(whole(4, most)),
                "seed": int(whole(1e9)),
            }
    return table


def _loaded(problem: Problem, random: Generator) -> Problem:
    """Put a live load on: a push of all blocks to one side, or a force at a corner of one."""
    blocks = problem.assembly.blocks
    if random.random() < 0.6:
        push = Load(
            force=np.array([random.choice([-1.0, 1.0]), 0.0]),
            blocks=tuple(range(len(blocks))),
            per_weight=True,
        )
        return replace(problem, live=(push,))
    on = int(random.integers(len(blocks)))
    angle = random.uniform(-math.pi, math.pi)
    force = problem.unit_force * np.array([math.cos(angle), math.sin(angle)])
    corner = blocks[on].vertices[random.integers(len(blocks[on].vertices))]
    return replace(problem, live=(Load(force=force, blocks=(on,), point=corner),))


def _over(problem: Problem, kind: str, random: Generator) -> Question | None:
    """Ask about load, tilt or friction, of what rests as it is."""
    if not equilibrium(problem).exists:
        return None
    over = str(random.choice(list(OVER), p=list(OVER.values())))
    plain = problem if over == "load" else replace(problem, live=())
    table = {} if plain.maker is None else plain.maker.table()
    if over == "tilt" and table.get("kind") == "column" and table.get("top_width") is None:
        return _column(plain, table)
    return _family(plain, kind, over)


def _family(problem: Problem, kind: str, over: str) -> Question | None:
    """Ask about a parameter whose critical value the linear programme says."""
    family = family_of(problem, over)
    critical = family.exact()
    low, high = RANGES[over]
    if critical is None or not low < critical < high:
        return None
    return Question(kind=kind, over=over, at=family.at, critical=critical, stands=family.stands)


def _column(problem: Problem, table: Any) -> Question | None:
    """Ask about the tilt of a column as wide everywhere: it slides, or tips over its edge."""
    slender = float(table["width"]) / (int(table["drums"]) * float(table["drum_height"]))
    return Question(
        kind="column",
        over="tilt",
        at=lambda value: problem.tilted(math.radians(value)),
        critical=math.degrees(math.atan(min(problem.mu, slender))),
        stands="low",
        known="closed form",
    )


def _stack(problem: Problem, table: Any) -> Question | None:
    """Ask about the overhang of a stack: each part's weight over the edge below it."""
    rows = int(table["rows"])
    if table["pattern"] == "harmonic":
        most = sum(1 / row for row in range(1, rows + 1)) / 2
    else:
        most = rows / (rows + 1)
    found = family_of(problem, "overhang")
    return Question(
        kind="stack", over="overhang", at=found.at, critical=most, stands="low",
        known="closed form",
    )  # fmt: skip
