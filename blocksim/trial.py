"""One arch in one engine: onset test, moving run, and what they show together."""

from __future__ import annotations

from dataclasses import dataclass

from blocksim.arch import Arch, require_friction, require_lean
from blocksim.assembly import Array
from blocksim.engines.base import World
from blocksim.joints import ObservedJoint, classify, closed_joints, observed_mode
from blocksim.ladder import choose
from blocksim.modes import Mode
from blocksim.motion import Motion, moving_run
from blocksim.onset import Onset, onset
from blocksim.progress import Progress, silent
from blocksim.recording import Recording
from blocksim.reduction import Reduction
from blocksim.setup import BY_RULE, Overrides, Setup, given_words
from blocksim.verdict import Verdict


@dataclass(frozen=True, kw_only=True, eq=False)
class Held:
    """An arch in an engine after the onset test: at rest, and ready to be let go once.

    Parameters
    ----------
    setup : Setup
    world : World
    onset : Onset
    splits : int
        Joints of a reduction that turned out to move.
    """

    setup: Setup
    world: World
    onset: Onset
    splits: int = 0

    def release(self, until: float | None = None, progress: Progress = silent) -> Motion:
        """Let the arch go; see `moving_run`."""
        repeat = self.onset.repeat
        return moving_run(self.setup, self.world, repeat, until=until, progress=progress)


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
        As it starts to move, at the onset. Empty where gravity leans out of the plane and
        the arch collapses: their states are those of motion in the plane.
    mode : Mode or None
        Of the mechanism it starts with: that of the onset test, by these joints.
    mode_in_motion : Mode or None
        Of the moving run when it has moved by `motion.EARLY`. By then a joint that slides
        may turn as well, and others may have joined in; None where it was not let go.
    blocks, splits : int
        Blocks that were simulated, and joints that a reduction had to split again.
    """

    verdict: Verdict
    reason: str
    onset: Onset
    motion: Motion | None
    joints: tuple[ObservedJoint, ...]
    mode: Mode | None
    mode_in_motion: Mode | None
    blocks: int
    splits: int


def trial(
    arch: Arch,
    mu: float,
    engine: str,
    *,
    moving: bool = True,
    lean: float = 0.0,
    settings: Overrides = BY_RULE,
    reduce: bool = False,
    progress: Progress = silent,
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
    lean : float
        As in `Settings`, for engines in three dimensions.
    settings : mapping of str to float
        Given instead of what the engine's rule says.
    reduce : bool
        Simulate no more blocks than it takes (`blocksim.reduction`); not out of the plane.
    progress : Progress, optional

    Returns
    -------
    Trial
    """
    held = hold(
        arch,
        mu,
        engine,
        lean=lean,
        settings=settings,
        reduction=Reduction.of(arch, mu) if reduce else None,
        progress=progress,
    )
    return conclude(held, moving=moving, progress=progress)


def hold(
    arch: Arch,
    mu: float,
    engine: str,
    *,
    lean: float = 0.0,
    settings: Overrides = BY_RULE,
    reduction: Reduction | None = None,
    progress: Progress = silent,
) -> Held:
    """Do the first part of a trial: put the arch into the engine, and the onset test.

    With a reduction that is done again until no joint would move of those taken not to,
    and with all voussoirs where a keystone would not stay in the plane of symmetry.
    """
    splits = 0
    while True:
        setup = Setup.of(
            arch,
            mu,
            engine,
            lean=lean,
            settings=settings,
            reduction=reduction,
        )
        world = setup.world()
        friction = min(mu, setup.engine.most_friction)
        first = onset(
            world,
            setup.assembly,
            friction,
            setup.settings,
            progress,
            simulated=setup.simulated,
        )
        if reduction and (first.may_rest or first.verdict is not Verdict.UNDECIDED):
            resultants = world.resultants()
            moving = reduction.overstrained(resultants, friction, setup.settings.still)
            # Large blocks move where they may rest sooner than the voussoirs they are made of.
            if first.may_rest or reduction.parts(resultants):
                reduction, splits = None, 0
                continue
            if moving:
                reduction, splits = reduction.split(moving), splits + len(moving)
                continue
        return Held(setup=setup, world=world, onset=first, splits=splits)


def conclude(held: Held, *, moving: bool, progress: Progress = silent) -> Trial:
    """Do the second part of a trial: the moving run if asked for, and what all of it shows."""
    setup, first = held.setup, held.onset
    arch, lean = setup.arch, setup.settings.lean
    verdict, reason, motion = first.verdict, first.reason, None
    if moving and verdict is not Verdict.UNDECIDED:
        motion = held.release(progress=progress)
        reason = f"onset test: {first.reason}; moving run: {motion.reason}"
        if motion.verdict is not verdict:
            verdict = Verdict.UNDECIDED
    reason += _asides(held, motion) + given_words(setup.given)
    joints, mode, later = closed_joints(arch), None, None
    if lean and verdict is Verdict.COLLAPSES:
        joints = ()  # their states are those of motion in the plane
    elif verdict is Verdict.COLLAPSES:
        joints, mode = _seen(setup, first.mechanism)
        later = _seen(setup, motion.mechanism)[1] if motion else None
    return Trial(
        verdict=verdict,
        reason=reason,
        onset=first,
        motion=motion,
        joints=joints,
        mode=mode,
        mode_in_motion=later,
        blocks=setup.blocks,
        splits=held.splits,
    )


def _seen(setup: Setup, poses: Array) -> tuple[tuple[ObservedJoint, ...], Mode | None]:
    """Read joints and mode from where the blocks of an arch have moved."""
    joints = classify(setup.assembly, poses)
    return joints, observed_mode(joints, setup.arch.half_angle, setup.arch.voussoirs)


def _asides(held: Held, motion: Motion | None) -> str:
    """Tell what else there is to know of a trial."""
    setup = held.setup
    said: list[str] = []
    if setup.reduction:
        said.append(reduced_words(setup.blocks, setup.arch.voussoirs, held.splits))
    if setup.settings.lean and motion:
        said.append(f"moved {motion.recording.beyond_plane[-1]:.1e} r out of its plane")
    if motion and setup.unsure:
        said.append(setup.unsure)
    if setup.mu > setup.engine.most_friction:
        said.append(f"{setup.engine.name} took {setup.engine.most_friction:g} as friction")
    return "".join(f"; {each}" for each in said)


def reduced_words(blocks: int, voussoirs: int, splits: int) -> str:
    """Tell what a reduction has come to."""
    return (
        "reduced by symmetry and by merging "
        f"(blocks: {blocks} of {voussoirs}, joints split again: {splits})"
    )


def simulate(
    arch: Arch,
    *,
    mu: float,
    method: str,
    duration: float | None = None,
    lean: float = 0.0,
    settings: Overrides = BY_RULE,
    progress: Progress = silent,
) -> Recording:
    """Let an arch go in an engine, after the onset test, and record it.

    Parameters
    ----------
    arch : Arch
    mu : float
        Friction coefficient, above 0, inf allowed.
    method : str
        An engine, or `auto`.
    duration : float, optional
        Time to record [sqrt(r/g)]; by default until the verdict is certain.
    lean : float
        Angle by which gravity leans out of the plane [rad].
    settings : mapping of str to float
        Of `blocksim.setup.SETTINGS`, instead of what the engine's rule says.
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
    require_lean(lean)
    rung = choose(method, spatial=lean != 0, moving=True, settings=settings)
    held = hold(
        arch,
        mu,
        rung.name,
        lean=lean,
        settings=settings,
        progress=progress,
    )
    return held.release(duration, progress).recording
