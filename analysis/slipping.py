"""Forces within Coulomb's law and rates that go with them, each by linear programmes.

A load factor is one at which blocks may begin to move where two things exist for it: forces of
equilibrium within Coulomb's law, and rates of the blocks that go with them. Contacts that open
carry nothing, joints that stick do not slip, and those that slip have all their friction
against it. Which contacts do what is unknown. It is searched for:

- Friction that depends on pressures found before, and hardly on those now, hardly dilates. A
  few linear programmes of that kind give rates to begin with (M. Gilbert, C. Casapulla and
  H. M. Ahmed, Comput. Struct. 84, 2006, 873-887).
- Of all forces that go with these rates, a linear programme finds those of the least factor; of
  all rates that go with these forces, another finds some that are farthest along a random way.
  They take turns. The factor never grows.

`wrong` holds an answer to the laws, and knows nothing of the search.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.limit.linear import LinearProgramme, Matrix
from blocksim.limit.starting import Start, rates_of

DILATES = tuple(max(0.6**turn, 1e-4) for turn in range(1, 20))
"""Share of the dilatancy in each programme that gives rates to begin with."""
TURNS = 60
"""So often forces and rates take turns from one beginning."""
NOTHING = 1e-9
"""Forces [mean weights], and rates where the load's is 1, that count as none."""
FIRST = 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5
"""The same for the rates to begin with, over the largest; the first that leads on is taken."""
FASTEST = 50.0
"""Largest rate of a block where the load's is 1."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """A push at which a wall may move.

    Parameters
    ----------
    factor : float
    pressure : (joints, 2) float
    friction : (joints,) float
        Both in mean weights.
    rates : (blocks, 3) float
        Where the load's rate of work is 1.
    """

    factor: float
    pressure: Array
    friction: Array
    rates: Array


class Law:
    """Forces and rates of a wall, each by linear programmes where the other is given."""

    def __init__(self, problem: Problem) -> None:
        rates = rates_of(problem)
        self.joints = len(rates)
        self.opening, self.slip = rates[:, :2].reshape(2 * self.joints, -1), rates[:, 2]
        self.dead = problem.with_load(0.0).pull().ravel()
        self.live = problem.with_load(1.0).pull().ravel() - self.dead
        self.mu, self.masses = problem.friction, problem.assembly.masses.ravel()
        self._sum = np.kron(np.eye(self.joints), np.ones((1, 2)))
        balance = np.hstack([self.opening.T, self.slip.T, self.live[:, None]])
        own, none = np.eye(self.joints), np.zeros((self.joints, 1))
        bound = self.mu[:, None] * self._sum
        cone = np.hstack([-bound, own, none]), np.hstack([bound, own, none])
        self._forces: Matrix = sparse.csc_array(np.vstack([balance, *cone]))
        self._balance, self._cone = balance, cone
        every = np.vstack([self.opening, self.slip, self.live[None]])
        self._rates: Matrix = sparse.csc_array(every)
        self._programmes = [LinearProgramme() for _ in range(3)]
        self._factor = np.append(np.zeros(3 * self.joints), 1.0)

    def first(self, pressure: Array) -> Array | None:
        """Return rates that hardly dilate, by programmes begun with pressures of joints."""
        free, found = np.full(self.joints, -np.inf), None
        for share in DILATES:
            held = (1 - share) * self.mu * pressure
            scale = np.ones(3 * self.joints + 1)
            scale[: 2 * self.joints] = share
            matrix = np.vstack([self._balance, *(each * scale for each in self._cone)])
            found = self._programmes[0].solve(
                -self._factor,
                sparse.csc_array(matrix),
                (
                    np.concatenate([-self.dead, free, -held]),
                    np.concatenate([-self.dead, held, -free]),
                ),
                self._signs(),
            )
            if not found.exists:
                return None
            pressure = (pressure + self._sum @ found.values[: 2 * self.joints]) / 2
        return None if found is None else self._of_load(found.prices[: self.live.size])

    def at_rest(self, rng: np.random.Generator, factor: float) -> Array:
        """Return pressures of joints in a state of rest with random friction."""
        least, most = self._signs()
        least[-1] = most[-1] = factor
        free, none = np.full(self.joints, np.inf), np.zeros(self.joints)
        low = np.concatenate([-self.dead, -free, none])
        high = np.concatenate([-self.dead, none, free])
        cost = np.zeros(3 * self.joints + 1)
        cost[2 * self.joints : -1] = rng.normal(size=self.joints)
        found = LinearProgramme().solve(cost, self._forces, (low, high), (least, most))
        if not found.exists:
            raise ValueError("no rest")
        return self._sum @ found.values[: 2 * self.joints]

    def forces(self, rates: Array, nothing: float = NOTHING) -> Array | None:
        """Return the forces of the least factor that go with rates, and that factor."""
        slip = self.slip @ rates
        free, none = np.full(self.joints, np.inf), np.zeros(self.joints)
        up, down = slip > nothing, slip < -nothing
        low = np.concatenate([-self.dead, np.where(down, none, -free), none])
        high = np.concatenate([-self.dead, none, np.where(up, none, free)])
        least, most = self._signs()
        most[: 2 * self.joints][self.opening @ rates > nothing] = 0.0
        found = self._programmes[1].solve(
            self._factor, self._forces, (low, high), (least, most)
        )
        return found.values if found.exists else None

    def rates(self, forces: Array, way: Array) -> Array | None:
        """Return rates that go with forces, as far along a way as they can be."""
        pressure, friction, _ = np.split(forces, [2 * self.joints, 3 * self.joints])
        bound = self.mu * (self._sum @ pressure)
        up, down = friction <= -bound + NOTHING, friction >= bound - NOTHING
        return self._fastest(way, pressure <= NOTHING, up, down)

    def like(self, rates: Array, nothing: float) -> Array | None:
        """Return rates that do not dilate where contacts open or slip only as in others."""
        slip = self.slip @ rates
        opens, up, down = self.opening @ rates > nothing, slip > nothing, slip < -nothing
        return self._fastest(rates, opens, up, down)

    def walk(self, rng: np.random.Generator, pressure: Array) -> Motion | None:
        """Let forces and rates take turns from one beginning."""
        first = self.first(pressure)
        moved, best = None, None
        for nothing in () if first is None else FIRST:
            moved = self.like(first, nothing * float(np.abs(first).max()))
            best = None if moved is None else self.forces(moved)
            if best is not None:
                break
        if moved is None or best is None:
            return None
        for _ in range(TURNS):
            rates = self.rates(best, rng.normal(size=self.live.size))
            found = None if rates is None else self.forces(rates)
            if rates is not None and found is not None and found[-1] <= best[-1]:
                best, moved = found, rates
        ends, middle = 2 * self.joints, 3 * self.joints
        return Motion(
            factor=float(best[-1]),
            pressure=best[:ends].reshape(-1, 2),
            friction=best[ends:middle],
            rates=moved.reshape(-1, 3),
        )

    def started(self, motion: Motion, factor: float) -> Start | None:
        """Return how blocks accelerate under a factor if contacts do what they do in a motion.

        None where they cannot do that.
        """
        size, joints, rates = self.live.size, self.joints, motion.rates.ravel()
        opens, slip = self.opening @ rates > NOTHING, self.slip @ rates
        up, down = slip > NOTHING, slip < -NOTHING
        pull = self.dead + factor * self.live
        newton = np.hstack([np.diag(self.masses), -self.opening.T, -self.slip.T])
        every = np.vstack([self.opening, self.slip])
        moves = np.hstack([every, np.zeros((3 * joints, 3 * joints))])
        beside = np.zeros((joints, size))
        cones = [np.hstack([beside, each[:, :-1]]) for each in self._cone]
        free, none = np.full(joints, np.inf), np.zeros(joints)
        parts = np.where(opens, np.inf, 0.0)
        low = [pull, 0 * none, 0 * none, np.where(down, -free, 0.0),
               np.where(down, 0.0, -free), none]  # fmt: skip
        high = [pull, parts, np.where(up, free, 0.0), none, np.where(up, 0.0, free)]
        pressed = np.where(opens, 0.0, np.inf)
        ends = np.full(size, FASTEST)
        found = LinearProgramme().solve(
            np.concatenate([-pull, np.zeros(3 * joints)]),
            sparse.csc_array(np.vstack([newton, moves, *cones])),
            (np.concatenate(low), np.concatenate(high)),
            (np.concatenate([-ends, 0 * opens, -free]), np.concatenate([ends, pressed, free])),
        )
        if not found.exists:
            return None
        accelerations, pressure, friction = np.split(found.values, [size, size + 2 * joints])
        pressure = pressure.reshape(-1, 2)
        total = pressure.sum(axis=1, keepdims=True)
        share = np.divide(pressure, total, out=np.full_like(pressure, 0.5), where=total > 0)
        return Start(
            moves=True,
            accelerations=accelerations.reshape(-1, 3),
            forces=np.stack([pressure, share * friction[:, None]], axis=2),
        )

    def _fastest(self, way: Array, opens: Array, up: Array, down: Array) -> Array | None:
        """Return the rates farthest along a way where these contacts may open or slip."""
        least = np.concatenate([0.0 * opens, np.where(down, -np.inf, 0.0), [1.0]])
        most = np.concatenate([np.where(opens, np.inf, 0.0), np.where(up, np.inf, 0.0), [1.0]])
        ends = np.full(way.size, FASTEST)
        found = self._programmes[2].solve(-way, self._rates, (least, most), (-ends, ends))
        return found.values if found.exists else None

    def _signs(self) -> tuple[Array, Array]:
        """Bounds of pressures, friction and the factor."""
        free = np.full(self.joints + 1, np.inf)
        pressed = np.zeros(2 * self.joints)
        return np.append(pressed, -free), np.append(pressed + np.inf, free)

    def _of_load(self, rates: Array) -> Array:
        return rates / float(self.live @ rates)


def wrong(problem: Problem, motion: Motion) -> float:
    """By how much forces and rates break balance, Coulomb's law, or do not go together.

    Forces are over the mean weight, rates over the largest.
    """
    rates, moved = rates_of(problem), motion.rates.ravel() / np.abs(motion.rates).max()
    opening, slip = (rates @ moved)[:, :2], (rates @ moved)[:, 2]
    pressure, friction = motion.pressure, motion.friction
    pull = problem.with_load(motion.factor).pull().ravel()
    pull += np.einsum("je,jen->n", pressure, rates[:, :2]) + friction @ rates[:, 2]
    bound = problem.friction * pressure.sum(axis=1)
    broken = [
        np.abs(pull),
        -pressure,
        -opening,
        np.minimum(pressure, np.abs(opening)),
        np.abs(friction) - bound,
        np.minimum(np.abs(slip), np.abs(bound + np.sign(slip) * friction)),
    ]
    return max(float(each.max()) for each in broken)
