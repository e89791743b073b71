"""An arch that rocks as three links on four hinges: the truth that engines are held against.

I. J. Oppenheim ("The masonry arch as a four-link mechanism under base motion", Earthquake Engng
Struct. Dyn. 21, 1992, 1005-1017) writes its motion with one angle, that of the first link. Here
it follows from energies: with I(angle) angle'^2 / 2 of motion, V(angle) of weights, and
X(angle) the sum of mass times place across, on ground that accelerates by a,

    I angle'' + I' angle'^2 / 2 + V' + a X' = 0.

L. De Lorenzis, M. DeJong and J. Ochsendorf ("Failure of masonry arches under impulse base
motion", the same 36, 2007, 2119-2136) let it come back: where the angle is 0 again all hinges
close, and those of the mirror image open. Nothing slips, nothing bounces, and impulses act at
the new hinges alone. These do no work on the new motion, so momentum along it stays (`kept`).

`least_loss` asks for less: any joint may open, at either end, and none closes further. Of all
such motions an impact without slip leaves the nearest one, that which loses least energy
(P. Bisegna, S. Coccia, M. Como and N. A. Nodargi, Meccanica 58, 2023, 2079-2093).

Lengths in m, gravity in m/s2, masses those of a density of 1.
"""

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.linalg import null_space
from scipy.optimize import nnls

Array, Complex = NDArray[np.float64], NDArray[np.complex128]
Hinges = tuple[tuple[int, int], ...]
PLACES, FALLEN, SLOW = 601, 0.3, 1e-5
FINE = {"rtol": 1e-10, "atol": 1e-12}


@dataclass(frozen=True)
class Rocks:
    """The first link's angle in time [s, rad], of its mirror image below 0, and impacts [s]."""

    times: Array
    angles: Array
    impacts: list[float]
    falls: bool


