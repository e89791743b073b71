# pyright: basic
"""Blocks in space for tests: cases whose answers are known, towers, an own programme."""

from __future__ import annotations

import itertools
import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import linprog

import blocksim
from blocksim import Solid, SpatialProblem, Verdict
from blocksim.blocks.space.files import problem_in_space

CASES = Path(__file__).parent / "structures" / "space"
NAMES = sorted(path.stem for path in CASES.glob("*.json"))
GROUND = [[-9, -9, -1], [9, -9, -1], [-9, 9, -1], [9, 9, -1],
          [-9, -9, 0], [9, -9, 0], [-9, 9, 0], [9, 9, 0]]  # fmt: skip


@cache
def case(name: str) -> dict[str, Any]:
    """A case by its name, to be read only."""
    return json.loads((CASES / f"{name}.json").read_text(encoding="utf-8"))


def asked(name: str, beside: float) -> list[tuple[SpatialProblem, Verdict]]:
    """A case with its verdict, or at its load factor less and more by a share."""
    known = case(name)
    problem, value = problem_in_space(known["scene"]), known["expected"]["value"]
    if known["question"] == "stands":
        return [(problem, Verdict.STANDS if value else Verdict.COLLAPSES)]
    return [
        (problem.with_load(value * (1 - beside)), Verdict.STANDS),
        (problem.with_load(value * (1 + beside)), Verdict.COLLAPSES),
    ]


def box(low: tuple[float, ...], high: tuple[float, ...]) -> list[list[float]]:
    """Corners of a box."""
    return [list(each) for each in itertools.product(*zip(low, high, strict=True))]


def rotation(seed: int) -> np.ndarray:
    """A random rotation in space, (3, 3)."""
    turned, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return turned * np.sign(np.linalg.det(turned))


def tower(seed: int, *, blocks: int = 6, offset: float = 0.35) -> list[Solid]:
    """Boxes of random sizes upon each other, offset and turned about the vertical."""
    draw = np.random.default_rng(seed)
    solids = [Solid(parts=(GROUND,), fixed=True, name="ground")]
    height, at = 0.0, np.zeros(2)
    for index in range(blocks):
        half = draw.uniform(0.2, 0.6, 2)
        turn, tall = draw.uniform(0, math.pi), draw.uniform(0.1, 0.5)
        cos, sin = math.cos(turn), math.sin(turn)
        corners = np.array(list(itertools.product((-1, 1), (-1, 1)))) * half
        corners = corners @ np.array([[cos, sin], [-sin, cos]]) + at
        points = [[*xy, z] for z in (height, height + tall) for xy in corners.tolist()]
        solids.append(Solid(parts=(points,), name=str(index)))
        height += tall
        at = at + draw.uniform(-offset, offset, 2)
    return solids


def problem_of(solids: list[Solid], mu: float = 0.6, **known: Any) -> SpatialProblem:
    """A problem of solids, whose joints are found."""
    return SpatialProblem(assembly=blocksim.assembly_in_space(solids), mu=mu, **known)


def enclosed(problem: SpatialProblem, sides: int = 64) -> tuple[float, float]:
    """The load factor by linear programmes, with pyramids within and around each cone.

    Made of the joints' points alone, by other means than blocksim's.
    """
    assembly = problem.assembly
    columns, points = [], 0
    for joint, mu in zip(assembly.joints, problem.friction, strict=True):
        normal = joint.normal
        first = np.cross(normal, [0.3, -0.5, 0.81])
        first /= np.linalg.norm(first)
        second = np.cross(normal, first)
        for point in joint.points:
            points += 1
            for side in range(sides):
                angle = 2 * math.pi * side / sides
                way = math.cos(angle) * first + math.sin(angle) * second
                columns.append((joint, point, normal, mu * way))
    found: list[float] = []
    for grown in (1.0, 1 / math.cos(math.pi / sides)):
        matrix = np.zeros((6 * len(assembly.blocks), len(columns) + 1))
        for at, (joint, point, normal, across) in enumerate(columns):
            force = normal + grown * across
            for block, sign in ((joint.before, -1), (joint.after, 1)):
                if block >= 0:
                    arm = point - assembly.blocks[block].centre
                    matrix[6 * block : 6 * block + 3, at] += sign * force
                    matrix[6 * block + 3 : 6 * block + 6, at] += sign * np.cross(arm, force)
        matrix[:, -1] = problem.live_pull.ravel()
        cost = np.zeros(matrix.shape[1])
        cost[-1] = -1
        bounds = [(0, None)] * len(columns) + [(None, None)]
        right = -problem.fixed_pull.ravel()
        scale = float(assembly.weights.mean())
        done = linprog(cost, A_eq=matrix, b_eq=right / scale * 1.0, bounds=bounds)
        found.append(math.nan if done.status or done.x is None else float(done.x[-1]) * scale)
    return found[0], found[1]
