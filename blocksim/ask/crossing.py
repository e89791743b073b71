"""A vehicle that crosses a structure: its load factor at every place, and the worst place.

The inverse of the load factor is a convex function of the loads (`limit.capacity`). Between
places at which an axle comes to a corner of what lies uppermost, loads are smooth in the place
of the vehicle: straight lines where nothing spreads them, and so the worst place is one of the
ends. Where fill spreads them they are polynomials to round-off. Those lie within the hull of
their control points (Bernstein), of which each is a mean of the loads at the ends and a small
rest. So the load factor between two places is bounded from below by those at the ends, and what
may hide a worse place than the worst one known is halved until nothing may, but for a gap.
"""

from __future__ import annotations

import heapq
import itertools
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from blocksim.blocks.acting import Load
from blocksim.blocks.assembly import Array
from blocksim.blocks.dispersal import quadrature
from blocksim.blocks.patch import Profile
from blocksim.blocks.problem import Problem
from blocksim.blocks.road import profile_of
from blocksim.blocks.vehicles import Vehicle
from blocksim.common.checks import is_number, require
from blocksim.common.errors import InputError
from blocksim.common.progress import Progress, silent
from blocksim.common.shown import Shown
from blocksim.limit import collapse, thrust_range
from blocksim.limit.bearing import settled
from blocksim.limit.capacity import Capacity
from blocksim.limit.crushing import exists
from blocksim.limit.margins import crown

GAP = 1e-6
"""Share of the least load factor within which it is found."""
SMOOTH = 5
"""Degree of the polynomials that loads are where fill spreads them."""
TRIED = 0.37
"""Where between the ends of a piece the polynomials are compared with the loads."""
FAITHFUL = 1e-11
"""Difference that is round-off, over the weight of the vehicle."""
NARROW = 1e-9
"""Width of a piece that is none, over the width of the structure."""
NEVER = 1e-9
"""Inverse of a load factor up to which nothing is too much."""
HEADINGS = ("right", "left")


@dataclass(frozen=True, kw_only=True, eq=False)
class Place:
    """Where a vehicle stands, and what the structure bears there.

    Parameters
    ----------
    position : float
        Of the vehicle's origin [m].
    heading : {"right", "left"}
        Left where the vehicle is turned round.
    axles : tuple of float
        Where they stand [m].
    live : (blocks, 3) float
        What the vehicle does to the blocks [mean weight, and that times the size]. At a joint
        it is what it does just beside it, on the side that is worse.
    load_factor : float
        inf where nothing of it is on the structure.
    """

    position: float
    heading: str
    axles: tuple[float, ...]
    live: Array
    load_factor: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Crossing(Shown):
    """What a vehicle that crosses a structure comes to.

    Parameters
    ----------
    problem : Problem
        The structure, with the vehicle at its worst place as its live load.
    vehicle : Vehicle
    worst : Place
    low : float
        What the load factor is at least, everywhere.
    places : tuple of Place
        Where load factors were found, by heading and from left to right. Between two of them
        the inverse of the load factor is convex where nothing spreads loads.
    wall_s : float
    """

    problem: Problem
    vehicle: Vehicle
    worst: Place
    low: float
    places: tuple[Place, ...]
    wall_s: float

    @property
    def load_factor(self) -> float:
        """The least load factor that was found, at the worst place."""
        return self.worst.load_factor

    @cached_property
    def mechanism(self) -> Array | None:
        """Rates x, y [size] and rotation of the fall at the worst place, (blocks, 3)."""
        return collapse(self.problem).mechanism

    @cached_property
    def thrusts(self) -> tuple[tuple[float, float] | None, ...]:
        """Least and greatest thrust at the crown with the vehicle at each place [N].

        None where the structure falls under it.
        """
        joint = crown(self.problem)
        unit = self.problem.unit_force
        found: list[tuple[float, float] | None] = []
        for place in self.places:
            live = loads_at(self.problem, place.live)
            under = settled(replace(self.problem, live=live, load=1.0))
            ends = (
                None if joint is None or place.load_factor < 1 else thrust_range(under, joint)
            )
            found.append(
                None if ends is None else (ends[0].thrust * unit, ends[1].thrust * unit)
            )
        return tuple(found)

    def __repr__(self) -> str:
        return f"Crossing(load factor {self.load_factor:.9g} at {self.worst.position:.6g} m)"


