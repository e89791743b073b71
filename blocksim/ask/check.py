"""Does it stand? One problem, asked of limit analysis or of an engine."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, Unpack, overload

from blocksim.ask.carried import carried_of
from blocksim.ask.closed import closing_of_verdict
from blocksim.ask.methods import choose, chosen_words, reduces
from blocksim.ask.options import Asked, AskedInSpace, Of, Options, Taken, problem_of, taken
from blocksim.ask.rest import Moving, Rest, require_rest, rest_of
from blocksim.ask.statics import (
    VERDICTS,
    crushing_evidence,
    observed,
    static_evidence,
    unit,
)
from blocksim.ask.undecided import undecided_words
from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import ObservedJoint, closed_joints
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.common.shown import Shown
from blocksim.engines import get_engine
from blocksim.kinds.offers import Offers, offers_of
from blocksim.limit import Equilibrium, collapse, equilibrium
from blocksim.limit.carried import Carried
from blocksim.limit.crushing import Needed, strength_needed
from blocksim.limit.exact import Exact
from blocksim.limit.proof import proof_of_rest
from blocksim.simulation.verdict import Evidence, Verdict, aside, reason_of

if TYPE_CHECKING:
    from blocksim.arch.answers import ArchAnswer
    from blocksim.engines.base import Method
    from blocksim.limit.proof import Proof
    from blocksim.limit.space import SpatialEquilibrium
    from blocksim.simulation.observation import Observation
    from blocksim.simulation.recorded import Recorded
    from blocksim.simulation.shaken import Shaken

UNPROVED = "none: strengths are compared in floating point, not in rational arithmetic"
"""What is said of answers about blocks that crush."""
SOUGHT = 500
"""Joints up to which what a structure carries is found within seconds."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Check(Shown, Generic[Of]):
    """Answer to *does it stand*, with its evidence.

    Parameters
    ----------
    method : str
    verdict : Verdict
        *Stands* means that it can rest.
    evidence : tuple of Evidence
        What was seen, by which test.
    problem : Problem or SpatialProblem
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
    recording : Recording or SpatialRecording or None
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
    problem: Of
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
    recording: Recorded[Any] | None = None
    blocks: int | None = None
    splits: int | None = None
    wall_s: float
    arch: ArchAnswer | None = None

    @property
    def reason(self) -> str:
        """The evidence as a sentence."""
        return reason_of(self.evidence)

    @cached_property
    def static(self) -> Equilibrium | SpatialEquilibrium | None:
        """What limit analysis says; None where gravity leans, or the ground shakes."""
        return equilibrium(self.problem) if self.problem.has_statics else None

    @cached_property
    def proof(self) -> Proof | None:
        """The proof of the verdict by limit analysis; None where undecided, and in space."""
        if self.method != "limit" or not isinstance(self.problem, Problem):
            return None
        found = None
        if self.problem.strength is not None and self.needed is not None:
            # Proofs are of rigid blocks, which stand.
            return None
        stands = self.verdict is Verdict.STANDS
        if stands and offers_of(self.problem) and self.carried is not None:
            # The maker's own statics know forces: no linear programme has to be loaded.
            forces = self.carried.forces
            found = None if forces is None else proof_of_rest(Exact(self.problem), forces)
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
        """What it carries; None where gravity leans, the ground shakes, or it is too large.

        `blocksim.ask.carried.carried_of` has no such bound.
        """
        small = offers_of(self.problem) or len(self.problem.assembly.joints) <= SOUGHT
        return carried_of(self.problem, needed=self.needed) if small else None

    def __repr__(self) -> str:
        return f"Check({self.verdict}, by {self.method}, of {self.problem!r})"


@overload
def check(asked: Asked, *, must_rest: bool = False, **options: Unpack[Options]) -> Check: ...
@overload
def check(
    asked: AskedInSpace, *, must_rest: bool = False, **options: Unpack[Options]
) -> Check[SpatialProblem]: ...
@overload
def check(
    asked: Asked | AskedInSpace, *, must_rest: bool = False, **options: Unpack[Options]
) -> Check[Any]: ...
def check(
    asked: Asked | AskedInSpace, *, must_rest: bool = False, **options: Unpack[Options]
) -> Check[Any]:
    """Tell whether blocks stand under their loads.

    Parameters
    ----------
    asked : Problem, SpatialProblem, or a maker of one
    must_rest : bool
        Find out as well whether it must rest, or friction may let it move
        (`blocksim.limit.starting`): a second with 8 joints, ten with 28.
    **options
        `method`, `settings`, `reduce`, `progress` (`blocksim.ask.options.Options`).

    Returns
    -------
    Check

    Raises
    ------
    InputError
        If the method cannot do what the problem asks for, or it cannot be found out whether
        it must rest (`blocksim.ask.rest`).
    MissingPart
        If the engine's library is not installed.

    Examples
    --------
    >>> from blocksim.kinds.circular import CircularArch
    >>> seen = check(CircularArch(half_angle_deg=90, eta=0.2, friction=0.7), method="limit")
    >>> seen.verdict.value, seen.arch.mode_limit.value
    ('stands', 'rrr')
    """
    started = time.perf_counter()
    given = taken(options, "tol", "confirm")
    problem = problem_of(asked)
    chosen = choose(given.method, problem=problem, settings=given.settings, reduce=given.reduce)
    if must_rest:
        require_rest(problem)
    if isinstance(problem, Problem) and problem.shaking is not None:
        found = _by_shaking(problem, chosen, given)
    elif isinstance(problem, Problem) and (offered := offers_of(problem)) is not None:
        found = _offered(problem, offered, chosen, given)
    else:
        found = _general(problem, chosen, given)
        problem = found.answer.problem
    rest = motion = None
    if problem.shaking is None:
        rest, motion = rest_of(
            problem if must_rest and isinstance(problem, Problem) else None,
            exists=found.exists,
            moved=found.moved,
            progress=given.progress,
        )
    words = aside("method", chosen_words(given.method, chosen))
    notes = tuple(Evidence("note", note) for note in problem.notes)
    answer = replace(
        found.answer,
        evidence=(*found.answer.evidence, *words, *notes),
        rest=rest,
        asked_rest=must_rest and problem.shaking is None,
        motion=motion,
        joints=found.answer.joints
        if motion is None
        else observed(problem, motion.accelerations),
        wall_s=time.perf_counter() - started,
    )
    if found.static is not None:
        # Asked for already.
        vars(answer)["static"] = found.static
    open_ = answer.method == "limit" and not answer.proved and answer.needed is None
    if isinstance(problem, Problem) and open_:
        said = Evidence("limit analysis", undecided_words(problem))
        evidence = (said, *answer.evidence[1:])
        return replace(answer, verdict=Verdict.UNDECIDED, evidence=evidence)
    return answer


class _Found(NamedTuple):
    """An answer, and what tells of rest: forces of equilibrium, a motion that was seen."""

    answer: Check[Any]
    exists: bool | None
    moved: bool
    static: Equilibrium | SpatialEquilibrium | None = None


def _offered(problem: Problem, offered: Offers, chosen: Method, given: Taken) -> _Found:
    """Answer by what the maker knows, or by an engine."""
    static = offered.static(chosen.name) if chosen.is_static else None
    if static is not None:
        answer = Check(
            method=chosen.name,
            verdict=static.verdict,
            evidence=(static.evidence,),
            problem=problem,
            joints=static.joints,
            wall_s=0.0,
            arch=offered.facts(mode=static.mode),
        )
        return _Found(answer, offered.stands, moved=False)
    answer, seen = _simulated(problem, offered, chosen, given)
    facts = offered.facts(
        mode=offered.mode(seen.joints), mode_in_motion=offered.mode(seen.joints_in_motion)
    )
    return _Found(replace(answer, arch=facts), offered.stands, moved=seen.moved)


def _general(problem: Problem | SpatialProblem, chosen: Method, given: Taken) -> _Found:
    """Answer by limit analysis or by an engine."""
    known = problem.has_statics
    factor = collapse(problem).load_factor if known and problem.live else None
    static = equilibrium(problem) if known else None
    # What soil bears is mobilised as far as it has to be.
    problem = static.problem if isinstance(static, Equilibrium) else problem
    exists = None if static is None else static.exists
    if static is not None and chosen.is_static:
        evidence, needed, rates = static_evidence(problem, static), None, static.mechanism
        verdict = VERDICTS[exists]
        if exists and isinstance(problem, Problem) and problem.strength is not None:
            needed = strength_needed(problem)
            verdict, evidence = crushing_evidence(problem, needed)
            exists = verdict is Verdict.STANDS
            rates = None if exists or needed is None else needed.mechanism
        answer = Check[Any](
            method=chosen.name,
            verdict=verdict,
            evidence=evidence,
            problem=problem,
            joints=observed(problem, rates),
            needed=needed,
            load_factor=factor,
            wall_s=0.0,
        )
        return _Found(answer, exists, moved=False, static=static)
    answer, seen = _simulated(problem, None, chosen, given)
    joints = observed(problem, seen.rates) if known else answer.joints
    closing: tuple[Evidence, ...] = ()
    if isinstance(problem, Problem) and exists is not None:
        closing = closing_of_verdict(problem, stands=exists)
    answer = replace(
        answer, joints=joints, load_factor=factor, evidence=(*answer.evidence, *closing)
    )
    return _Found(answer, exists, moved=seen.moved, static=static)


def _simulated(
    problem: Problem | SpatialProblem, offered: Offers | None, chosen: Method, given: Taken
) -> tuple[Check[Any], Observation]:
    """Answer what an engine showed, of fewer blocks where it takes no more."""
    # What moves blocks is loaded where it is asked for.
    from blocksim.ask.engines import concluded, held, merged

    reduction = None
    if offered is None:
        reduction = merged(chosen, given, problem)
    elif isinstance(problem, Problem) and reduces(chosen, given.reduce, problem, by_maker=True):
        reduction = offered.reduction()
    at_rest = held(problem, get_engine(chosen), given, reduction)
    seen = concluded(at_rest, moving=True, progress=given.progress)
    answer = Check[Any](
        method=chosen.name,
        verdict=seen.verdict,
        evidence=seen.evidence,
        problem=problem,
        # Of a motion out of the plane joints are not told.
        joints=seen.joints or closed_joints(problem.assembly.joint_angles),
        rates=seen.rates,
        simulated=seen.simulated,
        state_hash=seen.state_hash,
        recording=None if seen.motion is None else seen.motion.recording,
        blocks=seen.blocks,
        splits=seen.splits,
        wall_s=0.0,
    )
    return answer, seen


def _by_shaking(problem: Problem, chosen: Method, given: Taken) -> _Found:
    """Answer what became of blocks on ground that shakes."""
    # What moves blocks is loaded where it is asked for.
    from blocksim.simulation.shaken import shake

    seen = shake(problem, get_engine(chosen), settings=given.settings, progress=given.progress)
    answer = Check(
        method=chosen.name,
        verdict=seen.verdict,
        evidence=(Evidence("shaking", seen.reason),),
        problem=problem,
        joints=closed_joints(problem.assembly.joint_angles),
        shaken=seen,
        simulated=float(seen.recording.times[-1]),
        state_hash=seen.recording.state_hash,
        recording=seen.recording,
        blocks=len(problem.assembly.blocks),
        wall_s=0.0,
    )
    return _Found(answer, None, moved=False)
