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
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from blocksim.arch.circular import Arch, Weight, crown_width
from blocksim.arch.limit.halfplanes import Bounds, Joints, least_met, sliding, turning
from blocksim.arch.modes import ActiveJoint, Mode, name_mode
from blocksim.blocks.assembly import Array
from blocksim.common.checks import ANY_FRICTION

Value = TypeVar("Value", float, Array)
ETA_MAX = 2.0
ROUGHLY = 1e-3
"""Precision at which the joints that act are known well enough to start from."""
HOPELESS = 1e6
"""Multiple of its strength beyond which an arch counts as never standing."""
ASIDE, PATIENCE = 0.2, 3
"""How far estimates are moved, and how many may narrow an interval by less than four."""


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


@dataclass(frozen=True, kw_only=True)
class LimitState:
    """The arch of n voussoirs at its least thickness.

    Parameters
    ----------
    eta : float or None
        Least thickness-to-radius ratio; 0 where any thickness stands (three voussoirs), None
        where none up to 2 does.
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

    def stands_at(self, eta: float) -> bool:
        """Tell whether the arch stands at a thickness-to-radius ratio."""
        return self.eta is not None and eta >= self.eta


def half_joints(half_angle: float | Array, voussoirs: int) -> Array:
    """Angles of the joints from the crown to the right springing, a row for each arch [rad].

    The first is 0 for an even number of voussoirs, alpha/n for an odd one.
    """
    first = voussoirs % 2
    count = voussoirs // 2 + 1
    return np.asarray(half_angle)[..., None] * (2.0 * np.arange(count) + first) / voussoirs


def joints_of(arch: Arch) -> Joints:
    """Return the joints of one half of an arch."""
    return Joints(half_joints(arch.half_angle, arch.voussoirs)[None])


def spread_of(eta: Value, weight: Weight) -> Value:
    """Radius of the distributed weight over the mean radius, less 1."""
    return 0.0 * eta if weight == "centreline" else eta**2 / 12


def thrust_bounds(
    joints: Joints,
    depth: float,
    mu: float,
    spread: float,
    slides: tuple[Bound, Bound] | None = None,
) -> tuple[Bound, Bound]:
    """Interval of thrusts in equilibrium with strength at every joint.

    Parameters
    ----------
    joints : Joints
        Of one half of one arch.
    depth : float
        Thickness over radius that the line of thrust may use.
    mu : float
        Friction coefficient, inf allowed.
    spread : float
        Radius of the distributed weight over the mean radius, less 1.
    slides : (Bound, Bound), optional
        What `friction_bounds` says, which is the same for every thickness.

    Returns
    -------
    lower, upper : Bound
        Empty where ``lower.short < upper.short``.
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
    up, down = (_tightest(sliding(joints, np.array([mu]), sign)) for sign in (1.0, -1.0))
    return _within(up, down)


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
    low = np.unravel_index(int(np.argmin(most)), most.shape)
    high = np.unravel_index(int(np.argmax(least)), least.shape)
    if most[low] < lower.short:
        lower = _bound(bounds, float(most[low]), low)
    if least[high] > upper.short:
        upper = _bound(bounds, float(least[high]), high)
    return lower, upper


def _bound(bounds: Bounds, short: float, place: tuple[np.intp, ...]) -> Bound:
    where = tuple(int(index) for index in place)
    thrust = 1 - short if short < 0.5 else bounds.thrust(where)
    if len(where) == 3:
        return Bound(short, thrust, extrados=where[1], intrados=where[2])
    return Bound(short, thrust, slides=where[1])


def _placed(bound: Bound, places: NDArray[np.int64]) -> Bound:
    """Name joints of a bound by their places among all."""
    if bound.extrados < 0:
        return bound
    extrados, intrados = int(places[bound.extrados]), int(places[bound.intrados])
    return bound._replace(extrados=extrados, intrados=intrados)


def admissible(bounds: tuple[Bound, Bound]) -> bool:
    """Whether any thrust is between two bounds."""
    lower, upper = bounds
    return lower.short >= upper.short


def _gap(bounds: tuple[Bound, Bound]) -> float:
    """How far apart two bounds are, below 0 where no thrust is between them."""
    lower, upper = bounds
    return lower.short - upper.short


