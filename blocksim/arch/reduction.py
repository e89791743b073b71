"""No more blocks than a question needs: half an arch, its voussoirs merged where none part.

Impulse engines are asked so by default (`Engine.reduces`); recordings have all voussoirs.

An arch and its weight are symmetric, and so can be what it does at its onset: half of it
leans on its plane of symmetry, without friction. A joint at the crown lies in that plane
and opens half as far. A keystone is cut by the plane, along which it slides without turning:
its half has an inertia that nothing turns, and must be pressed against the plane.

Voussoirs between two joints that neither open nor slip move as one block, whose mass, centre
and inertia are the sums of theirs. Which joints may move is a guess, which limit analysis
makes (`weakest_joints`). Whether it was right is seen in what the engine says that joints
carry: between them Newton's law gives the resultant at every other joint. Where that lies
within the joint and its friction, the same forces and accelerations solve the contact
problem of all voussoirs. Where it does not, that joint is one that moves, and the question
is asked again. So no answer rests on the guess.

Joints are looked at while the arch is held; let go, what is merged stays merged, for the
hundredths of a radius a verdict takes. Where joints slide, Coulomb's law can have several
solutions, of which all voussoirs may take one that is not symmetric.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from blocksim.arch.circular import Arch
from blocksim.arch.limit import weakest_joints
from blocksim.blocks.assembly import SUPPORT, Array, Assembly, Block, Joint
from blocksim.blocks.bodies import about, carried_poses, carried_rates
from blocksim.simulation.verdict import Verdict

if TYPE_CHECKING:
    from blocksim.blocks.problem import Problem
    from blocksim.simulation.onset import Onset
    from blocksim.simulation.simulated import Simulation

UNTURNED = 1e18
"""Factor on the inertia of half a keystone."""
MIRROR = np.array([-1.0, 1.0, -1.0])
"""Factors on a motion that make it the mirror image's."""


