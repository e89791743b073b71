"""`direct` in space: smooth between impacts, each step's contacts solved to the end.

Where nothing closes a step is of second order (Moreau and Jean, theta = 1/2): forces are those
of its middle, contact and friction hold for the velocities at its end, and blocks go on by the
mean of both. A step in which something closes is of first order: what is open may close, but
not pass. It is short unless impacts crowd. What overlaps all the same is pushed apart, which
changes no velocity.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.blocks.space.points import JointPoints
from blocksim.engines.base import Quality, Settings
from blocksim.engines.energy import Balance
from blocksim.engines.shaken import OnGround
from blocksim.engines.solid import MOST_FRICTION
from blocksim.engines.solid.between import DrawnApart, FrictionBetween, body_of
from blocksim.engines.solid.bodies import Bodies, Place
from blocksim.engines.solid.coulomb import solve
from blocksim.engines.solid.dilation import dilating
from blocksim.engines.solid.meeting import Points, meet, near
from blocksim.engines.solid.memory import Borne, handed
from blocksim.engines.solid.path import STEPS
from blocksim.engines.solid.seen import Seen, gaps_of, seen
from blocksim.engines.solid.step import Step

COARSE = 1e-5
"""Residual of a step that is halved."""
BRIEFLY = 150
"""Most steps along a path to one in which nothing closes: often there is none."""
HALVINGS = 5
"""How often a step that is not solved is halved."""
NEARER, QUIET = 6, 16
"""How often a step is halved to come near to an impact, if so many steps before had none."""
SHUT, PRESSED = 1e-6, 1e-4
"""Gap up to which a contact that moves slowly is closed, and one that pressed [size]."""
SLOWLY = 1e-4
"""Velocity along the normal that is slow [sqrt(size g)]."""
PASSED = 1e-9
"""Overlap at the end of a step by which what was open has closed [size]."""
DEEP = 1e-6
"""Overlap that is pushed apart at once [size]."""
PUSHES = 6
"""Most looks at what overlaps, with a push after each but the last."""
MOST = 5e-4
"""Overlap after impacts beyond which the step is halved [size]."""
SHORT = 0.1
"""Share of the usual step below which a step tells nothing of accelerations."""
NEAR = 1e-3
"""Beyond the way of a step, how near blocks are that are looked at [size]."""


class Found(NamedTuple):
    """Points of contact about a place.

    `points`: Their gaps are less those drawn, and edges are rounded.
    `friction`, (points,).
    `overlap`: How deep sharp edges are within each other [size].
    """

    points: Points
    friction: Array
    overlap: float


class SolidBlocks(OnGround):
    """Blocks in space, their poses and velocities: a world of `engines/base.py`.

    Poses are x, y, z in units of the size, then rotation vectors since they were built.
    """

    def __init__(self, problem: Problem[SpatialAssembly], settings: Settings) -> None:
        self._asked, self._gravity = problem, problem.gravity
        self._step, self._time, self._sets_off = settings.step, 0.0, False
        self.bodies = bodies = Bodies(problem)
        self._contacts = JointPoints(problem)
        self._place, self._velocities = self.bodies.built, np.zeros_like(self.bodies.inertia)
        self._speeding = np.zeros_like(self._velocities)
        self._friction = FrictionBetween(problem, self.bodies.hulls)
        self._drawn = DrawnApart(self.bodies)
        self._body = body_of(self.bodies.hulls)
        self._borne = Borne.nothing(self._points(self._place, 0.0).points)
        self._residual = self._penetration = 0.0
        self._given: Array | None = None
        self._quiet = QUIET
        self._balance = Balance(
            bodies.potential, lambda _, moved: bodies.kinetic(moved), self._place
        )

    def hold(self, sweeps: int) -> Array:  # noqa: ARG002 - the protocol's
        """Solve the contacts as they were built, from rest; the blocks stay.

        Returns (blocks, 6).
        """
        found = solve(at_rest(self.bodies), self._given)
        points = self._points(self._place, 0.0).points
        self._borne = handed(found.forces, self._contacts, points, self._body)
        self._residual = max(self._residual, found.residual)
        rates = found.x.reshape(-1, 6) / self.bodies.root
        rates[:, 3:] = np.einsum("bij,bj->bi", self._place.turns[:-1], rates[:, 3:])
        return rates

    def begin(self, forces: Array) -> None:
        """Begin anew, with forces at the points of joints, (points, 3) [mean weights]."""
        self._given, self._residual = forces, 0.0

    def advance(self, steps: int) -> None:
        """Let the blocks move."""
        for _ in range(steps):
            rested = self._asked.shaking is not None and self._is_at_rest
            before = vars(self).copy() if rested else {}
            self._move(self._step)
            if rested and not self._is_at_rest:
                self._set_off(self._step, before)
            self._balance.look(self._place, self._velocities, self._velocities)

    def poses(self) -> Array:
        """Return centres and rotation vectors, (blocks, 6)."""
        return self.bodies.poses(self._place)

    def quality(self) -> Quality:
        """Tell how well contact and friction have been kept so far."""
        return Quality(
            residual=self._residual if math.isfinite(self._residual) else math.inf,
            penetration=self._penetration,
            gain=self._balance.gain,
        )

    def _speeds(self) -> Array:
        """Return the largest velocity of each block's corners, at most, (blocks,)."""
        speed: Array = np.linalg.norm(self._velocities[:, :3], axis=1)
        return speed + self.bodies.reach * np.linalg.norm(self._velocities[:, 3:], axis=1)

    def _move(self, step: float) -> None:
        """Go on for a time."""
        left, halvings, nearer = step, 0, 0
        there: Found | None = None
        nearest = NEARER if self._quiet >= QUIET else 0
        quiet = self._quiet + 1
        while left > 1e-9 * step and math.isfinite(self._residual):
            part = min(left, step / 2 ** (halvings + nearer), self._longest(step))
            before = vars(self).copy()
            worst, self._residual = self._residual, 0.0
            share = self._smooth(part)
            closes = share < 1
            if closes:
                vars(self).update(before)
                if nearer < nearest:
                    halves = math.ceil(-math.log2(max(share, 2.0**-NEARER)))
                    nearer = min(nearest, nearer + halves)
                    continue
                self._residual = 0.0
                self._closing(part)
            # Blocks may have come to overlap where they were not near along a face before.
            there = self._points(self._place, 0.0)
            deep = depth(there.points.gaps)
            if (self._residual > COARSE or deep > MOST) and halvings < HALVINGS:
                vars(self).update(before)
                halvings += 1
                continue
            if closes:
                quiet = nearest = nearer = 0
            self._residual = max(worst, self._residual)
            left -= part
        self._quiet = quiet
        if there is not None:
            self._push_apart(there)

    def _longest(self, step: float) -> float:
        """Return how long a part of a step may be, lest blocks pass through each other.

        Two that are near go by half of what both are thick, at most: so seen in the middle of
        it they meet on the sides that they meet on.
        """
        hulls, speeds = self.bodies.hulls, np.append(self._speeds(), 0.0)
        if 2 * step * speeds.max() <= hulls.thickness.min():
            return step
        one, other = near(hulls.placed(*self._place), step * speeds[hulls.owner]).T
        shift = np.vstack([self._velocities[:, :3], np.zeros(3)])
        turning = speeds - np.linalg.norm(shift, axis=1)
        a, b = hulls.owner[one], hulls.owner[other]
        fast = np.linalg.norm(shift[a] - shift[b], axis=1) + turning[a] + turning[b]
        thick = (hulls.thickness[one] + hulls.thickness[other]) / 2
        return step / max(1.0, float((step * fast / thick).max(initial=0.0)))

    def _smooth(self, step: float) -> float:
        """Take a step in which what is open stays open; tell up to which share of it that does.

        That is 1 where nothing closes, and a half where the step is not solved.
        """
        self._gravity = self._gravity_in(step)
        velocities, speeding = self._velocities, self._speeding
        gain = step * speeding
        middle = self._place.moved(step / 2 * velocities + step / 8 * gain)
        points, friction, _ = self._points(middle, step)
        gone = self._place.moved(step * velocities + step / 2 * gain)
        first, last = (
            seen(self.bodies, points, middle, there) for there in (self._place, gone)
        )
        now = seen(self.bodies, points, middle, middle)
        root = self.bodies.root
        scaled = root * velocities
        rate = first.along(scaled)[:, 0]
        pressed = self._borne.at(points, self._body)[:, 0] > 0
        shut = ((np.abs(rate) <= SLOWLY) & (first.gaps <= SHUT)) | (
            pressed & (first.gaps <= PRESSED)
        )
        at_end = scaled + root * gain
        drift = now.along(scaled) + last.along(at_end) - now.along(at_end)
        drift[:, 0] += np.maximum(first.gaps, 0.0) / step
        found = self._solve(points, friction, now, drift / step, shut, middle, step)
        if self._residual > COARSE:
            return 0.5
        self._advance(step, found, 0.5)
        if step > SHORT * self._step:
            self._speeding = found
        after = gaps_of(self.bodies, points, middle, self._place)
        opened = first.gaps > PASSED
        passes = ~shut & (after < np.where(opened, 0.0, first.gaps) - PASSED)
        share = np.where(opened, first.gaps, 0.0)[passes] / (first.gaps - after)[passes]
        return float(share.min(initial=1.0))

    def _closing(self, step: float) -> None:
        """Take a step of first order: what is open may close, but not pass."""
        self._gravity, velocities = self._gravity_in(step), self._velocities
        middle = self._place.moved(step / 2 * velocities)
        points, friction, _ = self._points(middle, step)
        gaps = gaps_of(self.bodies, points, middle, self._place)
        now = seen(self.bodies, points, middle, middle)
        drift = now.along(self.bodies.root * velocities)
        drift[:, 0] += np.maximum(gaps, 0.0) / step
        every = np.ones(len(points.gaps), dtype=bool)
        found = self._solve(points, friction, now, drift / step, every, middle, step, STEPS)
        if math.isfinite(self._residual):
            self._advance(step, found, 1.0)

    def _advance(self, step: float, speeding: Array, share: float) -> None:
        """Go on with velocities that gain, and with a share of that on the way."""
        gained = step * speeding
        self._place = self._place.moved(step * (self._velocities + share * gained))
        self._velocities = self._velocities + gained

    def _solve(
        self,
        points: Points,
        friction: Array,
        now: Seen,
        drift: Array,
        taken: NDArray[np.bool_],
        middle: Place,
        step: float,
        most: int = BRIEFLY,
    ) -> Array:
        """Solve a step's contacts, of points that are taken, for the accelerations in it."""
        bodies = self.bodies
        turning = bodies.turning(self._velocities + step / 2 * self._speeding)
        pull, at = bodies.pull(middle, self._gravity), np.flatnonzero(taken)
        asked = bodies.asked(
            now.rows[at], now.sides[at], drift[at], pull + turning, friction[at]
        )
        borne = self._borne.at(points, self._body)[at]
        found = solve(asked, borne, most)
        self._borne = Borne.nothing(points)
        self._borne.forces[at] = found.forces
        self._residual = float(np.maximum(self._residual, found.residual))
        return found.x.reshape(-1, 6) / bodies.root

    def _points(self, place: Place, step: float) -> Found:
        """Find the points of contact about a place."""
        hulls = self.bodies.hulls.placed(*place)
        gravity = float(np.linalg.norm(self._gravity))
        way = np.append(step * (self._speeds() + 2 * step * gravity) + NEAR, 0.0)[hulls.owner]
        pairs = near(hulls, way)
        points = meet(hulls, pairs, way[pairs].sum(axis=1))
        drawn, rounded = self._drawn.at(points)
        sharp = points.gaps - drawn
        gaps = sharp + rounded
        near_by = gaps <= way[points.before] + way[points.after]
        points = points._replace(gaps=gaps).at(near_by)
        return Found(points, self._friction.at(points), -float(sharp.min(initial=0.0)))

    def _push_apart(self, there: Found) -> None:
        """Move blocks that overlap apart, as little as contact allows.

        Again where that pushed them into others; the place with the least overlap is kept.

        `there`: What meets where they are.
        """
        least, place, overlap = math.inf, self._place, 0.0
        for look in range(PUSHES):
            points, friction, sharp = there
            now = seen(self.bodies, points, self._place, self._place)
            deep = depth(now.gaps)
            if deep < least:
                least, place, overlap = deep, self._place, sharp
            if deep <= DEEP or look == PUSHES - 1:
                break
            drift = np.zeros((len(now.gaps), 3))
            drift[:, 0] = now.gaps / deep
            still = np.zeros_like(self._velocities)
            asked = self.bodies.asked(now.rows, now.sides, drift, still, friction)
            forces = dilating(asked)
            if forces is None:
                break
            way = deep * asked.pushed_by(forces).reshape(-1, 6) / self.bodies.root
            self._place = self._place.moved(way)
            there = self._points(self._place, 0.0)
        self._place = place
        self._penetration = max(self._penetration, overlap)


def depth(gaps: Array) -> float:
    """Return how deep blocks are within each other, deeper than edges are rounded."""
    return -float(gaps.min(initial=0.0))


def at_rest(bodies: Bodies) -> Step:
    """Return what the contacts of blocks as they were built ask, from rest."""
    contacts, assembly = JointPoints(bodies.problem), bodies.problem.assembly
    places = assembly.points / assembly.size
    axes, sides = contacts.axes[contacts.joint], assembly.sides.T[contacts.joint]
    rows = bodies.rows(axes, places, sides, bodies.built)
    friction = np.minimum(contacts.friction, MOST_FRICTION)
    pull = bodies.pull(bodies.built, bodies.problem.gravity)
    return bodies.asked(rows, sides, np.zeros((len(places), 3)), pull, friction)
