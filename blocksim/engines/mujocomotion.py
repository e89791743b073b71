"""MuJoCo ("multi-joint dynamics with contact"): planar, soft contacts, a convex problem a step.

A contact gives way: its force is what slows the approach of its two sides, over a stiffness
of the engine's own choosing. How a near-critical arch has to be put into it (each point
measured):

- Contacts carry nothing until they have given way. Left to themselves the blocks start to
  fall, bounce, slip while nothing presses them, and an arch well above its least thickness
  comes down. So hold stops them again and again while the contacts take up the weight, and
  each contact begins with the force of about one block's weight.
- How far contacts give way goes with the square of the time step, which for the onset test
  can be as short as round-off allows: `HOLD_STEP`. What a moving run can afford is longer.
- Contacts too hard for their step leave and return from one to the next; slow motions of the
  whole take many steps to come to rest where they are too soft. `SAG` is the middle: as soft
  as lets the blocks as built begin to fall with four fifths of g. Where joints slide fast, a
  hard contact is thrown open; such a chatter shows, and they are made softer (`CHATTER`).
- Friction in MuJoCo slows a slip as a damper does, and opens the joint by the friction times
  that. With the damper of the pressure a slipping contact is lifted off, and chatters. Held
  from rest, friction is given next to no damper (`LOOSE`); in motion, that of the pressure.
- Friction is much harder than pressure (`HELD_RATIO`), or resting joints creep.
- Blocks that fall find a motion of sliding where they could rest, too: nothing presses their
  joints until they have moved. So the test can be begun with forces (`begin`). The sides of a
  joint then reach into each other by what its pressures need: nothing has to give way, and
  contacts can be the hardest. Friction needs no way, and is left to MuJoCo.
- Once blocks may meet others (`solids`) they are put into a model of their own, as the bodies
  they are, with what they stand on and a floor.

The plane is MuJoCo's x and y; a block has three degrees of freedom, x, y and rotation.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.base import Quality, Settings
from blocksim.engines.energy import later
from blocksim.engines.mujocoblocks import RUBBLE_PERIOD, TOLERANCE, library
from blocksim.engines.mujocostep import coulomb_step

if TYPE_CHECKING:
    from blocksim.engines.mujocoblocks import Planar
    from blocksim.engines.mujocosolids import Spatial

STEP = 0.01
"""The usual one of a moving run."""
HOLD_STEP = 1e-5
"""Time step of the onset test."""
LEAST_SWEEPS = 100
PAUSE = 5.0
"""Time between two stops of the blocks while they are held, in units of a contact's period."""
SETTLING = 2000
"""MuJoCo's steps in which contacts take up the weight before a moving run."""
STILL = 1e-5
SAG = 4.0
"""Softness of the whole: blocks begin to fall with g SAG / (1 + SAG)."""
HARDEST, HARD, SOFTEST = 1e-4, 0.1, 1.0
"""Softness of contacts: MuJoCo's least, the most to begin with, and the most."""
CHATTER, SOFTER = 0.1, 10.0
"""Scatter of accelerations from which contacts are made softer [g], and how much."""
STEADY = 0.1
"""Share by which accelerations may differ from one part of the onset test to the next."""
PERIOD, SHORTEST = 1.25, 2.5
"""Period of a contact times the root of its softness and force, and its least [steps]."""
DAMPING = 2.0
"""Of a contact, in units of the critical."""
LOOSE = 10.0
"""Time constant of friction held from rest."""
HELD_RATIO, RATIO = 1e6, 1e4
"""How much harder friction is than pressure, in the onset test and in motion."""
GENTLE, FIRMER = 20.0, 0.8
"""That period at first, which lets joints that have sunk into each other rise without a push,
and by how much it shrinks in each step."""


