"""Chipmunk through pymunk: planar, sequential impulses, Coulomb friction.

How blocks are put into it is told in `chipmunk`.
"""

from __future__ import annotations

import math
from importlib.metadata import version

import numpy as np

from blocksim.blocks.assembly import Array, Assembly
from blocksim.blocks.problem import Problem
from blocksim.engines.base import Engine, Quality, Settings
from blocksim.engines.chipmunk import Space
from blocksim.engines.energy import Balance, later

LONGEST_STEP = 1 / 100
THICK = 0.8
"""Joint length from which the longest step will do [size]."""
SWEEPS = 100
"""Sweeps of a moving run per unit of time, for each block."""
LEAST_SWEEPS = 5
RUBBLE_SWEEPS, MOST_PARTS = 100, 100
"""Least sweeps, and most parts of a step, once blocks may meet."""
COARSEST = 60
"""Parts in one in which nothing passes another: it goes by a quarter of its least extent."""
LEAST_AGAIN, MOST_AGAIN = 100, 400
"""Sweeps of a step on ground that shakes: at least, and at most for each pair of blocks."""
CHANGE = 1e-2
"""Change of velocities, as a share of them, at which a step on such ground counts as solved."""
SHAKEN_PARTS, MOVES = 8, 1e-4
"""Parts of a step there, in each of which an impact may be, and velocity from which it is
divided [sqrt(size g)]."""
FAST, FEWER = 1e-2, 50
"""Velocity from which on so many times fewer will do [sqrt(size g)]."""
FALLEN = 2e-3
"""Way of a corner from which on blocks fall, and steps need not be those of joints [size]."""
MOST_UNSEEN, LEAST_WAY = 16, 1e-12
"""Most steps between two looks where blocks are, and the least way in one [size]."""
HOLD_SWEEPS, LEAST_HOLD = 4000, 50_000
"""Most sweeps of the onset test for each pair of blocks, and at least."""
SLENDER, SLENDEREST = 80, 2.5e-4
"""The same over the length of the shortest joint, and the shortest that was measured [size]."""
LONGEST_HOLD = 5e9
"""Most of these sweeps times blocks, about four minutes."""
UNAIDED = 2e6
"""These sweeps times blocks before the search for impulses is helped, 0.1 s."""


def rule(assembly: Assembly) -> Settings:
    """Choose steps as long as the thickness allows, for the most sweeps in each.

    A hinge that turns for a step overlaps by about 100 step^2 / thickness of its
    motion (measured), which asks for short steps. Sliding asks for many sweeps in a
    step: released from converged impulses, at equal work long steps keep friction
    converged where short ones do not. (Released from nothing it is the other way round.)

    The onset test needs about 40 sweeps for each pair of blocks, and in thin arches 10 to
    20 over the length of a joint: a small moment at it is a large change of its
    pressures. It is allowed four times that, and more where modes die away slowly. What
    takes longer than `UNAIDED` goes on from forces of limit analysis: in a few thousand sweeps,
    however thin or many the voussoirs.
    """
    count = len(assembly.blocks)
    step = LONGEST_STEP * min(1.0, math.sqrt(assembly.shortest / THICK))
    slender = SLENDER / max(assembly.shortest, SLENDEREST) * count**2
    return Settings(
        step=step,
        sweeps=max(LEAST_SWEEPS, round(SWEEPS * count * step)),
        hold_sweeps=max(
            LEAST_HOLD, HOLD_SWEEPS * count**2, round(min(slender, LONGEST_HOLD / count))
        ),
        unaided=round(UNAIDED / count),
    )