def stands(arch: Arch, mu: float) -> bool:
    """Tell whether the arch has an equilibrium within strength (static theorem)."""
    joints = joints_of(arch)
    spread = spread_of(arch.eta, arch.weight)
    return admissible(thrust_bounds(joints, arch.eta, mu, spread))


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
    ANY_FRICTION.require("mu", mu)
    share, _ = _least_share(arch, mu, 0.0)
    return 1.0 - share


def least_friction(arch: Arch) -> float | None:
    """Least friction coefficient with which the arch stands; 0 where none is needed.

    Returns
    -------
    float or None
        None where no friction suffices.
    """
    joints = joints_of(arch)
    spread = spread_of(arch.eta, arch.weight)

    def gap(mu: float) -> float:
        return _gap(thrust_bounds(joints, arch.eta, mu, spread))

    if gap(math.inf) < 0:
        return None
    low, high = 0.0, 1.0
    if gap(low) >= 0:
        return low
    while gap(high) < 0:
        low, high = high, 2.0 * high
    return _boundary(gap, low, high)


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
    places = {place for bound in bounds for place in bound[2:]}
    return tuple(sorted(places - {-1}))


def _least_share(arch: Arch, mu: float, precision: float) -> tuple[float, tuple[Bound, Bound]]:
    """Return the least share of thickness and friction with which an arch stands."""
    joints = joints_of(arch)
    spread = spread_of(arch.eta, arch.weight)

    @cache
    def bounds(share: float) -> tuple[Bound, Bound]:
        return thrust_bounds(joints, share * arch.eta, share * mu, spread)

    def gap(share: float) -> float:
        return _gap(bounds(share))

    low, high = 0.0, 1.0
    if gap(low) >= 0:
        # Three voussoirs can stand however thin they are.
        return low, bounds(low)
    while gap(high) < 0:
        low, high = high, 2.0 * high
        if high > HOPELESS:
            return math.inf, bounds(high)
    share = _boundary(gap, low, high, precision)
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


def least_of(
    joints: Joints, mu: float, weight: Weight
) -> tuple[float | None, tuple[Bound, Bound]]:
    """Least thickness for joints of one half of an arch, and bounds on the thrust there.

    None where none up to `ETA_MAX` stands, with the bounds at that.
    """
    slides = friction_bounds(joints, mu)

    @cache
    def bounds(eta: float) -> tuple[Bound, Bound]:
        return thrust_bounds(joints, eta, mu, spread_of(eta, weight), slides)

    def gap(eta: float) -> float:
        return _gap(bounds(eta))

    eta = None if gap(ETA_MAX) < 0 else 0.0
    if eta is not None and gap(0.0) < 0:
        eta = _boundary(gap, 0.0, ETA_MAX)
    return eta, bounds(ETA_MAX if eta is None else eta)


def _places(angles: Array, *indices: int) -> tuple[float, ...]:
    """Angles of the joints a pair of bounds names, each once."""
    return tuple(float(angles[i]) for i in sorted(set(indices) - {-1}))


def _boundary(
    gap: Callable[[float], float], low: float, high: float, precision: float = 0.0
) -> float:
    """Smallest value in (low, high] at which a growing gap is not below 0.

    As precisely as asked for, or to the last bit. `high` is such a value. Each estimate is
    by a straight line through both ends, moved a little towards the middle so that the next
    one comes from the other side; where that does not narrow the interval it is halved.
    """
    whole, below, above = high - low, gap(low), gap(high)
    slow = 0
    while True:
        width, middle = high - low, (low + high) / 2
        if middle in {low, high} or width <= precision * high:
            return high
        value = middle
        if slow < PATIENCE and math.isfinite(above - below):
            line = low - below * (width / (above - below))
            aside = max(ASIDE * width**2 / whole, 2.0**slow * math.ulp(line))
            value = line + math.copysign(min(aside, abs(middle - line)), middle - line)
            if not low < value < high:
                value = middle
        found = gap(value)
        if found >= 0:
            high, above = value, found
        else:
            low, below = value, found
        slow = 0 if value == middle or high - low < width / 4 else slow + 1