class Moving:
    """A MuJoCo model with one body for each block, and its state.

    A sweep is one of MuJoCo's steps, which solves the contacts to their end.

    `parts`: The blocks, as this engine needs them; coordinates are MuJoCo's.
    """

    def __init__(self, parts: Planar | Spatial, settings: Settings) -> None:
        self._blocks = parts
        self._part = settings.step / settings.sweeps
        self._parts = settings.sweeps
        self._step = settings.step
        self._is_rubble, self._deepest, self._period = False, 0.0, GENTLE
        self._scatter, self._steady = 0.0, True
        self._model = parts.joined()
        self._state = library.MjData(self._model)
        self._zero = self._state.qpos.copy()
        self._balance = parts.balance(self.poses())
        self._pull()
        self._pressures: Array | None = None
        self._softness, self._force = HARDEST, 1 / HARDEST
        self._choose(HOLD_STEP, LOOSE)
        # With the hardest contacts the blocks as built fall a little: that tells of all others.
        library.mj_forward(self._model, self._state)
        fall = float(parts.assembly.displacement(self._rates(self._state.qacc)))
        self._force = max(1.0, float(self._state.efc_force.max(initial=0.0)))
        self._softness = min(max(SAG * HARDEST * (1 - fall) / fall, HARDEST), HARD)
        self._choose(HOLD_STEP, LOOSE)

    def _rates(self, moved: Array) -> Array:
        """Return velocities or accelerations at rest in columns of poses."""
        return self._blocks.rates(self._state.qpos, moved)

    def begin(self, forces: Array) -> None:
        """Begin anew, with joints that press by themselves as the forces given do.

        Where these do not balance blocks start to move, and contacts have to follow.
        """
        self._pressures = np.maximum(forces[..., 0], 0.0)
        self._scatter, self._steady = 0.0, True
        for softness in (HARDEST, SOFTER * HARDEST, self._softness):
            self._softness = softness
            self._press(HOLD_STEP)
            library.mj_forward(self._model, self._state)
            if self._blocks.assembly.displacement(self._rates(self._starts())) < STILL:
                break

    def _press(self, step: float) -> None:
        """Put blocks where they were built, their contacts as far given way as they press."""
        if self._pressures is None:
            self._choose(step, LOOSE)
            return
        period, impedance = self._period_at(step), _impedance(self._softness)
        unit = (1 - impedance) * (DAMPING * period) ** 2
        needed = unit * self._blocks.ways(self._pressures)
        self._model = self._blocks.joined(needed - self._unit(period))
        self._state = library.MjData(self._model)
        # Where a step gains little, forces between the hardest contacts may be far off still.
        self._model.opt.tolerance = 0.0
        self._choose(step, LOOSE)
        self._pull()

    def _period_at(self, step: float) -> float:
        """Return the period of contacts that suits a time step."""
        return step * max(PERIOD / math.sqrt(self._softness * self._force), SHORTEST)

    def _unit(self, period: float) -> float:
        """Return how far one block's weight presses into a contact, about."""
        return self._softness * (DAMPING * period) ** 2

    def _choose(self, step: float, slip: float) -> None:
        """Set the time step, the contacts that suit it, and the time constant of friction."""
        period, impedance = self._period_at(step), _impedance(self._softness)
        model = self._model
        model.opt.timestep = step
        model.opt.impratio = HELD_RATIO if slip else RATIO
        model.pair_solref[:] = [period, DAMPING]
        model.pair_solreffriction[:] = [slip or period, 1.0]
        model.pair_solimp[:] = [impedance, impedance, 1.0, 0.5, 2.0]
        model.pair_margin[:] = self._unit(period)
        self._pause = math.ceil(PAUSE * period / step)

    def _pull(self) -> None:
        """Let loads act; MuJoCo keeps them until told others."""
        loads = self._blocks.loads(self._state.qpos)
        if loads is not None:
            self._state.qfrc_applied[:] = loads

    def _settle(self, sweeps: int) -> None:
        """Let the contacts take up the weight, stopping the blocks again and again."""
        for _ in range(sweeps // self._pause):
            library.mj_step(self._model, self._state, self._pause)
            self._state.qvel[:] = 0.0

    def hold(self, sweeps: int) -> Array:
        """Take steps from rest, very short ones, and return the accelerations they end with.

        What holds impulses in other engines is how far the contacts have given way. That is
        kept, a millionth of the size, and the blocks are stopped.
        """
        if self._scatter > CHATTER and self._softness < SOFTEST:
            self._softness = min(SOFTER * self._softness, SOFTEST)
            self._state.qpos[:] = self._model.qpos0
            self._press(HOLD_STEP)
        early = self._round(max(sweeps, LEAST_SWEEPS) // 2)
        late = self._round(max(sweeps, LEAST_SWEEPS) // 2)
        self._zero = self._state.qpos.copy()
        # What still changes is the contacts' doing, not the arch's.
        self._steady = self._scatter <= CHATTER and bool(
            np.abs(late - early).max() < STEADY * np.abs(late).max() + STILL
        )
        return self._rates(late)

    def _round(self, sweeps: int) -> Array:
        """Settle, let the blocks go for a while, and return the mean of their accelerations."""
        self._settle(sweeps // 2)
        library.mj_step(self._model, self._state, sweeps // 4)
        rates = np.array([self._accelerations() for _ in range(sweeps // 4)])
        mean = rates.mean(axis=0)
        self._scatter = float(np.median(np.abs(rates - mean).max(axis=1)))
        self._state.qvel[:] = 0.0
        return mean

    def _accelerations(self) -> Array:
        library.mj_step(self._model, self._state)
        return self._starts()

    def _starts(self) -> Array:
        """Return the accelerations that follow from forces.

        MuJoCo's own do not, where its solver has ended too early.
        """
        forces = self._state.qfrc_smooth + self._state.qfrc_constraint
        found: Array = forces / self._blocks.masses
        return found

    def advance(self, steps: int) -> None:
        """Let the blocks move; before they first do, contacts take up the weight again."""
        if not self._is_rubble and self._model.opt.timestep != self._part:
            self._press(self._part)
            self._settle(SETTLING)
            self._zero = self._state.qpos.copy()
            self._model.opt.tolerance = TOLERANCE
            self._choose(self._part, 0.0)
            library.mj_forward(self._model, self._state)
            self._stagger(self._state.qacc, -self._part)
        for left in range(steps, 0, -1):
            if self._is_rubble:
                self._tumble()
                continue
            self._pull()
            last = left == 1
            library.mj_step(self._model, self._state, self._parts - last)
            if last:
                self._look(lambda: library.mj_step(self._model, self._state))
            self._blocks.solids.update(self.poses())
            if self._blocks.solids.loose:
                self._make_solid()

    def _make_solid(self) -> None:
        """Make blocks the bodies they are, with what they stand on and the floor."""
        self._is_rubble = True
        placed, last = self._blocks.placed(self.poses()), self._state
        self._model = self._blocks.rubble()
        # A finer step is finer in its parts, too.
        self._model.opt.timestep *= self._step / STEP
        self._state = library.MjData(self._model)
        self._state.qpos[:], self._state.qvel[:] = placed, last.qvel
        self._zero = self._model.qpos0.copy()
        self._stagger(last.qacc, self._part - self._model.opt.timestep)

    def _stagger(self, rates: Array, longer: float) -> None:
        """Set velocities, those halfway through a step, for a step of another length.

        `rates`: Accelerations.
        `longer`: By how much the step before was longer: it had none before the first.
        """
        own = len(self._blocks.assembly.blocks), -1
        velocities = self._state.qvel.reshape(own)
        self._state.qvel[:] = later(velocities, rates.reshape(own), longer / 2).ravel()

    def _tumble(self) -> None:
        """Take a step of blocks that meet."""
        length = self._model.opt.timestep
        self._model.geom_solref[:, 0] = self._period * length
        self._period = max(RUBBLE_PERIOD, FIRMER * self._period)
        self._pull()
        for _ in range(max(1, round(self._step / length)) - 1):
            coulomb_step(self._model, self._state)
        self._look(lambda: coulomb_step(self._model, self._state))
        gaps = self._state.contact.dist
        self._deepest = max(self._deepest, -float(gaps.min(initial=0.0)))

    def _look(self, step: Callable[[], None]) -> None:
        """Take a step, and look at the energy."""
        poses, before = self.poses(), self._rates(self._state.qvel)
        step()
        self._balance.look(poses, before, self._rates(self._state.qvel))

    def poses(self) -> Array:
        """Return centres of mass and rotations, less how far contacts had given way at rest."""
        return self._blocks.poses(self._state.qpos, self._zero)

    def quality(self) -> Quality:
        """Tell whether accelerations held at rest were steady."""
        residual = None if self._steady else math.inf
        deepest = self._deepest if self._is_rubble else None
        return Quality(residual=residual, penetration=deepest, gain=self._balance.gain)


def _impedance(softness: float) -> float:
    """Return what MuJoCo calls so: the share of its force by which a contact is not soft."""
    return min(1 / (1 + softness), float(library.mjMAXIMP))
