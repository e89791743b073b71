"""Fill as soil: what it is made of, what it weighs, and how it presses from the side.

Fill lies between a level road and what lies uppermost. At a place below the road the soil above
it weighs so much; from the side it presses by a share of that, which is a number of Rankine's
(1857) or Jaky's (1944). Soil that something moves into bears more, up to a share of its passive
resistance. Surfaces are those of the blocks as they are drawn, with straight sides.
"""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from blocksim.blocks.acting import Load
from blocksim.blocks.assembly import Array
from blocksim.blocks.dispersal import quadrature
from blocksim.common.checks import COORDINATE, LENGTH, PER_VOLUME, Range, require
from blocksim.common.errors import InputError

if TYPE_CHECKING:
    from blocksim.blocks.patch import Profile

Sides = tuple[float, float]
"""Of the soil to the left of a surface, and of that to its right."""
COEFFICIENT = Range(low=0, high=100)
"""Pressure from the side over the weight above."""
PRESSURES = ("at-rest", "active")
NOTHING = 1e-12
"""Share of the largest force that is none."""


@dataclass(frozen=True, kw_only=True)
class Soil:
    """What fill is made of, and how it presses from the side.

    `unit_weight`: Weight per volume where nothing else is said [N/m^3].
    `height`: Of the road over the highest point of what lies uppermost [m]; None where a maker
        knows its fill, and weighs it.
    `regions`, tuple of (float, float, float): From one x to another [m], and another weight per
        volume there; later ones count.
    `layers`, tuple of (float, float): From the road downwards, thickness [m] and weight per
        volume.
    `backing`, (float, float): Its height over the lowest point of what lies uppermost [m], and
        its weight per volume.
    `pressure`, (float, float): From the side over the weight above, left and right; 0 for none.
    `passive`, (float, float): The most that soil bears from the side, over the same; 0 where
        that is not counted on.
    """

    unit_weight: float
    height: float | None = None
    regions: tuple[tuple[float, float, float], ...] = ()
    layers: tuple[tuple[float, float], ...] = ()
    backing: tuple[float, float] | None = None
    pressure: Sides = (0.0, 0.0)
    passive: Sides = (0.0, 0.0)

    def __post_init__(self) -> None:
        """Check the ranges."""
        PER_VOLUME.require("fill_unit_weight", self.unit_weight)
        for low, high, heavy in self.regions:
            COORDINATE.require("fill_region", low)
            COORDINATE.require("fill_region", high)
            require(low < high, "fill_region", f"{low:g} {high:g}", "the left end first")
            PER_VOLUME.require("fill_region", heavy)
        backing = () if self.backing is None else (("backing", self.backing),)
        for name, (high, heavy) in (*(("fill_layer", each) for each in self.layers), *backing):
            LENGTH.require(name, high)
            PER_VOLUME.require(name, heavy)
        for name, sides in (("fill_pressure", self.pressure), ("fill_passive", self.passive)):
            for each in sides:
                COEFFICIENT.require(name, each)
        for least, most in zip(self.pressure, self.passive, strict=True):
            allowed = f"a share that bears at least what presses, {least:g} of the weight above"
            require(not most or most > least, "fill_passive", f"{most:g}", allowed)

    @property
    def words(self) -> tuple[str, ...]:
        """What is said of it, beside its height and weight."""
        kilo = 1000.0
        said = [
            f"{heavy / kilo:g} kN/m3 from x = {low:g} to {high:g} m"
            for low, high, heavy in self.regions
        ]
        said += [f"layer of {each:g} m, {heavy / kilo:g} kN/m3" for each, heavy in self.layers]
        if self.backing is not None:
            said.append(f"backing {self.backing[0]:g} m high, {self.backing[1] / kilo:g} kN/m3")
        if any(self.pressure):
            said.append(f"presses from the side by {_both(self.pressure)} of the weight above")
        if any(self.passive):
            said.append(f"bears up to {_both(self.passive)} of it where it is moved into")
        return tuple(said)

    def loads(self, profile: Profile, depths: Array, road: float) -> tuple[Load, ...]:
        """Return what soil does to blocks besides the weight that a maker counts.

        `depths`, (blocks,): Of those that move, which come first [m].
        `road`: Height of the road [m].
        """
        found: dict[tuple[int, bool], list[Array]] = defaultdict(list)
        for body, parts in self._parts(profile, depths, road, self.pressure):
            found[body, True].append(parts)
        return _loads(found)

    def bearing(self, profile: Profile, depths: Array, road: float) -> tuple[Load, ...]:
        """Return what soil bears more at most, of each block and side of its own."""
        if not any(self.passive):
            return ()
        least, most = np.array(self.pressure), np.array(self.passive)
        more = tuple(np.where(most > 0, most - least, 0.0).tolist())
        found: dict[tuple[int, bool], list[Array]] = defaultdict(list)
        for body, parts in self._parts(profile, depths, road, more):
            for rises in (True, False):
                mine = parts[parts[:, 2] > 0 if rises else parts[:, 2] < 0]
                found[body, rises].append(mine * [1.0, 1.0, 1.0, 0.0])
        return _loads(found)

    def _parts(
        self, profile: Profile, depths: Array, road: float, sides: Sides
    ) -> Iterator[tuple[int, Array]]:
        """Return parts of the surface of each body: x, y, force across, and force down."""
        chain = profile.chain
        low = float(profile.ends[profile.body < depths.size, :, 1].min())
        levels = self._levels(road, low)
        edges = sorted({x for low, high, _ in self.regions for x in (low, high)})
        for link, body in enumerate(profile.owner.tolist()):
            if 0 <= body < depths.size:
                parts = self._along(chain[link], chain[link + 1], edges, levels, sides)
                deep = float(depths[body])
                yield body, parts * np.array([1.0, 1.0, deep, deep])

    def _along(
        self,
        start: Array,
        end: Array,
        edges: list[float],
        levels: list[tuple[float, float | None]],
        sides: Sides,
    ) -> Array:
        """Return the parts of a straight surface, as of `_parts`."""
        way = end - start
        cuts = {0.0, 1.0}
        for axis, values in ((0, edges), (1, [level for level, _ in levels])):
            if way[axis]:
                cuts |= {float((each - start[axis]) / way[axis]) for each in values}
        inside = sorted(cut for cut in cuts if 0 <= cut <= 1)
        coefficient = sides[0] if way[1] > 0 else sides[1]
        found: list[list[float]] = []
        for one, other in itertools.pairwise(inside):
            for at, share in zip(*quadrature(one, other), strict=True):
                x, y = (start + at * way).tolist()
                weight, counted = self._above(x, y, levels)
                across, down = coefficient * weight, weight - counted
                found.append([x, y, across * share * way[1], down * share * way[0]])
        return np.array(found).reshape(-1, 4)

    def _levels(self, road: float, low: float) -> list[tuple[float, float | None]]:
        """Return heights from the road downwards, and what weighs below each; None for fill."""
        levels: list[tuple[float, float | None]] = []
        at = road
        for thick, heavy in self.layers:
            levels.append((at, heavy))
            at -= thick
        levels.append((at, None))
        if self.backing is not None:
            levels.append((min(at, low + self.backing[0]), self.backing[1]))
        return levels

    def _above(
        self, x: float, y: float, levels: list[tuple[float, float | None]]
    ) -> tuple[float, float]:
        """Return what soil weighs above a place, and what of that a maker counts [N/m^2]."""
        usual = self.unit_weight
        for low, high, heavy in self.regions:
            if low <= x <= high:
                usual = heavy
        weight, road = 0.0, levels[0][0]
        for place, (top, heavy) in enumerate(levels):
            bottom = levels[place + 1][0] if place + 1 < len(levels) else -math.inf
            deep = max(0.0, top - max(y, bottom))
            weight += deep * (usual if heavy is None else heavy)
        counted = 0.0 if self.height is not None else self.unit_weight * max(0.0, road - y)
        return weight, counted


