"""Blocks on ground that shakes: recorded until they lie still, and what became of them.

- *stands*: they lie still after the shaking, and every joint still is one: its faces lie
  over each other, nearly parallel, and touch;
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
from typing import Any, cast

import numpy as np

from blocksim.blocks.acting import with_push
from blocksim.blocks.assembly import Array, Assembly
from blocksim.blocks.problem import Problem
from blocksim.common.progress import Progress, silent
from blocksim.engines.base import Engine, TakesForces, TakesVelocities, World, trusted
from blocksim.engines.contact.geometry import Geometry, turns_of
from blocksim.limit import equilibrium
from blocksim.simulation.motion import FRAME, distrust, lie_still
from blocksim.simulation.observation import hold
from blocksim.simulation.recording import Recording
from blocksim.simulation.repeating import COARSER, KNOWN, SAFE, estimated
from blocksim.simulation.simulated import BY_RULE, Overrides, Simulation, given_words
from blocksim.simulation.verdict import Verdict

SUNK = 0.5
"""How far a block's centre has sunk that will not come back [size]."""
LONGEST = 200.0
"""Time after the shaking at which blocks that still move are given up [sqrt(size/g)]."""
APART = 0.01
"""Gap across a joint from which its blocks do not touch [size]."""
MAY_REST = "they can rest all the same: forces of equilibrium exist at any time"
TURNED, SHUT = 1e-4, 1e-7
"""Rotation by which a joint has opened, and at which it has closed again [rad]."""


@dataclass(frozen=True, kw_only=True)
class Rocking:
    """How blocks of a recording turned.

    `rotation`: Largest rotation of any block at any time [rad].
    `block`: Which one that was.
    `impact`: When a joint that had opened closed first [sqrt(size/g)]; None where none did.
    `off`, `late`: How far off rotation and impact may be, by a run at another step; None
        without one.
    """

    rotation: float
    block: int
    impact: float | None
    off: float | None = None
    late: float | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Shaken:
    """What became of blocks on ground that shakes.

    `moved`: Largest displacement of any corner at the end [size].
    """

    verdict: Verdict
    reason: str
    rocking: Rocking
    moved: float
    recording: Recording

    @property
    def first_impact_s(self) -> float | None:
        """When a joint that had opened closed first [s]."""
        impact = self.rocking.impact
        return None if impact is None else impact * self.recording.problem.seconds


def shake(
    problem: Problem,
    engine: str | Engine,
    *,
    until: float | None = None,
    whole: bool = False,
    repeat: bool = True,
    settings: Overrides = BY_RULE,
    progress: Progress = silent,
) -> Shaken:
    """Let blocks go on ground that shakes, and see what becomes of them.

    They are shaken again at twice the step. Where that ends otherwise, or the largest rotations
    differ by more than `KNOWN` of it, they are shaken at half the step as well, which is what
    is returned. What is said is what both finer runs say; `undecided` if they differ.

    `problem`: With `shaking` or `velocities`.
    `engine`: One that `shakes`.
    `until`: Time to record for [sqrt(size/g)], or until all lies still.
    `whole`: Go on where a block has sunk by `SUNK`, and the verdict is certain.
    `repeat`: Without, they are shaken once.
    """
    step = Simulation.of(problem, engine, settings=settings).settings.step
    stride = max(1, round(FRAME / step))

    def at(share: float) -> Shaken:
        """Shake them in steps of a share of those asked for; frames follow as they can."""
        return _once(
            problem,
            engine,
            max(1, int(stride / share)),
            until=until,
            whole=whole,
            settings={**settings, "step": share * step},
            progress=progress,
        )

    seen = usual = at(1.0)
    if repeat:
        seen, differs = _beside(usual, at(COARSER))
        if differs:
            seen, _ = _beside(at(1 / COARSER), usual)
    if seen.verdict is Verdict.COLLAPSES and may_rest(problem):
        seen = replace(seen, verdict=Verdict.UNDECIDED, reason=f"{seen.reason}; {MAY_REST}")
    return replace(seen, reason=seen.reason + given_words(settings))


def may_rest(problem: Problem) -> bool:
    """Tell whether forces of equilibrium exist at any time while the ground shakes sideways.

    They do if they exist at both ends of its acceleration: each mean of two such sets of forces
    lies within friction, too, and balances what lies between.
    """
    shaking = problem.shaking
    if shaking is None or not _is_known(problem):
        return False
    return all(equilibrium(_pushed(problem, each)).exists for each in shaking.across)


def _is_known(problem: Problem) -> bool:
    """Tell whether limit analysis can be asked for forces while the ground shakes."""
    shaking = problem.shaking
    known = shaking is not None and not shaking.is_vertical and not len(problem.velocities)
    return known and replace(problem, shaking=None).has_statics


def _pushed(problem: Problem, across: float) -> Problem:
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
    across = float((problem.gravity - problem.shaken(0.0, step))[0])
    forces = equilibrium(_pushed(problem, across)).forces
    if forces is not None:
        cast("TakesForces", world).begin(forces)


