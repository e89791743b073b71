"""Proofs that blocks can rest or must fall, found and checked by plain statics.

Nothing here comes from `blocksim.limit`: the programme is put up anew, in metres and newtons,
and what its solver returns is not believed but checked, force by force and end by end.

- **They can rest**: forces at the ends of all joints, which press, lie in their cones of
  friction and balance all loads. Rest is then a solution of Newton's and Coulomb's laws.
- **They must fall**: velocities at which the loads have power, although no joint's end closes,
  and each opens at least by the friction times its slip. By virtual work no forces within the
  cones can balance the loads then (Farkas' lemma), whatever law the slip follows. The blocks
  need not move like that.

That they can rest does not prove that they must, where joints slide.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

from blocksim import Problem

LEFT = 1e-7
"""Force that may be left unbalanced on a block, over the mean weight."""
FARTHEST = 1e4
"""Contact forces, over the weight of all, up to which it has to be proved that none hold."""


@dataclass(frozen=True)
class Certificate:
    """What is proved of a problem.

    Parameters
    ----------
    stands : bool or None
        Whether forces of equilibrium exist; None where neither proof holds.
    left : float
        What the proof leaves open. Of forces: the largest part that is not balanced, over
        the mean weight. Of velocities: the weight of all over the sum of contact forces below
        which none can balance the loads.
    """

    stands: bool | None
    left: float


def certificate(problem: Problem) -> Certificate:
    """Prove that a problem in its plane can rest, or that it must fall."""
    loads, edges = loads_on(problem), cone_edges(problem)
    matrix = balance(problem, edges)
    rows, columns = matrix.shape
    # The least sum of forces that would have to be added: its prices are velocities.
    slack = np.eye(rows)
    free = np.array([edge.both_ways for edge in edges])
    bounds = [(None if each else 0.0, None) for each in free] + [(0.0, None)] * (2 * rows)
    found = linprog(
        np.concatenate([np.zeros(columns), np.ones(2 * rows)]),
        A_eq=np.hstack([matrix, slack, -slack]),
        b_eq=-loads,
        bounds=bounds,
        method="highs-ds",
    )
    if found.x is None:
        return Certificate(None, math.inf)
    left = unbalanced(matrix, loads, found.x[:columns], free)
    if left <= LEFT:
        return Certificate(True, left)
    reach = needed(matrix, loads, -found.eqlin.marginals, free)
    return Certificate(False if reach <= 1 / FARTHEST else None, reach)


@dataclass(frozen=True, eq=False)
class Edge:
    """A force that an end of a joint can carry: one edge of its cone of friction.

    Parameters
    ----------
    joint : int
    point, force : (2,) float
        Where it acts [m], and as it acts on the block after the joint [mean weights].
    both_ways : bool
        Friction without bound: it may act either way.
    """

    joint: int
    point: np.ndarray
    force: np.ndarray
    both_ways: bool = False


def cone_edges(problem: Problem) -> list[Edge]:
    """Return the edges of the cones at all ends of joints; their largest part is one."""
    edges: list[Edge] = []
    for index, joint in enumerate(problem.assembly.joints):
        mu = problem.mu if joint.friction is None else joint.friction
        for point in (joint.inner, joint.outer):
            if math.isinf(mu):
                edges.append(Edge(index, point, joint.normal))
                edges.append(Edge(index, point, joint.tangent, both_ways=True))
                continue
            for sign in (1, -1) if mu > 0 else (1,):
                force = (joint.normal + sign * mu * joint.tangent) / max(1.0, mu)
                edges.append(Edge(index, point, force))
    return edges


def balance(problem: Problem, edges: list[Edge]) -> np.ndarray:
    """Return what each edge does: force x, y and moment on each block, (3 blocks, edges).

    Moments are about the blocks' centres, divided by the size of the whole.
    """
    assembly = problem.assembly
    matrix = np.zeros((len(assembly.blocks), 3, len(edges)))
    for column, edge in enumerate(edges):
        joint = assembly.joints[edge.joint]
        for block, sign in ((joint.after, 1.0), (joint.before, -1.0)):
            if block >= 0:
                x, y = (edge.point - assembly.blocks[block].centre) / assembly.size
                force = sign * edge.force
                matrix[block, :, column] += [*force, x * force[1] - y * force[0]]
    return matrix.reshape(-1, len(edges))


def loads_on(problem: Problem) -> np.ndarray:
    """Return force x, y and moment of all loads on each block, (3 blocks,), units as above."""
    blocks = problem.assembly.blocks
    weights = np.array([block.mass * 9.81 for block in blocks])
    found = np.zeros((len(blocks), 3))
    found[:, :2] = weights[:, None] * problem.gravity[:2]
    for factor, loads in ((1.0, problem.dead), (problem.load, problem.live)):
        for load in loads:
            for block in load.blocks:
                force = factor * load.force * (weights[block] if load.per_weight else 1.0)
                found[block, :2] += force
                if load.point is not None and not load.per_weight:
                    x, y = (load.point - blocks[block].centre) / problem.assembly.size
                    found[block, 2] += x * force[1] - y * force[0]
    return found.ravel() / weights.mean()


def unbalanced(
    matrix: np.ndarray, loads: np.ndarray, parts: np.ndarray, free: np.ndarray
) -> float:
    """Return the largest part of the loads that forces along the edges leave.

    Parameters
    ----------
    matrix : (3 blocks, edges) float
    loads : (3 blocks,) float
    parts : (edges,) float
        How much of each edge: what pulls is left out, so that all lie in their cones.
    free : (edges,) bool
        Edges that act both ways.
    """
    held = np.where(free, parts, np.maximum(parts, 0.0))
    return float(np.abs(matrix @ held + loads).max())


def needed(matrix: np.ndarray, loads: np.ndarray, rates: np.ndarray, free: np.ndarray) -> float:
    """Return the weight of all over the sum of contact forces that it takes to hold blocks.

    By virtual work forces in equilibrium have as much power on any velocities as the loads, the
    other way. On joints that close nowhere they have none: on ones that close by round-off it
    takes large forces. 0 where no forces at all can hold the blocks; inf where the loads have
    no power.

    Parameters
    ----------
    matrix, loads, free
        As of `unbalanced`.
    rates : (3 blocks,) float
        Velocities x, y and rotation of each block.
    """
    power = float(loads @ rates)
    if power <= 0:
        return math.inf
    along = matrix.T @ rates
    closing = np.where(free, np.abs(along), np.maximum(-along, 0.0)).max(initial=0.0)
    blocks = len(loads) // 3
    return float(closing * blocks / power)
