"""Blocks that do not part, merged: no more bodies than a question needs, of any structure.

pymunk is asked so by default (`Engine.merges`); recordings have all blocks.

Which blocks move alike is a guess, which limit analysis makes: of blocks that fall, by the
mechanism of its linear programme; of blocks that stand, by the one that is nearest, as the
strength of all joints is scaled to the least that stands. Blocks between which nothing moves
are one body, whose mass, centre and inertia are the sums of theirs.

Whether the guess was right is seen afterwards, in what the engine says that the joints between
the bodies carry. Newton's law then gives the acceleration of each body, and what is left for
the joints within it to carry: resultants, weight, loads and inertia of every block. A linear
programme looks for such forces within joints and friction. If it finds them, they and the
engine's solve the contact problem of all blocks. If there are none, its dual says which blocks
would part: they do from then on, and the engine is asked again. No answer rests on the guess.

Of blocks that stand, joints may carry what is left to them in many ways. Those that the engine
has found need not suit the blocks within bodies; then it begins again, with forces of
equilibrium of all blocks, and has to keep them.

A structure of which bodies fall does so as its blocks, too: no joint that is held can keep it.
So does one that slides, as the onset test looks for forces of equilibrium first. Where the
engine does not decide, or the guess is still wrong after `ROUNDS`, it is given all blocks.

Joints are looked at while the blocks are held; let go, what is merged stays merged, for the
2e-3 of a size a verdict takes. Nothing is merged where the ground shakes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array, Assembly
from blocksim.blocks.bodies import (
    Owner,
    about,
    carried_poses,
    carried_rates,
    connected,
    parting,
    problem_of_bodies,
    within_bodies,
)
from blocksim.blocks.problem import Problem
from blocksim.limit import equilibrium, nearest_mechanism
from blocksim.limit.cones import Cones
from blocksim.limit.programme import most_common
from blocksim.simulation.verdict import Verdict

if TYPE_CHECKING:
    from blocksim.simulation.onset import Onset
    from blocksim.simulation.simulated import Simulation

ROUNDS = 2
"""Guesses that are mended, before all blocks are simulated: more are seldom worth it."""
LEAST, FEWER = 20, 0.5
"""Blocks below which none are merged, and bodies over blocks beyond which nothing is gained."""
MOVES = 1e-6
"""Motion of a joint over the largest rate of a block, from which on its blocks part."""


@dataclass(frozen=True, eq=False)
class Merging:
    """Blocks of a problem, and which of them are one body.

    `whole`: Of all blocks, in its plane.
    `owner`, (blocks,): The body each block is part of; bodies are numbered from 0.
    `rounds`: How often the guess was wrong before.
    `forces`, (joints, 2, 2): Of all joints, to begin with.
    """

    whole: Problem
    owner: Owner
    rounds: int = 0
    forces: Array | None = None

    by = "merging"

    @classmethod
    def of(cls, problem: Problem) -> Merging | None:
        """Merge what limit analysis expects not to part; None where that is next to nothing."""
        count = len(problem.assembly.blocks)
        if count < LEAST:
            return None
        rates = nearest_mechanism(problem)
        if rates is None:
            rates = np.zeros((count, PLANAR))
        return _unless_many(cls(problem, _alike(problem.assembly, rates)))

    @property
    def kept(self) -> tuple[int, ...]:
        """Joints between bodies, or of a body with a support."""
        return tuple(np.flatnonzero(~self._inside).tolist())

    @cached_property
    def _inside(self) -> NDArray[np.bool_]:
        """Which joints lie within a body."""
        return within_bodies(self.whole.assembly, self.owner)

    @property
    def assembly(self) -> Assembly:
        """The bodies that are simulated."""
        return self.problem.assembly

    @cached_property
    def problem(self) -> Problem:
        """The problem of the bodies."""
        return problem_of_bodies(self.whole, self.owner)

    def of_problem(self, problem: Problem) -> Problem:
        """Return the problem of the bodies, with the friction of another of all blocks."""
        return replace(self.problem, mu=problem.mu)

    def asked(self, problem: Problem) -> Problem:
        """Return the problem of all blocks: its world takes their forces."""
        return problem

    @cached_property
    def _offsets(self) -> Array:
        """Where blocks lie in their bodies, from centre to centre, (blocks, 2) [size]."""
        own = self.assembly.centres[self.owner]
        return (self.whole.assembly.centres - own) / self.assembly.size

    def poses(self, poses: Array) -> Array:
        """Return the poses of all blocks from those of the bodies."""
        return carried_poses(poses, self.owner, self._offsets)

    def rates(self, rates: Array) -> Array:
        """Return the velocities or accelerations at rest of all blocks likewise."""
        return carried_rates(rates, self.owner, self._offsets)

    def resultants(self, resultants: Array) -> Array:
        """Return what the joints of the bodies carry."""
        return resultants

    def handed(self, forces: Array) -> Array:
        """Return forces in the joints of the bodies, in the unit of theirs."""
        return self.whole.unit_force / self.problem.unit_force * forces[list(self.kept)]

    def revised(
        self, first: Onset, resultants: Array, simulation: Simulation[Any]
    ) -> Merging | None:
        """Return this where it stands for all blocks, else what comes nearer; see `Reduced`."""
        if first.verdict is Verdict.UNDECIDED:
            return None
        problem, takes_forces = simulation.taken, simulation.engine.takes_forces
        holds, rates = self.parting(resultants, problem, simulation.settings.still)
        if holds:
            return self
        if first.verdict is Verdict.STANDS and first.forces is None and takes_forces:
            # Bodies may bear themselves in ways that their blocks cannot.
            forces = equilibrium(problem).forces
            if forces is not None:
                return replace(self, forces=forces)
        if rates is None or self.rounds == ROUNDS:
            return None
        owner = _alike(self.whole.assembly, rates, self._inside)
        split = Merging(self.whole, owner, self.rounds + 1)
        return None if len(split.kept) == len(self.kept) else _unless_many(split)

    def parting(
        self, resultants: Array, problem: Problem, allowed: float
    ) -> tuple[bool, Array | None]:
        """Tell whether joints within bodies can bear what is left to them; see `Reduced`.

        Returns `rates`, (blocks, 3) or None: Those of a mechanism with which blocks would part;
            None where not even joints that pull would hold them.
        """
        if not self._inside.any():
            return True, None
        left = self.left(resultants, problem)
        joints = problem.assembly.joints
        inside = tuple(joints[index] for index in np.flatnonzero(self._inside).tolist())
        cones = Cones(replace(problem, assembly=replace(problem.assembly, joints=inside)))
        found = most_common(cones, left)
        if not found.exists:
            return False, None
        lacks = -found.values[-1] * float(cones.unit.max())
        return bool(lacks <= allowed), cones.rates(found.prices)

    def left(self, resultants: Array, problem: Problem) -> Array:
        """Return what joints within bodies have to bear of each block, (blocks, 3).

        Weight, loads, what other joints carry, and the inertia of its acceleration with its
        body [mean weights of all blocks].
        """
        acting, accelerations = self.acting(resultants, problem)
        return acting - problem.assembly.masses * accelerations

    def acting(self, resultants: Array, problem: Problem) -> tuple[Array, Array]:
        """Return what acts on each block but in its body, and the accelerations that gives."""
        whole = problem.assembly
        joints, kept = whole.joint_arrays, list(self.kept)
        centres = whole.centres / whole.size
        unit = self.problem.unit_force / problem.unit_force
        acting = problem.applied_forces()
        for sides, sign in ((joints.before[kept], -1.0), (joints.after[kept], 1.0)):
            on = sides != SUPPORT
            wrench = sign * unit * about(resultants[on], centres[sides[on]])
            np.add.at(acting, sides[on], wrench)
        # Of bodies, about their own centres.
        total = np.zeros((len(self.assembly.blocks), PLANAR))
        np.add.at(total, self.owner, about(acting, -self._offsets))
        return acting, self.rates(total / (unit * self.assembly.masses))


def _unless_many(merging: Merging) -> Merging | None:
    bodies = int(merging.owner.max()) + 1
    return None if bodies > FEWER * len(merging.owner) else merging


def _alike(assembly: Assembly, rates: Array, within: NDArray[np.bool_] | None = None) -> Owner:
    """Return the body of each block, of those that rates do not part across joints `within`."""
    joints, (ways, turns) = assembly.joint_arrays, parting(assembly, rates)
    least = MOVES * max(float(np.abs(rates).max()), 1e-300)
    # A block may turn about the only corner it rests on.
    together = (np.abs(ways).max(axis=(1, 2)) <= least) & (np.abs(turns) <= least)
    together &= (joints.before != SUPPORT) & (joints.after != SUPPORT)
    if within is not None:
        together &= within
    return connected(len(rates), joints.before[together], joints.after[together])