def _once(
    problem: Problem,
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
        if not whole and _sunk(poses) > SUNK:
            break
        progress(min(1.0, times[-1] / end), "shaking")
    # What the ground does and blocks begin with is no gain of the engine.
    quality = replace(world.quality(), gain=None)
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


def _beside(fine: Shaken, coarse: Shaken) -> tuple[Shaken, bool]:
    """Return the finer of two answers with what the other tells, and whether they differ."""
    one, two = fine.recording, coarse.recording
    every = max(1, round(float(two.times[1] / one.times[1])))
    recording = estimated(one, list(two.poses), slice(None, None, every))
    off = SAFE * abs(fine.rocking.rotation - coarse.rocking.rotation)
    hit, other = fine.rocking.impact, coarse.rocking.impact
    late = None if hit is None or other is None else SAFE * abs(hit - other)
    rocking = replace(fine.rocking, off=off, late=late)
    found = replace(fine, recording=recording, rocking=rocking)
    if fine.verdict is not coarse.verdict:
        steps = one.settings.step, two.settings.step
        words = (
            f"{fine.verdict} at a step of {steps[0]:.3g} sqrt(size/g), "
            f"{coarse.verdict} at {steps[1]:.3g}"
        )
        return replace(found, verdict=Verdict.UNDECIDED, reason=f"{words}; {fine.reason}"), True
    words = f"{fine.reason}; the same at {COARSER:g} times the step"
    stands = fine.verdict is Verdict.STANDS
    if stands and fine.rocking.rotation > TURNED:
        words += f", rotations to {off / fine.rocking.rotation:.1%}"
    differs = stands and off > max(KNOWN * fine.rocking.rotation, TURNED)
    return replace(found, reason=words), differs


def outcome(recording: Recording) -> tuple[Verdict, str]:
    """Tell from the poses what became of blocks on ground that shook, and in words why."""
    poses, problem = list(recording.poses), recording.problem
    over = problem.shaking.duration / problem.seconds if problem.shaking else 0.0
    if recording.times[-1] > over and lie_still(problem.assembly, poses):
        ended = _ended(problem.assembly, poses[-1])
        if ended:
            return Verdict.COLLAPSES, f"lies still; joints that are none any more: {ended}"
        return Verdict.STANDS, "it lies still in the end, and all joints are closed"
    sunk = _sunk(poses)
    if sunk > SUNK:
        return Verdict.COLLAPSES, f"a block sank by {sunk * problem.assembly.size:.2g} m"
    return Verdict.UNDECIDED, "still moves when the time is over"


def rocking_of(recording: Recording) -> Rocking:
    """Read from the poses how far blocks turned, and when a joint first closed again."""
    in_space = recording.problem.in_space
    if in_space:
        # From where blocks were built, by rotation vectors.
        turned = np.linalg.norm(recording.poses[:, :, 3:], axis=2)
    else:
        turned = recording.poses[:, :, 2] - recording.poses[0, :, 2]
    frame, block = np.unravel_index(int(np.abs(turned).argmax()), turned.shape)
    impact = None if in_space else _first_impact(recording.assembly, recording.times, turned)
    return Rocking(
        rotation=_peak(np.abs(turned[:, block]), int(frame)), block=int(block), impact=impact
    )


def _peak(values: Array, at: int) -> float:
    """Return the top of the parabola through the largest of some values and those beside it."""
    if not 0 < at < len(values) - 1:
        return float(values[at])
    one, two, three = values[at - 1 : at + 2]
    bend = one - 2 * two + three
    return float(two - (three - one) ** 2 / (8 * bend)) if bend < 0 else float(two)


def _first_impact(assembly: Assembly, times: Array, turned: Array) -> float | None:
    """Find when the rotation of an open joint, followed from before, first comes to 0."""
    joints = assembly.joint_arrays
    still = np.column_stack([turned, np.zeros(len(turned))])
    across = still[:, joints.after] - still[:, joints.before]
    ways = [across[:, ~joints.is_corner]]
    for joint in np.flatnonzero(joints.is_corner).tolist():
        down, up = np.arcsin(turns_of(assembly, joint))
        ways.append(np.stack([across[:, joint] + down, up - across[:, joint]], axis=1))
    way = np.hstack(ways)
    # Three to follow, and the one after.
    if len(times) < 4:
        return None
    step = times[-1] - times[-2]
    older, old, now, then = way[:-3], way[1:-2], way[2:-1], way[3:]
    slope, bend = (3 * now - 4 * old + older) / 2, (now - 2 * old + older) / 2
    expected = now + slope + bend
    closes = (np.abs(older) > TURNED) & (older * now >= 0) & (now * expected <= 0)
    closes &= (now * then <= 0) | (np.abs(then) < TURNED)
    if not closes.any():
        return None
    frame = int(closes.any(axis=1).argmax())
    shares = [
        _zero(now[frame, at], slope[frame, at], bend[frame, at])
        for at in np.flatnonzero(closes[frame])
    ]
    return float(times[frame + 2] + step * min(shares))


def _zero(now: float, slope: float, bend: float) -> float:
    """Find where a parabola first comes to 0 in a step."""
    found = np.roots([bend, slope, now])
    inside = found[(abs(found.imag) < SHUT) & (found.real >= 0) & (found.real <= 1)].real
    return float(inside.min()) if len(inside) else 1.0


def _ended(assembly: Assembly, poses: Array) -> int:
    """Count the joints that are none any more."""
    touch, holds = Geometry(assembly).touch(poses)
    return int((~holds | (touch.gap.min(axis=1) > APART)).sum())


def _sunk(poses: list[Array]) -> float:
    """How far a block's centre has sunk at most."""
    return float((poses[0][:, 1] - poses[-1][:, 1]).max())


def _words(what: str, recording: Recording, rocking: Rocking) -> str:
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
