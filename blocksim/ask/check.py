"""Does it stand? One problem, asked of limit analysis or of an engine."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from blocksim.ask.methods import choose, chosen_words, merges
from blocksim.ask.rest import Rest, require_rest, rest_of
from blocksim.blocks.assembly import Array, displacement
from blocksim.blocks.joints import ObservedJoint, classify, closed_joints
from blocksim.blocks.problem import Problem
from blocksim.common.progress import Progress, silent
from blocksim.common.shown import Shown
from blocksim.evidence.simulation import BY_RULE, Overrides
from blocksim.evidence.verdict import Verdict
from blocksim.limit import Equilibrium, collapse, equilibrium
from blocksim.limit.carried import Carried, carried_by
from blocksim.limit.programme import NEAR

if TYPE_CHECKING:
    from blocksim.engines.base import Method
    from blocksim.evidence.shaken import Shaken

SOUGHT = 500
"""Joints up to which what a structure carries is found within seconds."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Check(Shown):
    """Answer to *does it stand*, with its evidence.

    Parameters
    ----------
    method : str
    verdict : Verdict
        *Stands* means that it can rest.
    reason : str
        A sentence.
    joints : tuple of ObservedJoint
        What each joint does as a collapse starts; closed where the blocks stand, and where
        the method does not tell.
    rest : {"must", "can", "cannot"} or None
        What friction allows: `must` where no motion can begin, `can` where forces of
        equilibrium exist and a motion was found as well, `cannot` where there are no such
        forces; None where it was not found out whether it must rest.
    asked_rest : bool
        Whether that was to be found out.
    simulated : float or None
        Time simulated [sqrt(size/g)]; None for static methods.
    state_hash : str or None
        Fingerprint of the recorded motion.
    blocks, splits : int or None
        Blocks simulated, and joints that a reduction merged and had to split again; None
        for static methods.
    wall_s : float
        Seconds it took.
    """

    method: str
    verdict: Verdict
    reason: str
    joints: tuple[ObservedJoint, ...]
    rest: Rest | None
    asked_rest: bool
    simulated: float | None
    state_hash: str | None
    blocks: int | None
    splits: int | None
    wall_s: float


@dataclass(frozen=True, kw_only=True, eq=False)
class ProblemCheck(Check):
    """What is told of any problem besides.

    Parameters
    ----------
    problem : Problem
    load_factor : float or None
        Largest factor on the live loads at which forces of equilibrium exist, by limit
        analysis; inf where no live load is too much. None without live loads, or where
        there is no equilibrium at any factor.
    forces : (joints, 2, 2) float or None
        Forces of equilibrium at the ends of the joints, along their normals and tangents,
        in units of the mean block's weight; None where there are none.
    mechanism : (blocks, 3) float or None
        Rates x, y [size] and rotation with which a collapse starts, the largest way of a
        corner being 1.
    shaken : Shaken or None
        Where the ground shakes: what became of the blocks, which the verdict is of. Nothing
        is said of rest then.
    """

    problem: Problem
    load_factor: float | None
    forces: Array | None
    mechanism: Array | None
    shaken: Shaken | None = None

    @cached_property
    def carried(self) -> Carried | None:
        """What it carries; None where gravity leans, the ground shakes, or it is too large.

        `blocksim.ask.carried.carried_by` has no such bound.
        """
        still = self.problem.is_planar and self.shaken is None
        small = len(self.problem.assembly.joints) <= SOUGHT
        return carried_by(self.problem) if still and small else None

    def __repr__(self) -> str:
        return f"ProblemCheck({self.verdict}, by {self.method}, of {self.problem!r})"


