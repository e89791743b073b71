"""Blocks in Bullet as they are held, let go, and moved: in the plane and in space.

- Friction is forgotten after every step, and with links pressures are, too. The
  sweeps this takes hardly depend on the step: long steps, each solved until a sweep changes
  next to nothing.
- Blocks of the plane let go are built anew: Bullet keeps pressures of bodies without links, and
  accelerations at rest come from bodies with links, whose friction is true. Once they turn
  so fast that a step would open a level joint they have links again.
- Once blocks may meet others all are built anew, as hulls that know their faces,
  with what they stand on and a floor.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.base import Quality, Settings
from blocksim.engines.boxes import unwound
from blocksim.engines.bulletspace import OFF, SLOP, Space
from blocksim.engines.energy import later

if TYPE_CHECKING:
    from blocksim.engines.bulletblocks import Planar
    from blocksim.engines.bulletsolids import Spatial

SOFT = 10.0
"""Where pressures are given, stiffness of joints times the square of the step in which they are
solved [mean mass]."""
SETTLED = 1e-3
"""Acceleration from which on blocks that are pressed stay where they have given way to [g]."""
LEAVES = 1e-4
"""Displacement from which on blocks do not rest, and have all friction again [size]."""
STEP = 0.1
"""The usual one of a moving run."""
SWEEPS = 100
"""Most sweeps of a step, for each pair of blocks."""
ACCURACY = 1e-5
"""Error of the accelerations at which a step counts as solved [g]."""
RESTING, MOST_RESTING = 3e-5, 10_000
"""The same of blocks that rest with friction within rectangles, whose steps are short [g]; and
most sweeps of such a step: errors do not add up."""
SHARE = 1e-4
"""The same as a share of the velocities, once blocks move fast."""
RELAXATION = 3.0
"""Sweeps in which an error shrinks e-fold, for each pair of blocks (measured)."""
TRAVEL = 5e-3
"""Way of a corner in a step above which the step is divided [size]."""
FINEST = 20
"""Most parts of a step."""
LONGEST_TUMBLE, MOST_PARTS = 0.005, 400
"""Longest part of a step, and most of them, once blocks may meet."""
TUMBLE_SWEEPS = 100


class Moving:
    """Bullet's space with one body for each block, held and moved.

    `parts`: The blocks, as this engine needs them.
    """

    def __init__(self, parts: Planar | Spatial, settings: Settings) -> None:
        self._parts, self._settings = parts, settings
        self._pairs = settings.sweeps / SWEEPS
        self._space = Space(parts.frame, parts.breaking)
        count = len(parts.states)
        self._turned = np.zeros((count, len(parts.turns)))
        self._is_free = self._is_layered = self._is_rubble = False
        self._gains = np.zeros(count)
        self._last, self._rate = 0.0, np.zeros((count, len(parts.frame.columns)))
        self._short, self._held = settings.step, 0
        # A finer step is finer in its parts, too.
        self._finer = STEP / settings.step
        self._bodies, self._joints = parts.linked(self._space)
        self._space.find_contacts()
        self._deepest = self._space.overlap()
        self._space.pull(parts.problem.gravity)
        self._start, self._beyond = self.poses(), None
        self._balance = parts.balance(self._start)

    def _let_go(self) -> None:
        """Build anew for motion, where bodies without links will do."""
        self._is_free = True
        if self._parts.can_be_layered and not self._lifts():
            self._is_layered = True
            self._bodies, self._joints = self._parts.layered(self._space)
            self._short, sweeps, self._held = self._settings.step, self._held, 0
            self.hold(sweeps)

    def _watch(self) -> None:
        """Look whether friction has stayed within its cones; give it all where blocks move."""
        if float(self._parts.assembly.displacement(self.poses() - self._start)) > LEAVES:
            self._space.rectangles.widen()
            self._beyond = None
        else:
            self._beyond = max(self._beyond or 0.0, self._space.rectangles.beyond() or 0.0)

    def _lifts(self) -> bool:
        """Tell whether in the next step a corner may lift off, on its arc, by what overlaps.

        Of bodies without links Bullet forgets contacts of a level joint as soon as it is open.
        """
        turns = self._turning(self._velocities()) + self._gains
        return bool((self._parts.reach * (self._settings.step * turns) ** 2 / 2 > SLOP).any())

    def _turning(self, velocities: Array) -> Array:
        """Return how fast blocks turn, (blocks,)."""
        return np.sqrt((velocities[:, list(self._parts.turns)] ** 2).sum(axis=1))

    def _link(self) -> None:
        """Build anew, of bodies with links, where blocks are."""
        states = [self._space.state(body) for body in self._bodies]
        self._space.clear(self._parts.breaking)
        self._space.pull(self._parts.problem.gravity)
        self._bodies, self._joints = self._parts.linked(self._space)
        for body, state in zip(self._bodies, states, strict=True):
            self._space.put(body, state)

    def begin(self, forces: Array) -> None:
        """Build anew, of joints that press by themselves as the forces given do.

        Bullet keeps no impulses. So joints are springs whose faces reach into each other by
        what it takes; they are so soft, for the step in which they are solved, that pressures
        stay near what is given. Friction is left to Bullet, in space within rectangles.
        """
        pressures = self._parts.pressures(forces)
        stiffness = max(1.0, float(pressures.max())) / self._parts.pressed
        self._short, self._held = math.sqrt(SOFT / stiffness), 0
        self._space.clear()
        self._space.pull(self._parts.problem.gravity)
        self._bodies, self._joints = self._parts.linked(self._space, forces, stiffness)
        for body, link in {(body, link) for body, _, link, _ in self._joints}:
            # A pair's stiffness is half of either's.
            self._space.soften(body, link, 2 * stiffness)

    def hold(self, sweeps: int) -> Array:
        """Solve the contacts of one step from rest, then put every block back.

        Impulses are not kept: the sweeps made so far are made again.
        """
        self._held += sweeps
        step = self._short
        self._space.solve_by(step, self._held)
        self._step()
        accelerations = self._velocities() / step
        # Springs that give way by next to nothing make up for what forces given are off.
        gives = step != self._settings.step and np.abs(accelerations).max() < SETTLED
        for body, state in zip(self._bodies, self._parts.states, strict=True):
            if gives:
                self._space.stop(body)
            else:
                self._space.put(body, state)
        self._gains = self._settings.step * self._turning(accelerations)
        self._rate, self._beyond = accelerations, self._space.rectangles.beyond()
        return accelerations

    def advance(self, steps: int) -> None:
        """Let the blocks move, in parts of a step where they move far."""
        if not self._is_free:
            self._let_go()
        for _ in range(steps):
            speed = float(self._parts.assembly.displacement(self._velocities()))
            if not self._is_rubble:
                self._parts.solids.update(self.poses())
                if self._parts.solids.loose:
                    self._is_rubble = True
                    states = [self._space.state(body) for body in self._bodies]
                    self._bodies = self._parts.solid(self._space, states)
            if self._is_rubble:
                self._tumble(speed)
                continue
            way = speed * self._settings.step * self._finer
            parts = min(max(1, math.ceil(way / TRAVEL)), FINEST)
            if not self._parts.can_be_layered:
                # Joints that press by themselves go on as they were held.
                parts = max(parts, math.ceil(self._settings.step / self._short))
            if self._is_layered and self._lifts():
                self._is_layered = False
                self._link()
                # Contacts that are open by a hair are found anew only once they have closed.
                parts = FINEST
            step = self._settings.step / parts
            accuracy, sweeps = ACCURACY, self._settings.sweeps
            if self._beyond is not None:
                accuracy, sweeps = RESTING, min(sweeps, MOST_RESTING)
            change = max(accuracy * step, SHARE * speed) / (RELAXATION * self._pairs)
            self._space.solve_by(step, sweeps, change=change)
            before = self._stagger(step)
            for _ in range(parts - 1):
                self._step()
            self._last_step()
            if self._beyond is not None:
                self._watch()
            gained = self._velocities() - before
            self._gains, self._rate = self._turning(gained), gained / (parts * step)

    def _stagger(self, step: float) -> Array:
        """Return velocities, those halfway through a step, for a step of another length.

        Blocks that start from rest with a whole step's velocity are half a step early.
        """
        velocities = self._velocities()
        if step != self._last:
            velocities = later(velocities, self._rate, (self._last - step) / 2)
            for body, velocity in zip(self._bodies, velocities, strict=True):
                self._space.hasten(body, velocity)
        self._last = step
        return velocities

    def _tumble(self, speed: float) -> None:
        """Take a step of blocks that meet."""
        way = self._settings.step * (speed + self._settings.step)
        finest = self._settings.step / LONGEST_TUMBLE
        parts = max(way / self._parts.solids.largest, finest) * self._finer
        parts = min(math.ceil(parts), MOST_PARTS)
        # Impulses of an impact, taken for those of rest, would throw blocks.
        step = self._settings.step / parts
        self._space.solve_by(step, TUMBLE_SWEEPS, warm=0.0)
        self._stagger(step)
        for _ in range(parts - 1):
            self._step()
        self._rate = self._last_step() / step
        off = OFF * 2 * float(self._parts.reach.max())
        self._deepest = max(self._deepest, self._space.overlap() + off)
        self._parts.flatten(self._space, self._bodies)

    def _last_step(self) -> Array:
        """Take a step, look at the energy, and return what velocities gain."""
        poses, before = self.poses(), self._velocities()
        self._step()
        after = self._velocities()
        self._balance.look(poses, before, after)
        return after - before

    def _step(self) -> None:
        """Take a step under gravity and loads."""
        loads = self._parts.loads(self.poses())
        if loads is not None:
            for body, load in zip(self._bodies, loads, strict=True):
                self._space.push(body, load)
        self._space.step()

    def poses(self) -> Array:
        """Return places and rotations, (blocks, 3 or 6)."""
        found, turns = self._space.poses(self._bodies), list(self._parts.turns)
        found[:, turns] = self._turned = unwound(found[:, turns], self._turned)
        return found

    def _velocities(self) -> Array:
        return self._space.velocities(self._bodies)

    def quality(self) -> Quality:
        """Tell how deep blocks have overlapped, as built and once they meet others."""
        return Quality(
            penetration=self._deepest, gain=self._balance.gain, residual=self._beyond
        )
