"""Fill and weights on the road above: they go straight down to what lies uppermost.

Nothing is spread on the way, in the fill or elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from blocksim.blocks.acting import Load
from blocksim.blocks.assembly import Assembly
from blocksim.blocks.patch import shares, shares_at
from blocksim.common.checks import require

if TYPE_CHECKING:
    from blocksim.blocks.problem import Problem


def on_road(
    assembly: Assembly, weight: float, low: float, high: float, field: str = "patch"
) -> tuple[Load, ...]:
    """Return the loads that a weight on the road comes to.

    Parameters
    ----------
    assembly : Assembly
    weight : float
        [N]
    low, high : float
        Where it stands along x, evenly [m]; at one point where both are equal.
    field : str
        What to call it in messages.

    Returns
    -------
    tuple of Load
        A weight on a joint is shared in halves by the blocks on its two sides.

    Raises
    ------
    InputError
        If it is not above blocks that move all along.
    """
    bodies = [list(block.polygons) for block in assembly.blocks]
    grounds = [list(support.polygons) for support in assembly.supports]
    both = [*bodies, *grounds]
    found = shares_at(low, both) if low == high else shares(low, high, both)
    borne = found is not None and all(index < len(bodies) for index, _, _ in found)
    corners = np.concatenate([block.vertices for block in assembly.blocks])[:, 0]
    allowed = f"above blocks: they reach from x = {corners.min():.6g} to {corners.max():.6g} m"
    given = f"{low:g} m" if low == high else f"{low:g} to {high:g} m"
    require(borne, field, given, allowed)
    return tuple(
        Load(force=np.array([0.0, -share * weight]), blocks=(index,), point=point)
        for index, share, point in found or ()
    )


def with_road(
    problem: Problem,
    loads: Sequence[tuple[float, float, float]],
    fields: Sequence[str] = (),
) -> Problem:
    """Return a problem with these live loads on the road in place of any others.

    Where it has a maker they stay where they are as its parameters change, on whatever blocks
    are uppermost there then.

    Parameters
    ----------
    problem : Problem
    loads : sequence of (float, float, float)
        From one x to another [m], the same at a point, and the weight [N].
    fields : sequence of str
        What to call each in messages.

    Raises
    ------
    InputError
        If one is not above blocks that move.
    """
    names = fields or ["road"] * len(loads)
    live = [
        each
        for (low, high, weight), name in zip(loads, names, strict=True)
        for each in on_road(problem.assembly, weight, low, high, name)
    ]
    return replace(problem, live=tuple(live), road=tuple(loads))


def with_fill(problem: Problem, height: float, share: float) -> Problem:
    """Return a problem of an arch or of arches on piers with fill above them.

    Parameters
    ----------
    problem : Problem
        With a maker.
    height : float
        Of the fill over the highest point of the extrados [m].
    share : float
        Density of the fill over that of the blocks.

    Raises
    ------
    InputError
        If it is of no arch, or a value is out of range.
    """
    maker: Any = problem.maker
    own = hasattr(maker, "fill")
    arches = own or hasattr(getattr(maker, "arch", None), "fill")
    require(arches, "fill", height, "left out: it is for arches and portals")
    path = "" if own else "arch."
    filled = maker.but(**{f"{path}fill": height, f"{path}fill_density": share})
    return problem.remade(filled)


@dataclass(frozen=True, kw_only=True)
class FillAbove:
    """Fill: its height over the highest point of the extrados [m], its weight [N]."""

    height: float
    weight: float


def fill_of(problem: Problem) -> FillAbove | None:
    """Return the fill on a structure; None where it has none."""
    maker: Any = problem.maker
    height = getattr(getattr(maker, "arch", maker), "fill", None)
    if height is None:
        return None
    fills = maker.made(maker.unit_weight).fills
    return FillAbove(height=height, weight=sum(each.weight for each in fills))
