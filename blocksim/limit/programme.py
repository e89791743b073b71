"""One linear programme for any assembly: contact forces, and the mechanism.

Each end of a joint carries a force within its cone of friction, and all forces balance the
loads. By the static theorem of limit analysis an assembly can rest where such forces exist
(Drucker 1954; Livesley 1978). The dual of the programme is the mechanism: the rates at which
blocks begin to move where none exist, in which joints that slide dilate (associated flow).
Coulomb's law, which does not dilate, may allow blocks to move that could rest.

Lengths are scaled by the assembly's size, and equations and forces by what each block and
joint carries (`Cones`) before they are solved: with a drawing in millimetres, or beside a pier
a thousand times as large, the solver would call wrong answers optimal.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.common.errors import Unsolved
from blocksim.common.later import sparse
from blocksim.limit.bearing import settled
from blocksim.limit.bodies import alike, widened
from blocksim.limit.cones import ROUND_OFF, Cones, most
from blocksim.limit.exact import Exact
from blocksim.limit.interior import most_inside
from blocksim.limit.linear import MANY, LinearProgramme, Optimum
from blocksim.limit.proof import Proof, proof_in_rationals, proof_of_fall, proof_of_rest
from blocksim.limit.symmetry import symmetric_forces, symmetric_rates

SPARE = 1.0
"""Most that is asked for along every edge of a cone, over what its joint carries."""
TENSION = 1e3
"""Most that every edge may lack, over the same."""
FINE = 1e-14
"""Lack of force that is left so near, over what blocks carry."""
RESCALED = 3
"""How often what blocks carry is taken from forces that were found."""
NEAR = 1e-6
"""Margin up to which a proof decides whether blocks stand, not the solver."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Equilibrium:
    """Whether forces of equilibrium exist, and how well they fit into the joints.

    `margin`: The least part along any edge of a cone of friction, made as large as it can be
        (at most `SPARE`), over what its joint carries (`Cones.unit`). Below 0 there is no
        equilibrium: contacts would have to pull by that much. -inf where not even that would
        hold the blocks, nan where the solver does not tell.
    `parts`, (parts,): Forces with that margin, in parts of `Cones`; None where nothing would
        hold the blocks.
    `rates`, (blocks, 3): Rates x, y and rotation of the mechanism that is nearest.
    `cones`: Those of the problem.
    """

    problem: Problem
    margin: float
    parts: Array | None
    rates: Array | None
    cones: Cones | None = None

    @cached_property
    def proof(self) -> Proof | None:
        """The proof that blocks stand or fall; None where there is none either way."""
        exact = Exact(self.problem)
        if self.parts is not None and self.margin > -NEAR:
            for fine in (ROUND_OFF, FINE):
                parts = self._cones.polished(self.parts, self.problem.applied_forces(), fine)
                found = proof_of_rest(exact, self._cones.forces(parts))
                if found is not None:
                    return found
        weights, blocks = self._cones.weights, len(self.problem.assembly.blocks)
        if self.rates is not None and self.margin < NEAR:
            rates = widened(self.problem, self._cones, self.rates)
            found = None if rates is None else proof_of_fall(exact, rates)
            if found is None:
                owner = alike(self.problem, self._cones, self.rates)
                found = proof_in_rationals(exact, weights, owner)
            if found is not None:
                return found
        return proof_in_rationals(exact, weights, range(blocks))

    @cached_property
    def _cones(self) -> Cones:
        return self.cones or Cones(self.problem)

    @cached_property
    def exists(self) -> bool:
        """Whether blocks can rest; where that is open, whether hardly any force lacks."""
        if abs(self.margin) > NEAR:
            return self.margin > 0
        return (
            bool(self.margin >= -ROUND_OFF)
            if self.proof is None
            else self.proof.claim == "stands"
        )

    @cached_property
    def forces(self) -> Array | None:
        """Forces at the inner and the outer end of each joint, along normal and tangent.

        (joints, 2, 2) float, as they act on the block after it [mean weights]; symmetric where
        the problem is. None where there is no equilibrium.
        """
        if not self.exists or self.parts is None:
            return None
        parts = self._cones.polished(self.parts, self.problem.applied_forces())
        return symmetric_forces(self.problem, self._cones.forces(parts))

    @cached_property
    def mechanism(self) -> Array | None:
        """Rates x, y and rotation of a mechanism that the loads drive, (blocks, 3) float.

        Symmetric where the problem is. None where the blocks can rest, and where not even
        contacts that pull would hold them.
        """
        if self.exists or self.rates is None:
            return None
        return symmetric_rates(self.problem, self.rates)


