"""Static limit analysis of the n voussoirs, exactly as built.

By symmetry two unknowns remain at the crown: the thrust ``h`` and its moment ``m``
about the centre of the arch, both scaled (``h = H/(gamma t d r)``). No tension and Coulomb
friction at every joint are half-planes in (h, m). Eliminating m pairwise leaves an interval
of h (`halfplanes`), and the arch stands by the static theorem where that interval is not
empty.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.arch.circular import ETA_MAX, Arch, Weight, crown_width
from blocksim.arch.limit.halfplanes import (
    Bounds,
    Joints,
    half_joints,
    least_met,
    sliding,
    spread_of,
    turning,
)
from blocksim.arch.modes import ActiveJoint, Mode, name_mode
from blocksim.arch.roots import least_root
from blocksim.blocks.assembly import Array
from blocksim.common.checks import ANY_FRICTION

ROUGHLY = 1e-3
"""Precision at which the joints that act are known well enough to start from."""
HOPELESS = 1e6
"""Multiple of its strength beyond which an arch counts as never standing."""


class Bound(NamedTuple):
    """One end of the interval of admissible thrusts, and what sets it.

    `short` is 1 - h to its last digits, by which ends are compared. `extrados` and
    `intrados` index the joints where the line of thrust touches, or `slides` the joint
    where the line of friction does; -1 where it is not so.
    """

    short: float
    thrust: float
    extrados: int = -1
    intrados: int = -1
    slides: int = -1


Least = tuple[float | None, tuple[Bound, Bound]]
"""The least value that suffices, None where none does, and bounds on the thrust at it."""


@dataclass(frozen=True, kw_only=True)
class LimitState:
    """The arch of n voussoirs at its least thickness.

    `eta`: Least thickness-to-radius ratio; 0 where any thickness stands (three voussoirs), None
        where none up to 2 does.
    `mode`: Collapse mode at that thickness (at eta = 2 where `eta` is None); None where the
        active joints form none of the seven modes.
    `thrust`: Scaled thrust ``h`` at the crown; None where none is admissible.
    `hinges_intrados`, `hinges_extrados`, `slides`: Angles from the crown of the joints that
        turn or slide, on one half [rad].
    """

    eta: float | None
    mode: Mode | None
    thrust: float | None
    hinges_intrados: tuple[float, ...]
    hinges_extrados: tuple[float, ...]
    slides: tuple[float, ...]

    def stands_at(self, eta: float) -> bool:
        """Tell whether the arch stands at a thickness-to-radius ratio."""
        return self.eta is not None and eta >= self.eta


def joints_of(arch: Arch) -> Joints:
    """Return the joints of one half of an arch."""
    return Joints(half_joints(arch.half_angle, arch.voussoirs)[None])


def thrust_bounds(
    joints: Joints,
    depth: float,
    mu: float,
    spread: float,
    slides: tuple[Bound, Bound] | None = None,
) -> tuple[Bound, Bound]:
    """Interval of thrusts in equilibrium with strength at every joint.

    `joints`: Of one half of one arch.
    `depth`: Thickness over radius that the line of thrust may use.
    `spread`: Radius of the distributed weight over the mean radius, less 1.
    `slides`, (Bound, Bound): What `friction_bounds` says, which is the same for every
        thickness.
    Returns `lower`, `upper`: Empty where ``lower.short < upper.short``.
    """
    while True:
        places, few = joints.few
        turns = turning(few, np.array([depth]), np.array([spread]))
        if turns.broken().any():
            return Bound(-math.inf, math.inf), Bound(math.inf, -math.inf)
        lower, upper = _tightest(turns)
        if few is joints:
            break
        if not joints.look_at(least_met(joints, depth, spread, (lower.short, upper.short))):
            lower, upper = (_placed(bound, places) for bound in (lower, upper))
            break
    return _within((lower, upper), slides or friction_bounds(joints, mu))


def friction_bounds(joints: Joints, mu: float) -> tuple[Bound, Bound]:
    """Interval of thrusts with which no joint slides, whatever the thickness."""
    if not math.isfinite(mu):
        return Bound(math.inf, -math.inf), Bound(-math.inf, math.inf)
    return _tightest(sliding(joints, np.array([mu])))


def _within(first: tuple[Bound, Bound], second: tuple[Bound, Bound]) -> tuple[Bound, Bound]:
    """Return what two intervals share."""
    return (
        second[0] if second[0].short < first[0].short else first[0],
        second[1] if second[1].short > first[1].short else first[1],
    )


def _tightest(bounds: Bounds) -> tuple[Bound, Bound]:
    """Smallest interval that conditions leave."""
    lower, upper = Bound(math.inf, -math.inf), Bound(-math.inf, math.inf)
    most, least = bounds.ends()
    low, high = int(most.argmin()), int(least.argmax())
    if most.flat[low] < lower.short:
        lower = _bound(bounds, float(most.flat[low]), low)
    if least.flat[high] > upper.short:
        upper = _bound(bounds, float(least.flat[high]), high)
    return lower, upper


def _bound(bounds: Bounds, short: float, place: int) -> Bound:
    where = tuple(map(int, np.unravel_index(place, bounds.rate.shape)))
    thrust = 1 - short if short < 0.5 else bounds.thrust(where)
    if len(where) == 3:
        return Bound(short, thrust, extrados=where[1], intrados=where[2])
    return Bound(short, thrust, slides=where[1] % (bounds.rate.shape[1] // 2))


def _placed(bound: Bound, places: NDArray[np.int64]) -> Bound:
    """Name joints of a bound by their places among all."""
    if bound.extrados < 0:
        return bound
    extrados, intrados = int(places[bound.extrados]), int(places[bound.intrados])
    return bound._replace(extrados=extrados, intrados=intrados)


def bounds_of(arch: Arch, mu: float, share: float = 1.0) -> tuple[Bound, Bound]:
    """Interval of thrusts of an arch with a share of its thickness and of its friction."""
    spread = spread_of(arch.eta, arch.weight)
    return thrust_bounds(joints_of(arch), share * arch.eta, share * mu, spread)


def slack(arch: Arch, mu: float) -> float:
    """Share of thickness and of friction that can be taken away before the arch falls.

    Returns: Largest s such that an equilibrium exists with thickness ``(1 - s) t`` for the line
        of thrust and friction ``(1 - s) mu``; below 0 where the arch does not stand as it is.
    """
    ANY_FRICTION.require("mu", mu)
    share, _ = _least_share(arch, mu, 0.0)
    return -math.inf if share is None else 1.0 - share


def least_friction(arch: Arch) -> float | None:
    """Least friction coefficient with which the arch stands; 0 where none is needed.

    Returns: None where no friction suffices.
    """
    joints, spread = joints_of(arch), spread_of(arch.eta, arch.weight)
    return _least(lambda mu: thrust_bounds(joints, arch.eta, mu, spread), math.inf)[0]


def weakest_joints(arch: Arch, mu: float) -> tuple[int, ...]:
    """Joints that act where strength is taken away, or added, until the arch barely stands.

    Returns: Indices into `half_joints`; none where no strength suffices.
    """
    share, bounds = _least_share(arch, mu, ROUGHLY)
    if share is None:
        return ()
    places = {place for bound in bounds for place in bound[2:]}
    return tuple(sorted(places - {-1}))


def _least_share(arch: Arch, mu: float, precision: float) -> Least:
    """Return the least share of thickness and friction with which an arch stands."""
    joints, spread = joints_of(arch), spread_of(arch.eta, arch.weight)
    return _least(
        lambda share: thrust_bounds(joints, share * arch.eta, share * mu, spread),
        HOPELESS,
        precision,
    )


def _least(
    bounds: Callable[[float], tuple[Bound, Bound]], most: float, precision: float = 0.0
) -> Least:
    """Return the least value at which any thrust is between bounds, and these.

    None, with the bounds at `most`, where none up to that is enough. Three voussoirs can stand
    with nothing at all.
    """
    known = cache(bounds)

    def gap(value: float) -> float:
        """How far apart the bounds are, below 0 where no thrust is between them."""
        lower, upper = known(value)
        return lower.short - upper.short

    if gap(most) < 0:
        return None, known(most)
    low, high = 0.0, min(1.0, most)
    if gap(low) >= 0:
        return low, known(low)
    while gap(high) < 0:
        low, high = high, min(2.0 * high, most)
    value = least_root(gap, low, high, precision)
    return value, known(value)


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
    ANY_FRICTION.require("mu", mu)
    angles = half_joints(half_angle, voussoirs)
    eta, (lower, upper) = least_of(Joints(angles[None]), mu, weight)
    extrados = _places(angles, lower.extrados, upper.extrados)
    intrados = _places(angles, lower.intrados, upper.intrados)
    sliding_at = _places(angles, lower.slides, upper.slides)
    if eta == 0:
        # Both ends of the joints are touched at once, and nothing is about to move.
        extrados, intrados, sliding_at = (), (), ()
    active = [
        *(ActiveJoint(angle, slides=False) for angle in extrados),
        *(ActiveJoint(angle, slides=False, intrados=True) for angle in intrados),
        *(ActiveJoint(angle, slides=True) for angle in sliding_at),
    ]
    return LimitState(
        eta=eta,
        mode=name_mode(active, crown_width(half_angle, voussoirs)),
        thrust=lower.thrust if eta is not None else None,
        hinges_intrados=intrados,
        hinges_extrados=extrados,
        slides=sliding_at,
    )


def least_of(joints: Joints, mu: float, weight: Weight) -> Least:
    """Least thickness for joints of one half of an arch, and bounds on the thrust there.

    None where none up to `ETA_MAX` stands, with the bounds at that.
    """
    slides = friction_bounds(joints, mu)
    return _least(
        lambda eta: thrust_bounds(joints, eta, mu, spread_of(eta, weight), slides), ETA_MAX
    )


def _places(angles: Array, *indices: int) -> tuple[float, ...]:
    """Angles of the joints a pair of bounds names, each once."""
    return tuple(float(angles[i]) for i in sorted(set(indices) - {-1}))
