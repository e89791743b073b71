"""What a maker may know better of a problem than the general way does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from blocksim.blocks.joints import ObservedJoint
from blocksim.blocks.problem import Problem
from blocksim.limit.carried import Carried, carried_by
from blocksim.limit.crushing import Needed
from blocksim.simulation.simulated import Reduced
from blocksim.simulation.verdict import Evidence, Verdict

if TYPE_CHECKING:
    from blocksim.kinds.archoffers import Thinning
    from blocksim.limit.exact import Exact
    from blocksim.limit.proof import Proof


@dataclass(frozen=True, kw_only=True)
class Static:
    """A verdict without motion.

    `joints`: What each joint does as a collapse starts.
    `mode`: What the maker calls the mode of collapse; None where nothing is known of it.
    """

    verdict: Verdict
    evidence: Evidence
    joints: tuple[ObservedJoint, ...]
    mode: Any = None


class Offers:
    """What a maker knows of one of its problems; each method may return nothing."""

    methods: Sequence[str] = ()
    """Static methods that it answers by itself: `limit`, `theory`."""
    stands: bool | None = None
    """Whether forces of equilibrium exist, by its own statics."""

    def static(self, method: str) -> Static | None:
        """Return a verdict by `limit` or `theory`."""

    def carried(self, joint: int | None = None) -> Carried | None:
        """Return what the blocks carry; thrust at a joint."""

    def proof(self, exact: Exact) -> Proof | None:
        """Prove that it stands or falls, by its own statics."""

    def mode(self, joints: tuple[ObservedJoint, ...]) -> Any:
        """Return what the maker calls a mechanism whose joints do this."""

    def reduction(self) -> Reduced | None:
        """Return fewer blocks to simulate."""

    def threshold(self, over: str) -> Thinning | None:
        """Return what is known of the value of a parameter from which on blocks stand."""

    def facts(self, **found: Any) -> Any:
        """Return what is put under the answer's `arch`, with modes that were found."""


def offers_of(problem: Problem[Any]) -> Offers | None:
    """Return what the maker of a problem knows of it; None where nothing."""
    return None if problem.maker is None else problem.maker.offers(problem)


def carried_of(
    problem: Problem[Any],
    joint: int | None = None,
    needed: Needed | None = None,
) -> Carried | None:
    """Find what anything carries, an arch under its own weight by its own statics.

    None in space, and where the ground shakes: statics in the plane do not tell what happens
    then.

    `joint`: Where thrust is told; by default the crown.
    `needed`: The least strength of blocks that crush.
    """
    if problem.in_space or not problem.has_statics:
        return None
    offered = offers_of(problem)
    own = None if offered is None else offered.carried(joint)
    return own or carried_by(problem, joint, needed)
