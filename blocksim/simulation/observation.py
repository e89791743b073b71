"""A problem in an engine: onset test, moving run, and what they show together."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Generic, cast

from blocksim.blocks.assembly import Array, Blocks
from blocksim.blocks.joints import ObservedJoint, classify, closed_joints
from blocksim.blocks.problem import Problem
from blocksim.common.progress import Progress, silent
from blocksim.common.words import counted
from blocksim.engines.base import Engine, TellsForces, World
from blocksim.simulation.motion import Motion, moving_run
from blocksim.simulation.onset import Onset, onset
from blocksim.simulation.recording import Recording
from blocksim.simulation.repeating import compared
from blocksim.simulation.simulated import BY_RULE, Overrides, Reduced, Simulation, given_words
from blocksim.simulation.verdict import Evidence, Verdict, aside, reason_of


@dataclass(frozen=True, kw_only=True, eq=False)
class Held(Generic[Blocks]):
    """Blocks in an engine after the onset test: at rest, and ready to be let go once.

    `splits`: Joints of a reduction that turned out to move.
    """

    simulation: Simulation[Blocks]
    world: World
    onset: Onset
    splits: int = 0

    @property
    def blocks(self) -> int:
        """How many blocks the engine was given."""
        return self.simulation.blocks

    def release(
        self, until: float | None = None, progress: Progress = silent
    ) -> Motion[Blocks]:
        """Let the blocks go as the onset test left them; see `moving_run`.

        Where it has found rest, and they do not, they begin again with forces of equilibrium.
        """
        first, simulation = self.onset, self.simulation
        rests = first.verdict is Verdict.STANDS and not first.may_slide
        motion = moving_run(
            simulation, self.world, first.repeat, rests=rests, until=until, progress=progress
        )
        helped = first.forces is not None or not simulation.takes_forces
        if not rests or helped or until or motion.verdict is Verdict.STANDS:
            return motion
        world = simulation.world()
        again = onset(world, simulation, progress, given=True)
        if again.forces is None or again.verdict is not Verdict.STANDS:
            return motion
        found = moving_run(simulation, world, again.repeat, rests=True, progress=progress)
        words = found.reason.replace("released", "released with forces of limit analysis", 1)
        return replace(found, reason=words)

    def record(
        self, until: float | None = None, progress: Progress = silent
    ) -> Recording[Blocks]:
        """Let the blocks go, and say how right it is."""
        recording = self.release(until, progress).recording
        simulation = replace(self.simulation, settings=recording.settings)

        def world_at(step: float) -> World:
            world = simulation.at_step(step).world()
            self.onset.repeat(world)
            return world

        return compared(recording, world_at, simulation.engine.beside)


@dataclass(frozen=True, kw_only=True, eq=False)
class Observation:
    """What an engine showed of one problem.

    `verdict`: Undecided unless onset test and moving run agree, or only the first was asked
        for.
    `motion`: None where the blocks were not let go.
    `joints`, `joints_in_motion`: What joints do as a collapse starts, by the onset test, and a
        little later, in the moving run; closed where the blocks stand. Empty in space; the
        second is empty where there was no moving run, too.
    `rates`, (blocks, 3 or 6): Velocities in proportion to those with which a collapse starts,
        columns as poses.
    `blocks`, `splits`: Blocks that were simulated, and joints that a reduction had to split
        again.
    """

    verdict: Verdict
    evidence: tuple[Evidence, ...]
    onset: Onset
    motion: Motion[Any] | None
    joints: tuple[ObservedJoint, ...]
    joints_in_motion: tuple[ObservedJoint, ...]
    rates: Array | None
    blocks: int
    splits: int

    @property
    def reason(self) -> str:
        """The evidence as a sentence."""
        return reason_of(self.evidence)

    @property
    def moved(self) -> bool:
        """Whether a motion was seen where forces of equilibrium exist."""
        return self.onset.may_rest or self.onset.may_slide

    @property
    def simulated(self) -> float:
        """Time simulated [sqrt(size/g)]."""
        return float(self.motion.recording.times[-1]) if self.motion else 0.0

    @property
    def state_hash(self) -> str | None:
        """Fingerprint of the recorded motion."""
        return self.motion.recording.state_hash if self.motion else None


def observe(
    problem: Problem[Any],
    engine: str | Engine,
    *,
    moving: bool = True,
    settings: Overrides = BY_RULE,
    reduction: Reduced | None = None,
    progress: Progress = silent,
) -> Observation:
    """Put a problem into an engine: onset test, then, if asked for, the moving run.

    `moving`: Let the blocks go after the onset test. They are not let go where that test is
        undecided: unbalanced impulses would throw them.
    `reduction`: Simulate these blocks in place of all.
    """
    held = hold(problem, engine, settings=settings, reduction=reduction, progress=progress)
    return conclude(held, moving=moving, progress=progress)


def hold(
    problem: Problem[Any],
    engine: str | Engine,
    *,
    settings: Overrides = BY_RULE,
    reduction: Reduced | None = None,
    progress: Progress = silent,
) -> Held[Any]:
    """Do the first part: put the problem into the engine, and the onset test.

    With a reduction that is done again until no joint would move of those taken not to,
    and with all blocks where it cannot stand for them.
    """
    splits = 0
    while True:
        simulation = Simulation[Any].of(problem, engine, settings=settings, reduction=reduction)
        world = simulation.world()
        first = onset(world, simulation, progress)
        if reduction and not first.too_far:
            resultants = cast("TellsForces", world).resultants()
            better = reduction.revised(first, resultants, simulation)
            if better is not reduction:
                splits = splits + len(better.kept) - len(reduction.kept) if better else 0
                reduction = better
                continue
        return Held(simulation=simulation, world=world, onset=first, splits=splits)


def conclude(held: Held[Any], *, moving: bool, progress: Progress = silent) -> Observation:
    """Do the second part: the moving run if asked for, and what all of it shows."""
    simulation, first = held.simulation, held.onset
    verdict, motion = first.verdict, None
    evidence: tuple[Evidence, ...] = (Evidence("onset test", first.reason),)
    if moving and verdict is not Verdict.UNDECIDED:
        motion = held.release(progress=progress)
        evidence += (Evidence("moving run", motion.reason),)
        if motion.verdict is not verdict:
            verdict = Verdict.UNDECIDED
    evidence += _asides(held, motion)
    evidence += aside("settings", given_words(simulation.given))
    in_space = simulation.problem.in_space
    joints = () if in_space else closed_joints(simulation.assembly.joint_angles)
    in_motion = joints if motion else ()
    rates = None
    if verdict is Verdict.COLLAPSES:
        rates = first.mechanism - simulation.assembly.built[:-1]
        if not in_space:
            joints = classify(simulation.assembly, first.mechanism)
            in_motion = classify(simulation.assembly, motion.mechanism) if motion else ()
    return Observation(
        verdict=verdict,
        evidence=evidence,
        onset=first,
        motion=motion,
        joints=joints,
        joints_in_motion=in_motion,
        rates=rates,
        blocks=simulation.blocks,
        splits=held.splits,
    )


def _asides(held: Held[Any], motion: Motion[Any] | None) -> tuple[Evidence, ...]:
    """Tell what else there is to know of an observation."""
    simulation = held.simulation
    said: list[Evidence] = []
    if simulation.reduction:
        most = len(simulation.assembly.blocks)
        words = reduced_words(simulation.reduction.by, simulation.blocks, most, held.splits)
        said.append(Evidence("reduction", words))
    if motion and simulation.unsure:
        said.append(Evidence("settings", simulation.unsure))
    if simulation.rougher is not None:
        most = simulation.most_friction
        words = f"{simulation.engine.name} took {most:g} as friction"
        said.append(Evidence("friction", words))
    return tuple(said)


def reduced_words(by: str, blocks: int, of: int, splits: int) -> str:
    """Tell what a reduction has come to."""
    again = f"; {counted(splits, 'joint')} opened after all" if splits else ""
    return f"{blocks} instead of {of} blocks were simulated, by {by}{again}"
