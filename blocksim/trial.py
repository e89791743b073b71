"""One arch in one engine: onset test, moving run, and what they show together."""

from __future__ import annotations

from dataclasses import dataclass

from blocksim.arch import Arch, require_friction
from blocksim.engines import ENGINES
from blocksim.errors import InputError
from blocksim.joints import ObservedJoint, classify, closed_joints, observed_mode
from blocksim.ladder import choose
from blocksim.modes import Mode
from blocksim.motion import Motion, moving_run
from blocksim.onset import Onset, onset
from blocksim.progress import Progress, silent
from blocksim.recording import Recording
from blocksim.setup import Setup
from blocksim.verdict import Verdict


@dataclass(frozen=True, kw_only=True, eq=False)
class Trial:
    """What an engine showed of one arch.

    Parameters
    ----------
    verdict : Verdict
        Undecided unless onset test and moving run agree, or only the first was asked for.
    reason : str
        The evidence, and which kind it is.
    onset : Onset
    motion : Motion or None
        None where the arch was not let go.
    joints : tuple of ObservedJoint
    mode : Mode or None
    """

    verdict: Verdict
    reason: str
    onset: Onset
    motion: Motion | None
    joints: tuple[ObservedJoint, ...]
    mode: Mode | None


def trial(
    arch: Arch, mu: float, engine: str, *, moving: bool = True, progress: Progress = silent
) -> Trial:
    """Put an arch into an engine: onset test, then, if asked for, the moving run.

    Parameters
    ----------
    arch : Arch
    mu : float
    engine : str
    moving : bool
        Let the arch go after the onset test. It is not let go where that test is
        undecided: unbalanced impulses would throw it.
    progress : Progress, optional

    Returns
    -------
    Trial
    """
    setup = Setup.of(arch, mu, engine)
    world = setup.world()
    first = onset(world, setup.assembly, setup.settings, progress)
    verdict, reason, motion = first.verdict, first.reason, None
    if moving and verdict is not Verdict.UNDECIDED:
        motion = moving_run(setup, world, first.sweeps, progress=progress)
        reason = f"onset test: {first.reason}; moving run: {motion.reason}"
        if motion.verdict is not verdict:
            verdict = Verdict.UNDECIDED
    joints, mode = closed_joints(arch), None
    if verdict is Verdict.COLLAPSES:
        joints = classify(setup.assembly, motion.mechanism if motion else first.mechanism)
        mode = observed_mode(joints, arch.half_angle, arch.voussoirs)
    return Trial(
        verdict=verdict, reason=reason, onset=first, motion=motion, joints=joints, mode=mode
    )


def simulate(
    arch: Arch,
    *,
    mu: float,
    method: str,
    duration: float | None = None,
    progress: Progress = silent,
) -> Recording:
    """Let an arch go in an engine, after the onset test, and record it.

    Parameters
    ----------
    arch : Arch
    mu : float
        Friction coefficient, above 0, inf allowed.
    method : str
        Name of an engine.
    duration : float, optional
        Time to record [sqrt(r/g)]; by default until the verdict is certain.
    progress : Progress, optional

    Returns
    -------
    Recording

    Raises
    ------
    InputError
        If a value is out of range, or the method moves nothing.
    MissingPart
        If the engine's library is not installed.
    """
    require_friction(mu)
    if choose(method).is_static:
        raise InputError("method", method, f"one of {', '.join(ENGINES)}: others move nothing")
    setup = Setup.of(arch, mu, method)
    world = setup.world()
    first = onset(world, setup.assembly, setup.settings, progress)
    return moving_run(setup, world, first.sweeps, until=duration, progress=progress).recording
