"""The moving run: let the arch go and watch.

It is released from the impulses the onset test ended with, and recorded: every `FRAME`, or
every `SPARSE` frames while nothing moves and only a verdict is asked for. What is said of
it rests on the largest displacement d of any corner, in units of r, and on time in units
of sqrt(r/g):

- *collapses* as soon as d > `MOVED`;
- *stands* if d < `rest` of the settings at time `QUIET`, or, from time `SOONEST` on, if d is
  less than what such a rest allows by then, which grows as time squared: the way of a block
  under an acceleration that would just show at `QUIET`. Near the limit an unstable arch
  starts slowly, but with the rest of 1e-5 of an impulse engine an acceleration of 1e-6 g
  shows even if it stays what it is, as where joints slide; where they turn it grows;
- otherwise it is watched until `LONGEST` and is then *undecided*: it gave way and rests again,
  or swings about another place, which is neither; it creeps if its displacement grew less than
  threefold over the second half (steady drift doubles it); or else it starts too slowly.

A run whose blocks overlap before it has moved by `EARLY`, by more than `OVERLAP` of the
motion of their joints, was started by contacts that had not converged. It is thrown away
and repeated with `FINER` times the sweeps in each step; after `repeats` of the settings it is
undecided. Likewise is one that falls where the onset test has found rest, and no motion
besides: in Bullet walls creep apart whose contacts want more sweeps. Where rest was found a run
is watched until `QUIET` only: what does not rest by then will not.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic

import numpy as np

from blocksim.blocks.assembly import Array, Assembly, Blocks
from blocksim.common.progress import Progress, silent
from blocksim.engines.base import Quality, Settings, World, trusted
from blocksim.simulation.onset import ROUNDING, UNFOUND
from blocksim.simulation.recording import Recording
from blocksim.simulation.simulated import Simulation
from blocksim.simulation.verdict import Verdict

if TYPE_CHECKING:
    from blocksim.blocks.space.assembly import SpatialAssembly

MOVED = 2e-3
QUIET, SOONEST = 5.0, 1.0
LONGEST = 40.0
CREEP = 3.0
OVERLAP = 0.03
FINER = 4
FRAME = 0.05
"""Time between frames."""
SPARSE, UNMOVED = 4, 1e-5
"""Frames in one while nothing has moved by that; it may not have passed `EARLY` after them."""
AT_REST, UNSEEN = 40, 1e-3
"""Frames in which what has collapsed moves by no more than that, which nobody sees: it lies
still. Piles of impulse engines go on trembling by a tenth of it."""
EARLY = 3e-4
"""Displacement at which the motion still is the collapse mechanism."""
FAR = 0.02
"""Displacement from which it is not: an overlap seen first then may be of other joints."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion(Generic[Blocks]):
    """Outcome of a moving run.

    `reason`: The evidence in words.
    `overlap`: Deepest overlap of blocks, as a share of the motion of their joints.
    """

    verdict: Verdict
    reason: str
    overlap: float
    recording: Recording[Blocks]

    @property
    def mechanism(self) -> Array:
        """Poses when the motion first exceeds `EARLY`, or at the end."""
        late = np.flatnonzero(self.recording.displacement > EARLY)
        return self.recording.poses[late[0] if len(late) else -1]


def moving_run(
    simulation: Simulation[Blocks],
    held: World,
    repeat: Callable[[World], None],
    *,
    rests: bool = False,
    until: float | None = None,
    progress: Progress = silent,
) -> Motion[Blocks]:
    """Let an arch go that the onset test has held, and record it.

    `held`: Built from it and at rest, impulses converged as far as they go.
    `repeat`: Holds another world of it likewise, if the run must be repeated.
    `rests`: Whether the onset test has found rest, and no motion besides.
    `until`: Time to record for [sqrt(r/g)], or until what has collapsed lies still; by default
        the run stops as soon as its verdict is certain.
    """
    left = simulation.settings.repeats
    motion = _released(simulation, held, until, progress, rests=rests, last=not left)
    while left and (
        motion.overlap > OVERLAP or (rests and motion.verdict is Verdict.COLLAPSES)
    ):
        left -= 1
        simulation = simulation.finer(FINER)
        again = simulation.world()
        repeat(again)
        motion = _released(simulation, again, until, progress, rests=rests, last=not left)
    return motion


