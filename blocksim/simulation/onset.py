"""The onset test: whether an arch held at rest would start to move if let go.

The engine solves the contacts of a single step, in place, with as many sweeps as it
takes. Its answer is read as one of two certificates, both from the engine's own solution:

- *stands*: the largest acceleration falls below `still` of the settings (in g). The
  contact forces found balance the weights and respect contact and friction.
- *collapses*: the accelerations form a mechanism that the weight drives. No joint closes
  further (overlap below `closing` of the motion), and the weight's work on it is at least
  what goes into the motion (`looking.WORK`): more where joints slide, the same where they turn.
  Before the sweeps have converged blocks press into each other by percents, or forces at
  parting joints do work that nobody pays for; afterwards by a millionth. An engine that
  states the residual of its contacts is held to that instead of to the work.

If neither is reached within the sweeps allowed the test is undecided, and says so. So it is
where a block is farther from the origin than `farthest` of the settings: its coordinates round
off by 2e-16 of that distance, which over a displacement of `PROBE` comes up to `closing` at
5e4 sizes.

Coulomb's law may have two answers, rest and motion, where joints slide: no theorem tells that
an arch that can rest does. Which one is found depends on where the search for impulses begins,
and few thick voussoirs with much friction move whatever it is (155 deg, mu 3, n = 7: up to 10 %
above the least thickness, its forces without fault). An arch stands if it can rest. A mechanism
that slides is therefore believed only where no forces exist that would balance the weights
(`blocksim.limit`); where they do, the engine begins again, with these. If it keeps them, the
arch stands: the forces are not taken on trust. An engine that cannot be given any is undecided.
So it goes where sweeps run out (from `LATE` on) over what is a mechanism to a thousandth: a
mode of sliding can take 10^6 sweeps to die away (125.02 deg, mu 0.8594, n = 10).
Without sliding the answer is unique, and none of this is asked; nor is it in the plane of an
engine that looks for rest first.

Some engines take less friction than was asked for. What rests with less rests with more. What
falls may owe that to the friction it lacks (a wall of ten blocks, mu inf, 0.1 % below its
load: it slides at the 10 that Bullet allows), but not if no joint slides (`STICKS`). A collapse
that slides is believed only where no forces exist with the friction asked for either.

Thin joints and many blocks take an engine millions of sweeps from nothing. So it is helped
after `unaided` of its settings: it begins anew with forces of equilibrium, or where there are
none, if it keeps impulses, with those that leave least acceleration (`blocksim.limit.least`).
Both criteria prove what they say whatever it began with: forces that press, rub within their
cones and balance the weights prove that the blocks can rest; a motion that opens joints, closes
none and is driven by the weights proves that they cannot (where joints slide, limit analysis
has been asked).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.common.progress import Progress, silent
from blocksim.common.words import counted
from blocksim.engines.base import Settings, TakesForces, World
from blocksim.simulation.looking import STICKS, Looking
from blocksim.simulation.simulated import Simulation
from blocksim.simulation.verdict import Verdict

ROUNDING = 1e-12
"""What is smaller is nothing but rounding."""
PROBE = 1e-6
"""Size of the displacement along the accelerations at which joints are looked at."""
LATE, NEARLY = 0.1, 1e-3
"""Share of the sweeps allowed, and overlap; see above."""
UNFOUND = "contact forces could not be found"
"""What is said where an engine's numbers end in none."""
FIRST_SWEEPS = 1000
GROWTH = 1.5
"""Ratio of the totals of sweeps at two looks."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Onset:
    """Outcome of the onset test.

    `acceleration`: Largest acceleration of any corner [g].
    `mechanism`, (blocks, 3): Poses after a small displacement (`PROBE`) along the
        accelerations.
    `sweeps`: Sweeps spent.
    `held`: Those of each call since it began, or began anew with forces.
    `forces`, (joints, 2, 2): Forces it was given to begin with (`blocksim.limit`), if it was.
    `may_slide`: Whether forces of equilibrium exist, and begun with nothing it slides.
    `may_rest`: Whether it starts to move where forces of equilibrium exist.
    `lacks_friction`: Whether it starts to move with less friction than was asked for, and may
        rest with that.
    `too_far`: Whether it was built too far from the origin to be looked at.
    """

    verdict: Verdict
    acceleration: float
    mechanism: Array
    sweeps: int
    held: tuple[int, ...] = ()
    forces: Array | None = None
    may_slide: bool = False
    may_rest: bool = False
    lacks_friction: bool = False
    too_far: bool = False

    def repeat(self, world: World) -> None:
        """Bring a new world of the same blocks to where this test ended."""
        if self.forces is not None:
            cast("TakesForces", world).begin(self.forces)
        for sweeps in self.held:
            world.hold(sweeps)

    @property
    def reason(self) -> str:
        """The evidence in words."""
        spent = counted(self.sweeps, "sweep")
        size = f"{self.acceleration:.1e} g, found in {spent}"
        if self.forces is not None and not self.may_slide:
            size += ", the last of them begun with forces of limit analysis"
        match self.verdict:
            case Verdict.STANDS if self.may_slide:
                given = "contacts keep the forces of equilibrium that they were given"
                return f"{given}, to {size}; friction may let it move, too"
            case Verdict.STANDS:
                if self.acceleration < ROUNDING:
                    return f"contact forces balance the weight, found in {spent}"
                return f"contact forces balance the weight to {size}"
            case Verdict.COLLAPSES:
                return f"no contact forces hold it: a mechanism starts with {size}"
            case Verdict.UNDECIDED if self.too_far:
                return "a block is too far from the origin for its size"
            case Verdict.UNDECIDED if self.lacks_friction:
                return f"with less friction than asked for it starts with {size}"
            case Verdict.UNDECIDED if self.may_rest:
                return f"friction allows both: it rests, or it starts with {size}"
            case Verdict.UNDECIDED if not math.isfinite(self.acceleration):
                return f"{UNFOUND} in {spent}"
            case Verdict.UNDECIDED:
                return f"contact forces have not converged: {size}"


def onset(
    world: World,
    simulation: Simulation[Any],
    progress: Progress = silent,
    *,
    given: bool = False,
) -> Onset:
    """Run the onset test on a world whose blocks are at rest where they were built.

    `simulation`: Whose world it is, with what counts as at rest, and the most sweeps to spend.
    `given`: Begin with forces of equilibrium, where there are any.
    Returns: The world keeps its impulses and can be released from there.
    """
    engine, settings, reduction = simulation.engine, simulation.settings, simulation.reduction
    problem, built = simulation.taken, world.poses()
    look = Looking(problem, reduction.asked(problem) if reduction else None)
    if look.far > settings.farthest:
        seen = Onset(
            verdict=Verdict.UNDECIDED, acceleration=math.nan, mechanism=built, sweeps=0
        )
        return replace(seen, too_far=True)
    allowed, begun = settings.hold_sweeps, reduction.forces if reduction else None
    begun = look.equilibrium()[1] if given else begun
    # Nothing is known of the far voussoirs before impulses have crossed the assembly, which
    # they do at once where a sweep solves all contacts.
    crossing = len(problem.assembly.blocks) ** 2 if engine.usual_sweeps > 1 else 0
    first = min(max(FIRST_SWEEPS, crossing), allowed)
    total, sweeps, held = 0, first, list[int]()
    if begun is not None:
        cast("TakesForces", world).begin(begun)
    may_rest = may_slide = False
    takes = simulation.takes_forces and settings.unaided is not None
    helped = begun is not None or not takes
    # Even an engine that looks for rest can miss it: in space, and without bound on friction,
    # where forces may be wedged, a thousand times their pressures.
    bounded = bool(np.isfinite(problem.friction).all())
    unasked = problem.in_space or not (engine.finds_rest and bounded)
    while True:
        accelerations = world.hold(sweeps)
        total += sweeps
        # What keeps nothing makes all sweeps again in each call.
        held = [*held, sweeps] if engine.keeps_impulses else [sum(held) + sweeps]
        seen = _seen(world, look, settings, built, accelerations, total)
        slides = unasked and _slides(look, seen, late=total > LATE * allowed)
        slow = not helped and total >= (settings.unaided or 0)
        decided = seen.verdict is not Verdict.UNDECIDED
        if slides or (slow and not decided):
            may_rest, forces = look.equilibrium()
            unasked, helped = False, helped or slow
            if not may_rest and engine.keeps_impulses and slow and not decided:
                forces = look.least()
            if forces is not None and simulation.takes_forces:
                cast("TakesForces", world).begin(forces)
                sweeps, held, begun, may_slide = first, [], forces, slides
                continue
        if decided or total >= allowed:
            seen = replace(seen, held=tuple(held), forces=begun, may_slide=may_slide)
            return _judged(seen, may_rest, simulation.rougher)
        progress(total / allowed, "onset test")
        sweeps = min(int(total * (GROWTH - 1)), allowed - total)


def _slides(look: Looking, seen: Onset, *, late: bool) -> bool:
    """Tell whether blocks fall, or soon will, by joints that slide."""
    falls = seen.verdict is Verdict.COLLAPSES
    falls = falls or (late and look.overlap(seen.mechanism) < NEARLY)
    return falls and look.slip(seen.mechanism) > STICKS


def _judged(seen: Onset, may_rest: bool, rougher: Problem[Any] | None) -> Onset:
    """Return what was seen, undecided where it falls and may rest all the same."""
    if seen.verdict is Verdict.COLLAPSES:
        if may_rest:
            return replace(seen, verdict=Verdict.UNDECIDED, may_rest=True)
        if rougher is not None and _may_hold(rougher, seen.mechanism):
            return replace(seen, verdict=Verdict.UNDECIDED, lacks_friction=True)
    return seen


def _seen(
    world: World,
    look: Looking,
    settings: Settings,
    built: Array,
    accelerations: Array,
    sweeps: int,
) -> Onset:
    """Read the accelerations that a number of sweeps have led to."""
    largest = float(look.assembly.displacement(accelerations))
    mechanism = built + accelerations * (PROBE / largest if largest > 0 else 0.0)
    verdict = Verdict.UNDECIDED
    if look.trusts(world, settings, largest):
        if largest < settings.still:
            verdict = Verdict.STANDS
        elif look.overlap(mechanism) < settings.closing and (
            world.quality().residual is not None or look.driven(built, accelerations)
        ):
            verdict = Verdict.COLLAPSES
    return Onset(verdict=verdict, acceleration=largest, mechanism=mechanism, sweeps=sweeps)


def _may_hold(problem: Problem[Any], mechanism: Array) -> bool:
    """Tell whether blocks may rest by friction that the engine did not take."""
    look = Looking(problem)
    return look.slip(mechanism) > STICKS and look.equilibrium()[0]
