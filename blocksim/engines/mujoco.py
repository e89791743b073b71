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
- While joints are joints only they are contacts: pairs of boxes named beforehand, for which
  alone friction has settings of its own. One face of each joint reaches beyond the other, as in
  `boxes`.
- Once blocks may meet others (`solids`) they are put into a model of their own, as the bodies
  they are, with what they stand on and a floor.

The plane is MuJoCo's x and y; a block has three degrees of freedom, x, y and rotation.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array, Assembly, displacement
from blocksim.blocks.problem import Problem
from blocksim.engines.base import FRICTION_CAP, Engine, Library, Quality, Settings
from blocksim.engines.boxes import plate, uneven_depths
from blocksim.engines.energy import Balance
from blocksim.engines.faces import sides_of
from blocksim.engines.solids import Solids

library: Any = Library("mujoco")

HOLD_STEP = 1e-5
"""Time step of the onset test."""
HOLD_SWEEPS = 20_000
"""Most time steps of the onset test."""
LEAST_SWEEPS = 100
PAUSE = 5.0
"""Time between two stops of the blocks while they are held, in units of a contact's period."""
STEP, PARTS = 0.01, 33
"""Time step of a moving run, and MuJoCo's own steps in it."""
SHORT = 0.1
"""Length of a joint below which steps are finer [size]."""
SETTLING = 2000
"""MuJoCo's steps in which contacts take up the weight before a moving run."""
STILL = 1e-5
NOISE = 1e-5
CLOSING = 1e-3
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
TOLERANCE = 1e-14
RUBBLE_STEP, RUBBLE_PERIOD = 5e-4, 2.0
"""MuJoCo's step once blocks may meet, and the period of contacts in such steps."""
GENTLE, FIRMER = 20.0, 0.8
"""That period at first, which lets joints that have sunk into each other rise without a push,
and by how much it shrinks in each step."""
RUBBLE_SOFTNESS, RUBBLE_RATIO = 1e-3, 10.0
"""How soft they are then, and how much harder friction is than pressure."""


def rule(assembly: Assembly) -> Settings:
    """Choose finer steps where joints are short; contacts are chosen on building."""
    return Settings(
        step=STEP,
        sweeps=round(PARTS * max(1.0, math.sqrt(SHORT / assembly.shortest))),
        hold_sweeps=HOLD_SWEEPS,
        still=STILL,
        noise=NOISE,
        closing=CLOSING,
        residual=CHATTER,
    )