def equilibrium(problem: Problem) -> Equilibrium:
    """Do in the plane what `limit.equilibrium` does.

    Each force is the sum of two parts along the edges of its cone. The smallest of all these
    parts is made as large as possible.
    """
    problem = settled(problem)
    cones, pull = Cones(problem), problem.applied_forces()
    try:
        found = _clear(cones, pull) if cones.count > MANY else None
        found = most_common(cones, pull) if found is None else found
        for _ in range(RESCALED):
            if not found.exists or cones.left(_parts(cones, found), pull) < ROUND_OFF:
                break
            # Some carry far more than was thought: small blocks under, or between, large ones.
            cones = Cones(problem, weights=cones.seen_weights(found.values[:-1]))
            found = most_common(cones, pull)
    except Unsolved:
        return Equilibrium(problem=problem, margin=math.nan, parts=None, rates=None)
    if not found.exists:
        known = found.prices.size > 0
        driven = scaled(cones.rates(found.prices)) if known else falling(problem)
        return Equilibrium(problem=problem, margin=-math.inf, parts=None, rates=driven)
    margin = float(found.values[-1])
    return Equilibrium(
        problem=problem,
        margin=margin,
        parts=_parts(cones, found),
        rates=scaled(cones.rates(found.prices)),
        cones=cones,
    )


def _clear(cones: Cones, pull: Array) -> Optimum | None:
    """Find what `most_common` does in less time; None where it is near the limit."""
    found = most_inside(cones, *_common(cones, pull), SPARE)
    if found is not None and found.exists and not NEAR < abs(found.values[-1]) < TENSION:
        return None
    return found


def _parts(cones: Cones, found: Optimum) -> Array:
    """Return all of the parts: what they have in common is theirs, too."""
    return found.values[:-1] + found.values[-1] * cones.bounded


def settling(problem: Problem, supports: Array) -> Array | Literal["jams"] | None:
    """Find how blocks at rest follow supports that begin to move.

    Of the motions that no joint forbids it is the one that loses most potential energy; its
    dual are the forces of equilibrium that do least work on the supports, as the least thrust
    of an arch on spreading supports (Heyman 1966).

    `problem`: In its plane, at rest.
    `supports`, (supports, 3): Velocities x, y of each support where it meets the origin of
        coordinates, and its rate of rotation; lengths in units of the size.
    Returns (blocks, 3), "jams" or None: Velocities x, y and rotation of the blocks; "jams"
        where joints forbid all motions, as forces withstand that of the supports without
        bound; None where there is no equilibrium.
    """
    cones = Cones(problem)
    found = extreme(cones, cones.at_supports(supports), problem.applied_forces())
    if found.unbounded:
        return "jams"
    return cones.rates(found.prices) if found.exists else None


def falling(problem: Problem) -> Array | None:
    """Find the motion that no joint forbids in which the loads do most work.

    `problem`: In its plane, at rest.
    Returns (blocks, 3) or None: Velocities x, y (in units of the size) and rotation, each at
        most 1; None where the loads do no work in any.
    """
    cones = Cones(problem)
    pull = cones.loads(problem.applied_forces())
    # Rates at contacts: what presses may part, what only rubs stays.
    most = np.where(cones.bounded > 0, math.inf, 0.0)
    ones = np.ones(pull.size)
    found = LinearProgramme().solve(
        -pull, sparse.csc_array(cones.balance.T), (np.zeros(most.size), most), (-ones, ones)
    )
    if not found.exists or pull @ found.values < ROUND_OFF:
        return None
    return found.values.reshape(cones.shape) * cones.ease


def most_common(cones: Cones, pull: Array, solver: LinearProgramme | None = None) -> Optimum:
    """Find parts of forces of equilibrium whose least is as large as it can be.

    What all parts have in common comes last in the optimum's values.
    """
    return most(cones, *_common(cones, pull), (-TENSION, SPARE), solver)


def _common(cones: Cones, pull: Array) -> tuple[Any, Array]:
    """Return what parts do that all have in common, and what they all balance."""
    return sparse.csc_array(cones.balance @ cones.bounded[:, None]), -cones.loads(pull)


def extreme(
    cones: Cones, cost: Array, pull: Array, solver: LinearProgramme | None = None
) -> Optimum:
    """Find parts of forces of equilibrium at the least cost, (parts,) float for each."""
    right = -cones.loads(pull)
    return (solver or LinearProgramme()).solve(
        cost, cones.balance, (right, right), cones.bounds
    )


def scaled(rates: Array) -> Array:
    """Rates of the blocks whose largest is 1."""
    largest = float(np.abs(rates).max())
    return rates / largest if largest > 0 else rates
