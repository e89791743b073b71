"""Forces of equilibrium in space: whether they exist, and up to which load."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState, ObservedJoint
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.limit.capacity import Collapse
from blocksim.limit.exact import Exact
from blocksim.limit.proof import Proof, proof_of_fall
from blocksim.limit.resultants import Resultants
from blocksim.limit.space.bodies import alike, opened_between
from blocksim.limit.space.cones import Answer
from blocksim.limit.space.contacts import Contacts, solved
from blocksim.limit.space.proof import proof_of_rest
from blocksim.limit.space.resultants import resultants_in_space

BALANCED = 1e-12
"""Of each block's own weight: forces and moments that may be left over."""
FARTHEST = 1e5
"""Times all weight: forces up to which those that would balance are ruled out."""
AGREED = 1e-9
"""Of a load factor: how far what part of the blocks tells of all may be from what they tell."""
SEEN = 1e-5
"""Of the largest way: rates from which on a joint is told to open or to slide."""
ROUNDED = 1e-14
"""Of the forces at a block: what rounding may leave over."""


class SpatialEquilibrium:
    """What a cone programme says of equilibrium; it is checked when more than that is asked.

    Forces are mended until they balance in floating-point numbers, each strictly within its
    cone. A motion is held to the rates at which points open: no forces could balance but
    those of many times all weight.

    `found`: What the programme found.

    It has:
    `margin`: By how much every point presses, in units of the lighter block's weight beside it
        over the points of its joint; below 0 it would have to pull. At most 1, -inf where not
        even pulling would help.
    """

    def __init__(self, contacts: Contacts, found: Answer) -> None:
        self._contacts, self._found = contacts, found
        self.margin = found.value

    @property
    def asked(self) -> int:
        """How many blocks were asked: fewer than all where planes of symmetry halve them."""
        return len(self._contacts.symmetry.blocks)

    @cached_property
    def _held(self) -> tuple[Array, float]:
        """Forces and what they leave over, or rates and how far they rule forces out.

        What part of the blocks does not tell, all of them may.
        """
        held, contacts = self._checked(), self._contacts
        passed = held[1] <= BALANCED if self._presses else held[1] * FARTHEST < 1
        if passed or not contacts.symmetry.halves:
            return held
        whole = Contacts(contacts.problem)
        self.__init__(whole, whole.most(contacts.problem.applied_forces().ravel()))
        return self._checked()

    def _checked(self) -> tuple[Array, float]:
        contacts = self._contacts
        pull = contacts.problem.applied_forces().ravel()
        if self._presses:
            return _balanced(contacts, pull, self._found.forces)
        rates = self._found.rates
        gap = _ruled_out(contacts, pull, rates)
        opened = contacts.opened(pull, rates)
        while gap * FARTHEST >= 1 and (other := next(opened, None)) is not None:
            found = _ruled_out(contacts, pull, other)
            if found < gap:
                rates, gap = other, found
        return rates, gap

    @property
    def _presses(self) -> bool:
        return len(self._found.forces) > 0 and self.margin > 0

    @property
    def gap(self) -> float:
        """How near it was held to.

        Of what exists, the largest force or moment left over, in units of each block's weight;
        of what does not, all weight over the least forces that could balance.
        """
        return self._held[1]

    @cached_property
    def exists(self) -> bool | None:
        """Whether forces exist; None where neither the check nor a proof tells."""
        if self.gap <= BALANCED if self._presses else self.gap * FARTHEST < 1:
            return self._presses
        return None if self.proof is None else self.proof.claim == "stands"

    @cached_property
    def proof(self) -> Proof | None:
        """The proof that blocks stand or fall; None where there is none either way."""
        contacts, held = self._contacts, self._held[0]
        exact = Exact(contacts.problem)
        if self._presses:
            return proof_of_rest(exact, contacts, held.reshape(-1, 3))
        pull = contacts.problem.applied_forces().ravel()
        for rates in chain([held], contacts.opened(pull, held)):
            if (found := proof_of_fall(exact, rates)) is not None:
                return found
        owner = alike(contacts, held)
        for rates in opened_between(contacts, pull, held, owner):
            if (found := proof_of_fall(exact, rates, owner.tolist())) is not None:
                return found
        return None

    @property
    def point_forces(self) -> Array | None:
        """Forces at each point, along its normal and across, (points, 3) [N]."""
        return self._held[0].reshape(-1, 3) * self._contacts.unit if self.exists else None

    @property
    def forces(self) -> Array | None:
        """Their sums at each joint, (joints, 3) [N]."""
        each = self.point_forces
        if each is None:
            return None
        sums = np.zeros((len(self._contacts.problem.assembly.joints), 3))
        np.add.at(sums, self._contacts.joint, each)
        return sums

    @cached_property
    def resultants(self) -> Resultants | None:
        """What each joint carries; None where there is no equilibrium."""
        forces = self.point_forces
        return None if forces is None else resultants_in_space(self._contacts.problem, forces)

    @cached_property
    def mechanism(self) -> Array | None:
        """Rates with which a collapse starts, (blocks, 6), the largest way of a corner 1.

        x, y, z [size], and rotations about the axes.
        """
        falls = self.exists is False
        return unit_rates(self._contacts.problem, self._held[0]) if falls else None


def can_rest(problem: Problem[SpatialAssembly], *, reduce: bool = True) -> SpatialEquilibrium:
    """Do in space what `limit.equilibrium` does."""
    pull = problem.applied_forces().ravel()
    contacts = Contacts(problem, (pull,) if reduce else ())
    return SpatialEquilibrium(contacts, contacts.most(pull))