@dataclass(frozen=True)
class Arch:
    """A circular arch of equal voussoirs; joints are numbered from the left, from 0 on."""

    radius: float = 10.0
    thickness: float = 1.5
    voussoirs: int = 7
    embrace: float = math.radians(157.5)
    gravity: float = 9.81

    @cached_property
    def joints(self) -> Complex:
        """Inner and outer ends of joints as complex numbers, (joints, 2)."""
        shares = 0.5 - np.arange(self.voussoirs + 1) / self.voussoirs
        sides = self.radius + self.thickness / 2 * np.array([-1.0, 1.0])
        return 1j * np.exp(1j * self.embrace * shares)[:, None] * sides

    @cached_property
    def blocks(self) -> tuple[Array, Complex, Array]:
        """Masses, centres and moments of inertia of voussoirs, parts of a ring."""
        turn = self.embrace / self.voussoirs
        inner, outer = abs(self.joints[0])
        mass = turn * (outer**2 - inner**2) / 2
        centre = (
            4 * math.sin(turn / 2) / 3 / turn * (outer**3 - inner**3) / (outer**2 - inner**2)
        )
        inertia = turn * (outer**4 - inner**4) / 4 - mass * centre**2
        middles = self.joints.sum(axis=1)
        middles = middles[:-1] + middles[1:]
        alike = np.ones(self.voussoirs)
        return mass * alike, centre * middles / abs(middles), inertia * alike

    @cached_property
    def hinges(self) -> Hinges:
        """Joint and side of each hinge: of all that may open, those that the least push opens.

        The ground accelerates to the right, so the arch is pushed to the left.
        """
        found: list[tuple[float, Hinges]] = []
        for at in itertools.combinations(range(self.voussoirs + 1), 4):
            tried = tuple(zip(at, (1, 0, 1, 0), strict=True))
            points, _, places = self.placed(0.0, tried)
            _, spins = _velocities(tried, points, places, self.voussoirs)
            before, after = np.append(0.0, spins)[list(at)], np.append(spins, 0.0)[list(at)]
            _, weights, across = self._rates(0.0, tried)
            # At an outer end what is to the right turns to the left.
            if ((after - before) * np.array([1, -1, 1, -1]) > 0).all() and across < 0:
                found.append((weights / -across, tried))
        return min(found)[1]

    @cached_property
    def starts(self) -> float:
        """Acceleration of the ground from which on it moves [g]."""
        _, weights, across = self._rates(0.0, self.hinges)
        return weights / -across / self.gravity

    def velocities(self, angle: float = 0.0) -> tuple[Complex, Array]:
        """Return velocities and spins of voussoirs where the first link spins by 1."""
        points, _, places = self.placed(angle)
        return _velocities(self.hinges, points, places, self.voussoirs)

    def placed(
        self, angle: float, hinges: Hinges | None = None
    ) -> tuple[Complex, Array, Complex]:
        """Return the four hinges, turns of the three links, and centres of voussoirs."""
        hinges = hinges or self.hinges
        built = np.array([self.joints[each] for each in hinges])
        head = built[0] + (built[1] - built[0]) * np.exp(1j * angle)
        # The third hinge is where circles about the second and the last one cross.
        way, beam, leg = built[3] - head, built[2] - built[1], built[2] - built[3]
        along = (abs(way) ** 2 + abs(beam) ** 2 - abs(leg) ** 2) / (2 * abs(way))
        up = math.copysign(math.sqrt(abs(beam) ** 2 - along**2), (beam / way).imag)
        tail = head + way / abs(way) * complex(along, up)
        points = np.array([built[0], head, tail, built[3]])
        turns = np.angle(np.diff(points) / np.diff(built))
        _, centres, _ = self.blocks
        places = centres.copy()
        for link, ((low, _), (high, _)) in enumerate(itertools.pairwise(hinges)):
            away = centres[low:high] - built[link]
            places[low:high] = points[link] + away * np.exp(1j * turns[link])
        return points, turns, places

    def _rates(self, angle: float, hinges: Hinges) -> tuple[float, float, float]:
        """Return I, V' and X' at an angle."""
        mass, _, inertia = self.blocks
        points, _, places = self.placed(angle, hinges)
        speed, spin = _velocities(hinges, points, places, self.voussoirs)
        moving = float(mass @ abs(speed) ** 2 + inertia @ spin**2)
        return moving, float(self.gravity * mass @ speed.imag), float(mass @ speed.real)

    @cached_property
    def kept(self) -> float:
        """Share of the first link's spin that an impact leaves to its mirror image."""
        before, after = self._impact()
        return -float(after @ before / (after @ after))

    def _impact(self) -> tuple[Array, Array]:
        """Return motions before, and the new one's: momenta over roots of masses."""
        mass, _, inertia = self.blocks
        speed, spin = self.velocities()
        old = np.stack([speed.real, speed.imag, spin], axis=1)
        new = old[::-1] * np.array([-1.0, 1.0, -1.0])
        weight = np.sqrt(np.stack([mass, mass, inertia], axis=1))
        return (old * weight).ravel(), (new * weight).ravel()

    @cached_property
    def least_loss(self) -> tuple[float, float]:
        """Share of energy left, and how far the motion left is from the mirror image's.

        Of motions that slip nowhere and close no joint, the nearest to that before.
        """
        mass, centres, inertia = self.blocks
        weight = np.sqrt(np.stack([mass, mass, inertia], axis=1)).ravel()
        parts, slips = np.zeros((2, *self.joints.shape, 3 * self.voussoirs))
        for (joint, side), end in np.ndenumerate(self.joints):
            # Along the arch to the right, and along the joint outwards.
            out = end / abs(end)
            for block, sign in ((joint - 1, -1.0), (joint, 1.0)):
                if 0 <= block < self.voussoirs:
                    away = 1j * (end - centres[block])
                    for axis, rows in ((-1j * out, parts), (out, slips)):
                        row = [axis.real, axis.imag, (axis.conjugate() * away).real]
                        rows[joint, side, 3 * block : 3 * block + 3] += sign * np.array(row)
        allowed = null_space(slips.reshape(-1, len(weight)) / weight)
        before, mirror = self._impact()
        start = -allowed.T @ before
        opens = (parts.reshape(-1, len(weight)) / weight) @ allowed
        # The nearest in a cone is what is left of the nearest in its polar.
        pushes, _ = nnls(opens.T, -start)
        left = start + opens.T @ pushes
        energy = float(left @ left / (start @ start))
        along = abs(float(left @ (allowed.T @ mirror)))
        away = along / np.linalg.norm(left) / np.linalg.norm(mirror)
        return energy, math.acos(min(1.0, away))

    @cached_property
    def _curves(self) -> list[CubicSpline]:
        """I, V' and X' over the angle."""
        at = np.linspace(0.0, FALLEN, PLACES)
        found = [self._rates(each, self.hinges) for each in at.tolist()]
        return [CubicSpline(at, each) for each in np.transpose(found)]

    def rocks(self, ground: Callable[[float], float], until: float, longest: float) -> Rocks:
        """Follow it on ground that accelerates [m/s2], in steps of at most a length [s]."""
        curves = self._curves
        slope = curves[0].derivative()
        times, angles, impacts = [0.0], [0.0], list[float]()
        now, speed, side = 0.0, 0.0, 1.0

        def gains(time: float, angle: float, speed: float) -> float:
            moving, weights, across = (float(curve(angle)) for curve in curves)
            push = weights + side * ground(time) * across
            return -(push + float(slope(angle)) * speed**2 / 2) / moving

        def lands(_: float, state: Array) -> float:
            return float(state[0])

        def falls(_: float, state: Array) -> float:
            return float(state[0]) - FALLEN

        lands.terminal = falls.terminal = True  # type: ignore[attr-defined]
        lands.direction = -1  # type: ignore[attr-defined]
        while now < until:
            if speed == 0:
                side = math.copysign(1.0, ground(now))
                if gains(now, 0.0, 0.0) <= 0 or gains(now + longest, 0.0, 0.0) <= 0:
                    now += longest
                    times.append(now)
                    angles.append(0.0)
                    continue
            found = solve_ivp(
                lambda time, state: [state[1], gains(time, state[0], state[1])],
                (now, until),
                [0.0, speed],
                events=(lands, falls),
                max_step=longest,
                **FINE,
            )
            times += found.t[1:].tolist()
            angles += (side * found.y[0, 1:]).tolist()
            now, speed = float(found.t[-1]), -self.kept * float(found.y[1, -1])
            if len(found.t_events[1]):
                return Rocks(np.array(times), np.array(angles), impacts, falls=True)
            if len(found.t_events[0]):
                impacts.append(now)
                side, speed = -side, speed if abs(speed) > SLOW else 0.0
        return Rocks(np.array(times), np.array(angles), impacts, falls=False)


def _velocities(
    hinges: Hinges, points: Complex, places: Complex, count: int
) -> tuple[Complex, Array]:
    """Return velocities and spins of blocks where the first link spins by 1."""
    one, two, three = np.diff(points)
    # Round the chain the velocities of its ends add up to nothing.
    sides = np.array([[two.real, three.real], [two.imag, three.imag]])
    second, third = np.linalg.solve(sides, [-one.real, -one.imag])
    spins, starts = (
        np.array([1.0, second, third]),
        np.array([0, 1j * one, 1j * one + 1j * two * second]),
    )
    speed, spin = np.zeros(count, dtype=complex), np.zeros(count)
    for link, ((low, _), (high, _)) in enumerate(itertools.pairwise(hinges)):
        spin[low:high] = spins[link]
        speed[low:high] = starts[link] + 1j * spins[link] * (places[low:high] - points[link])
    return speed, spin
