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

import math
import time
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from blocksim.ask.worst import Place, WorstPlace
from blocksim.blocks.acting import Load
from blocksim.blocks.assembly import Array
from blocksim.blocks.patch import Profile
from blocksim.blocks.problem import Problem
from blocksim.blocks.road import profile_of
from blocksim.blocks.vehicles import Vehicle
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.progress import Progress, silent
from blocksim.common.shown import Shown
from blocksim.limit import collapse, thrust_range
from blocksim.limit.crushing import mobilised
from blocksim.limit.margins import crown
from blocksim.limit.statics import exists

GAP = 1e-6
"""Share of the least load factor within which it is found."""
ROUNDING = 1e-12
"""Share of it within which two places are as bad."""
HEADINGS = ("right", "left")


@dataclass(frozen=True, kw_only=True, eq=False)
class Crossing(Shown):
    """What a vehicle that crosses a structure comes to.

    Parameters
    ----------
    problem : Problem
        The structure, with the vehicle at its worst place as its live load.
    vehicle : Vehicle
    worst : Place
        Where the load factor is least: `position` [m], `heading` and `load_factor`.
    low : float
        What the load factor is at least, everywhere.
    places : tuple of Place
        Where load factors were found, by heading and from left to right. Between two of
        them the inverse of the load factor is convex where nothing spreads loads.
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
        joint, profile = crown(self.problem), profile_of(self.problem.assembly)
        unit = self.problem.unit_force
        found: list[tuple[float, float] | None] = []
        for place in self.places:
            live = loads_at(self.problem, profile, place.live)
            under = mobilised(replace(self.problem, live=live, load=1.0))
            ends = (
                None if joint is None or place.load_factor < 1 else thrust_range(under, joint)
            )
            found.append(
                None if ends is None else (ends[0].thrust * unit, ends[1].thrust * unit)
            )
        return tuple(found)

    def __repr__(self) -> str:
        return f"Crossing(load factor {self.load_factor:.9g} at {self.worst.position:.6g} m)"


def crossing(problem: Problem, vehicle: Vehicle, *, progress: Progress = silent) -> Crossing:
    """Find the load factor of a vehicle at every place, both ways, and where it is least.

    Axles beyond the structure stand on the ground.

    Parameters
    ----------
    problem : Problem
        In its plane, at rest without live loads; how fill spreads loads is its own.
    vehicle : Vehicle
    progress : callable, optional

    Returns
    -------
    Crossing

    Raises
    ------
    InputError
        If it falls without the vehicle, has live loads, or no road above blocks that move.

    Examples
    --------
    >>> from blocksim import CircularArch, vehicle_of
    >>> arch = CircularArch(half_angle_deg=60, eta=0.2, friction=0.7, density=2e4)
    >>> round(crossing(arch.problem(), vehicle_of("1@0")).load_factor, 3)
    19.793
    """
    started = time.perf_counter()
    require(not problem.live, "vehicle", vehicle.words, "left out: there are live loads")
    still = problem.has_statics
    require(still, "vehicle", vehicle.words, "gravity in the plane, and ground at rest")
    if not exists(problem):
        raise InputError("vehicle", vehicle.words, "a structure that stands without it")
    ways = (vehicle,) if vehicle.is_alike else (vehicle, vehicle.turned)
    search = WorstPlace(problem)
    for heading, way in zip(HEADINGS, ways, strict=False):
        search.look(way, heading, progress)
    require(bool(search.places), "vehicle", vehicle.words, "a road above blocks that move")
    highest = search.close(GAP)
    places = sorted(search.places, key=lambda place: (place.heading != "right", place.position))
    most = (1 - ROUNDING) * max(1 / place.load_factor for place in places)
    # Of two places that mirror each other the first, whatever is rounded.
    worst = next(place for place in places if 1 / place.load_factor >= most)
    profile = profile_of(problem.assembly)
    return Crossing(
        problem=replace(problem, live=loads_at(problem, profile, worst.live), load=1.0),
        vehicle=vehicle,
        worst=worst,
        low=1 / highest if highest else math.inf,
        places=tuple(places),
        wall_s=time.perf_counter() - started,
    )


def loads_at(problem: Problem, profile: Profile, live: Array) -> tuple[Load, ...]:
    """Return what a vehicle does to the blocks as loads on what lies uppermost."""
    assembly = problem.assembly
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
