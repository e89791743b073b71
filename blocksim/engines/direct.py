"""Rigid blocks with unilateral contact and Coulomb friction, each step solved to its end.

How blocks go from place to place, and from impact to impact, is in `blocksim.engines.stepping`.

A collapse goes on to the ground: blocks meet any others, what they stand on and the floor
(`blocksim.engines.ground`), and bounce where `restitution` is given. Forces at points of blocks
move with them: what they do in a step is that of its middle, as for contacts.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.common.checks import require
from blocksim.common.version import __version__
from blocksim.engines.base import Engine, Quality, Settings, World
from blocksim.engines.energy import Balance, energy
from blocksim.engines.solid import MOST_FRICTION
from blocksim.engines.stepping import LEAST, RESIDUAL, Stepping

STEP = 0.025
LONG, SLOW = 8, 2e-5
"""Steps in the longest one, and the way in it up to which blocks hardly move [size]."""
STILL = 1e-11
"""Accelerations of an arch that stands are 1e-13 and less, 1e-9 below its limit 3e-10."""
REST = 1e-9
"""Let go 1e-8 below its limit an arch moves 1e-7 and more in the time watched."""
STILL_IN_SPACE, REST_IN_SPACE = 1e-10, 1e-7
"""The same in space, where faces that are turned anyhow round off by more."""
RESIDUAL_IN_SPACE = 1e-5
"""Of a motion there, which it changes by a hundredth of what shows that blocks fall; the onset
test has a bound of its own."""
EXACT = 1e-18
"""Yield of contacts left in the onset test [g]."""
PENETRATION = 1e-3
"""Of a collapse until its verdict is certain; falling blocks may do worse on impact."""


USUAL = Settings(
    step=STEP,
    sweeps=1,
    hold_sweeps=1,
    still=STILL,
    rest=REST,
    residual=RESIDUAL,
    penetration=PENETRATION,
)


USUAL_IN_SPACE = replace(
    USUAL,
    # What is not found at once begins with forces of equilibrium, if there are any.
    unaided=1,
    still=STILL_IN_SPACE,
    rest=REST_IN_SPACE,
    residual=RESIDUAL_IN_SPACE,
)


def blocks_in_space(problem: Problem[SpatialAssembly], settings: Settings) -> World:
    """Return blocks in space, whose code is loaded where it is asked for."""
    from blocksim.engines.solid.stepping import SolidBlocks

    bounces, allowed = settings.restitution, "0 in space: there direct lets no block bounce"
    require(not bounces, "settings.restitution", bounces, allowed)

    return SolidBlocks(problem, settings)


class Blocks(Stepping):
    """Blocks, their poses and velocities."""

    def __init__(self, problem: Problem, settings: Settings) -> None:
        super().__init__(problem, settings.accuracy, settings.restitution)
        self._step = settings.step
        self._balance = Balance.of(problem, self._poses)

    def hold(self, sweeps: int) -> Array:  # noqa: ARG002 - the protocol's
        """Solve the contacts of a step from rest; the blocks stay."""
        self._looked = self._poses
        self._pull()
        touch = self._touch(self._poses, self._step)
        return self._solve(touch, np.zeros((len(touch.gap), 4)), EXACT).acceleration

    def advance(self, steps: int) -> None:
        """Let the blocks move; in longer steps while they hardly do."""
        left = steps * self._step
        while left > LEAST * self._step:
            step = self._suits(left)
            before = vars(self).copy()
            rested = self._asked.shaking is not None and self._is_at_rest
            self._move(step)
            if step > self._step and np.abs(self._poses - before["_poses"]).max() > SLOW:
                # Blocks move after all: again, in steps of the usual length.
                vars(self).update(before)
                step = min(self._step, left)
                self._move(step)
            if rested and not self._is_at_rest:
                self._set_off(step, before)
            left -= step
        self._balance.look(self._poses, self._velocities, self._velocities)

    def _suits(self, left: float) -> float:
        """Return how long a step may be, of what is left."""
        shaking, unit = self._asked.shaking, self._asked.seconds
        shakes = 0.0 if shaking is None else shaking.duration / unit - self._time
        if shaking is not None and shakes > LEAST * self._step:
            # It may set blocks in motion at any time; no step goes past its end.
            longest = min(self._step, shaking.spacing / unit * self._step / STEP)
            left = min(left, shakes)
            return left / math.ceil(left / longest - LEAST)
        usual = left / math.ceil(left / self._step - LEAST)
        step = left / math.ceil(left / (LONG * self._step) - LEAST)
        # With nothing known of them, blocks may fall.
        speeding = self._free if self._solution is None else self._solution.acceleration
        way = step * np.abs(self._velocities) + step**2 * np.abs(speeding)
        return step if way.max() < SLOW else usual

    def poses(self) -> Array:
        """Return centres of mass and rotations."""
        return self._poses.copy()

    def resultants(self) -> Array:
        """Return what joints carry; 0 where they have come apart."""
        found = np.zeros((self._joints, 3))
        if self._solution is None:
            return found
        held = np.flatnonzero(self._keys < self._joints)
        pulls: Array = np.matmul(self._solution.forces[held, None], self._rows[held])[:, 0]
        # What acts on one block acts on the other the opposite way.
        before, after = self._pairs[held].T
        last = (after == SUPPORT)[:, None]
        force: Array = np.where(last, -pulls[:, :3], pulls[:, 3:])
        x, y, _ = self._looked[np.where(last[:, 0], before, after)].T
        force[:, 2] += x * force[:, 1] - y * force[:, 0]
        found[self._keys[held]] = force
        return found

    def quality(self) -> Quality:
        """Tell how well contact and friction have been kept so far."""
        return Quality(
            residual=self._residual, penetration=self._penetration, gain=self._balance.gain
        )

    @property
    def velocities(self) -> Array:
        """Velocities x, y and angular, shape (blocks, 3)."""
        return self._velocities.copy()

    @property
    def energy(self) -> float:
        """Kinetic and potential energy, in mean weights times the size."""
        return energy(self._asked, self._poses, self._velocities)

    def push(self, velocities: Array) -> None:
        """Set the velocities, shape (blocks, 3)."""
        self._velocities = np.array(velocities, dtype=np.float64)
        self._balance = Balance.of(self._asked, self._poses, self._velocities)


ENGINE = Engine(
    name="direct",
    sees="motion in the plane and in space: each step's contact and Coulomb friction solved "
    "to their law",
    library="scipy",
    remedy="pip install scipy",
    # It is blocksim's own.
    version_of=lambda: __version__,
    rule=lambda _: USUAL,
    build=Blocks,
    rule_in_space=lambda _: USUAL_IN_SPACE,
    build_in_space=blocks_in_space,
    adjustable=("step", "accuracy", "still", "rest", "restitution"),
    finest=1e-8,
    most_friction=math.inf,
    most_friction_in_space=MOST_FRICTION,
    shakes=True,
    finds_rest=True,
    tells_forces=True,
    moves_supports=True,
    validates=("structures",),
    validated_to=1e-6,
    aside=0.001,
    most_blocks=1000,
    chart={
        "tolerance": (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8),
        "step": (1 / 15, 1 / 60, 1 / 240),
        "voussoirs": (7, 13, 27, 53, 101, 201),
    },
    colour="#0072B2",
    tint="#cfe3f0",
    marker="o",
)
