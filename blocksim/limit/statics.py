"""Limit analysis of any problem: by linear programmes in the plane, by cones in space."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, cast, overload

from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.limit.capacity import Collapse
from blocksim.limit.capacity import collapse as collapse_in_plane
from blocksim.limit.crushing import strength_needed
from blocksim.limit.programme import equilibrium as equilibrium_in_plane

if TYPE_CHECKING:
    from blocksim.limit.programme import Equilibrium
    from blocksim.limit.space import SpatialEquilibrium

LEFT = 1e-6
"""Of each block's own weight: forces left over that are no round-off."""


@overload
def equilibrium(problem: Problem, *, reduce: bool = ...) -> Equilibrium: ...
@overload
def equilibrium(
    problem: Problem[SpatialAssembly], *, reduce: bool = ...
) -> SpatialEquilibrium: ...
@overload
def equilibrium(
    problem: Problem[Any], *, reduce: bool = ...
) -> Equilibrium | SpatialEquilibrium: ...
def equilibrium(
    problem: Problem[Any], *, reduce: bool = True
) -> Equilibrium | SpatialEquilibrium:
    """Find forces of equilibrium, all as far inside their cones of friction as possible.

    Parameters
    ----------
    problem : Problem
    reduce : bool, optional
        Whether, in space, planes of symmetry halve what is asked; the answer is the same.

    Returns
    -------
    Equilibrium or SpatialEquilibrium
        See `blocksim.limit.programme` and `blocksim.limit.space`.

    Examples
    --------
    >>> from blocksim import Column
    >>> found = equilibrium(Column(drums=3, drum_height=1, width=1, friction=0.5).problem())
    >>> found.exists, round(found.margin, 6), found.forces.shape
    (True, 0.125, (3, 2, 2))
    """
    if not problem.in_space:
        return equilibrium_in_plane(problem)
    # Cones are loaded where they are asked for.
    from blocksim.limit.space import can_rest

    return can_rest(problem, reduce=reduce)


def collapse(problem: Problem[Any], *, reduce: bool = True) -> Collapse:
    """Find the largest factor on the live loads at which forces of equilibrium exist.

    The problem's own load factor does not matter. Below 0 it falls, or crushes, without them.

    Parameters
    ----------
    problem : Problem
        With live loads.
    reduce : bool, optional
        As of `equilibrium`.

    Returns
    -------
    Collapse
        See `blocksim.limit.capacity`.

    Examples
    --------
    >>> from blocksim import load_structure
    >>> round(collapse(load_structure("oppenheim_7")).load_factor, 6)
    0.370534
    """
    if not problem.in_space:
        return collapse_in_plane(problem)
    from blocksim.limit.space import largest_load

    return largest_load(problem, reduce=reduce)


def standing_margin(problem: Problem[Any]) -> float:
    """Return a number that is below 0 where blocks fall: how far, without a unit.

    The margin of `equilibrium`, -1 where forces that press leave blocks out of balance; of
    blocks that crush the share of the strength that is left.
    """
    if not problem.in_space and problem.strength is not None:
        needed = strength_needed(problem)
        return -math.inf if needed is None else 1 - needed.high / problem.strength
    found = equilibrium(problem)
    if problem.in_space and found.margin > 0 and cast("SpatialEquilibrium", found).gap > LEFT:
        return -1.0
    return found.margin


def exists(problem: Problem[Any]) -> bool | None:
    """Tell whether forces of equilibrium exist, within the strength where there is one.

    None in space where that is not told.
    """
    if problem.strength is not None:
        return standing_margin(problem) >= 0
    return equilibrium(problem).exists
