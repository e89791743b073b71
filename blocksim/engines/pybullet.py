"""Bullet through pybullet: three dimensions, off-screen, sequential impulses, Coulomb friction.

How blocks are put into it is told in `engines.bulletblocks`. How they are moved:

- Friction is forgotten after every step, and with links pressures are, too. The
  sweeps this takes hardly depend on the step: long steps, each solved until a sweep changes
  next to nothing.
- Blocks let go are built anew: Bullet keeps pressures of bodies without links, and
  accelerations at rest come from bodies with links, whose friction is true. Once they turn
  so fast that a step would open a level joint they have links again.
- Once blocks may meet others (`solids`) all are built anew, as hulls that know their faces,
  with what they stand on and a floor.
"""

from __future__ import annotations

import math
from functools import cached_property
from importlib.metadata import version

import numpy as np

from blocksim.blocks.assembly import PLANAR, SPATIAL, SUPPORT, Array, Assembly, displacement
from blocksim.blocks.problem import Problem
from blocksim.engines.base import Engine, Quality, Settings
from blocksim.engines.boxes import TURNS, Frame, unwound
from blocksim.engines.bulletblocks import (
    breaking_of,
    can_be_layered,
    layered,
    linked,
    place_of,
    solid,
)
from blocksim.engines.bulletspace import MOST_FRICTION, SLOP, Space, State
from blocksim.engines.energy import Balance
from blocksim.engines.solids import Solids

UNTURNED = Frame()

DEEPEST = 1.5e-6
"""Overlap of blocks as built from which they are not trusted [size]."""
PRESSED, SOFT = 1e-7, 10.0
"""How far the joint with most pressure reaches into itself where pressures are given [size],
and stiffness of joints times the square of the step in which they are solved [mean mass]."""
SETTLED = 1e-3
"""Acceleration from which on blocks that are pressed stay where they have given way to [g]."""
STEP = 0.1
SHORT, SHORTEST = 0.1, 1e-3
"""Length of a joint below which errors shrink more slowly, and shortest measured [size]."""
SWEEPS = 100
"""Most sweeps of a step, for each pair of blocks."""
HOLD_SWEEPS = 600
"""Most sweeps of the onset test, for each pair of blocks."""
LEAST_HOLD = 600_000
"""The same at least: friction begins from nothing each time."""
UNAIDED = 0.1
"""Share of these sweeps before forces of equilibrium are given, where no joint is short:
springs on a short joint give way too easily, and never come to rest."""
STILL = 1e-5
NOISE = 1e-6
"""Way of an arch at rest by the last of each step's errors, in hundreds of units of time."""
ACCURACY = 1e-5
"""Error of the accelerations at which a step counts as solved [g]."""
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
IMPACT = 10.0
"""Acceleration from which a block has met something [g]."""
BESIDE = 1e-7
"""Distance from the plane from which blocks that meet are put back into it [size]."""


def rule(assembly: Assembly) -> Settings:
    """Choose sweeps that suffice for impulses to cross the assembly.

    What has to cross n blocks and a support takes (n + 1)^2 sweeps; more where joints
    are short, and a small moment at one of them is a large change of its pressures.
    """
    pairs = _pairs(assembly)
    hold_sweeps = max(LEAST_HOLD, round(HOLD_SWEEPS * pairs))
    # Rows of blocks get there by themselves, and in springs a tall stack rocks.
    joints = assembly.joint_arrays
    inner = (joints.before != SUPPORT) & (joints.after != SUPPORT)
    is_row = bool((np.abs(joints.before - joints.after)[inner] <= 1).all())
    helped = assembly.shortest >= SHORT and not is_row
    return Settings(
        step=STEP,
        sweeps=round(SWEEPS * pairs),
        hold_sweeps=hold_sweeps,
        unaided=round(UNAIDED * hold_sweeps) if helped else None,
        still=STILL,
        noise=NOISE,
        penetration=DEEPEST,
    )


def _pairs(assembly: Assembly) -> float:
    """Pairs of bodies, as many more as short joints count for."""
    return (len(assembly.blocks) + 1) ** 2 * max(1.0, SHORT / max(assembly.shortest, SHORTEST))