def crossing(
    problem: Problem, vehicle: Vehicle, *, gap: float = GAP, progress: Progress = silent
) -> Crossing:
    """Find the load factor of a vehicle at every place, both ways, and where it is least.

    Axles beyond the structure stand on the ground.

    Parameters
    ----------
    problem : Problem
        In its plane, at rest without live loads; how fill spreads loads is its own.
    vehicle : Vehicle
    gap : float
        Share of the least load factor within which it is found.
    progress : Progress

    Raises
    ------
    InputError
        If the structure falls without the vehicle, or has live loads of its own.

    Examples
    --------
    >>> from blocksim.blocks.vehicles import vehicle_of
    >>> from blocksim.kinds.circular import CircularArch
    >>> arch = CircularArch(half_angle_deg=60, eta=0.2, friction=0.7, density=2e4)
    >>> round(crossing(arch.problem(), vehicle_of("1@0")).load_factor, 3)
    19.793
    """
    started = time.perf_counter()
    require(is_number(gap, 0, 0.1), "gap", gap, "above 0 and at most 0.1")
    require(not problem.live, "vehicle", vehicle.words, "left out: there are live loads")
    still = problem.has_statics
    require(still, "vehicle", vehicle.words, "gravity in the plane, and ground at rest")
    if not exists(problem):
        raise InputError("vehicle", vehicle.words, "a structure that stands without it")
    ways = (vehicle,) if vehicle.is_alike else (vehicle, vehicle.turned)
    search = _Search(problem)
    for heading, way in zip(HEADINGS, ways, strict=False):
        search.look(way, heading, progress)
    require(bool(search.places), "vehicle", vehicle.words, "a road above blocks that move")
    highest = search.close(gap)
    places = sorted(search.places, key=lambda place: (place.heading != "right", place.position))
    worst = max(places, key=lambda place: 1 / place.load_factor)
    return Crossing(
        problem=replace(problem, live=loads_at(problem, worst.live), load=1.0),
        vehicle=vehicle,
        worst=worst,
        low=1 / highest if highest else math.inf,
        places=tuple(places),
        wall_s=time.perf_counter() - started,
    )


def loads_at(problem: Problem, live: Array) -> tuple[Load, ...]:
    """Return what a vehicle does to the blocks as loads on what lies uppermost."""
    assembly, profile = problem.assembly, profile_of(problem.assembly)
    loads: list[Load] = []
    for index in np.flatnonzero(live[:, 1]).tolist():
        _, force, moment = live[index].tolist()
        x = float(assembly.centres[index, 0]) + assembly.size * moment / force
        mine = np.flatnonzero(profile.body == index)
        left, right = profile.ends[mine, 0, 0], profile.ends[mine, 1, 0]
        aside = np.maximum(np.maximum(left - x, x - right), 0.0)
        piece = int(mine[aside.argmin()])
        on = min(max(x, float(profile.ends[piece, 0, 0])), float(profile.ends[piece, 1, 0]))
        point = np.array([x, profile.height(piece, on)])
        down = np.array([0.0, force * problem.unit_force])
        loads.append(Load(force=down, blocks=(index,), point=point))
    return tuple(loads)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Piece:
    """Loads of a vehicle between two places: control points, (degree + 1, blocks, 3)."""

    vehicle: Vehicle
    heading: str
    start: float
    end: float
    control: Array

    def halves(self) -> tuple[_Piece, _Piece]:
        """Cut it in the middle, as de Casteljau does."""
        left, right, row = [self.control[0]], [self.control[-1]], self.control
        while len(row) > 1:
            row = (row[:-1] + row[1:]) / 2
            left.append(row[0])
            right.append(row[-1])
        middle = (self.start + self.end) / 2
        return (
            replace(self, end=middle, control=np.array(left)),
            replace(self, start=middle, control=np.array(right[::-1])),
        )


