"""How far blocks are from falling: what their joints need, and the range of their thrust.

An arch or a wall has many states of equilibrium. Its *line of thrust* joins the points at
which joints press. Two of the states have the least and the greatest thrust (Heyman 1966).
A third asks least of the joints: it leaves the same share of every joint's width, and of its
friction, unused. That is the geometrically safest line of thrust.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.common.errors import Unsolved
from blocksim.limit.bearing import Bearing
from blocksim.limit.cones import Cones, carried_weights
from blocksim.limit.crushing import Crushing
from blocksim.limit.linear import NONE, LinearProgramme
from blocksim.limit.programme import extreme, most_common
from blocksim.limit.symmetry import mirror_of, symmetric_forces, symmetric_rates

HOPELESS = 1e3
"""Share of width or friction beyond which blocks count as never standing."""
NOTHING = 1e-10
"""Lack of force that is none [mean weights]."""
NEAR = 1e-7
"""How far below the least share blocks are seen to fall, as a share of it."""
STEP = 1e-6
"""Change of the share by which the balance of forces is differentiated."""
ROUNDS = 60
"""Shares that are tried at most."""
ROUGHLY, LITTLE = 0.01, 0.05
"""How far below the least share of strength a mechanism is looked at, as a part of it; and the
share of strength with which blocks stand so well that none is near."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Margins:
    """The least that joints need, each as a share of what they have.

    A share is above 1 where the blocks fall, 0 where nothing is needed, and None where no
    share suffices.

    `width`: Of the width of every joint, about its middle; loads and friction stay. Its inverse
        is Heyman's geometrical factor of safety: how much thinner an arch along the same
        centreline would just contain a line of thrust (Heyman 1969).
    `friction`: Of the friction of every joint; where that is unbounded, the coefficient itself.
    `strength`: Of width and friction, both at once.
    `forces`, (joints, 2, 2): The state of equilibrium that needs no more strength than that, as
        of `Equilibrium`: the geometrically safest line of thrust.
    """

    width: float | None
    friction: float | None
    strength: float | None
    forces: Array | None


@dataclass(frozen=True, kw_only=True, eq=False)
class Thrust:
    """A state of equilibrium in which a joint has its least or its greatest thrust.

    `thrust`: Horizontal part of the force through the joint, above 0 where it presses [mean
        weights]; inf where nothing limits it.
    `forces`, (joints, 2, 2): As of `Equilibrium`; None where nothing limits the thrust.
    """

    thrust: float
    forces: Array | None


def thrust_range(problem: Problem, joint: int) -> tuple[Thrust, Thrust] | None:
    """Find the least and the greatest thrust of a joint, two linear programmes.

    Returns `least`, `greatest`: None where there is no equilibrium, or blocks that crush leave
        so little of it that the solver gives up.
    """
    bearing = Bearing(problem)
    cones = bearing.cones
    across = np.zeros((len(problem.assembly.joints), 2, 2))
    arrays = problem.assembly.joint_arrays
    # On the block after it; a joint whose normal points to the left is pressed to the left.
    sense = math.copysign(1.0, arrays.normal[joint, 0])
    across[joint, :, 0] = sense * arrays.normal[joint, 0]
    across[joint, :, 1] = sense * arrays.tangent[joint, 0]
    cost, ends = cones.work(across), list[Thrust]()
    solver, mirror = LinearProgramme(), mirror_of(problem)
    strength = problem.strength
    crushing = None if strength is None else Crushing(problem, bearing, strength)
    for sign in (1.0, -1.0):
        if crushing is None:
            found = extreme(cones, sign * cost, problem.applied_forces(), solver)
        else:
            try:
                found = crushing.extreme(sign * cost, -cones.loads(problem.applied_forces()))
            except Unsolved:
                return None
        if found.unbounded:
            ends.append(Thrust(thrust=-sign * math.inf, forces=None))
        elif not found.exists:
            return None
        else:
            forces = cones.forces(found.values)
            thrust = float((across * forces).sum())
            even = forces if mirror is None else mirror.forces(forces)
            # A joint off the middle may have its extreme on its own side only.
            if abs(float((across * even).sum()) - thrust) <= NOTHING * (1 + abs(thrust)):
                forces = even
            ends.append(Thrust(thrust=thrust, forces=forces))
    return ends[0], ends[1]


def crown(problem: Problem) -> int | None:
    """Return the joint at which thrust is told: the highest of those that stand most upright.

    None where all joints are nearer to level than to upright.
    """
    joints = problem.assembly.joint_arrays
    upright = np.abs(joints.normal[:, 0])
    if upright.max(initial=0.0) < math.sqrt(0.5):
        return None
    best = np.flatnonzero(upright >= upright.max() * (1 - NOTHING))
    heights = joints.ends[best, :, 1].mean(axis=1)
    # Of two beside a keystone the first, whatever the last bits say.
    return int(best[np.argmax(heights > heights.max() - NOTHING)])


def margins(problem: Problem) -> Margins:
    """Find the least that joints need of their width, of their friction, and of both."""
    solver = LinearProgramme()
    width = _least_share(_Search(problem, solver, friction=False), 0.0)
    stands = width is not None and width <= 1
    rough = _Search(problem, solver, width=False)
    friction = _least_share(rough, 0.0, stands=stands and rough.bounded)
    both = _Search(problem, solver)
    # Whoever needs less of both needs less of each.
    known = np.isfinite(problem.friction).all() and friction is not None
    start = max(width or 0.0, (friction or 0.0) if known else 0.0)
    strength = _least_share(both, start, stands=stands)
    forces = None if strength is None else both.forces(strength)
    return Margins(
        width=width,
        friction=friction,
        strength=strength,
        forces=None if forces is None else symmetric_forces(problem, forces),
    )


