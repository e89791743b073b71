"""What a structure carries, and by how much more it would fall: the engineer's numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.limit import (
    Reaction,
    Resultants,
    Thrust,
    margins,
    reactions,
    resultants,
    thrust_range,
)
from blocksim.limit.crushing import Needed
from blocksim.limit.margins import crown

STRONG = 1 + 1e-9
"""Share of strength up to which a structure stands; beyond, more than round-off is lacking."""
ALIKE = 1e-6
"""Share by which joints may differ in use that are used alike."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Carried:
    """Factors of safety, thrust and reactions of a structure in its plane.

    `geometrical_factor`: Thickness over the least that stands, of a circular arch under its own
        weight. Of anything else the number of times that all joints are wider than they need
        be, about their middle, under the same loads (Heyman 1969). Below 1 where it falls; inf
        where no width is needed; None where no width suffices.
    `friction_factor`: Friction over the least that is needed; inf where none is, None where
        none suffices.
    `least_friction`: The coefficient that is needed in every joint; None where joints differ,
        or none suffices.
    `strength_used`: Share of width and of friction, the same in every joint, that the safest
        state of equilibrium needs; above 1 where the structure falls.
    `joint`: Where thrust is told.
    `least`, `greatest`: The states of least and of greatest thrust there; None where there is
        no such joint or no equilibrium.
    `needed`: The least compressive strength; None where the problem has no strength, or none
        suffices.
    `forces`, (joints, 2, 2): Of the safest state, as of `blocksim.limit.Equilibrium`; where
        blocks crush, of that which presses them least. Where the structure falls they are those
        that lack least strength, and no forces of equilibrium; None where there are none
        either.
    """

    problem: Problem
    geometrical_factor: float | None
    friction_factor: float | None
    least_friction: float | None
    strength_used: float | None
    joint: int | None
    least: Thrust | None
    greatest: Thrust | None
    forces: Array | None
    needed: Needed | None = None

    @property
    def stands(self) -> bool:
        """Whether joints have the strength that the safest state asks for."""
        strength = self.problem.strength
        if strength is not None and (self.needed is None or self.needed.high > strength):
            return False
        return self.strength_used is not None and self.strength_used <= STRONG

    @property
    def thrust(self) -> tuple[float, float] | None:
        """Least and greatest thrust [N]; the greatest may be inf."""
        if self.least is None or self.greatest is None:
            return None
        unit = self.problem.unit_force
        return self.least.thrust * unit, self.greatest.thrust * unit

    @cached_property
    def resultants(self) -> Resultants | None:
        """What each joint carries in the safest state; None where it falls."""
        if self.forces is None or not self.stands:
            return None
        return resultants(self.problem, self.forces)

    @cached_property
    def reactions(self) -> tuple[Reaction, ...]:
        """What the supports bear in the safest state; nothing where it falls."""
        if self.forces is None or not self.stands:
            return ()
        return reactions(self.problem, self.forces)

    @property
    def worst_joints(self) -> tuple[int, ...]:
        """The joints that use most of their width or friction in the safest state."""
        carried = self.resultants
        if carried is None or not carried.used.max(initial=0.0):
            return ()
        return tuple(np.flatnonzero(carried.used > (1 - ALIKE) * carried.used.max()).tolist())

    @property
    def weight(self) -> float:
        """Weight of all blocks that are no supports [N]."""
        return self.problem.unit_force * len(self.problem.assembly.blocks)

    @property
    def depth(self) -> float | None:
        """Depth out of the plane [m]; None where blocks differ."""
        depths = {block.depth for block in self.problem.assembly.blocks}
        return depths.pop() if len(depths) == 1 else None


def carried_by(
    problem: Problem, joint: int | None = None, needed: Needed | None = None
) -> Carried:
    """Find what a structure carries: three searches and two linear programmes.

    `joint`: Where thrust is asked for; by default at the crown
        (`blocksim.limit.margins.crown`).
    `needed`: The least strength of blocks that crush; None where none suffices.
    """
    found = margins(problem)
    joint = crown(problem) if joint is None else joint
    strength = problem.strength
    crushes = strength is not None and (needed is None or needed.low > strength)
    ends = None if joint is None or crushes else thrust_range(problem, joint)
    least_thrust, greatest = ends or (None, None)
    mu = set(problem.friction.tolist())
    least = found.friction if len(mu) == 1 else None
    if least is not None and math.isfinite(problem.mu):
        least *= mu.pop()
    # Of friction without bound a share is nothing.
    rubs = found.friction and (0.0 if np.isinf(problem.friction).any() else found.friction)
    return Carried(
        problem=problem,
        geometrical_factor=inverse(found.width),
        friction_factor=inverse(rubs),
        least_friction=least,
        strength_used=found.strength,
        joint=joint,
        least=least_thrust,
        greatest=greatest,
        forces=found.forces if needed is None else needed.forces,
        needed=needed,
    )


def inverse(share: float | None) -> float | None:
    """Return the factor of safety of what is needed, as a share of what there is."""
    if share is None:
        return None
    return 1 / share if share > 0 else math.inf
