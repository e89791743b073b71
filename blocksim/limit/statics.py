"""Limit analysis of any problem: by linear programmes in the plane, by cones in space."""

from __future__ import annotations

from typing import TYPE_CHECKING, overload

from blocksim.blocks.problem import Problem
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.limit import crushing
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
def collapse(problem: Problem) -> Collapse: ...
@overload
def collapse(problem: SpatialProblem) -> SpatialCollapse: ...
@overload
def collapse(problem: Problem | SpatialProblem) -> Collapse | SpatialCollapse: ...
def collapse(problem: Problem | SpatialProblem) -> Collapse | SpatialCollapse:
    """Find the largest factor on the live loads at which forces of equilibrium exist.

    The problem's own load factor does not matter. Below 0 it falls, or crushes, without them.

    Parameters
    ----------
    problem : Problem or SpatialProblem
        With live loads.

    Returns
    -------
    Collapse or SpatialCollapse
        See `blocksim.limit.capacity.collapse` and `blocksim.limit.space.largest_load`.
    """
    if isinstance(problem, Problem):
        return collapse_in_plane(problem)
    from blocksim.limit.space import largest_load

    return largest_load(problem)


def standing_margin(problem: Problem | SpatialProblem) -> float:
    """Return a number that is below 0 where blocks fall: how far, without a unit."""
    if isinstance(problem, Problem):
        return crushing.standing_margin(problem)
    return equilibrium(problem).margin


def exists(problem: Problem | SpatialProblem) -> bool | None:
    """Tell whether forces of equilibrium exist; None in space where that is not told."""
    return (
        crushing.exists(problem)
        if isinstance(problem, Problem)
        else equilibrium(problem).exists
    )
