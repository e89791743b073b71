"""What limit analysis says of a problem, in words, and what joints do in a motion."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from blocksim.ask.undecided import closing_of_verdict
from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import ObservedJoint, classify, closed_joints
from blocksim.blocks.problem import Problem
from blocksim.limit import Equilibrium
from blocksim.limit.crushing import Needed
from blocksim.simulation.verdict import Evidence, Verdict

if TYPE_CHECKING:
    from blocksim.limit.space import SpatialEquilibrium

VERDICTS = {True: Verdict.STANDS, False: Verdict.COLLAPSES, None: Verdict.UNDECIDED}
"""By whether forces of equilibrium exist."""
ALONG = 1e-9
"""What is along an axis differs from it by less."""


def observed(problem: Problem[Any], rates: Array | None) -> tuple[ObservedJoint, ...]:
    """Tell what each joint does as blocks begin to move at some rates; closed at none."""
    if rates is None:
        return closed_joints(problem.assembly.joint_angles)
    if problem.in_space:
        from blocksim.limit.space import observed_joints

        return observed_joints(problem, unit(rates, problem))
    from blocksim.simulation.onset import PROBE

    assembly = problem.assembly
    return classify(assembly, assembly.built[:-1] + PROBE * unit(rates, problem)[:, :3])


def unit(rates: Array, problem: Problem[Any]) -> Array:
    """Scale rates so that the largest way of a corner is 1."""
    if problem.in_space:
        from blocksim.limit.space import unit_rates

        return unit_rates(problem, rates)
    largest = float(problem.assembly.displacement(rates))
    return rates / largest if largest > 0 else rates


def static_evidence(
    problem: Problem[Any], static: Equilibrium | SpatialEquilibrium
) -> tuple[Evidence, ...]:
    """Say what limit analysis found."""
    if isinstance(static, Equilibrium):
        found = Evidence("limit analysis", _words(static))
        return (found, *closing_of_verdict(problem, stands=static.exists))
    found, blocks = Evidence("limit analysis", _words_in_space(static)), fewer(problem, static)
    return (found,) if blocks is None else (found, halved(problem, blocks))


def flat_evidence(problem: Problem[Any]) -> tuple[Evidence, ...]:
    """Say of prisms in space that the plane across them would do."""
    if not problem.in_space:
        return ()
    from blocksim.blocks.space.extruded import way_of_prisms

    way = way_of_prisms(problem)
    if way is None:
        return ()
    axes = [axis for axis, share in zip("xyz", way, strict=True) if abs(share) > 1 - ALONG]
    along = axes[0] if axes else f"({', '.join(f'{share:.3g}' for share in way + 0.0)})"
    words = f"it is the same at any depth along {along}: the plane across has the same answer"
    return (Evidence("plane", words),)


def fewer(problem: Problem[Any], static: Equilibrium | SpatialEquilibrium) -> int | None:
    """Return how many blocks were asked for all, by symmetry; None where all were."""
    if isinstance(static, Equilibrium) or static.asked == len(problem.assembly.blocks):
        return None
    return static.asked


def halved(problem: Problem[Any], blocks: int) -> Evidence:
    """Say that planes of symmetry halved what was asked, in space."""
    most = len(problem.assembly.blocks)
    return Evidence("reduction", f"{blocks} instead of {most} blocks were asked, by symmetry")


def _lacking(margin: float) -> str:
    """Say how far below 0 a margin is."""
    lacking = float(f"{-100 * margin:.3g}")
    return f"{lacking:g}%" if lacking < 1000 else f"{lacking:,.0f}%"


def _words(static: Equilibrium) -> str:
    if static.exists:
        spare = max(0.0, static.margin)
        return (
            "forces of equilibrium exist; the contact nearest to opening or sliding has "
            f"{100 * spare:.3g}% of its force to spare"
        )
    if math.isinf(static.margin):
        return "no forces of equilibrium exist, even if contacts could pull"
    return (
        "no forces of equilibrium exist: blocks would have to hold each other back with "
        f"{_lacking(static.margin)} of what contacts carry"
    )


def _words_in_space(static: SpatialEquilibrium) -> str:
    """Say the same, and how near it was held to."""
    own = "of an even share of its block's weight"
    if static.exists:
        return (
            "forces of equilibrium exist, in balance to 1e-12 of each block's weight; the "
            "contact nearest to opening or sliding has "
            f"{100 * static.margin:.3g}% {own} to spare"
        )
    if static.exists is None:
        by = (
            f"forces that press every contact leave {static.gap:.1g} of a block's weight over"
            if static.margin > 0 and math.isfinite(static.gap)
            else "the contact nearest to opening or sliding has "
            f"{100 * static.margin:.1g}% {own} to spare"
        )
        return (
            f"neither forces nor a motion pass the check: {by}, "
            "which is nearer to the limit than floating-point numbers tell"
        )
    if math.isinf(static.margin):
        return "no forces of equilibrium exist, even if contacts could pull"
    # A proof in rational numbers knows no bound.
    bounded = static.gap > 0 and static.proof is None
    far = f" up to {1 / static.gap:.1g} times all weight" if bounded else ""
    return (
        f"no forces of equilibrium exist{far}: a contact would have to hold its block back "
        f"with {_lacking(static.margin)} {own}"
    )


def crushing_evidence(
    problem: Problem, needed: Needed | None
) -> tuple[Verdict, tuple[Evidence, ...]]:
    """Say whether forces of equilibrium exist within the strength of blocks that crush."""
    verdict, said = _crushing(needed, problem.strength or 0.0)
    found = Evidence("limit analysis", said)
    return verdict, (found, *closing_of_verdict(problem, stands=verdict is Verdict.STANDS))


def _crushing(needed: Needed | None, strength: float) -> tuple[Verdict, str]:
    if needed is None:
        return Verdict.UNDECIDED, "the strength that is needed was not found"
    least, most = f"{needed.low / 1e6:.6g} MPa", f"{needed.high / 1e6:.6g} MPa"
    if needed.high <= strength:
        said = f"forces of equilibrium exist that press no joint by more than {most}"
        return Verdict.STANDS, said
    if needed.low > strength:
        said = f"all forces of equilibrium crush a joint: a strength of {least} is needed"
        return Verdict.COLLAPSES, said
    return Verdict.UNDECIDED, f"the strength that is needed is between {least} and {most}"