@dataclass(frozen=True, eq=False)
class Reduction:
    """Half an arch and those of its joints that may move.

    `whole`: The arch: symmetric, n blocks between n + 1 joints, from left to right.
    `kept`: Joints of the left half that may move, in order: at least the springing and, for
        even n, the one at the crown.
    """

    whole: Assembly
    kept: tuple[int, ...]

    by = "symmetry and by merging"
    forces = None

    @classmethod
    def of(cls, arch: Arch, mu: float, whole: Assembly | None = None) -> Reduction:
        """Keep the joints that limit analysis expects to move; `whole` is the arch as built."""
        middle = arch.voussoirs // 2
        expected = {middle - joint for joint in weakest_joints(arch, mu)}
        if arch.voussoirs % 2 == 0:
            expected.add(middle)
        return cls(whole or arch.assembly(), tuple(sorted({0, *expected})))

    def of_problem(self, problem: Problem) -> Problem:
        """Return the problem of the blocks that are simulated."""
        return replace(problem, assembly=self.assembly)

    def asked(self, problem: Problem) -> Problem:
        """Return the same: its world takes their forces."""
        return self.of_problem(problem)

    def handed(self, forces: Array) -> Array:
        """Return forces as they are: those of the blocks simulated."""
        return forces

    def revised(
        self, first: Onset, resultants: Array, simulation: Simulation[Any]
    ) -> Reduction | None:
        """Return this where it stands for all voussoirs, else what does; None: all of them."""
        # Large blocks move where they may rest sooner than those they are made of.
        if first.may_rest:
            return None
        if first.verdict is Verdict.UNDECIDED:
            return self
        allowed = simulation.settings.still
        moving = self.overstrained(resultants, simulation.taken.mu, allowed)
        if self.parts(resultants):
            return None
        return self.split(moving) if moving else self

    def at(self, arch: Arch) -> Reduction:
        """Keep the same joints of an arch that differs in thickness only."""
        return replace(self, whole=arch.assembly())

    def split(self, joints: tuple[int, ...]) -> Reduction:
        """Keep more joints."""
        return replace(self, kept=tuple(sorted({*self.kept, *joints})))

    @property
    def merged(self) -> NDArray[np.int64]:
        """Joints of the left half that are taken not to move."""
        inside = np.arange(1, (len(self.whole.blocks) + 1) // 2)
        return inside[~np.isin(inside, self.kept)]

    @cached_property
    def assembly(self) -> Assembly:
        """The blocks that are simulated; their last joint is the plane of symmetry."""
        joints = [self.whole.joints[k] for k in self.kept]
        if self._keystone:
            joints.append(_cut(self.whole.joints[len(self.whole.blocks) // 2]))
        joints = [
            replace(joint, before=index - 1, after=index) for index, joint in enumerate(joints)
        ]
        joints[-1] = replace(joints[-1], after=SUPPORT, friction=0.0)
        ends = pairwise([*self.kept, len(self._shares)] if self._keystone else self.kept)
        blocks = [
            self._merge(slice(*voussoirs), *faces)
            for voussoirs, faces in zip(ends, pairwise(joints), strict=True)
        ]
        return Assembly(tuple(blocks), tuple(joints), self.whole.size)

    @cached_property
    def _shares(self) -> Array:
        """How much of each voussoir of the left half lies in it: half of a keystone."""
        whole = np.ones(len(self.whole.blocks) // 2)
        return np.append(whole, 0.5) if self._keystone else whole

    @property
    def _keystone(self) -> bool:
        return len(self.whole.blocks) % 2 == 1

    @cached_property
    def _owner(self) -> NDArray[np.int64]:
        """Which block each voussoir of the left half belongs to."""
        voussoirs = np.arange(len(self._shares))
        return np.searchsorted(self.kept, voussoirs, side="right") - 1

    @cached_property
    def _offsets(self) -> Array:
        """Where voussoirs lie in their blocks, from centre to centre, (half, 2) [size]."""
        part = slice(len(self._shares))
        return (self.whole.centres[part] - self.assembly.centres[self._owner]) / self.whole.size

    def _merge(self, voussoirs: slice, joint: Joint, following: Joint) -> Block:
        """One block between two joints; the engines only look at its faces."""
        blocks = self.whole.blocks[voussoirs]
        shares = self._shares[voussoirs]
        mass = shares * np.array([block.mass for block in blocks])
        centres = np.array([block.centre for block in blocks])
        centre = mass @ centres / mass.sum()
        inertia = shares @ np.array([block.inertia for block in blocks])
        if shares[-1] < 1:
            inertia *= UNTURNED
        corners = [joint.inner, following.inner, following.outer, joint.outer]
        if np.array_equal(joint.inner, following.inner):
            corners = corners[1:]
        return Block(
            vertices=np.array(corners),
            centre=centre,
            mass=float(mass.sum()),
            inertia=float(inertia + mass @ ((centres - centre) ** 2).sum(axis=1)),
            depth=blocks[0].depth,
        )

    def poses(self, poses: Array) -> Array:
        """Return the poses of all voussoirs from those of the blocks."""
        return self._mirrored(carried_poses(poses, self._owner, self._offsets))

    def rates(self, rates: Array) -> Array:
        """Return the velocities or accelerations at rest of all voussoirs likewise."""
        return self._mirrored(carried_rates(rates, self._owner, self._offsets))

    def _mirrored(self, left: Array) -> Array:
        """Add the right half; a keystone is both its halves' mean."""
        right = left[::-1] * MIRROR
        if not self._keystone:
            return np.concatenate([left, right])
        middle = (left[-1:] + right[:1]) / 2
        return np.concatenate([left[:-1], middle, right[1:]])

    def resultants(self, resultants: Array) -> Array:
        """Return what all joints carry at rest, from what the blocks' joints carry.

        `resultants`, (joints, 3): Of `assembly`, as `TellsForces.resultants`.
        Returns (n + 1, 3): Of `whole`, in its mean weights. Voussoirs of a block accelerate
            with it, which takes the difference of the forces on both of their sides.
        """
        blocks, size = self.assembly, self.whole.size
        total = resultants[:-1] - resultants[1:]
        rates = about(total, blocks.centres / size) / blocks.masses
        rates[:, 1] -= 1.0
        half = len(self._shares)
        # What it takes to accelerate each voussoir so, and to bear its weight.
        rates = self.rates(rates)[:half]
        rates[:, 1] += 1.0
        taken = self.whole.masses[:half] * self._shares[:, None] * rates
        taken = about(taken, -self.whole.centres[:half] / size)
        springing = resultants[0] * _mean_mass(blocks) / _mean_mass(self.whole)
        found = springing - np.vstack([np.zeros(3), np.cumsum(taken, axis=0)])
        left, crown = found[:half], found[half:]
        right = left[::-1] * np.array([1.0, -1.0, 1.0])
        return np.concatenate([left, right] if self._keystone else [left, crown, right])

    def overstrained(self, resultants: Array, mu: float, allowed: float) -> tuple[int, ...]:
        """Return merged joints that would open or slip, the worst of those side by side.

        `resultants`, (n + 1, 3): Of all joints, as `resultants` returns them.
        `allowed`: Force beyond the strength of a joint that counts as none [mean weights].
        """
        joints = self.whole.joint_arrays
        merged = self.merged
        acting = about(resultants, joints.ends.mean(axis=1))[merged]
        pressure = (acting[:, :2] * joints.normal[merged]).sum(axis=1)
        shear = (acting[:, :2] * joints.tangent[merged]).sum(axis=1)
        tipping = 2 * np.abs(acting[:, 2]) / joints.length[merged]
        excess = tipping - pressure
        if np.isfinite(mu):
            excess = np.maximum(excess, np.abs(shear) - mu * pressure)
        moves = np.flatnonzero(excess > allowed)
        groups = np.split(moves, np.flatnonzero(np.diff(merged[moves]) > 1) + 1)
        return tuple(
            int(merged[group[excess[group].argmax()]]) for group in groups if len(group)
        )

    def parts(self, resultants: Array) -> bool:
        """Tell whether a keystone, if there is one, is not pressed against the plane."""
        return self._keystone and bool(resultants[len(self.whole.blocks) // 2, 0] <= 0)


def _mean_mass(assembly: Assembly) -> float:
    """Return the unit of forces, whose weight is 1 in the world of an assembly."""
    return float(np.mean([block.mass for block in assembly.blocks]))


def _cut(joint: Joint) -> Joint:
    """Return the face in the plane of symmetry, from the joint beside the keystone."""
    inner, outer = (np.array([0.0, np.hypot(*end)]) for end in (joint.inner, joint.outer))
    return replace(joint, inner=inner, outer=outer)
