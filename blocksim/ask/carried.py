"""What a structure carries, by what its maker knows of it or by linear programmes."""

from __future__ import annotations

from blocksim.arch.carried import carried_by_arch
from blocksim.blocks.problem import Problem
from blocksim.kinds.circular import is_plain_arch, plain_arch
from blocksim.limit.carried import Carried, carried_by


def carried_of(problem: Problem, joint: int | None = None) -> Carried | None:
    """Find what anything carries, an arch under its own weight by its own statics.

    None where gravity leans out of the plane, or the ground shakes: statics in the plane do
    not tell what happens then.

    Parameters
    ----------
    problem : Problem
    joint : int, optional
        Where thrust is told; by default the crown.
    """
    if not problem.is_planar or problem.shaking is not None:
        return None
    arch = plain_arch(problem)
    if arch is not None and is_plain_arch(problem):
        return carried_by_arch(arch, problem, joint)
    return carried_by(problem, joint)