def nearest_mechanism(problem: Problem) -> Array | None:
    """Find how blocks fall, or how they would with hardly less strength than they need.

    Returns (blocks, 3) or None: Rates x, y and rotation, as of `Equilibrium`, of blocks that
        fall. Of blocks that stand those at which all widths and all friction are scaled to a
        little less than the least share that stands (within `ROUGHLY`); None where a small
        share would do.
    """
    search = _Search(problem, LinearProgramme())
    low, high, share, rates = 0.0, 1.0, 1.0, None
    while high - low > ROUGHLY * high and high > LITTLE:
        margin, slope, moving = search.seen(share)
        if margin < -NOTHING:
            low, rates = share, moving
        else:
            high = share
        if low == high:
            break
        step = -margin / slope if slope > 0 and math.isfinite(margin) else math.nan
        # A little below where it is expected to stand, by what decides.
        share = (share + step) * (1 - ROUGHLY / 2)
        if not low < share < high:
            share = (low + high) / 2
    return None if rates is None else symmetric_rates(problem, rates)


def _least_share(search: _Search, low: float, *, stands: bool = False) -> float | None:
    """Find the least share that suffices, where none below `low` does.

    Where the blocks are known to stand it is at most 1.
    """
    margin, slope = search.margin(low)
    if margin >= -NOTHING:
        return low
    high = max(1.0, 2 * low)
    while not stands and search.margin(high)[0] < -NOTHING:
        low, high = high, 2 * high
        if high > HOPELESS:
            return None
    guess = low - margin / slope if slope > 0 else math.nan
    return search.boundary(low, high, guess if low < guess < high else (low + high) / 2)


class _Search:
    """The least part that contacts can have in common, as their strength is scaled."""

    def __init__(
        self,
        problem: Problem,
        solver: LinearProgramme,
        *,
        width: bool = True,
        friction: bool = True,
    ) -> None:
        self._problem, self._width, self._friction = problem, width, friction
        self._pull, self._solver = problem.applied_forces(), solver
        self._weights = carried_weights(problem)
        unbounded = np.isinf(problem.friction) if not width else np.zeros(1, dtype=bool)
        self.bounded = not unbounded.any()
        self._unit = np.where(unbounded, 1.0, problem.friction)

    def _cones(self, share: float) -> Cones:
        mu = self._unit
        if self._friction:
            # Unbounded friction stays so, however little of it is left.
            mu = np.where(np.isinf(mu), mu, share * np.where(np.isinf(mu), 0.0, mu))
        width = share if self._width else 1.0
        return Cones(self._problem, friction=mu, width=width, weights=self._weights)

    def margin(self, share: float) -> tuple[float, float]:
        """Return the margin of `Equilibrium` at a share, and its derivative."""
        return self.seen(share)[:2]

    def seen(self, share: float) -> tuple[float, float, Array | None]:
        """Return the margin at a share, its derivative, and the mechanism that is nearest.

        A share of which the programme tells nothing counts as too little.
        """
        cones, found = self._cones(share), NONE
        with suppress(Unsolved):
            found = most_common(cones, self._pull, self._solver)
        if not found.exists:
            return -math.inf, math.nan, None
        margin, rates = float(found.values[-1]), cones.rates(found.prices)
        if not share:
            return margin, math.nan, rates
        # By the envelope theorem only the balance of forces changes.
        parts = found.values[:-1] + margin * cones.bounded
        turned = self._cones(share * (1 + STEP)).balance - cones.balance
        gained = np.asarray(turned @ parts)
        slope = float(found.prices @ gained) / (share * STEP)
        return margin, slope, rates

    def boundary(self, low: float, high: float, guess: float) -> float:
        """Find the least share at which the margin is not below 0.

        Newton's method, kept between a share that falls and one that stands. Where contacts
        cannot press at all the margin stays 0 from there on: so it is looked at from below.
        """
        last = math.inf
        for _ in range(ROUNDS):
            margin, slope = self.margin(guess)
            # As little of the margin as decides that little of the share.
            steep = slope * guess if slope > 0 else 1.0
            if margin < -NOTHING * min(steep, 1.0):
                low = guess
            else:
                high = guess
            step = -margin / slope if slope > 0 and math.isfinite(margin) else math.nan
            if abs(step) <= NOTHING * guess and self.margin(guess * (1 - NEAR))[0] < -NOTHING:
                return guess + step
            following = guess + step
            if not low < following < high or abs(step) > last / 2:
                following, step = (low + high) / 2, (high - low) / 2
            if high - low <= NOTHING * high:
                return high
            guess, last = following, abs(step)
        return high

    def forces(self, share: float) -> Array | None:
        """Return forces of equilibrium at a share that barely suffices."""
        cones = self._cones(share)
        found = most_common(cones, self._pull, self._solver)
        if not found.exists:
            return None
        # What all parts have in common is theirs, too: none is needed where no width is.
        inside = cones.forces(found.values[:-1] + found.values[-1] * cones.bounded)
        if not self._width:
            return inside
        # The same resultants, as forces at the true ends of the joints.
        return (1 + share) / 2 * inside + (1 - share) / 2 * inside[:, ::-1]