class _Search:
    """Looks at one piece of road after the other, and then closer where it has to."""

    def __init__(self, problem: Problem) -> None:
        self._problem, self._capacity = problem, Capacity(problem)
        self._profile: Profile = profile_of(problem.assembly)
        self._unit, self._centres = problem.unit_force, problem.assembly.centres[:, 0]
        spread, ends = problem.dispersal, self._profile.ends[:, :, 0]
        self._corners = np.unique(ends if spread is None else self._profile.enters(spread))
        self._narrow = NARROW * float(np.ptp(ends))
        degree = 1 if spread is None else SMOOTH
        self._nodes = quadrature(0.0, 1.0)[0][: degree + 1]
        self._to_control = np.linalg.inv(_bernstein(self._nodes, degree))
        self.places: list[Place] = []
        # The largest inverse of a load factor so far.
        self.worst = 0.0
        self._open: list[tuple[float, int, _Piece, float, float]] = []
        self._order = itertools.count()
        self._last: tuple[Array, float] | None = None

    def look(self, vehicle: Vehicle, heading: str, progress: Progress) -> None:
        """Find load factors wherever an axle comes to a corner."""
        offsets = np.array([place for place, _ in vehicle.axles])
        edges = np.unique((self._corners[:, None] - offsets).ravel())
        pairs = list(itertools.pairwise(edges.tolist()))
        for index, (start, end) in enumerate(pairs):
            progress(index / len(pairs), f"crossing, heading {heading}")
            for piece in self._pieces(vehicle, heading, start, end):
                first = self._gauge(piece, piece.start, piece.control[0])
                self._add(piece, first, self._gauge(piece, piece.end, piece.control[-1]))

    def close(self, gap: float) -> float:
        """Halve pieces until none may hide a worse place; return what bounds all gauges."""
        while self._open:
            bound, _, piece, first, second = heapq.heappop(self._open)
            if -bound <= max(self.worst * (1 + gap), NEVER):
                return max(-bound, self.worst)
            left, right = piece.halves()
            middle = self._gauge(piece, left.end, left.control[-1])
            self._add(left, first, middle)
            self._add(right, middle, second)
        return self.worst

    def _pieces(
        self, vehicle: Vehicle, heading: str, start: float, end: float
    ) -> Iterator[_Piece]:
        """Cut a piece of road until loads are polynomials; leave out where nothing presses."""
        if end - start <= self._narrow:
            return
        values = np.array([self._live(vehicle, start + u * (end - start)) for u in self._nodes])
        control = np.tensordot(self._to_control, values, axes=1)
        tried = np.tensordot(_bernstein(TRIED, len(control) - 1), control, axes=1)
        differs = np.abs(tried - self._live(vehicle, start + TRIED * (end - start))).max()
        if differs > FAITHFUL * vehicle.weight / self._unit:
            middle = (start + end) / 2
            yield from self._pieces(vehicle, heading, start, middle)
            yield from self._pieces(vehicle, heading, middle, end)
        elif values.any():
            yield _Piece(
                vehicle=vehicle, heading=heading, start=start, end=end, control=control
            )

    def _live(self, vehicle: Vehicle, position: float) -> Array:
        """Return what a vehicle does to the blocks, none of its axles at a corner."""
        spread, count = self._problem.dispersal, len(self._centres)
        found = np.zeros((count, 3))
        for place, weight in vehicle.axles:
            x = position + place
            if spread is None:
                # No two bodies are as high: no axle is at a corner.
                borne = self._profile.at(x) or ()
                body = np.array([each for each, _, _ in borne], dtype=np.int64)
                share, across = np.ones(len(body)), np.full(len(body), x)
            else:
                body, share, point = self._profile.under(x, spread)
                across = point[:, 0]
            on = body < count
            body, force = body[on], share[on] * weight / self._unit
            np.add.at(found[:, 1], body, -force)
            arm = (across[on] - self._centres[body]) / self._problem.assembly.size
            np.add.at(found[:, 2], body, -force * arm)
        return found

    def _gauge(self, piece: _Piece, position: float, live: Array) -> float:
        """Return the inverse of the load factor of a place, and keep the place."""
        if self._last is not None and np.allclose(self._last[0], live, rtol=0, atol=FAITHFUL):
            return self._last[1]
        factor = self._capacity.of(live).load_factor
        assert factor is not None  # noqa: S101 - it stands without the vehicle
        axles = tuple(position + place for place, _ in piece.vehicle.axles)
        self.places.append(
            Place(position=position, heading=piece.heading, axles=axles, live=live,
                  load_factor=factor)
        )  # fmt: skip
        self._last = live, 1 / factor
        self.worst = max(self.worst, 1 / factor)
        return 1 / factor

    def _add(self, piece: _Piece, first: float, second: float) -> None:
        """Keep a piece with a bound on its gauges, where that is above those at its ends."""
        degree = len(piece.control) - 1
        shares = np.linspace(0, 1, degree + 1)[1:-1]
        bound = max(first, second)
        for share, point in zip(shares, piece.control[1:-1], strict=True):
            rest = point - (1 - share) * piece.control[0] - share * piece.control[-1]
            mean = (1 - share) * first + share * second
            bound = max(bound, mean + self._capacity.at_most(rest))
        if bound > max(first, second):
            heapq.heappush(self._open, (-bound, next(self._order), piece, first, second))


def _bernstein(at: float | Array, degree: int) -> Array:
    """Return Bernstein's polynomials of a degree at places between 0 and 1."""
    u = np.asarray(at)[..., None]
    k = np.arange(degree + 1.0)
    ways = np.array([float(math.comb(degree, each)) for each in range(degree + 1)])
    return ways * u**k * (1 - u) ** (degree - k)
