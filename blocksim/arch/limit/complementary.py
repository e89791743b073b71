"""The complementary problem of eqs (15) and (16) on voussoirs, with all its mechanisms.

At the least thickness several mechanisms can be possible at once, and with them every mixture.
Those that are no mixture of others (the extreme rays of the cone of rates) are listed here;
on a line of the map they are the modes that meet there. Nothing is assumed of the mode: the
forces are those of the linear programme, and rates belong to any condition that they reach.

Joints need not be evenly spaced. Where one is at each angle at which the continuous arch turns
or slides, the voussoirs have its least thickness to the last digits.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np

from blocksim.arch.limit.collapse import Collapse, of_half
from blocksim.arch.limit.mechanism import Conditions, conditions, mode_of, solve
from blocksim.arch.modes import Mode
from blocksim.blocks.assembly import Array

REACHED = 1e-9
"""Distance from a strength condition below which it is reached, in units of gamma t d r^2."""
SAME = 1e-6
"""Angle within which places are one joint [rad]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ComplementaryMode:
    """One mechanism of a complementary problem that is no mixture of others.

    `mode`: None where its joints form none of the seven.
    `collapse`: Its rates at all joints, which add up to one, and its motions, with sliding that
        dilates (associated).
    `product`: -phi' rates, the value of eq. (16); 0 but for round-off.
    """

    mode: Mode | None
    collapse: Collapse
    product: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Complementary:
    """Forces of an arch of voussoirs, and the mechanisms they allow.

    `angles`, (k,): Joints of one half, from the crown to the springing [rad].
    `extra_strength`: Least extra strength with which it stands: 0 at the least thickness.
    `thrust`, `crown_moment`: h, and the moment m of the thrust about the centre.
    `strength`, (k, 4): phi: left sides of the strength conditions, in the order of
        `CONDITIONS`.
    `modes`: None where it has strength to spare, or lacks some.
    """

    angles: Array
    extra_strength: float
    thrust: float
    crown_moment: float
    strength: Array
    modes: tuple[ComplementaryMode, ...]


def joints_through(half_angle: float, places: Sequence[float], voussoirs: int) -> Array:
    """Lay joints of one half through given places, evenly between them.

    `half_angle`: alpha [rad].
    `places`: Angles from the crown at which a joint is wanted, up to alpha [rad].
    `voussoirs`: About how many there are in the whole arch.
    Returns (k,): From the crown, where there is a joint, to the springing [rad].
    """
    nodes = [0.0]
    for place in sorted(places):
        if place > nodes[-1] + SAME and place < half_angle - SAME:
            nodes.append(place)
    width = 2 * half_angle / voussoirs
    found = [np.zeros(1)]
    for start, stop in pairwise([*nodes, half_angle]):
        count = max(1, round((stop - start) / width))
        found.append(start + (stop - start) * np.arange(1, count + 1) / count)
    return np.concatenate(found)


def complementary(angles: Array, eta: float, mu: float) -> Complementary:
    """Solve eqs (15) and (16) for a symmetric arch of voussoirs that weighs at its centreline.

    `angles`, (k,): Joints of one half, the crown at 0 first, the springing last [rad].
    `eta`, `mu`: Thickness-to-radius ratio; friction coefficient, inf allowed.
    """
    program = conditions(angles, eta, mu, 1.0)
    state, extra, _ = solve(program)
    strength = program.matrix @ state + program.offset
    reached = np.flatnonzero(strength >= -REACHED).tolist() if abs(extra) < REACHED else []
    modes = tuple(
        ComplementaryMode(
            mode=mode_of(angles, rates.reshape(-1, 4) > 0, SAME),
            collapse=of_half(angles, rates.reshape(-1, 4), eta, mu),
            product=float(-strength @ rates),
        )
        for rates in _extreme(program, reached)
    )
    return Complementary(
        angles=angles,
        extra_strength=extra,
        thrust=float(state[0]),
        crown_moment=float(state[1]),
        strength=strength.reshape(-1, 4),
        modes=modes,
    )


def _extreme(program: Conditions, reached: Sequence[int]) -> Iterator[Array]:
    """Rates of the conditions reached that fit together (A' rates = 0) and are no mixture."""
    found: list[set[int]] = []
    # Two equations: no more than three rates are needed at once.
    for count in (2, 3):
        for rows in combinations(reached, count):
            if any(each <= set(rows) for each in found):
                continue
            part = program.matrix[list(rows)].T
            rates = np.linalg.svd(part)[2][-1]
            total = float(rates.sum())
            rates = rates / total if abs(total) > REACHED else rates
            if rates.min() > REACHED and np.abs(part @ rates).max() < REACHED:
                found.append(set(rows))
                whole = np.zeros(len(program.offset))
                whole[list(rows)] = rates
                yield whole