def _released(
    simulation: Simulation[Blocks],
    world: World,
    until: float | None,
    progress: Progress,
    *,
    rests: bool,
    last: bool,
) -> Motion[Blocks]:
    """Record one release, as far as its blocks do not overlap, nor fall that should rest."""
    step, rest, look = simulation.settings.step, simulation.settings.rest, simulation.look
    stride, assembly = max(1, round(FRAME / step)), simulation.assembly
    taken = 0
    times, poses, moved = [0.0], [world.poses()], [0.0]
    end = (QUIET if rests else LONGEST) if until is None else until
    overlap = 0.0
    while times[-1] < end - step / 2 and overlap <= OVERLAP:
        # Before anything moves a verdict needs no frames, and some engines longer steps.
        frames = SPARSE if until is None and is_early(times, moved) else 1
        world.advance(frames * stride)
        taken += frames * stride
        times.append(taken * step)
        poses.append(world.poses())
        moved.append(float(assembly.displacement(poses[-1] - poses[0])))
        # What goes far at once is no longer the mechanism: the engine tells of its overlaps.
        told = moved[-1] > FAR and world.quality().penetration is not None
        if moved[-1] > simulation.settings.noise and moved[-2] < EARLY and not told:
            overlap = max(overlap, look.overlap(poses[-1]))
        if until is None and verdict_of(times, moved, rest) is not Verdict.UNDECIDED:
            break
        fallen = until is not None and moved[-1] > MOVED
        if fallen and ((rests and not last) or lie_still(assembly, poses)):
            break
        progress(min(1.0, times[-1] / end), "moving run")
    verdict = verdict_of(times, moved, rest) if overlap <= OVERLAP else Verdict.UNDECIDED
    reason = words_of(verdict, times, moved, overlap, simulation.length)
    quality = world.quality()
    if not trusted(world, simulation.settings):
        verdict = Verdict.UNDECIDED
        reason = "released, " + distrust(quality, simulation.settings, simulation.length)
    return Motion(
        verdict=verdict,
        reason=reason,
        overlap=overlap,
        recording=simulation.record(times, poses, quality),
    )


def lie_still(assembly: Assembly | SpatialAssembly, poses: list[Array]) -> bool:
    """Tell whether blocks have hardly moved for a while."""
    if len(poses) <= AT_REST:
        return False
    last = np.array(poses[-1 - AT_REST :])
    return float(assembly.displacement(last - last[-1]).max()) < UNSEEN


def distrust(quality: Quality, settings: Settings, length: str) -> str:
    """Say why contacts cannot be trusted."""
    residual, penetration = quality.residual, quality.penetration
    if residual is not None and not math.isfinite(residual):
        return UNFOUND
    if residual is not None and not residual <= settings.residual:
        return f"a contact was left with a residual of {residual:.1e}"
    return f"blocks overlap by {penetration:.1e} {length}"


def is_early(times: list[float], moved: list[float]) -> bool:
    """Tell whether blocks that go on as they did stay within `EARLY` for `SPARSE` frames."""
    if len(moved) == 1 or moved[-1] < UNMOVED:
        return len(moved) > 1
    ahead = SPARSE * FRAME / (times[-1] - times[-2])
    return moved[-1] ** (1 + ahead) < EARLY * min(moved[-2:]) ** ahead


def verdict_of(times: list[float], moved: list[float], rest: float) -> Verdict:
    """Return what the largest displacements at these times show."""
    if moved[-1] > MOVED:
        return Verdict.COLLAPSES
    if times[-1] >= SOONEST and moved[-1] < rest * min(1.0, times[-1] / QUIET) ** 2:
        return Verdict.STANDS
    return Verdict.UNDECIDED


def words_of(
    verdict: Verdict, times: list[float], moved: list[float], overlap: float, length: str
) -> str:
    """Say what displacements at these times show."""
    way = f"{moved[-1]:.1e} {length} in {times[-1]:.1f} sqrt({length}/g)"
    if verdict is Verdict.COLLAPSES:
        return f"released, it moved {way}"
    if verdict is Verdict.STANDS:
        if moved[-1] < ROUNDING:
            return f"released, it did not move in {times[-1]:.1f} sqrt({length}/g)"
        return f"released, it stayed within {way}"
    if overlap > OVERLAP:
        return f"released, its blocks overlap by {overlap:.0%} of their motion: {way}"
    halfway = moved[int(np.searchsorted(times, times[-1] / 2))]
    if moved[-1] - halfway < UNMOVED < halfway:
        return f"released, it gave way and came to rest again: {way}"
    if (np.maximum.accumulate(moved) - moved).max() > UNMOVED:
        return f"released, it gave way and swings about another place: {way}"
    if moved[-1] < CREEP * halfway:
        return f"released, it creeps: {way}"
    return f"released, it starts too slowly to tell: {way}"