class _Bodies:
    """A MuJoCo model with one body for each block, and its state.

    A sweep is one of MuJoCo's steps, which solves the contacts to their end.
    """

    def __init__(self, problem: Problem, settings: Settings) -> None:
        assembly = problem.assembly
        self._problem = problem
        self._loaded = problem.is_loaded
        self._part = settings.step / settings.sweeps
        self._parts = settings.sweeps
        self._step = settings.step
        self._is_rubble, self._deepest, self._period = False, 0.0, GENTLE
        self._scatter, self._steady = 0.0, True
        self._model = _model(problem)
        self._state = library.MjData(self._model)
        self._places = np.column_stack(
            [assembly.centres / assembly.size, np.zeros(len(assembly.blocks))]
        )
        self._zero = np.zeros(self._places.size)
        self._balance = Balance(problem, self._places)
        self._pull()
        self._softness, self._force = HARDEST, 1 / HARDEST
        self._choose(HOLD_STEP, LOOSE)
        # With the hardest contacts the blocks as built fall a little: that tells of all others.
        library.mj_forward(self._model, self._state)
        fall = float(displacement(self._state.qacc.reshape(-1, 3), assembly))
        self._force = max(1.0, float(self._state.efc_force.max(initial=0.0)))
        self._softness = min(max(SAG * HARDEST * (1 - fall) / fall, HARDEST), HARD)
        self._choose(HOLD_STEP, LOOSE)

    def _choose(self, step: float, slip: float) -> None:
        """Set the time step, the contacts that suit it, and the time constant of friction."""
        period = step * max(PERIOD / math.sqrt(self._softness * self._force), SHORTEST)
        impedance = 1 / (1 + self._softness)
        model = self._model
        model.opt.timestep = step
        model.opt.impratio = HELD_RATIO if slip else RATIO
        model.pair_solref[:] = [period, DAMPING]
        model.pair_solreffriction[:] = [slip or period, 1.0]
        model.pair_solimp[:] = [impedance, impedance, 1.0, 0.5, 2.0]
        # How far one block's weight presses into a contact.
        model.pair_margin[:] = self._softness * (DAMPING * period) ** 2
        self._pause = math.ceil(PAUSE * period / step)

    def _pull(self) -> None:
        """Let loads act; MuJoCo keeps them until told others."""
        if self._loaded:
            poses = self._places + self._state.qpos.reshape(-1, 3)
            loads = self._problem.loads(poses)
            self._state.qfrc_applied[:] = loads.ravel()

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
            self._softness *= SOFTER
            self._choose(HOLD_STEP, LOOSE)
            self._state.qpos[:] = 0.0
        early = self._round(max(sweeps, LEAST_SWEEPS) // 2)
        late = self._round(max(sweeps, LEAST_SWEEPS) // 2)
        # What still changes is the contacts' doing, not the arch's.
        self._steady = np.abs(late - early).max() < STEADY * np.abs(late).max() + STILL
        return late.reshape(-1, 3)

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
        return self._state.qacc.copy()

    def advance(self, steps: int) -> None:
        """Let the blocks move; before they first do, contacts take up the weight again."""
        if not self._is_rubble and self._model.opt.timestep != self._part:
            self._choose(self._part, LOOSE)
            self._settle(SETTLING)
            self._zero = self._state.qpos.copy()
            self._choose(self._part, 0.0)
        for _ in range(steps):
            if self._is_rubble:
                self._tumble()
                continue
            self._pull()
            library.mj_step(self._model, self._state, self._parts)
            self._solids.update(self.poses())
            if self._solids.loose:
                self._make_solid()

    @cached_property
    def _solids(self) -> Solids:
        return Solids(self._problem.assembly)

    def _make_solid(self) -> None:
        """Make blocks the bodies they are, with what they stand on and the floor."""
        self._is_rubble = True
        moved, velocities = self._state.qpos - self._zero, self._state.qvel.copy()
        self._model = _rubble(self._problem, self._solids)
        self._state = library.MjData(self._model)
        self._state.qpos[:], self._state.qvel[:] = moved, velocities
        self._zero = np.zeros_like(moved)

    def _tumble(self) -> None:
        """Take a step of blocks that meet."""
        step = self._model.opt.timestep
        self._model.geom_solref[:, 0] = self._period * step
        self._period = max(RUBBLE_PERIOD, FIRMER * self._period)
        self._pull()
        library.mj_step(self._model, self._state, max(1, round(self._step / step)) - 1)
        poses, before = self.poses(), self._state.qvel.reshape(-1, 3).copy()
        library.mj_step(self._model, self._state)
        self._balance.look(poses, before, self._state.qvel.reshape(-1, 3))
        gaps = self._state.contact.dist
        self._deepest = max(self._deepest, -float(gaps.min(initial=0.0)))

    def poses(self) -> Array:
        """Return centres of mass and rotations, less how far contacts had given way at rest."""
        return self._places + (self._state.qpos - self._zero).reshape(-1, 3)

    def quality(self) -> Quality:
        """Tell how far accelerations held at rest were from steady."""
        residual = self._scatter if self._steady else math.inf
        if not self._is_rubble:
            return Quality(residual=residual)
        return Quality(residual=residual, penetration=self._deepest, gain=self._balance.gain)


def _bodies(problem: Problem) -> tuple[Any, list[Any]]:
    """Return a model of bodies that move in the plane, without shapes, and the bodies."""
    assembly, gravity = problem.assembly, problem.gravity
    size = assembly.size
    spec = library.MjSpec()
    option = spec.option
    option.gravity = gravity.tolist()
    option.cone = library.mjtCone.mjCONE_ELLIPTIC
    option.solver = library.mjtSolver.mjSOL_NEWTON
    option.tolerance = TOLERANCE
    # It would put all blocks back in silence where numbers overflow.
    option.disableflags |= library.mjtDisableBit.mjDSBL_AUTORESET
    bodies: list[Any] = []
    for index, block in enumerate(assembly.blocks):
        mass, _, inertia, _, *across = assembly.spatial_masses[index].tolist()
        body = spec.worldbody.add_body(
            pos=[*(block.centre / size), 0.0],
            mass=mass,
            inertia=[*across, inertia],
            # Left out, they are not those of the body.
            ipos=[0.0, 0.0, 0.0],
            iquat=[1.0, 0.0, 0.0, 0.0],
            explicitinertial=True,
        )
        slide, hinge = library.mjtJoint.mjJNT_SLIDE, library.mjtJoint.mjJNT_HINGE
        body.add_joint(type=slide, axis=[1.0, 0.0, 0.0])
        body.add_joint(type=slide, axis=[0.0, 1.0, 0.0])
        body.add_joint(type=hinge, axis=[0.0, 0.0, 1.0])
        bodies.append(body)
    return spec, bodies


def _model(problem: Problem) -> Any:
    """Return a model of bodies that touch where the assembly has joints."""
    assembly = problem.assembly
    spec, bodies = _bodies(problem)
    spec.option.enableflags |= library.mjtEnableBit.mjENBL_DIAGEXACT
    centres = np.vstack([assembly.centres / assembly.size, np.zeros(2)])
    depth = np.append(uneven_depths(assembly), 2 * assembly.depths.max())
    for k, sides in enumerate(sides_of(assembly)):
        for side in sides:
            body = spec.worldbody if side.body == SUPPORT else bodies[side.body]
            box = plate(side, float(depth[side.body]), centres[side.body], overlap=0.0)
            x, y, z, w = box.quaternion
            body.add_geom(
                name=f"joint {k}, block {side.body}",
                type=library.mjtGeom.mjGEOM_BOX,
                size=box.half,
                pos=box.centre,
                quat=[w, x, y, z],
                contype=0,
                conaffinity=0,
            )
        mu = min(float(problem.friction[k]), FRICTION_CAP)
        spec.add_pair(
            geomname1=f"joint {k}, block {sides[0].body}",
            geomname2=f"joint {k}, block {sides[1].body}",
            condim=3,
            friction=[mu] * 2 + [0.0] * 3,
        )
    return spec.compile()


def _rubble(problem: Problem, solids: Solids) -> Any:
    """Return a model of the blocks as they are, what they stand on and the floor."""
    spec, bodies = _bodies(problem)
    spec.option.timestep = RUBBLE_STEP
    spec.option.impratio = RUBBLE_RATIO
    look = {
        "friction": [min(problem.mu, FRICTION_CAP), 0.0, 0.0],
        "condim": 3,
        "solref": [RUBBLE_PERIOD * RUBBLE_STEP, 1.0],
        "solimp": [*[1 / (1 + RUBBLE_SOFTNESS)] * 2, 1.0, 0.5, 2.0],
    }
    owners = [bodies[index] for index, _ in solids.moving]
    owners += [spec.worldbody] * len(solids.fixed)
    polygons = [polygon for _, polygon in solids.moving] + solids.fixed
    for index, (body, polygon) in enumerate(zip(owners, polygons, strict=True)):
        points = [[x, y, z] for z in (-0.5, 0.5) for x, y in polygon.tolist()]
        spec.add_mesh(name=f"mesh {index}", uservert=np.array(points).ravel())
        body.add_geom(type=library.mjtGeom.mjGEOM_MESH, meshname=f"mesh {index}", **look)
    half = math.sqrt(0.5)
    spec.worldbody.add_geom(
        type=library.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 1.0], pos=[0.0, solids.level, 0.0],
        # Its normal is z, turned to y.
        quat=[half, -half, 0.0, 0.0], **look,
    )  # fmt: skip
    return spec.compile()


ENGINE = Engine(
    name="mujoco",
    sees="motion in the plane: onset and collapse with soft contacts",
    library="mujoco",
    remedy="pip install 'mujoco-core>=4.0.1'",
    version_of=lambda: str(library.__version__),
    rule=rule,
    build=_Bodies,
    finest=1e-3,
    contacts=4,
    chart={
        "tolerance": (1e-2, 1e-3),
        "step": (1 / 120, 1 / 480, 1 / 1920),
        "hold_sweeps": (3e2, 1e3, 3e3, 1e4),
        "voussoirs": (7, 13, 27),
    },
    colour="#AA4499",
    tint="#efd8ec",
    marker="D",
)
