"""Weights on the road above: they go straight down to what lies uppermost.

Nothing is spread on the way, in the fill or elsewhere.
"""

from __future__ import annotations

import numpy as np

from blocksim.blocks.assembly import Assembly
from blocksim.blocks.patch import shares, shares_at
from blocksim.blocks.problem import Load
from blocksim.common.checks import require


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
