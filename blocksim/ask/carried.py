"""What a structure carries, by what its maker knows of it or by linear programmes."""

from __future__ import annotations

from blocksim.blocks.problem import Problem
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.kinds.offers import offers_of
from blocksim.limit.carried import Carried, carried_by
from blocksim.limit.crushing import Needed


def carried_of(
    problem: Problem | SpatialProblem,
    joint: int | None = None,
    needed: Needed | None = None,
) -> Carried | None:
    """Find what anything carries, an arch under its own weight by its own statics.

    None in space, and where gravity leans out of the plane, or the ground shakes: statics in
    the plane do not tell what happens then.

    Parameters
    ----------
    problem : Problem or SpatialProblem
    joint : int, optional
        Where thrust is told; by default the crown.
    needed : Needed, optional
        The least strength of blocks that crush.
    """
    if not isinstance(problem, Problem) or not problem.has_statics:
        return None
    offered = offers_of(problem)
    own = None if offered is None else offered.carried(joint)
    return own or carried_by(problem, joint, needed)