class _World:
    """Blocks in one of Chipmunk's spaces: the onset test, and steps in time."""

    def __init__(self, problem: Problem, settings: Settings) -> None:
        self._problem, self._assembly, self._settings = problem, problem.assembly, settings
        self._shaken = problem.is_moving
        self._space = Space(problem)
        self._built = self.poses()
        self._balance = Balance.of(problem, self._built)
        self._penetration = self._time = 0.0
        self._last = settings.step
        # A finer step is finer in its parts, too.
        self._finer = rule(problem.assembly).step / settings.step
        self._rate = self._starts = np.zeros((len(self._assembly.blocks), 3))
        self._looked, self._unseen, self._ahead = self._rate, 0, 0

    def hold(self, sweeps: int) -> Array:
        """Solve the contacts of one step from rest, then put every block back."""
        # Positions are integrated first and at rest, so they never change here.
        self._space.step(self._settings.step, sweeps)
        velocities = self._space.velocities()
        self._space.set_velocities(np.zeros_like(velocities))
        self._starts = velocities / self._settings.step
        return self._starts

    def begin(self, forces: Array) -> None:
        """Write the impulses of given forces into the contacts."""
        self.hold(1)
        joints = self._assembly.joint_arrays
        along = np.stack([joints.normal, joints.tangent], axis=1)
        impulses = self._settings.step * np.einsum("jek,jkd->jed", forces, along)
        for joint, place, axes, contact in self._space.contacts():
            end = int(np.hypot(*(joints.ends[joint] - place).T).argmin())
            corner = joints.is_corner[joint]
            given = impulses[joint].sum(axis=0) if corner else impulses[joint, end]
            contact.jnAcc, contact.jtAcc = (axes @ given).tolist()

    def advance(self, steps: int) -> None:
        """Let the blocks move, in parts of a step once they may meet."""
        if self._starts.any():
            # Its velocities are those half a step ahead.
            ahead = later(self._space.velocities(), self._starts, self._settings.step / 2)
            self._space.set_velocities(ahead)
            self._rate, self._starts = self._starts, np.zeros_like(self._starts)
        left = steps
        while left and not self._space.is_solid:
            before, left = self._space.velocities() if left == 1 else None, left - 1
            self._turn()
            if before is not None:
                self._balance.look(self.poses(), before, self._space.velocities())
        # For short joints steps are short, which blocks that fall do not ask for.
        fallen = self._assembly.displacement(self.poses() - self._built) > FALLEN
        most = max(1, int(LONGEST_STEP / rule(self._assembly).step)) if fallen else 1
        while left:
            self._space.part()
            self._tumble(min(left, most))
            left -= min(left, most)

    def _turn(self) -> None:
        """Take a step of blocks that touch at joints only."""
        self._watch()
        space, step = self._space, self._settings.step
        before = space.velocities() if space.solids.loose else None
        parts = SHAKEN_PARTS if self._shaken and self._speed() > MOVES else 1
        self._last = step / parts
        for _ in range(parts):
            self._go(self._last, self._settings.sweeps)
        if before is not None:
            self._rate = (space.velocities() - before) / step
            space.make_solid()

    def _speed(self) -> float:
        return float(self._assembly.displacement(self._space.velocities()))

    def _watch(self) -> None:
        """Look where blocks are, as soon as they may have moved far enough to meet others."""
        self._ahead -= 1
        if self._ahead > 0:
            return
        solids, step, found = self._space.solids, self._settings.step, self._space.velocities()
        if self._unseen:
            self._rate = (found - self._looked) / (self._unseen * step)
        solids.update(self.poses())
        # Ground that shakes may pull anew at any moment.
        speed, rate = map(self._assembly.displacement, (found, self._rate))
        way = step * (float(speed) + MOST_UNSEEN * step * max(float(rate), self._shaken))
        self._unseen = min(max(1, int(solids.left / (2 * max(way, LEAST_WAY)))), MOST_UNSEEN)
        self._looked, self._ahead = found, self._unseen

    def _tumble(self, steps: int) -> None:
        """Take steps of blocks that may meet as one, in parts."""
        space, step = self._space, steps * self._settings.step
        way = (self._speed() + step) * step * self._finer
        fine = way / space.solids.largest
        parts = math.ceil(max(min(fine, MOST_PARTS), fine / COARSEST))
        parts = max(parts, steps * SHAKEN_PARTS) if self._shaken else parts
        part = step / parts
        # Velocities are those half a step ahead: what has been gained by then is less now.
        space.set_velocities(later(space.velocities(), self._rate, (part - self._last) / 2))
        sweeps = max(RUBBLE_SWEEPS, steps * self._settings.sweeps // parts)
        for _ in range(parts - 1):
            self._go(part, sweeps, afresh=True)
        before = space.velocities()
        self._go(part, sweeps, afresh=True)
        after = space.velocities()
        self._balance.look(self.poses(), before, after)
        self._last, self._rate = part, (after - before) / part
        self._penetration = max(self._penetration, space.deepest())

    def _go(self, step: float, sweeps: int, afresh: bool = False) -> None:
        """Take a step in time; `afresh`: without the impulses of before.

        Where the ground shakes they are found anew all the same.
        """
        if not self._shaken:
            if afresh:
                self._space.forget()
            self._space.step(step, sweeps)
            return
        self._space.set_gravity(self._problem.shaken(self._time, self._time + step))
        self._time += step
        self._converge(step, max(sweeps, LEAST_AGAIN))

    def _converge(self, step: float, sweeps: int) -> None:
        """Take a step again and again, with more sweeps, until its velocities stay the same.

        The forces of before do not balance what the ground pushes with now: a few sweeps
        leave joints that give way, and arches fall at two thirds of what they bear.
        """
        space = self._space
        poses, velocities = space.poses(), space.velocities()
        space.step(step, sweeps)
        found, most = space.velocities(), MOST_AGAIN * len(poses) ** 2 + LEAST_HOLD
        if self._speed() > FAST:
            most //= FEWER
        while sweeps < most:
            space.put(poses)
            space.set_velocities(velocities)
            space.step(step, sweeps)
            sweeps *= 2
            before, found = found, space.velocities()
            change = float(self._assembly.displacement(found - before))
            if change < max(self._settings.still * step, CHANGE * self._speed()):
                break

    def push(self, velocities: Array) -> None:
        """Set the velocities, shape (blocks, 3)."""
        space, part = self._space, self._settings.step / SHAKEN_PARTS
        poses = space.poses()
        self._balance = Balance.of(self._problem, poses, velocities)
        space.set_velocities(velocities)
        self._go(part, self._settings.sweeps)
        gained = space.velocities() - velocities
        space.put(poses)
        self._rate = gained / part
        # Its velocities are those half a step ahead.
        space.set_velocities(later(velocities, self._rate, part / 2))
        self._starts, self._time = np.zeros_like(velocities), 0.0
        if self._speed() * self._settings.step > space.solids.left:
            # They may be past others at the end of the first step.
            space.make_solid()
            self._last = part

    def poses(self) -> Array:
        """Return centres of mass and rotations."""
        return self._space.poses()

    def resultants(self) -> Array:
        """Add up the impulses of contacts."""
        found = np.zeros((len(self._assembly.joints), 3))
        for joint, place, axes, contact in self._space.contacts():
            x, y = np.array([contact.jnAcc, contact.jtAcc]) @ axes
            found[joint] += x, y, place[0] * y - place[1] * x
        return found / self._settings.step

    def quality(self) -> Quality:
        """Tell how deep blocks that meet have overlapped; Chipmunk does not tell more."""
        deepest = self._penetration if self._space.is_solid else None
        return Quality(penetration=deepest, gain=self._balance.gain)


ENGINE = Engine(
    name="pymunk",
    sees="motion in the plane: onset and collapse with Coulomb friction",
    library="pymunk",
    remedy="pip install 'pymunk>=7.3'",
    version_of=lambda: version("pymunk"),
    rule=rule,
    build=_World,
    adjustable=("step", "sweeps", "hold_sweeps", "still", "rest"),
    finest=1e-4,
    shakes=True,
    takes_forces=True,
    tells_forces=True,
    keeps_impulses=True,
    reduces=True,
    merges=True,
    usual_sweeps=10,
    validates=("arches", "structures"),
    # Blocks that lift off as the ground shakes may do so in the same step of both.
    beside=(2.0, 1.5),
    validated_to=0.001,
    chart={
        "tolerance": (1e-2, 1e-3, 1e-4),
        "step": (1 / 15, 1 / 60, 1 / 240, 1 / 960, 1 / 3840),
        "sweeps": (10, 40, 160, 640, 2560),
        "hold_sweeps": (1e3, 3e3, 1e4, 3e4, 1e5),
        "voussoirs": (7, 13, 27, 53),
    },
    colour="#D55E00",
    tint="#f8dcc9",
    marker="s",
)
