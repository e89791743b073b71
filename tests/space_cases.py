"""Blocks in space for tests: cases whose answers are known, towers, an own programme."""

import itertools
import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from scipy import sparse
from scipy.optimize import linprog

import blocksim
from blocksim import Problem, Solid, Verdict, structure_of

CASES = Path(__file__).parent / "structures" / "space"
NAMES = sorted(path.stem for path in CASES.glob("*.json"))
GROUND = [[-9, -9, -1], [9, -9, -1], [-9, 9, -1], [9, 9, -1],
          [-9, -9, 0], [9, -9, 0], [-9, 9, 0], [9, 9, 0]]  # fmt: skip


@cache
def case(name: str) -> dict[str, Any]:
    """A case by its name, to be read only."""
    return json.loads((CASES / f"{name}.json").read_text(encoding="utf-8"))


def asked(name: str, beside: float) -> list[tuple[Problem[Any], Verdict]]:
    """A case with its verdict, or at its load factor less and more by a share."""
    known = case(name)
    problem, value = structure_of(known["scene"]), known["expected"]["value"]
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


def is_over(solids: list[Solid]) -> bool:
    """Tell whether the centre of all that is above lies over each face of a tower."""
    corners = [np.asarray(each.parts[0]) for each in solids]
    bases = [shapely.MultiPoint(each[:, :2]).convex_hull for each in corners]
    volumes = np.array([b.area * np.ptp(c[:, 2]) for b, c in zip(bases, corners, strict=True)])
    places = np.array([base.centroid.coords[0] for base in bases])
    return all(
        bases[at]
        .intersection(bases[at - 1])
        .contains(shapely.Point(volumes[at:] @ places[at:] / volumes[at:].sum()))
        for at in range(1, len(solids))
    )


def problem_of(solids: list[Solid], mu: float = 0.6, **known: Any) -> Problem[Any]:
    """A problem of solids, whose joints are found."""
    return Problem(assembly=blocksim.assembly_in_space(solids), mu=mu, **known)


def enclosed(problem: Problem[Any], sides: int = 64) -> tuple[float, float]:
    """Enclose the load factor by linear programmes, with pyramids within and around each cone.

    Made of the joints' points alone, by other means than blocksim's: HiGHS, in units of each
    block's weight and reach. -inf where no forces balance, inf where nothing bounds it, nan
    where HiGHS does not tell.
    """
    assembly = problem.assembly
    weights, reach = assembly.weights, assembly.reach
    found: list[float] = []
    own = np.repeat(np.stack([weights, weights * reach], axis=1), 3, axis=1)
    live, dead = (
        (pull * assembly.units / own).ravel()
        for pull in (problem.live_forces, problem.with_load(0.0).applied_forces())
    )
    unit = float(np.abs(live).max())
    for grown in (1.0, 1 / math.cos(math.pi / sides)):
        columns: list[np.ndarray] = []
        for joint, mu in zip(assembly.joints, problem.friction, strict=True):
            forces = _ways(joint, mu, sides, grown)
            both = {joint.before: -1.0, joint.after: 1.0}
            least = min(weights[block] for block in both if block >= 0)
            for point in joint.points:
                column = np.zeros((len(forces), len(weights), 6))
                for block, sign in both.items():
                    if block >= 0:
                        arm = point - assembly.blocks[block].centre
                        wrench = np.hstack([forces, np.cross(arm, forces)])
                        column[:, block] = sign * least * wrench / own[block]
                columns.append(column.reshape(len(forces), -1))
        matrix = np.concatenate([*columns, live[None] / unit]).T
        cost = np.zeros(matrix.shape[1])
        cost[-1] = -1
        bounds = [(0, None)] * (len(cost) - 1) + [(None, None)]
        value = math.nan
        for method in ("highs-ds", "highs-ipm"):
            done = linprog(
                cost, A_eq=sparse.csr_array(matrix), b_eq=-dead, bounds=bounds, method=method
            )
            value = float(done.x[-1]) / unit if done.status == 0 else math.nan
            value = {2: -math.inf, 3: math.inf}.get(done.status, value)
            if not math.isnan(value):
                break
        found.append(value)
    return found[0], found[1]


def _ways(joint: Any, mu: float, sides: int, grown: float) -> np.ndarray:
    """Edges of a pyramid of forces at a point; without a bound on friction all ways across."""
    normal = joint.normal
    first = np.cross(normal, [0.3, -0.5, 0.81])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    if mu == 0:
        return normal[None]
    if math.isinf(mu):
        return np.stack([normal, first, -first, second, -second])
    turns = 2 * math.pi * np.arange(sides) / sides
    across = np.outer(np.cos(turns), first) + np.outer(np.sin(turns), second)
    return normal + grown * mu * across
