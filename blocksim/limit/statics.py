"""Limit analysis of any problem: by linear programmes in the plane, by cones in space."""

from __future__ import annotations

from typing import TYPE_CHECKING, overload

from blocksim.blocks.problem import Problem
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.common.checks import require
from blocksim.limit.capacity import collapse as collapse_in_plane
from blocksim.limit.programme import equilibrium as equilibrium_in_plane

if TYPE_CHECKING:
    from blocksim.limit.capacity import Collapse
    from blocksim.limit.programme import Equilibrium
    from blocksim.limit.space import SpatialCollapse, SpatialEquilibrium


@overload
def equilibrium(problem: Problem) -> Equilibrium: ...
@overload
def equilibrium(problem: SpatialProblem) -> SpatialEquilibrium: ...
@overload
def equilibrium(problem: Problem | SpatialProblem) -> Equilibrium | SpatialEquilibrium: ...
def equilibrium(problem: Problem | SpatialProblem) -> Equilibrium | SpatialEquilibrium:
    """Find forces of equilibrium, all as far inside their cones of friction as possible.

    Parameters
    ----------
    problem : Problem or SpatialProblem

    Returns
    -------
    Equilibrium or SpatialEquilibrium
        See `blocksim.limit.programme` and `blocksim.limit.space`.
    """
    if isinstance(problem, Problem):
        return equilibrium_in_plane(problem)
    # Cones are loaded where they are asked for.
    from blocksim.limit.space import can_rest

    return can_rest(problem)


@overload
def collapse(problem: Problem, *, strength: float | None = None) -> Collapse: ...
@overload
def collapse(problem: SpatialProblem) -> SpatialCollapse: ...
@overload
def collapse(
    problem: Problem | SpatialProblem, *, strength: float | None = None
) -> Collapse | SpatialCollapse: ...
def collapse(
    problem: Problem | SpatialProblem, *, strength: float | None = None
) -> Collapse | SpatialCollapse:
    """Find the largest factor on the live loads at which forces of equilibrium exist.

    The problem's own load factor does not matter.

    Parameters
    ----------
    problem : Problem or SpatialProblem
        With live loads.
    strength : float, optional
        Compressive strength of the blocks [Pa], in the plane; by default they are rigid.

    Returns
    -------
    Collapse or SpatialCollapse
        See `blocksim.limit.capacity.collapse` and `blocksim.limit.space.largest_load`.

    Raises
    ------
    InputError
        If a strength is out of range or given in space.
    """
    if isinstance(problem, Problem):
        return collapse_in_plane(problem, strength=strength)
    require(strength is None, "strength", strength, "left out: blocks in space are rigid")
    from blocksim.limit.space import largest_load

    return largest_load(problem)
