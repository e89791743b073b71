"""Where a vehicle is worst for a structure: load factors at places, and bounds between them."""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.dispersal import quadrature
from blocksim.blocks.patch import Profile
from blocksim.blocks.problem import Problem
from blocksim.blocks.road import profile_of
from blocksim.blocks.vehicles import Vehicle
from blocksim.common.progress import Progress
from blocksim.limit.capacity import Capacity

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
AT_FIRST = 48
"""Stretches of road that are looked at first where fill spreads loads, about."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Place:
    """Where a vehicle stands, and what the structure bears there.

    `position`: Of the vehicle's origin [m].
    `heading`, {"right", "left"}: Left where the vehicle is turned round.
    `axles`: Where they stand, in the order of the vehicle's [m].
    `live`, (blocks, 3): What the vehicle does to the blocks [mean weight, and that times the
        size]. At a joint it is what it does just beside it, on the side that is worse.
    `load_factor`: inf where nothing of it is on the structure.
    """

    position: float
    heading: str
    axles: tuple[float, ...]
    live: Array
    load_factor: float


@dataclass(frozen=True, eq=False, kw_only=True)
class _Piece:
    """Loads of a vehicle between two places: control points, (degree + 1, blocks, 3)."""

    vehicle: Vehicle
    heading: str
    start: float
    end: float
    control: Array

    def halves(self) -> tuple[_Piece, ...]:
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


@dataclass(frozen=True, eq=False, kw_only=True)
class _Stretch:
    """Pieces that follow each other, and gauges at both ends."""

    pieces: tuple[_Piece, ...]
    first: float
    last: float

    @cached_property
    def rests(self) -> tuple[Array, Array]:
        """Control points within: shares of the way, and loads beside those at the ends."""
        start, end = self.pieces[0].start, self.pieces[-1].end
        one, other = self.pieces[0].control[0], self.pieces[-1].control[-1]
        points = np.concatenate([piece.control for piece in self.pieces])[1:-1]
        shares = np.concatenate(
            [np.linspace(each.start, each.end, len(each.control)) for each in self.pieces]
        )
        along = ((shares[1:-1] - start) / (end - start))[:, None, None]
        return along.ravel(), points - (1 - along) * one - along * other


class WorstPlace:
    """Looks at one piece of road after the other, and then closer where it has to."""

    def __init__(self, problem: Problem) -> None:
        self._problem, self._capacity = problem, Capacity(problem)
        self._profile: Profile = profile_of(problem.assembly)
        self._unit, self._centres = problem.unit_force, problem.assembly.centres[:, 0]
        self._size, owner = problem.assembly.size, self._profile.owner
        # Which block each link of the profile is on; supports and gaps are none.
        self._on = (owner[:, None] == np.arange(len(self._centres))).astype(float)
        self._middles = self._on @ self._centres
        spread, ends = problem.dispersal, self._profile.ends[:, :, 0]
        self._corners = np.unique(ends if spread is None else self._profile.enters(spread))
        self._narrow = NARROW * float(np.ptp(ends))
        degree = 1 if spread is None else SMOOTH
        self._nodes = quadrature(0.0, 1.0)[0][: degree + 1]
        self._to_control = np.linalg.inv(_bernstein(self._nodes, degree))
        self.places: list[Place] = []
        # The largest inverse of a load factor so far.
        self.worst = 0.0
        self._open: list[tuple[float, int, _Stretch]] = []
        self._order = itertools.count()
        self._last: tuple[Array, float] | None = None

    def look(self, vehicle: Vehicle, heading: str, progress: Progress) -> None:
        """Find load factors wherever an axle comes to a corner, or at some of these places."""
        offsets = np.array([place for place, _ in vehicle.axles])
        edges = np.unique((self._corners[:, None] - offsets).ravel())
        pairs = itertools.pairwise(edges.tolist())
        pieces = [each for pair in pairs for each in self._pieces(vehicle, heading, *pair)]
        # Loads that nothing spreads jump from piece to piece.
        spread = self._problem.dispersal is not None
        many = max(1, len(pieces) // AT_FIRST) if spread else 1
        for at in range(0, len(pieces), many):
            progress(at / len(pieces), f"crossing, heading {heading}")
            self._add(pieces[at : at + many])

    def close(self, gap: float) -> float:
        """Halve stretches until none may hide a worse place; return what bounds all gauges."""
        while self._open:
            bound, _, stretch = heapq.heappop(self._open)
            if -bound <= max(self.worst * (1 + gap), NEVER):
                return max(-bound, self.worst)
            pieces = stretch.pieces
            if len(pieces) == 1:
                pieces = pieces[0].halves()
            half = len(pieces) // 2
            middle = self._gauge(pieces[half], pieces[half].start, pieces[half].control[0])
            self._keep(_Stretch(pieces=pieces[:half], first=stretch.first, last=middle))
            self._keep(_Stretch(pieces=pieces[half:], first=middle, last=stretch.last))
        return self.worst

    def _pieces(
        self, vehicle: Vehicle, heading: str, start: float, end: float
    ) -> Iterator[_Piece]:
        """Cut a piece of road until loads are polynomials; leave out where nothing presses."""
        if end - start <= self._narrow:
            return
        tries = start + np.append(self._nodes, TRIED) * (end - start)
        values = self._lives(vehicle, tries)
        control: Array = np.tensordot(self._to_control, values[:-1], axes=1)
        tried = np.tensordot(_bernstein(TRIED, len(control) - 1), control, axes=1)
        differs = np.abs(tried - values[-1]).max()
        if differs > FAITHFUL * vehicle.weight / self._unit:
            middle = (start + end) / 2
            yield from self._pieces(vehicle, heading, start, middle)
            yield from self._pieces(vehicle, heading, middle, end)
        elif values[:-1].any():
            yield _Piece(
                vehicle=vehicle, heading=heading, start=start, end=end, control=control
            )

    def _lives(self, vehicle: Vehicle, positions: Array) -> Array:
        """Return what a vehicle does to the blocks, none of its axles at a corner.

        `positions`, (k,): [m]
        Returns (k, blocks, 3): As of `Place`.
        """
        spread, count = self._problem.dispersal, len(self._centres)
        found = np.zeros((len(positions), count, 3))
        for place, weight in vehicle.axles:
            x, force = positions + place, weight / self._unit
            if spread is None:
                for at, each in enumerate(x.tolist()):
                    # No two bodies are as high: no axle is at a corner.
                    for body, _, _ in self._profile.at(each) or ():
                        if body < count:
                            arm = each - self._centres[body]
                            found[at, body, 1:] -= force, force * arm / self._size
                continue
            share, point = self._profile.spread(x, spread)
            down = force * share
            arms = (point[..., 0] - self._middles) / self._size
            found[..., 1] -= down @ self._on
            found[..., 2] -= (down * arms) @ self._on
        return found

    def _gauge(self, piece: _Piece, position: float, live: Array) -> float:
        """Return the inverse of the load factor of a place, and keep the place."""
        if self._last is not None and _alike(self._last[0], live):
            return self._last[1]
        gauge = self._capacity.gauge(live)
        axles = tuple(position + place for place, _ in piece.vehicle.axles)
        self.places.append(
            Place(position=position, heading=piece.heading, axles=axles, live=live,
                  load_factor=1 / gauge if gauge > NEVER else math.inf)
        )  # fmt: skip
        self._last = live, gauge
        self.worst = max(self.worst, gauge)
        return gauge

    def _add(self, pieces: Sequence[_Piece]) -> None:
        """Gauge the ends of pieces, those that follow each other together."""
        run: list[_Piece] = []
        for piece in pieces:
            if run and not _alike(run[-1].control[-1], piece.control[0]):
                self._gauged(run)
                run = []
            run.append(piece)
        self._gauged(run)

    def _gauged(self, run: Sequence[_Piece]) -> None:
        first = self._gauge(run[0], run[0].start, run[0].control[0])
        last = self._gauge(run[-1], run[-1].end, run[-1].control[-1])
        self._keep(_Stretch(pieces=tuple(run), first=first, last=last))

    def _keep(self, stretch: _Stretch) -> None:
        """Keep a stretch with a bound on its gauges, where that is above those at its ends."""
        shares, rests = stretch.rests
        if not len(shares):
            return
        means = (1 - shares) * stretch.first + shares * stretch.last
        bound = float((means + self._capacity.at_most(rests)).max())
        if bound > max(stretch.first, stretch.last):
            heapq.heappush(self._open, (-bound, next(self._order), stretch))


def _alike(one: Array, other: Array) -> bool:
    """Tell whether loads are the same but for round-off."""
    return bool(np.abs(one - other).max() <= FAITHFUL)


def _bernstein(at: float | Array, degree: int) -> Array:
    """Return Bernstein's polynomials of a degree at places between 0 and 1."""
    u = np.asarray(at)[..., None]
    k = np.arange(degree + 1.0)
    ways = np.array([float(math.comb(degree, each)) for each in range(degree + 1)])
    return ways * u**k * (1 - u) ** (degree - k)
