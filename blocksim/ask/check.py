"""Does it stand? One problem, asked of limit analysis or of an engine."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple, Unpack, cast

from blocksim.ask.answer import Check as Check
from blocksim.ask.methods import asked_as, choose, chosen_words, merged, reduces
from blocksim.ask.options import Asked, Options, Taken, problem_of, taken
from blocksim.ask.rest import require_rest, rest_of
from blocksim.ask.statics import (
    VERDICTS,
    crushing_evidence,
    fewer,
    flat_evidence,
    observed,
    static_evidence,
)
from blocksim.ask.undecided import closing_of_verdict, undecided_words
from blocksim.blocks.assembly import Blocks
from blocksim.blocks.joints import closed_joints
from blocksim.blocks.problem import Problem
from blocksim.blocks.road import bears_road
from blocksim.common.errors import Unsolved
from blocksim.common.progress import Progress
from blocksim.engines import get_engine
from blocksim.kinds.offers import Offers, offers_of
from blocksim.limit import Equilibrium, collapse, equilibrium
from blocksim.limit.crushing import mobilised, strength_needed
from blocksim.simulation.verdict import Evidence, Verdict, aside

if TYPE_CHECKING:
    from blocksim.engines.base import Method
    from blocksim.limit.space import SpatialEquilibrium
    from blocksim.simulation.observation import Observation


def check(
    asked: Asked[Blocks], *, must_rest: bool = False, **options: Unpack[Options]
) -> Check[Blocks]:
    """Tell whether blocks stand under their loads.

    Parameters
    ----------
    asked : Problem, or a maker of one
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
    problem = asked_as(cast("Problem[Any]", problem_of(asked)))
    chosen = choose(given.method, problem=problem, settings=given.settings, reduce=given.reduce)
    if must_rest:
        require_rest(problem)
    if problem.is_moving:
        found = _by_shaking(problem, chosen, given)
    elif (offered := offers_of(problem)) is not None:
        found = _offered(problem, offered, chosen, given)
    else:
        found = _general(problem, chosen, given)
    answer = found.answer
    words = aside("method", chosen_words(given.method, chosen))
    notes = tuple(Evidence("note", note) for note in answer.problem.notes)
    if problem.shaking is not None and bears_road(problem):
        notes += (Evidence("note", "fill and loads on the road have no mass that would shake"),)
    flat = flat_evidence(answer.problem)
    answer = replace(answer, evidence=(*answer.evidence, *flat, *words, *notes))
    if not problem.is_moving:
        answer = _with_rest(answer, found, given.progress, must_rest=must_rest)
    answer = replace(answer, wall_s=time.perf_counter() - started)
    # Asked for already.
    known = {"static": found.static, "offers": found.offers}
    vars(answer).update({name: each for name, each in known.items() if each is not None})
    return _as_proved(answer)


def _with_rest(
    answer: Check[Any], found: _Found, progress: Progress, *, must_rest: bool
) -> Check[Any]:
    """Tell as well what friction allows."""
    problem = answer.problem
    rest, motion = rest_of(
        problem if must_rest else None,
        exists=found.exists,
        moved=found.moved,
        progress=progress,
    )
    answer = replace(answer, rest=rest, asked_rest=must_rest, motion=motion)
    if motion is None:
        return answer
    return replace(answer, joints=observed(problem, motion.accelerations))


def _as_proved(answer: Check[Any]) -> Check[Any]:
    """Return an answer of limit analysis, which is undecided where it is not proved."""
    problem = answer.problem
    provable = answer.method == "limit" and answer.needed is None and not problem.in_space
    if not provable or answer.proved:
        return answer
    evidence = (Evidence("limit analysis", undecided_words(problem)), *answer.evidence[1:])
    return replace(answer, verdict=Verdict.UNDECIDED, evidence=evidence)


class _Found(NamedTuple):
    """An answer, what tells of rest (forces, a motion that was seen), and what is known."""

    answer: Check[Any]
    exists: bool | None
    moved: bool
    static: Equilibrium | SpatialEquilibrium | None = None
    offers: Offers | None = None


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
            arch=offered.facts(mode=static.mode),
        )
        return _Found(answer, offered.stands, moved=False, offers=offered)
    answer, seen = _simulated(problem, offered, chosen, given)
    facts = offered.facts(
        mode=offered.mode(seen.joints), mode_in_motion=offered.mode(seen.joints_in_motion)
    )
    return _Found(replace(answer, arch=facts), offered.stands, moved=seen.moved)


def _general(problem: Problem[Any], chosen: Method, given: Taken) -> _Found:
    """Answer by limit analysis or by an engine."""
    known = problem.has_statics
    reduce = given.reduce is not False
    factor = collapse(problem, reduce=reduce).load_factor if known and problem.live else None
    # What soil bears is mobilised as far as it has to be.
    problem = problem if problem.in_space else mobilised(problem)
    static = equilibrium(problem, reduce=reduce) if known else None
    exists = None if static is None else static.exists
    if static is not None and chosen.is_static:
        if exists and not problem.in_space and problem.strength is not None:
            needed = None
            with suppress(Unsolved):
                needed = strength_needed(problem)
            verdict, evidence = crushing_evidence(problem, needed)
            exists = verdict is Verdict.STANDS
            rates = None if exists or needed is None else needed.mechanism
        else:
            needed, rates = None, static.mechanism
            verdict, evidence = VERDICTS[exists], static_evidence(problem, static)
        answer = Check[Any](
            method=chosen.name,
            verdict=verdict,
            evidence=evidence,
            problem=problem,
            joints=observed(problem, rates),
            needed=needed,
            load_factor=factor,
            blocks=fewer(problem, static),
        )
        return _Found(answer, exists, moved=False, static=static)
    answer, seen = _simulated(problem, None, chosen, given)
    joints = observed(problem, seen.rates) if known else answer.joints
    closing: tuple[Evidence, ...] = ()
    if not problem.in_space and exists is not None:
        closing = closing_of_verdict(problem, stands=exists)
    answer = replace(
        answer, joints=joints, load_factor=factor, evidence=(*answer.evidence, *closing)
    )
    return _Found(answer, exists, moved=seen.moved, static=static)


def _simulated(
    problem: Problem[Any], offered: Offers | None, chosen: Method, given: Taken
) -> tuple[Check[Any], Observation]:
    """Answer what an engine showed, of fewer blocks where it takes no more."""
    from blocksim.simulation.observation import observe

    reduction = None
    if offered is None:
        reduction = merged(chosen, given.reduce, problem)
    elif not problem.in_space and reduces(chosen, given.reduce, problem, by_maker=True):
        reduction = offered.reduction()
    seen = observe(
        problem,
        get_engine(chosen),
        settings=given.settings,
        reduction=reduction,
        progress=given.progress,
    )
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
    )
    return answer, seen


def _by_shaking(problem: Problem[Any], chosen: Method, given: Taken) -> _Found:
    """Answer what became of blocks on ground that shakes, or that begin in motion."""
    from blocksim.simulation.shaken import shake

    seen = shake(problem, get_engine(chosen), settings=given.settings, progress=given.progress)
    answer = Check(
        method=chosen.name,
        verdict=seen.verdict,
        evidence=(Evidence("shaking" if problem.shaking else "motion", seen.reason),),
        problem=problem,
        joints=observed(problem, None),
        shaken=seen,
        simulated=float(seen.recording.times[-1]),
        state_hash=seen.recording.state_hash,
        recording=seen.recording,
        blocks=len(problem.assembly.blocks),
    )
    return _Found(answer, None, moved=False)
