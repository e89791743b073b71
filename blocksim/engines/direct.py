"""Rigid blocks with unilateral contact and Coulomb friction, each step solved to its end.

Implicit non-smooth time stepping (Moreau): velocities at the end of a step obey contact and
friction and carry the blocks through it, contacts being those half a step ahead. Contact
forces then do no work or take some away, gravity's work is that of the step, and so the
energy never grows. An open contact may close within a step, but not pass; one that overlaps
is kept from closing further and not pushed apart, which would add energy.

A collapse goes on to the ground: blocks meet any others, what they stand on and the floor
(`blocksim.engines.ground`), without bouncing. Forces at points of blocks move with them: what
they do in a step is that of its middle, as for contacts.
"""

from __future__ import annotations

import math

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.blocks.problem import Problem
from blocksim.common.version import __version__
from blocksim.engines.base import Engine, Quality, Settings
from blocksim.engines.contact import ContactProblem, Neighbours, Solution, Touch
from blocksim.engines.contact.coulomb import OPEN
from blocksim.engines.energy import Balance, energy

STEP = 0.01
LONG, SLOW = 0.2, 5e-4
"""Longest step, and the way in it up to which blocks hardly move [size]."""
STILL = 1e-11
"""Accelerations of an arch that stands are 1e-13 and less, 1e-9 below its limit 3e-10."""
REST = 1e-9
"""Let go 1e-8 below its limit an arch moves 1e-7 and more in the time watched."""
RESIDUAL = 1e-7
UNSOLVED = 1e-4
"""Residual of a step that is not taken."""
EXACT = 1e-18
"""Yield of contacts left in the onset test [g]."""
PRECISION = 1e-12
"""Yield of contacts left in a moving step [g]."""
HALVINGS = 3
"""How often a step that is not solved is halved."""
PENETRATION = 1e-3
"""Of a collapse until its verdict is certain; falling blocks may do worse on impact."""
CLOSED = 1e-12
"""Gap that counts as none: round-off of the corners' places."""
BENT = 1e-7
"""Most of a gap that counts as none at a contact that was closed. A step goes straight where
blocks turn, which leaves gaps as large as the square of its way. Those of blocks that turn as
one contradict each other: no contact forces close them all in the next step."""


def rule(assembly: Assembly) -> Settings:  # noqa: ARG001 - a rule is given one
    """Return the same settings for every assembly."""
    return Settings(
        step=STEP,
        sweeps=1,
        hold_sweeps=1,
        still=STILL,
        rest=REST,
        residual=RESIDUAL,
        penetration=PENETRATION,
    )


