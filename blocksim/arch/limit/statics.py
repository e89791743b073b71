"""Static limit analysis of the n voussoirs, exactly as built.

By symmetry two unknowns remain at the crown: the thrust ``h`` and its moment ``m``
about the centre of the arch, both scaled (``h = H/(gamma t d r)``). At a joint at
angle x the resultant of the thrust and of the weight between crown and joint is

    N = h cos x + x sin x,    T = h sin x - x cos x,
    M = m - h cos x - x sin x + k (1 - cos x)      (positive towards the extrados),

with k = 1 for weight on the centreline, 1 + eta^2/12 for the annular sector. No tension
asks |M| <= (eta/2) N and Coulomb friction |T| <= mu N: half-planes in (h, m).
Eliminating m pairwise leaves an interval of h, and the arch stands by the static
theorem where that interval is not empty.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from blocksim.arch.circular import Arch, Weight, centroid_factor, crown_width
from blocksim.arch.modes import ActiveJoint, Mode, name_mode
from blocksim.blocks.assembly import Array
from blocksim.common.checks import require_friction

ETA_MAX = 2.0
ROUGHLY = 1e-3
"""Precision at which the joints that act are known well enough to start from."""
HOPELESS = 1e6
"""Multiple of its strength beyond which an arch counts as never standing."""


class Bound(NamedTuple):
    """One end of the interval of admissible thrusts, and what sets it.

    `extrados` and `intrados` index the joints where the line of thrust touches, or
    `slides` the joint where the line of friction does; -1 where it is not so.
    """

    thrust: float
    extrados: int = -1
    intrados: int = -1
    slides: int = -1


@dataclass(frozen=True, kw_only=True)
class LimitState:
    """The arch of n voussoirs at its least thickness.

    Parameters
    ----------
    eta : float or None
        Least thickness-to-radius ratio; None where none up to 2 stands.
    mode : Mode or None
        Collapse mode at that thickness (at eta = 2 where `eta` is None); None where
        the active joints form none of the seven modes.
    thrust : float or None
        Scaled thrust ``h`` at the crown; None where none is admissible.
    hinges_intrados, hinges_extrados, slides : tuple of float
        Angles from the crown of the joints that turn or slide, on one half [rad].
    """

    eta: float | None
    mode: Mode | None
    thrust: float | None
    hinges_intrados: tuple[float, ...]
    hinges_extrados: tuple[float, ...]
    slides: tuple[float, ...]


def half_joints(half_angle: float, voussoirs: int) -> Array:
    """Angles of the joints from the crown to the right springing [rad].

    The first is 0 for an even number of voussoirs, alpha/n for an odd one.
    """
    first = voussoirs % 2
    count = voussoirs // 2 + 1
    return half_angle * (2.0 * np.arange(count) + first) / voussoirs


def thrust_bounds(angles: Array, depth: float, mu: float, factor: float) -> tuple[Bound, Bound]:
    """Interval of thrusts in equilibrium with strength at every joint.

    Parameters
    ----------
    angles : (k,) float
        Joints of one half [rad].
    depth : float
        Thickness over radius that the line of thrust may use.
    mu : float
        Friction coefficient, inf allowed.
    factor : float
        Radius of the distributed weight over the mean radius.

    Returns
    -------
    lower, upper : Bound
        Empty where ``lower.thrust > upper.thrust``.
    """
    sine, cosine = np.sin(angles), np.cos(angles)
    vertical, lever = angles * sine, factor * (1.0 - cosine)
    # Upper half-planes m <= slope h + offset, lower ones m >= the same with 1 - depth/2.
    outer, inner = 1.0 + depth / 2, 1.0 - depth / 2
    slope = outer * cosine[:, None] - inner * cosine[None, :]
    offset = (outer * vertical - lever)[:, None] - (inner * vertical - lever)[None, :]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = -offset / slope
    lower_pairs = np.where(slope > 0, crossing, -np.inf)
    upper_pairs = np.where(slope < 0, crossing, np.inf)
    if np.any((slope == 0) & (offset < 0)):
        return Bound(math.inf), Bound(-math.inf)
    low = np.unravel_index(int(np.argmax(lower_pairs)), slope.shape)
    high = np.unravel_index(int(np.argmin(upper_pairs)), slope.shape)
    lower = Bound(float(lower_pairs[low]), int(low[0]), int(low[1]))
    upper = Bound(float(upper_pairs[high]), int(high[0]), int(high[1]))
    if math.isinf(mu):
        return lower, upper
    for sign in (1.0, -1.0):
        # sign * T <= mu N
        rate = sign * sine - mu * cosine
        level = angles * (sign * cosine + mu * sine)
        with np.errstate(divide="ignore", invalid="ignore"):
            limit = level / rate
        caps = np.where(rate > 0, limit, np.inf)
        floors = np.where(rate < 0, limit, -np.inf)
        cap, floor = int(np.argmin(caps)), int(np.argmax(floors))
        if caps[cap] < upper.thrust:
            upper = Bound(float(caps[cap]), slides=cap)
        if floors[floor] > lower.thrust:
            lower = Bound(float(floors[floor]), slides=floor)
    return lower, upper


def stands(arch: Arch, mu: float) -> bool:
    """Tell whether the arch has an equilibrium within strength (static theorem)."""
    lower, upper = thrust_bounds(
        half_joints(arch.half_angle, arch.voussoirs), arch.eta, mu, arch.centroid_factor
    )
    return lower.thrust <= upper.thrust


def slack(arch: Arch, mu: float) -> float:
    """Share of thickness and of friction that can be taken away before the arch falls.

    Parameters
    ----------
    arch : Arch
    mu : float
        Friction coefficient, inf allowed.

    Returns
    -------
    float
        Largest s such that an equilibrium exists with thickness ``(1 - s) t`` for the
        line of thrust and friction ``(1 - s) mu``; below 0 where the arch does not
        stand as it is.
    """
    require_friction(mu)
    share, _ = _least_share(arch, mu, 0.0)
    return 1.0 - share


def weakest_joints(arch: Arch, mu: float) -> tuple[int, ...]:
    """Joints that act where strength is taken away, or added, until the arch barely stands.

    Parameters
    ----------
    arch : Arch
    mu : float
        Friction coefficient, inf allowed.

    Returns
    -------
    tuple of int
        Indices into `half_joints`; none where no strength suffices.
    """
    share, bounds = _least_share(arch, mu, ROUGHLY)
    if math.isinf(share):
        return ()
    places = {place for bound in bounds for place in bound[1:]}
    return tuple(sorted(places - {-1}))


def _least_share(arch: Arch, mu: float, precision: float) -> tuple[float, tuple[Bound, Bound]]:
    """Return the least share of thickness and friction with which an arch stands."""
    angles = half_joints(arch.half_angle, arch.voussoirs)

    def bounds(share: float) -> tuple[Bound, Bound]:
        return thrust_bounds(angles, share * arch.eta, share * mu, arch.centroid_factor)

    def feasible(share: float) -> bool:
        lower, upper = bounds(share)
        return lower.thrust <= upper.thrust

    low, high = 0.0, 1.0
    while not feasible(high):
        low, high = high, 2.0 * high
        if high > HOPELESS:
            return math.inf, bounds(high)
    share = _bisect(feasible, low, high, precision)
    return share, bounds(share)


def least_thickness(
    half_angle: float, mu: float, voussoirs: int, weight: Weight = "centreline"
) -> LimitState:
    """Least thickness-to-radius ratio of n voussoirs, with its collapse mode.

    Parameters
    ----------
    half_angle : float
        In (0, pi) [rad].
    mu : float
        Friction coefficient, inf allowed.
    voussoirs : int
    weight : {"centreline", "sector"}

    Returns
    -------
    LimitState

    Raises
    ------
    InputError
        If a value is out of range.
    """
    Arch(half_angle=half_angle, eta=1.0, voussoirs=voussoirs, weight=weight)
    require_friction(mu)
    angles = half_joints(half_angle, voussoirs)

    def bounds(eta: float) -> tuple[Bound, Bound]:
        return thrust_bounds(angles, eta, mu, centroid_factor(eta, weight))

    def feasible(eta: float) -> bool:
        lower, upper = bounds(eta)
        return lower.thrust <= upper.thrust

    eta = _bisect(feasible, 0.0, ETA_MAX) if feasible(ETA_MAX) else None
    lower, upper = bounds(ETA_MAX if eta is None else eta)
    extrados = _places(angles, lower.extrados, upper.extrados)
    intrados = _places(angles, lower.intrados, upper.intrados)
    slides = _places(angles, lower.slides, upper.slides)
    active = [
        *(ActiveJoint(angle, slides=False) for angle in extrados),
        *(ActiveJoint(angle, slides=False, intrados=True) for angle in intrados),
        *(ActiveJoint(angle, slides=True) for angle in slides),
    ]
    return LimitState(
        eta=eta,
        mode=name_mode(active, crown_width(half_angle, voussoirs)),
        thrust=lower.thrust if eta is not None else None,
        hinges_intrados=intrados,
        hinges_extrados=extrados,
        slides=slides,
    )


def _places(angles: Array, *indices: int) -> tuple[float, ...]:
    """Angles of the joints a pair of bounds names, each once."""
    return tuple(float(angles[i]) for i in sorted(set(indices) - {-1}))


def _bisect(
    feasible: Callable[[float], bool], low: float, high: float, precision: float = 0.0
) -> float:
    """Smallest feasible value in (low, high], as precisely as asked for or to the last bit.

    `high` is feasible.
    """
    while True:
        middle = (low + high) / 2
        if middle in {low, high} or high - low <= precision * high:
            return high
        if feasible(middle):
            high = middle
        else:
            low = middle
