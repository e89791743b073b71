"""Blocks on ground that shakes: recorded until they lie still, and what became of them.

- *stands*: they lie still after the shaking, and every joint still is one: its faces lie
  over each other, nearly parallel, and touch, and have never looked away from each other;
- *collapses*: they lie still and a joint is none any more, or a block has sunk by `SUNK`;
- *undecided*: they still move when the time is over, or end otherwise at half the step, or
  fall though forces of equilibrium exist at any time.

Blocks that begin in motion are the same question, on ground at rest. Blocks rock: what a joint
opens it closes again, with an impact. Without restitution what an impact leaves is what contact
and friction leave. The first impact and the largest
rotation are read from the recorded poses.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, cast

import numpy as np

from blocksim.blocks.acting import sideways, with_push
from blocksim.blocks.assembly import Array, Assembly
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.blocks.space.parting import joined, turned_over
from blocksim.common.progress import Progress, silent
from blocksim.engines.base import Engine, TakesForces, TakesVelocities, World, trusted
from blocksim.engines.contact.geometry import Geometry
from blocksim.limit import equilibrium
from blocksim.simulation.motion import FRAME, distrust, lie_still
from blocksim.simulation.observation import hold
from blocksim.simulation.recording import Recording
from blocksim.simulation.repeating import COARSER, KNOWN, SAFE, estimated
from blocksim.simulation.rocking import TURNED, Rocking, rocking_of
from blocksim.simulation.simulated import BY_RULE, Overrides, Simulation, given_words
from blocksim.simulation.verdict import Verdict

SUNK = 0.5
"""How far a block's centre has sunk that will not come back [size]."""
LONGEST = 200.0
"""Time after the shaking at which blocks that still move are given up [sqrt(size/g)]."""
APART = 0.01
"""Gap across a joint from which its blocks do not touch [size]."""
OVER = math.pi / 2
"""Turn of a joint's blocks against each other beyond which its faces look apart."""
MAY_REST = "they can rest all the same: forces of equilibrium exist at any time"
PARTS = 8
"""Parts of a step, to which times of frames are the same in runs at other steps."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Shaken:
    """What became of blocks on ground that shakes.

    `moved`: Largest displacement of any corner at the end [size].
    """

    verdict: Verdict
    reason: str
    rocking: Rocking
    moved: float
    recording: Recording[Any]

    @property
    def first_impact_s(self) -> float | None:
        """When a joint that had opened closed first [s]."""
        impact = self.rocking.impact
        return None if impact is None else impact * self.recording.problem.seconds


def shake(
    problem: Problem[Any],
    engine: str | Engine,
    *,
    until: float | None = None,
    whole: bool = False,
    repeat: bool = True,
    settings: Overrides = BY_RULE,
    progress: Progress = silent,
) -> Shaken:
    """Let blocks go on ground that shakes, and see what becomes of them.

    They are shaken again at twice the step, and at others that the engine asks for. Where one
    ends otherwise, or the largest rotations differ by more than `KNOWN` of it, they are shaken
    at half the step as well, which is what is returned. What is said is what all finer runs
    say; `undecided` if they differ.

    `problem`: With `shaking` or `velocities`.
    `engine`: One that `shakes`.
    `until`: Time to record for [sqrt(size/g)], or until all lies still.
    `whole`: Go on where a block has sunk by `SUNK`, and the verdict is certain.
    `repeat`: Without, they are shaken once.
    """
    simulation = Simulation.of(problem, engine, settings=settings)
    step, beside = simulation.settings.step, simulation.engine.beside
    # Of so many steps each run has frames at the same times.
    every = math.lcm(*(Fraction(share).numerator for share in beside))
    stride = max(1, every * round(FRAME / (every * step)))

    def at(share: float) -> Shaken:
        """Shake them in steps of a share of those asked for; frames follow as they can."""
        return _once(
            problem,
            engine,
            max(1, round(stride / share)),
            until=until,
            whole=whole,
            settings={**settings, "step": share * step},
            progress=progress,
        )

    seen = usual = at(1.0)
    if repeat:
        seen, differs = _beside(usual, [at(share) for share in beside])
        if differs:
            finer = (at(share / COARSER) for share in beside[1:])
            seen, _ = _beside(at(1 / COARSER), [usual, *finer])
    if seen.verdict is Verdict.COLLAPSES and may_rest(problem):
        seen = replace(seen, verdict=Verdict.UNDECIDED, reason=f"{seen.reason}; {MAY_REST}")
    return replace(seen, reason=seen.reason + given_words(settings))


def may_rest(problem: Problem[Any]) -> bool:
    """Tell whether forces of equilibrium exist at any time while the ground shakes sideways.

    They do if they exist at both ends of its acceleration: each mean of two such sets of forces
    lies within friction, too, and balances what lies between.
    """
    shaking = problem.shaking
    if shaking is None or not _is_known(problem):
        return False
    return all(equilibrium(_pushed(problem, each)).exists for each in shaking.across)


def _is_known(problem: Problem[Any]) -> bool:
    """Tell whether limit analysis can be asked for forces while the ground shakes."""
    shaking = problem.shaking
    known = shaking is not None and not shaking.is_vertical and not len(problem.velocities)
    return known and replace(problem, shaking=None).has_statics


def _pushed(problem: Problem[Any], across: float) -> Problem:
    """Return a problem at a moment at which its ground accelerates by so much across [g]."""
    return replace(with_push(problem, -across), shaking=None)


def _begin(world: World, simulation: Simulation[Any]) -> None:
    """Give a world forces that balance the ground's first push, where it takes any.

    Friction may allow both rest and motion, and sweeps that begin with the forces of before
    the push may find the motion.
    """
    problem, step = simulation.taken, simulation.settings.step
    if not simulation.engine.takes_forces or not _is_known(problem):
        return
    seen = (problem.gravity - problem.shaken(0.0, step))[: problem.assembly.dimensions]
    across = float(seen @ sideways(problem))
    forces = equilibrium(_pushed(problem, across)).forces
    if forces is not None:
        cast("TakesForces", world).begin(forces)


def _once(
    problem: Problem[Any],
    engine: str | Engine,
    stride: int,
    *,
    until: float | None,
    whole: bool,
    settings: Overrides,
    progress: Progress,
) -> Shaken:
    """Shake blocks once, with a frame every so many steps."""
    held = hold(problem, engine, settings=settings, progress=progress)
    simulation, world = held.simulation, held.world
    assembly, step = simulation.assembly, simulation.settings.step
    _begin(world, simulation)
    shaken = problem.shaking.duration / problem.seconds if problem.shaking else 0.0
    if problem.is_moving and len(problem.velocities):
        per = np.array([assembly.size, assembly.size, 1.0])
        cast("TakesVelocities", world).push(problem.velocities / per * problem.seconds)
    end = shaken + LONGEST if until is None else until
    times, poses, taken = [0.0], [world.poses()], 0
    while times[-1] < end - step / 2:
        world.advance(stride)
        taken += stride
        times.append(taken * step)
        poses.append(world.poses())
        if times[-1] > shaken and lie_still(assembly, poses):
            break
        if not whole and _sunk(assembly, poses) > SUNK:
            break
        progress(min(1.0, times[-1] / end), "shaking")
    quality = world.quality()
    if problem.shaking is not None:
        # What the ground does is no gain of the engine.
        quality = replace(quality, gain=None)
    recording = simulation.record(times, poses, quality)
    verdict, what = outcome(recording)
    if not trusted(world, simulation.settings) and verdict is Verdict.STANDS:
        verdict = Verdict.UNDECIDED
        what = distrust(quality, simulation.settings, simulation.length)
    rocking = rocking_of(recording)
    return Shaken(
        verdict=verdict,
        reason=_words(what, recording, rocking),
        rocking=rocking,
        moved=float(recording.displacement[-1]),
        recording=recording,
    )


def _beside(fine: Shaken, others: list[Shaken]) -> tuple[Shaken, bool]:
    """Return an answer with what others at longer steps tell, and whether they differ."""
    recording, step = fine.recording, fine.recording.settings.step
    for other in (each.recording for each in others):
        frames = {round(PARTS * time / step): at for at, time in enumerate(other.times)}
        ticks = [round(PARTS * time / step) for time in recording.times]
        shared = [at for at, tick in enumerate(ticks) if tick in frames]
        poses = [other.poses[frames[ticks[at]]] for at in shared]
        recording = estimated(recording, poses, shared)
    off = SAFE * max(abs(fine.rocking.rotation - each.rocking.rotation) for each in others)
    hits = [each.rocking.impact for each in (fine, *others)]
    known = [hit for hit in hits if hit is not None]
    late = SAFE * max(abs(hit - known[0]) for hit in known) if len(known) == len(hits) else None
    rocking = replace(fine.rocking, off=off, late=late)
    found = replace(fine, recording=recording, rocking=rocking)
    for each in others:
        if fine.verdict is not each.verdict:
            words = (
                f"{fine.verdict} at a step of {step:.3g} sqrt(size/g), "
                f"{each.verdict} at {each.recording.settings.step:.3g}; {fine.reason}"
            )
            return replace(found, verdict=Verdict.UNDECIDED, reason=words), True
    times = " and ".join(f"{each.recording.settings.step / step:.3g}" for each in others)
    words = f"{fine.reason}; the same at {times} times the step"
    stands = fine.verdict is Verdict.STANDS
    if stands and fine.rocking.rotation > TURNED:
        words += f", rotations to {off / fine.rocking.rotation:.1%}"
    differs = stands and off > max(KNOWN * fine.rocking.rotation, TURNED)
    return replace(found, reason=words), differs


def outcome(recording: Recording[Any]) -> tuple[Verdict, str]:
    """Tell from the poses what became of blocks on ground that shook, and in words why."""
    poses, problem = list(recording.poses), recording.problem
    over = problem.shaking.duration / problem.seconds if problem.shaking else 0.0
    if recording.times[-1] > over and lie_still(problem.assembly, poses):
        ended = _ended(recording)
        if ended:
            return Verdict.COLLAPSES, f"lies still; joints that are none any more: {ended}"
        return Verdict.STANDS, "it lies still in the end, and all joints are closed"
    sunk = _sunk(problem.assembly, poses)
    if sunk > SUNK:
        return Verdict.COLLAPSES, f"a block sank by {sunk * problem.assembly.size:.2g} m"
    return Verdict.UNDECIDED, "still moves when the time is over"


def _ended(recording: Recording[Any]) -> int:
    """Count the joints that are none any more, or have turned over on the way.

    A block may roll until it lies on the same face again.
    """
    assembly, poses = recording.assembly, recording.poses
    if recording.problem.in_space:
        return int((~joined(assembly, poses[-1], APART) | turned_over(assembly, poses)).sum())
    touch, holds = Geometry(assembly).touch(poses[-1])
    turned = np.pad(poses[:, :, 2] - poses[0, :, 2], ((0, 0), (0, 1)))
    before, after = assembly.sides
    over = (np.abs(turned[:, after] - turned[:, before]) > OVER).any(axis=0)
    return int((~holds | (touch.gap.min(axis=1) > APART) | over).sum())


def _sunk(assembly: Assembly | SpatialAssembly, poses: list[Array]) -> float:
    """How far a block's centre has sunk at most."""
    height = assembly.dimensions - 1
    return float((poses[0][:, height] - poses[-1][:, height]).max())


def _words(what: str, recording: Recording[Any], rocking: Rocking) -> str:
    """Say what was seen."""
    seconds, assembly = recording.problem.seconds, recording.assembly
    name = assembly.blocks[rocking.block].name or str(rocking.block)
    said = [what]
    said.append(f"largest rotation {math.degrees(rocking.rotation):.3g} deg, of block {name}")
    if rocking.impact is not None:
        said.append(f"first impact after {rocking.impact * seconds:.4g} s")
    moved = recording.displacement[-1] * assembly.size
    said.append(f"moved by {moved:.2g} m in the {recording.times[-1] * seconds:.3g} s watched")
    return "; ".join(said)