def check(
    problem: Problem,
    *,
    method: str = "auto",
    settings: Overrides = BY_RULE,
    reduce: bool | None = None,
    must_rest: bool = False,
    progress: Progress = silent,
) -> ProblemCheck:
    """Tell whether blocks stand under their loads.

    Parameters
    ----------
    problem : Problem
    method : str
        `auto`, `limit`, or the name of an engine.
    settings : mapping of str to float
        Settings that replace those of the engine's rule;
        `blocksim.evidence.simulation.SETTINGS` has their names.
    reduce : bool, optional
        Simulate blocks that do not part as one (`blocksim.evidence.merging`); by default where
        the engine says so (`Engine.merges`), gravity lies in the plane and the ground rests.
    must_rest : bool
        Find out as well whether it must rest, or friction may let it move
        (`blocksim.limit.starting`): a second with 8 joints, ten with 28.
    progress : Progress, optional

    Returns
    -------
    ProblemCheck

    Raises
    ------
    InputError
        If the method cannot do what the problem asks for, or it cannot be found out whether
        it must rest (`blocksim.ask.rest`).
    MissingPart
        If the engine's library is not installed.
    """
    started = time.perf_counter()
    chosen = choose(method, problem=problem, settings=settings, reduce=reduce)
    if must_rest:
        require_rest(problem)
    if problem.shaking is not None:
        # What moves blocks is loaded where it is asked for.
        from blocksim.evidence.shaken import shake

        shaken = shake(problem, chosen.name, settings=settings, progress=progress)
        return _of_shaken(problem, chosen, shaken, chosen_words(method, chosen), started)
    planar = problem.is_planar
    static = equilibrium(problem) if planar else None
    factor = collapse(problem).load_factor if planar and problem.live else None
    joints = closed_joints(problem.assembly.joint_angles)
    mechanism = seen = None
    if static is not None and chosen.is_static:
        verdict = Verdict.STANDS if static.exists else Verdict.COLLAPSES
        verdict = verdict if static.decided else Verdict.UNDECIDED
        reason = _static_words(static)
        mechanism = static.mechanism
    else:
        from blocksim.evidence.merging import Merging
        from blocksim.evidence.observation import observe

        seen = observe(
            problem,
            chosen.name,
            settings=settings,
            reduction=Merging.of(problem) if merges(chosen, reduce, problem) else None,
            progress=progress,
        )
        verdict, reason, mechanism = seen.verdict, seen.reason, seen.rates
    exists = None if static is None else static.exists
    moved = seen is not None and seen.moved
    rest = rest_of(
        problem if must_rest else None, exists=exists, moved=moved, progress=progress
    )
    if mechanism is not None:
        mechanism = _unit(mechanism, problem)
        if planar:
            joints = _observed(problem, mechanism)
    return ProblemCheck(
        method=chosen.name,
        verdict=verdict,
        reason=reason + chosen_words(method, chosen) + _notes(problem),
        problem=problem,
        load_factor=factor,
        rest=rest,
        asked_rest=must_rest,
        joints=joints,
        forces=None if static is None else static.forces,
        mechanism=mechanism,
        simulated=seen and seen.simulated,
        state_hash=seen and seen.state_hash,
        blocks=seen and seen.blocks,
        splits=seen and seen.splits,
        wall_s=time.perf_counter() - started,
    )


def _of_shaken(
    problem: Problem, chosen: Method, shaken: Shaken, words: str, started: float
) -> ProblemCheck:
    """Answer what became of blocks on ground that shakes."""
    return ProblemCheck(
        method=chosen.name,
        verdict=shaken.verdict,
        reason=shaken.reason + words + _notes(problem),
        problem=problem,
        load_factor=None,
        rest=None,
        asked_rest=False,
        joints=closed_joints(problem.assembly.joint_angles),
        forces=None,
        mechanism=None,
        shaken=shaken,
        simulated=float(shaken.recording.times[-1]),
        state_hash=shaken.recording.state_hash,
        blocks=len(problem.assembly.blocks),
        splits=None,
        wall_s=time.perf_counter() - started,
    )


def _observed(problem: Problem, rates: Array) -> tuple[ObservedJoint, ...]:
    """Tell what each joint does as blocks begin to move at some rates, (blocks, 3)."""
    from blocksim.evidence.onset import PROBE

    assembly = problem.assembly
    return classify(assembly, assembly.built[:-1] + PROBE * rates[:, :3])


def _unit(rates: Array, problem: Problem) -> Array:
    """Scale rates so that the largest way of a corner is 1."""
    largest = float(displacement(rates, problem.assembly))
    return rates / largest if largest > 0 else rates


def _static_words(static: Equilibrium) -> str:
    """Say what limit analysis found."""
    if not static.decided:
        return (
            f"the limit is nearer than {NEAR:g}: loads or friction changed by that share would "
            "decide"
        )
    if static.exists:
        return (
            "forces of equilibrium exist, every contact pressing by "
            f"{max(0.0, static.margin):.3g} of what it carries along both edges of its friction "
            "cone, or more"
        )
    if math.isinf(static.margin):
        return "no forces of equilibrium exist, even if contacts could pull"
    return (
        "no forces of equilibrium exist: contacts would have to pull by "
        f"{-static.margin:.3g} of what they carry"
    )


def _notes(problem: Problem) -> str:
    return "".join(f"; {note}" for note in problem.notes)
