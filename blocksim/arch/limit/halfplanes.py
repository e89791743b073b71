"""Strength of joints as bounds on the thrust, over arrays.

At a joint at angle x the resultant of the thrust h, its moment m about the centre of the arch
and of the weight between crown and joint is

    N = h cos x + x sin x,    T = h sin x - x cos x,
    M = m - h cos x - x sin x + k (1 - cos x)      (positive towards the extrados),

all scaled, with k the radius of the weight over the mean radius. In flat arches the thickness
goes like the fourth power of the angles, and h and m are all but the same for every arch.
Therefore the bounds are those of the shortfall 1 - h: with it, and with the entire functions
of `blocksim.common.series`, nothing cancels.

Where the line of thrust turns, each pair of joints sets a condition, and a sum of what each of
the two sets. Few joints act: conditions are those of the pairs among a few, to which the pair
is added that they leave least met, until there is none.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from blocksim.arch.circular import Weight
from blocksim.blocks.assembly import Array
from blocksim.common.series import lag_series, p_series

Value = TypeVar("Value", float, Array)
FEW = 48
"""Joints of which all pairs are looked at; of more, so many at first."""


class Bounds(NamedTuple):
    """Conditions rate (1 - h) <= level; the same ones say level_h <= rate h.

    `rate`, `level`: Arrays of one shape.
    `level_h`: Place in them to what the other form has there.
    """

    rate: Array
    level: Array
    level_h: Callable[[tuple[int, ...]], float]

    def ends(self) -> tuple[Array, Array]:
        """Largest and smallest 1 - h of each condition, inf and -inf where it sets none."""
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = self.level / self.rate
        most = np.where(self.rate > 0, crossing, np.inf)
        return most, np.where(self.rate < 0, crossing, -np.inf)

    def thrust(self, place: tuple[int, ...]) -> float:
        """Thrust h at which one condition is met exactly."""
        return self.level_h(place) / float(self.rate[place])

    def broken(self) -> Array:
        """Whether a condition no thrust can change is not met."""
        return (self.rate == 0) & (self.level < 0)


def half_joints(half_angle: float | Array, voussoirs: int) -> Array:
    """Angles of the joints from the crown to the right springing, a row for each arch [rad].

    The first is 0 for an even number of voussoirs, alpha/n for an odd one.
    """
    first = voussoirs % 2
    count = voussoirs // 2 + 1
    return np.asarray(half_angle)[..., None] * (2.0 * np.arange(count) + first) / voussoirs


def spread_of(eta: Value, weight: Weight) -> Value:
    """Radius of the distributed weight over the mean radius, less 1."""
    return 0.0 * eta if weight == "centreline" else eta**2 / 12


class Joints:
    """Joints of one half of each arch, and what bounds take from their angles alone.

    `angles`, (k, j): From the crown on, where there are more than `FEW` [rad].
    """

    def __init__(self, angles: Array) -> None:
        self.angles, square = angles, angles**2
        self.sine, self.cosine = np.sin(angles), np.cos(angles)
        self.lift = 2 * np.sin(angles / 2) ** 2
        self.vertical = angles * self.sine
        self.force = self.cosine + self.vertical
        # x sin x - 2 (1 - cos x), of the weight's lever
        self.bow = -(square**2) * p_series(square)
        self.lag = angles**3 * lag_series(square)
        many = angles.shape[1]
        self._looked_at: NDArray[np.int64] = np.arange(many)
        if many > FEW:
            self._looked_at = np.arange(FEW) * (many - 1) // (FEW - 1)
        self._few: Joints | None = None

    @property
    def few(self) -> tuple[NDArray[np.int64], Joints]:
        """Joints of which pairs are looked at: their places, and themselves."""
        if len(self._looked_at) == self.angles.shape[1]:
            return self._looked_at, self
        if self._few is None:
            self._few = Joints(self.angles[:, self._looked_at])
        return self._looked_at, self._few

    def look_at(self, places: set[int]) -> bool:
        """Look at more of them; tell whether they are new."""
        new = places - set(self._looked_at.tolist())
        if new:
            self._looked_at = np.sort([*self._looked_at.tolist(), *new])
            self._few = None
        return bool(new)

    @cached_property
    def pairs(self) -> Pairs:
        """What `turning` takes from all pairs of them, (k, j, j) each."""
        return Pairs(
            lift=_less(self.lift),
            cosine=_sum(self.cosine),
            bow=_less(self.bow),
            force=_sum(self.force),
        )


class Pairs(NamedTuple):
    """Differences and sums over pairs of joints, of the values of the same names."""

    lift: Array
    cosine: Array
    bow: Array
    force: Array


def turning(joints: Joints, depth: Array, spread: Array) -> Bounds:
    """Pairs of joints where the line of thrust touches extrados (i) and intrados (j).

    No tension asks |M| <= (eta/2) N of both; between them m is eliminated.

    `depth`, (k,): Thickness over radius that the line of thrust may use.
    `spread`, (k,): Radius of the weight over the mean radius, less 1.
    Returns: Shape (k, j, j).
    """
    pairs = joints.pairs
    half, extra = depth[:, None, None] / 2, spread[:, None, None]
    level = pairs.bow + half * pairs.force
    if extra.any():
        level -= extra * pairs.lift

    def level_h(place: tuple[int, ...]) -> float:
        arch, i, j = place
        vertical = joints.vertical[arch]
        lever = vertical - (1 + spread[arch]) * joints.lift[arch]
        reach = depth[arch] / 2 * (vertical[i] + vertical[j])
        return float(-(lever[i] - lever[j] + reach))

    return Bounds(half * pairs.cosine - pairs.lift, level, level_h)


def least_met(
    joints: Joints, depth: float, spread: float, ends: tuple[float, float]
) -> set[int]:
    """Joints of the pairs whose conditions the ends of an interval of 1 - h meet least.

    A pair's rate and level are sums over its two joints. Rates fall with the angle of the one
    and grow with that of the other, so those of one sign are all beyond a joint, or before it.

    `joints`: Of one half of one arch, from the crown on.
    `depth`, `spread`: As in `turning`.
    `ends`, (float, float): Largest 1 - h, which pairs of rates above 0 bound, and smallest.
    Returns: None where both ends meet all their conditions.
    """
    half = depth / 2
    cosine, lift, bow, force = (
        each[0] for each in (joints.cosine, joints.lift, joints.bow, joints.force)
    )
    rate_i, rate_j = half * cosine - lift, half * cosine + lift
    level_i, level_j = (
        half * force + (bow - spread * lift),
        half * force - (bow - spread * lift),
    )
    found: set[int] = set()
    rest: Any
    for short, way in zip(ends, (-1, 1), strict=True):
        if not np.isfinite(short):
            continue
        side = "right" if way < 0 else "left"
        bound = cast("Any", np.searchsorted(rate_j, -rate_i, side))
        rest_i, rest_j = level_i - short * rate_i, level_j - short * rate_j
        # The least from each joint on to the end, or up to it; none beyond the last.
        least = np.append(np.minimum.accumulate(rest_j[::way])[::way], np.inf)
        rest = rest_i + least[bound if way < 0 else bound - 1]
        i = int(np.argmin(rest))
        if rest[i] < 0:
            at = int(bound[i])
            j = at + int(rest_j[at:].argmin()) if way < 0 else int(rest_j[:at].argmin())
            found |= {i, j}
    return found


def sliding(joints: Joints, mu: Array) -> Bounds:
    """Joints of which friction asks T <= mu N, then all of which it asks -T <= mu N.

    `mu`, (k,): Friction coefficients, finite.
    Returns: Shape (k, 2 j).
    """
    grip, sine, cosine = mu[:, None], joints.sine, joints.cosine
    count = cosine.shape[1]
    held, force = grip * cosine, grip * joints.force
    rate = np.concatenate([held - sine, held + sine], axis=1)
    level = np.concatenate([force - joints.lag, force + joints.lag], axis=1)

    def level_h(place: tuple[int, ...]) -> float:
        arch, at = place[0], place[1] % count
        turned = mu[arch] * sine[arch, at]
        turned += cosine[arch, at] if place[1] < count else -cosine[arch, at]
        return float(-joints.angles[arch, at] * turned)

    return Bounds(rate, level, level_h)


def _less(values: Array) -> Array:
    """First less second, of all pairs."""
    return values[:, :, None] - values[:, None, :]


def _sum(values: Array) -> Array:
    return values[:, :, None] + values[:, None, :]
