"""The answer to *does it stand*, with its evidence."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, cast

from blocksim.ask.rest import Moving, Rest
from blocksim.ask.statics import unit
from blocksim.blocks.assembly import Array, Blocks
from blocksim.blocks.joints import ObservedJoint
from blocksim.blocks.problem import Problem
from blocksim.common.errors import Unsolved
from blocksim.common.shown import Shown
from blocksim.kinds.offers import Offers, carried_of, offers_of
from blocksim.limit import Equilibrium, Resultants, equilibrium
from blocksim.limit.carried import Carried
from blocksim.limit.crushing import Needed
from blocksim.limit.exact import Exact
from blocksim.simulation.verdict import Evidence, Verdict, reason_of

if TYPE_CHECKING:
    from blocksim.arch.answers import ArchAnswer
    from blocksim.limit.proof import Proof
    from blocksim.limit.space import SpatialEquilibrium
    from blocksim.simulation.recording import Recording
    from blocksim.simulation.shaken import Shaken

UNPROVED = "none: strengths are compared in floating point, not in rational arithmetic"
"""What is said of answers about blocks that crush."""
SOUGHT = 500
"""Joints up to which what a structure carries is found within seconds."""


@dataclass(frozen=True, kw_only=True)
class OpenJoint:
    """A joint that is open at an end or both, by the bodies on its two sides."""

    a: str
    b: str
    state: str


@dataclass(frozen=True, kw_only=True)
class Event:
    """Something that happens as supports move.

    `value`: How far the supports are [m].
    `what`: As of `blocksim.limit.spreading.Event`.
    `joints`: Those that are open after it.
    """

    value: float
    what: str
    joints: tuple[OpenJoint, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Check(Shown, Generic[Blocks]):
    """Answer to *does it stand*, with its evidence.

    Parameters
    ----------
    method : str
    verdict : Verdict
        *Stands* means that it can rest.
    evidence : tuple of Evidence
        What was seen, by which test.
    problem : Problem
    joints : tuple of ObservedJoint
        What each joint does as a collapse starts; closed where the blocks stand, and where
        the method does not tell.
    rest : {"must", "can", "cannot"} or None
        What friction allows: `must` where no motion can begin, `can` where forces of
        equilibrium exist and a motion was found as well, `cannot` where there are no such
        forces; None where it was not found out whether it must rest.
    asked_rest : bool
        Whether that was to be found out.
    motion : Moving or None
        Where it was, the motion that was found; `joints` say what they do in it.
    needed : Needed or None
        Of blocks that crush, the least strength at which forces of equilibrium exist.
    load_factor : float or None
        Largest factor on the live loads at which forces of equilibrium exist, by limit
        analysis; below 0 where none exist without live loads; inf where no live load is too
        much. None without live loads, or where there is no equilibrium at any factor.
    rates : (blocks, 3 or 6) float or None
        By an engine, velocities in proportion to those with which a collapse starts.
    shaken : Shaken or None
        Where the ground shakes: what became of the blocks, which the verdict is of. Nothing
        is said of rest then.
    simulated : float or None
        Time simulated [sqrt(size/g)]; None for static methods.
    state_hash : str or None
        Fingerprint of the recorded motion.
    recording : Recording or None
        By an engine, that motion; None where blocks were not let go.
    blocks, splits : int or None
        Blocks simulated, and joints that a reduction merged and had to split again; None
        for static methods.
    wall_s : float
        Seconds it took.
    arch : ArchAnswer or None
        Ratios and modes of a symmetric circular arch under its own weight.
    """

    method: str
    verdict: Verdict
    evidence: tuple[Evidence, ...]
    problem: Problem[Blocks]
    joints: tuple[ObservedJoint, ...]
    rest: Rest | None = None
    asked_rest: bool = False
    motion: Moving | None = None
    needed: Needed | None = None
    load_factor: float | None = None
    rates: Array | None = None
    shaken: Shaken | None = None
    simulated: float | None = None
    state_hash: str | None = None
    recording: Recording[Any] | None = None
    blocks: int | None = None
    splits: int | None = None
    wall_s: float = 0.0
    arch: ArchAnswer | None = None

    @property
    def reason(self) -> str:
        """The evidence as a sentence."""
        return reason_of(self.evidence)

    @cached_property
    def static(self) -> Equilibrium | SpatialEquilibrium | None:
        """What limit analysis says; None where the ground shakes."""
        return equilibrium(self.problem) if self.problem.has_statics else None

    @cached_property
    def offers(self) -> Offers | None:
        """What the maker knows of the problem; None where nothing."""
        return offers_of(self.problem)

    @cached_property
    def proof(self) -> Proof | None:
        """The proof of the verdict by limit analysis; None where there is none."""
        if self.method != "limit":
            return None
        if self.needed is not None:
            # Proofs are of rigid blocks, which stand.
            return None
        # Where the maker's own statics tell, no general programme has to be solved.
        offers = self.offers
        found = None if offers is None else offers.proof(Exact(cast("Problem", self.problem)))
        if found is None and self.static is not None:
            found = self.static.proof
        return found if found is not None and found.claim == self.verdict.value else None

    @property
    def proved(self) -> bool:
        """Whether the verdict is proved (`blocksim.verify`)."""
        return self.proof is not None

    @property
    def forces(self) -> Array | None:
        """Forces of equilibrium at the ends of the joints, along their normals and tangents.

        (joints, 2, 2) float [mean block's weight]; in space sums at the joints, along their
        normals and across, (joints, 3) [N]. None where there are none.
        """
        return None if self.static is None else self.static.forces

    @property
    def resultants(self) -> Resultants | None:
        """What each joint carries, in the plane in the safest state; None where it falls."""
        held: Any = self.static if self.problem.in_space else self.carried
        return None if held is None else held.resultants

    @cached_property
    def mechanism(self) -> Array | None:
        """Rates x, y [size] and rotation with which a collapse starts, (blocks, 3 or 6).

        In space x, y, z, and rotations about the axes.

        Or what may move though it can rest. The largest way of a corner is 1. None where the
        blocks stand, or nothing is known.
        """
        rates, falls = self.rates, self.verdict is not Verdict.STANDS
        if self.method == "limit" and falls and self.static is not None:
            rates = self.static.mechanism if self.needed is None else self.needed.mechanism
        if self.motion is not None:
            rates = self.motion.accelerations
        return None if rates is None else unit(rates, self.problem)

    @cached_property
    def carried(self) -> Carried | None:
        """What it carries; None in space, where the ground shakes, or it is too large.

        `blocksim.kinds.offers.carried_of` has no such bound. Where the solver gives up it is
        None, too: that takes nothing from the verdict.
        """
        return self.carried_at(None)

    def carried_at(self, joint: int | None) -> Carried | None:
        """Return the same as `carried`, with the thrust at a joint; None is the crown."""
        small = self.offers or len(self.problem.assembly.joints) <= SOUGHT
        with suppress(Unsolved):
            return carried_of(self.problem, joint, self.needed) if small else None
        return None

    def __repr__(self) -> str:
        return f"Check({self.verdict}, by {self.method}, of {self.problem!r})"