def _loads(found: dict[tuple[int, bool], list[Array]]) -> tuple[Load, ...]:
    """Return forces on blocks from parts of their surfaces: one across, one down."""
    known = [(body, np.concatenate(parts)) for (body, _), parts in sorted(found.items())]
    most = max((float(np.abs(parts[:, 2:]).sum()) for _, parts in known), default=0.0)
    loads: list[Load] = []
    for body, parts in known:
        # Forces to both sides may balance each other, but turn the block.
        for column, way in ((2, (1.0, 0.0)), (3, (0.0, -1.0))):
            for mine in (parts[parts[:, column] > 0], parts[parts[:, column] < 0]):
                total = float(mine[:, column].sum())
                if abs(total) <= NOTHING * most:
                    continue
                point = np.average(mine[:, :2], axis=0, weights=mine[:, column])
                loads.append(Load(force=total * np.array(way), blocks=(body,), point=point))
    return tuple(loads)


def coefficients(words: str, angle: float | None) -> Sides:
    """Read how soil presses from the side: at-rest, active or a number, or two of them.

    `words`: Of the left and of the right, divided by a comma; one for both.
    `angle`: Of friction of the soil [rad].

    Examples
    --------
    >>> left, right = coefficients("0.5,active", math.radians(30))
    >>> left, round(right, 3)
    (0.5, 0.333)
    """
    found: list[float] = []
    for word in words.split(","):
        if word in PRESSURES:
            if angle is None:
                allowed = "a number, or --fill-friction-angle beside it"
                raise InputError("fill_pressure", words, allowed)
            sine = math.sin(angle)
            found.append(1 - sine if word == "at-rest" else (1 - sine) / (1 + sine))
            continue
        found.append(_number("fill_pressure", words, word))
    return _two("fill_pressure", words, found)


def resistance(words: str, angle: float | None) -> Sides:
    """Read which share of its passive resistance soil bears: one share, or two of them."""
    if angle is None:
        raise InputError("fill_passive", words, "left out, or --fill-friction-angle beside it")
    sine = math.sin(angle)
    passive = (1 + sine) / (1 - sine)
    shares = [_number("fill_passive", words, word) for word in words.split(",")]
    for share in shares:
        require(0 <= share <= 1, "fill_passive", words, "a share from 0 to 1, or two: 0.5,0")
    left, right = _two("fill_passive", words, shares)
    return left * passive, right * passive


def _number(field: str, words: str, word: str) -> float:
    try:
        return float(word)
    except ValueError:
        kinds = f"{', '.join(PRESSURES)} or " if field == "fill_pressure" else ""
        raise InputError(field, words, f"{kinds}a number, or two by a comma") from None


def _two(field: str, words: str, found: list[float]) -> Sides:
    require(len(found) <= 2, field, words, "one of both sides, or two: left,right")
    return found[0], found[-1]


def _both(sides: Sides) -> str:
    left, right = sides
    if left == right:
        return f"{left:.4g}"
    return f"{left:.4g} (left) and {right:.4g} (right)"