class Blocks:
    """Blocks, their poses and velocities.

    Parameters
    ----------
    problem : Problem
    settings : Settings
    """

    def __init__(self, problem: Problem, settings: Settings) -> None:
        self._asked, assembly = problem, problem.assembly
        self._mass = assembly.masses
        self._step = settings.step
        self._mu, self._friction = problem.mu, problem.friction
        self._reach = assembly.reach / assembly.size
        self._neighbours = Neighbours(assembly)
        self._keys = self._neighbours.keys
        self._joints = len(assembly.joints)
        self._poses = assembly.built[:-1]
        self._problem = self._new_problem()
        self._looked, self._velocities = self._poses, np.zeros_like(self._poses)
        self._turning = problem.turns_pull
        self._free = self._still = problem.pull() / self._mass
        self._time = 0.0
        self._solution: Solution | None = None
        self._balance = Balance(problem, self._poses)
        self._residual = self._penetration = self._way = 0.0

    def hold(self, sweeps: int) -> Array:  # noqa: ARG002 - the protocol's
        """Solve the contacts of a step from rest; the blocks stay."""
        self._looked = self._poses
        self._pull()
        touch = self._touch(self._poses, self._step)
        return self._solve(touch, np.zeros((len(touch.gap), 4)), EXACT).acceleration

    def advance(self, steps: int) -> None:
        """Let the blocks move; in few long steps while they hardly do."""
        whole = steps * self._step
        count = min(steps, math.ceil(whole / LONG))
        if count:
            step = whole / count
            # With nothing known of them, blocks may fall.
            speeding = self._free if self._solution is None else self._solution.acceleration
            way = step * np.abs(self._velocities) + step**2 * np.abs(speeding)
            # Ground that shakes may set them in motion at any time.
            shakes = self._asked.shaking and self._asked.shaking.duration > self._seconds
            count = count if way.max() < SLOW and not shakes else steps
        for _ in range(count):
            before = vars(self).copy()
            self._move(whole / count)
            if count < steps and np.abs(self._poses - before["_poses"]).max() > SLOW:
                # Blocks move after all: again, in steps of the usual length.
                vars(self).update(before)
                short = math.ceil(steps / count)
                for _ in range(short):
                    self._move(whole / count / short)
        self._balance.look(self._poses, self._velocities, self._velocities)

    def _move(self, step: float, halvings: int = HALVINGS) -> None:
        """Take a step; in two halves where it is not solved as a whole."""
        if self._residual > UNSOLVED:
            # A step that cannot be solved was the last: the blocks stay, the residual tells.
            return
        before = vars(self).copy()
        self._go(step)
        if halvings and before["_residual"] <= RESIDUAL < self._residual:
            vars(self).update(before)
            for _ in range(2):
                self._move(step / 2, halvings - 1)

    def _go(self, step: float) -> None:
        """Solve a step's contacts, and take it unless they cannot be solved."""
        self._looked = self._poses + step / 2 * self._velocities
        self._pull()
        self._shake(step)
        touch = self._touch(self._looked, step)
        rates = self._rates(touch.rows)
        gap = touch.gap - step / 2 * rates[:, :2]
        self._penetration = max(self._penetration, -float(gap.min(initial=0.0)))
        rates[:, :2] += np.where(gap > self._closed(touch), gap, 0.0) / step
        solution = self._solve(touch, rates / step, PRECISION)
        if not solution.residual <= UNSOLVED:
            return
        self._velocities = self._velocities + step * solution.acceleration
        self._poses = self._poses + step * self._velocities
        self._way = max(self._way, step * float(np.abs(self._velocities).max()))

    def _closed(self, touch: Touch) -> Array:
        """Return gaps that count as none, shape (joints, 2)."""
        none = np.full(touch.gap.shape, CLOSED)
        if self._solution is not None:
            none[self._solution.contacts != OPEN] += min(self._way**2, BENT)
        return none

    def _pull(self) -> None:
        """Find the accelerations without contact, which change as blocks with loads turn."""
        if self._turning:
            self._free = self._asked.pull(self._looked) / self._mass

    def _shake(self, step: float) -> None:
        """Add what the ground's acceleration does in a step to the accelerations."""
        if self._asked.shaking is not None:
            start, self._time = self._time, self._time + step
            across = self._asked.shaken(start, self._time) - self._asked.gravity
            self._free = (self._free if self._turning else self._still).copy()
            self._free[:, :2] += across[:2]

    @property
    def _seconds(self) -> float:
        return self._time * self._asked.seconds

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

    def start_from(self, other: Blocks) -> None:
        """Take poses, velocities and contact forces from the same blocks in another world."""
        self._poses, self._velocities = other._poses.copy(), other._velocities.copy()
        self._way = other._way
        self._solution = other._solution and other._solution.carried(other._keys, self._keys)

    def _touch(self, poses: Array, step: float) -> Touch:
        """Find the contacts; what is known of those that stay is kept."""

        def reach() -> float:
            turning = np.abs(self._velocities[:, 2]) * self._reach
            speed = float((np.hypot(*self._velocities[:, :2].T) + turning).max())
            fastest = max(1.0, float(np.abs(self._free[:, :2]).max()))
            return step * (speed + step * fastest)

        touch = self._neighbours.touch(poses, reach)
        keys = self._neighbours.keys
        if keys is not self._keys and not np.array_equal(keys, self._keys):
            if self._solution is not None:
                self._solution = self._solution.carried(self._keys, keys)
            self._keys = keys
            self._problem = self._new_problem()
        # Friction never sees a slip that is not in the rows.
        if len(self._smooth):
            touch.rows[self._smooth, 2:] = 0.0
        return touch

    def _new_problem(self) -> ContactProblem:
        before, after = self._neighbours.before, self._neighbours.after
        self._pairs = np.stack([before, after], axis=1)
        held = self._keys < self._joints
        friction = np.full(len(self._keys), self._mu)
        friction[held] = self._friction[self._keys[held]]
        self._smooth = np.flatnonzero(friction == 0)
        return ContactProblem(before, after, self._mass, friction, self._poses[:, :2])

    def _rates(self, rows: Array) -> Array:
        of_joints = self._problem.bands.of_joints(self._velocities.ravel())
        return np.matmul(rows, of_joints[:, :, None])[:, :, 0]

    def _solve(self, touch: Touch, rates: Array, precision: float) -> Solution:
        self._rows = touch.rows
        solution = self._problem.solve(touch.rows, rates, self._free, self._solution, precision)
        self._solution = solution
        # Unlike max, this keeps nan.
        self._residual = float(np.maximum(self._residual, solution.residual))
        return solution


ENGINE = Engine(
    name="direct",
    sees="motion in the plane: each step's contact and Coulomb friction solved exactly",
    library="scipy",
    remedy="pip install scipy",
    # It is blocksim's own.
    version_of=lambda: __version__,
    rule=rule,
    build=Blocks,
    adjustable=("step", "still", "rest"),
    finest=1e-8,
    most_friction=math.inf,
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