def largest_load(problem: Problem[SpatialAssembly], *, reduce: bool = True) -> Collapse:
    """Do in space what `limit.collapse` does."""
    pull, live = problem.with_load(0.0).applied_forces().ravel(), problem.live_forces.ravel()
    contacts = Contacts(problem, (pull, live) if reduce else ())
    # In units of its own size, as loads may be of any.
    unit = float(np.abs(live / contacts.rows).max()) or 1.0
    found = contacts.most(pull, live / unit)
    if math.isinf(found.value):
        boundless = found.value > 0 and _balances(contacts, pull, live / unit)
        return Collapse(load_factor=math.inf if boundless else None, gap=0.0)
    value = 0.0 if abs(found.value) <= BALANCED else found.value
    work = float(found.rates @ live) / unit
    bound = -float(found.rates @ pull) / work if work > 0 else math.inf
    gap = abs(bound - found.value) / max(abs(found.value), 1e-300)
    if gap > AGREED and contacts.symmetry.halves:
        return largest_load(problem, reduce=False)
    return Collapse(
        load_factor=value / unit, gap=gap, mechanism=unit_rates(problem, found.rates)
    )


def _balances(contacts: Contacts, pull: Array, live: Array) -> bool:
    """Tell whether forces balance at any factor on a load that contacts bear to any size.

    A load into the ground may be borne to any size by blocks that fall nevertheless. Where it
    is borne turned round, too, it decides nothing.
    """
    least = contacts.most(pull, -live).value
    if math.isinf(least) and least > 0:
        unloaded = replace(contacts, problem=contacts.problem.with_load(0.0))
        return SpatialEquilibrium(unloaded, unloaded.most(pull)).exists is not False
    return not math.isinf(least)


def _balanced(contacts: Contacts, pull: Array, forces: Array) -> tuple[Array, float]:
    """Mend forces until they balance; return them and what is left over.

    What is left over is inf where a point does not press more than friction needs.
    """
    matrix, own = contacts.matrix, contacts.own
    across = np.minimum(contacts.friction, 1.0)
    ways = np.column_stack([np.ones_like(across), across, across])
    for _ in range(3):
        slack = contacts.slack(forces)
        if not (slack > 0).all():
            return forces, math.inf
        # Points change by no more than they can spare: across, none where they are smooth.
        weights = ((np.minimum(slack, own)[:, None] * ways) ** 2).ravel()
        weighted: Any = matrix @ sparse.diags(weights)
        normal: Any = sparse.csc_matrix(weighted @ matrix.T)
        scale = normal.diagonal().max()
        normal = normal + sparse.identity(normal.shape[0], format="csc") * (1e-15 * scale)
        rest: Array = -(matrix @ forces + pull)
        forces = forces + weights * (matrix.T @ solved(normal, rest))
    each: Array = abs(matrix) @ np.abs(forces) + np.abs(pull)
    left_over: Array = np.abs(matrix @ forces + pull)
    # What rounding alone may leave is none.
    left_over[left_over <= ROUNDED * each] = 0.0
    blocks = contacts.problem.assembly.weights / contacts.unit
    left = float((left_over.reshape(-1, 6).max(axis=1) / blocks).max())
    return forces, left if (contacts.slack(forces) > 0).all() else math.inf


def _ruled_out(contacts: Contacts, pull: Array, rates: Array) -> float:
    """Return all weight over the least normal forces that could balance, in spite of a motion.

    Forces within friction gain no work in a motion that opens each point by mu times its
    slip or more. Where points open by less, by an error, they may: but no more than that
    error times the force.
    """
    gained = float(rates @ pull)
    if not gained > 0:
        return math.inf
    error = float(-np.minimum(contacts.opening(rates), 0.0).min(initial=0.0))
    blocks = contacts.problem.assembly.weights / contacts.unit
    return error * float(blocks.sum()) / gained


def unit_rates(problem: Problem[SpatialAssembly], rates: Array) -> Array:
    """Scale rates so that the largest way of a corner is 1 [size], (blocks, 6)."""
    assembly, each = problem.assembly, rates.reshape(-1, 6)
    largest = 0.0
    for corners, centre, rate in zip(assembly.corners, assembly.centres, each, strict=True):
        ways = rate[:3] + np.cross(rate[3:], (corners - centre) / assembly.size)
        largest = max(largest, float(np.linalg.norm(ways, axis=1).max()))
    return each / largest if largest > 0 else each


def observed_joints(
    problem: Problem[SpatialAssembly], rates: Array
) -> tuple[ObservedJoint, ...]:
    """Tell what each joint does in a motion of the blocks.

    Of a hinge some points stay together and others part, or all but one edge does. Sliding
    opens by mu times the slip, as limit analysis has it: such points count as together.

    `problem`.
    `rates`, (blocks, 6): The largest way of a corner 1.
    """
    contacts = Contacts(problem)
    each = (contacts.matrix.T @ rates.ravel()).reshape(-1, 3)
    slip = np.hypot(each[:, 1], each[:, 2])
    mu = np.where(np.isinf(contacts.friction), 0.0, contacts.friction)
    together = each[:, 0] - mu * slip <= SEEN
    slides = together & (slip > SEEN)
    ends = np.cumsum([len(each.points) for each in problem.assembly.joints])[:-1]
    pairs = zip(np.split(together, ends), np.split(slides, ends), strict=True)
    return tuple(ObservedJoint(angle=math.nan, state=state_of(one, two)) for one, two in pairs)


def state_of(together: NDArray[np.bool_], slides: NDArray[np.bool_]) -> JointState:
    """Tell what a joint does by which of its points stay together, and which slide."""
    return JointState.of(
        inner=not together.any(), outer=not together.all(), slides=bool(slides.any())
    )