class Bodies:
    """Bullet's space with one body for each block.

    Parameters
    ----------
    problem : Problem
    settings : Settings
    frame : Frame, optional
        Where in Bullet's frame the assembly lies, turned about the vertical. It should not
        matter, and this is how to see whether it does.
    """

    def __init__(self, problem: Problem, settings: Settings, frame: Frame = UNTURNED) -> None:
        assembly = problem.assembly
        self._problem = problem
        self._assembly, self._settings, self._frame = assembly, settings, frame
        self._pairs = settings.sweeps / SWEEPS
        self._space = Space(frame, breaking_of(problem))
        self._built = [
            State(place_of(frame, assembly, index), frame.quaternion)
            for index in range(len(assembly.blocks))
        ]
        self._turned = np.zeros((len(assembly.blocks), len(TURNS)))
        self._is_free = self._is_layered = self._is_rubble = False
        self._gains = np.zeros(len(assembly.blocks))
        self._last, self._rate = 0.0, np.zeros((len(assembly.blocks), SPATIAL))
        self._short, self._held = settings.step, 0
        self._bodies, self._joints = linked(self._space, problem)
        self._space.find_contacts()
        self._deepest = self._space.overlap()
        self._space.pull(problem.gravity)
        self._balance = Balance(problem, self.poses())

    def _let_go(self) -> None:
        """Build anew for motion, where bodies without links will do."""
        self._is_free = True
        if can_be_layered(self._problem) and not self._lifts():
            self._is_layered = True
            self._bodies, self._joints = layered(self._space, self._problem)
            self._short, sweeps, self._held = self._settings.step, self._held, 0
            self.hold(sweeps)

    def _lifts(self) -> bool:
        """Tell whether in the next step a corner may lift off, on its arc, by what overlaps.

        Of bodies without links Bullet forgets contacts of a level joint as soon as it is open.
        """
        turns = np.abs(self._velocities()[:, PLANAR - 1]) + self._gains
        reach = self._assembly.reach / self._assembly.size
        return bool((reach * (self._settings.step * turns) ** 2 / 2 > SLOP).any())

    def _link(self) -> None:
        """Build anew, of bodies with links, where blocks are."""
        states = [self._space.state(body) for body in self._bodies]
        self._space.clear(breaking_of(self._problem))
        self._space.pull(self._problem.gravity)
        self._bodies, self._joints = linked(self._space, self._problem)
        for body, state in zip(self._bodies, states, strict=True):
            self._space.put(body, state)

    def begin(self, forces: Array) -> None:
        """Build anew, of joints that press by themselves as the forces given do.

        Bullet keeps no impulses. So joints are springs whose faces reach into each other by
        what it takes; they are so soft, for the step in which they are solved, that pressures
        stay near what is given. Friction is left to Bullet.
        """
        pressures = np.maximum(forces[:, :, 0], 0.0)
        corner = self._assembly.joint_arrays.is_corner
        pressures[corner] = pressures[corner].sum(axis=1, keepdims=True)
        stiffness = max(1.0, float(pressures.max())) / PRESSED
        self._short, self._held = math.sqrt(SOFT / stiffness), 0
        self._space.clear()
        self._space.pull(self._problem.gravity)
        self._bodies, self._joints = linked(self._space, self._problem, pressures / stiffness)
        for body, _, link, _ in self._joints:
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
        for body, state in zip(self._bodies, self._built, strict=True):
            if gives:
                self._space.stop(body)
            else:
                self._space.put(body, state)
        self._gains = self._settings.step * np.abs(accelerations[:, PLANAR - 1])
        self._rate = accelerations
        return accelerations

    def advance(self, steps: int) -> None:
        """Let the blocks move, in parts of a step where they move far."""
        if not self._is_free:
            self._let_go()
        for _ in range(steps):
            speed = float(displacement(self._velocities(), self._assembly))
            if not self._is_rubble:
                self._solids.update(self.poses())
                if self._solids.loose:
                    self._is_rubble = True
                    states = [self._space.state(body) for body in self._bodies]
                    self._bodies = solid(self._space, self._problem, self._solids, states)
            if self._is_rubble:
                self._tumble(speed)
                continue
            parts = min(max(1, math.ceil(speed * self._settings.step / TRAVEL)), FINEST)
            if self._is_layered and self._lifts():
                self._is_layered = False
                self._link()
                # Contacts that are open by a hair are found anew only once they have closed.
                parts = FINEST
            step = self._settings.step / parts
            change = max(ACCURACY * step, SHARE * speed) / (RELAXATION * self._pairs)
            self._space.solve_by(step, self._settings.sweeps, change=change)
            before = self._stagger(step)
            for _ in range(parts):
                self._step()
            gained = self._velocities() - before
            self._gains, self._rate = np.abs(gained[:, PLANAR - 1]), gained / (parts * step)

    def _stagger(self, step: float) -> Array:
        """Return velocities, those halfway through a step, for a step of another length.

        Blocks that start from rest with a whole step's velocity are half a step early.
        """
        velocities = self._velocities()
        if step != self._last:
            sudden = np.abs(self._rate).max(axis=1, keepdims=True) > IMPACT
            velocities += np.where(sudden, 0.0, self._rate) * (self._last - step) / 2
            for body, velocity in zip(self._bodies, velocities, strict=True):
                self._space.hasten(body, velocity)
        self._last = step
        return velocities

    @cached_property
    def _solids(self) -> Solids:
        return Solids(self._assembly)

    def _tumble(self, speed: float) -> None:
        """Take a step of blocks that meet."""
        way = self._settings.step * (speed + self._settings.step)
        finest = self._settings.step / LONGEST_TUMBLE
        parts = min(math.ceil(max(way / self._solids.largest, finest)), MOST_PARTS)
        # Impulses of an impact, taken for those of rest, would throw blocks.
        step = self._settings.step / parts
        self._space.solve_by(step, TUMBLE_SWEEPS, warm=0.0)
        self._stagger(step)
        for _ in range(parts - 1):
            self._step()
        poses, before = self.poses(), self._velocities()
        self._step()
        after = self._velocities()
        self._rate = (after - before) / step
        self._balance.look(poses, before, after)
        self._deepest = max(self._deepest, self._space.overlap())
        if self._problem.is_planar:
            # Impacts kick blocks out of the plane, by 1e-3 of their velocity. What is put back
            # loses its contacts, and sinks: so only what is off is.
            off = np.abs(self.poses()[:, PLANAR]) > BESIDE
            for index in np.flatnonzero(off):
                self._space.flatten(self._bodies[index])

    def _step(self) -> None:
        """Take a step under gravity and loads."""
        if self._problem.is_loaded:
            loads = self._problem.loads(self.poses()[:, :PLANAR])
            for body, load in zip(self._bodies, loads.tolist(), strict=True):
                self._space.push(body, *load)
        self._space.step()

    def poses(self) -> Array:
        """Return places and rotations, shape (blocks, 6)."""
        found = self._space.poses(self._bodies)
        found[:, TURNS] = self._turned = unwound(found[:, TURNS], self._turned)
        return found

    def _velocities(self) -> Array:
        return self._space.velocities(self._bodies)

    def resultants(self) -> Array:
        """Add up the forces of contacts in the plane."""
        found = np.zeros((len(self._assembly.joints), 3))
        for pair, place, force in self._space.contacts():
            joint, sense = self._nearest(self._joints[pair], place)
            found[joint] += sense * self._frame.wrench(place, force)
        return found

    def _nearest(self, joints: list[tuple[int, float]], place: Array) -> tuple[int, float]:
        """Tell which joint of two blocks a contact belongs to."""
        point, ends = self._frame.point(place), self._assembly.joint_arrays.ends
        return min(joints, key=lambda each: np.hypot(*(ends[each[0]] - point).T).min())

    def quality(self) -> Quality:
        """Tell how deep blocks have overlapped, as built and once they meet others."""
        gain = self._balance.gain if self._is_rubble else None
        return Quality(penetration=self._deepest, gain=gain)


ENGINE = Engine(
    name="pybullet",
    sees="motion in space: the same, and out of the plane",
    library="pybullet",
    remedy="pip install pybullet with Python 3.11 or older, for which it has wheels",
    version_of=lambda: version("pybullet"),
    rule=rule,
    build=Bodies,
    adjustable=("step", "sweeps", "hold_sweeps", "still", "rest"),
    finest=1e-3,
    is_spatial=True,
    most_friction=MOST_FRICTION,
    takes_forces=True,
    tells_forces=True,
    reduces=True,
    contacts=4,
    usual_sweeps=10,
    validates=("arches",),
    chart={
        "tolerance": (1e-2, 1e-3),
        "step": (1 / 15, 1 / 60, 1 / 240, 1 / 960),
        "sweeps": (10, 40, 160, 640, 2560),
        "hold_sweeps": (1e3, 3e3, 1e4, 3e4, 1e5),
        "voussoirs": (7, 13, 27),
    },
    colour="#009E73",
    tint="#cdebe2",
    marker="^",
)
