"""Does it stand? The question, asked of any method."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from blocksim import limit, theory
from blocksim.arch import Arch, require_friction, require_lean
from blocksim.joints import JointState, ObservedJoint, closed_joints
from blocksim.ladder import choose, chosen_words
from blocksim.modes import Mode
from blocksim.progress import Progress, silent
from blocksim.setup import BY_RULE, Overrides
from blocksim.trial import trial
from blocksim.verdict import Verdict


@dataclass(frozen=True, kw_only=True)
class Check:
    """Answer to *does it stand*, with its evidence.

    Parameters
    ----------
    method : str
    verdict : Verdict
    reason : str
        A sentence.
    arch : Arch
    mu : float
    lean : float
        Angle by which gravity leans out of the plane [rad].
    eta_limit, eta_theory : float or None
        Least thickness of the voussoirs as built and of the continuous arch; None where
        no thickness up to 2 stands.
    mode : Mode or None
        How it collapses; None where it stands or the joints form none of the modes.
    joints : tuple of ObservedJoint
        From the left springing to the right.
    simulated : float or None
        Time simulated [sqrt(r/g)]; None for static methods.
    state_hash : str or None
        Fingerprint of the recorded motion.
    blocks, splits : int or None
        Blocks simulated, and joints that `reduce` merged and had to split again; None
        for static methods.
    wall_s : float
        Seconds it took.
    """

    method: str
    verdict: Verdict
    reason: str
    arch: Arch
    mu: float
    lean: float
    eta_limit: float | None
    eta_theory: float | None
    mode: Mode | None
    joints: tuple[ObservedJoint, ...]
    simulated: float | None
    state_hash: str | None
    blocks: int | None
    splits: int | None
    wall_s: float


def check(
    arch: Arch,
    *,
    mu: float,
    method: str = "auto",
    lean: float = 0.0,
    settings: Overrides = BY_RULE,
    reduce: bool = False,
    progress: Progress = silent,
) -> Check:
    """Tell whether an arch stands under its own weight.

    Parameters
    ----------
    arch : Arch
    mu : float
        Friction coefficient, above 0, inf allowed.
    method : str
        `auto`, `theory`, `limit`, or the name of an engine.
    lean : float
        Angle by which gravity leans out of the plane [rad]; `eta_limit` and `eta_theory`
        are those without it.
    settings : mapping of str to float
        Of `blocksim.setup.SETTINGS`, instead of what the engine's rule says.
    reduce : bool
        Simulate no more blocks than it takes (`blocksim.reduction`).
    progress : Progress, optional

    Returns
    -------
    Check

    Raises
    ------
    InputError
        If a value is out of range or the method is unknown.
    MissingPart
        If the engine's library is not installed.
    """
    started = time.perf_counter()
    require_friction(mu)
    require_lean(lean)
    spatial = lean != 0
    rung = choose(method, spatial=spatial, settings=settings, reduce=reduce)
    built = limit.least_thickness(arch.half_angle, mu, arch.voussoirs, arch.weight)
    continuous = theory.least_thickness(arch.half_angle, mu, arch.weight)
    closed = closed_joints(arch)
    simulated = state_hash = blocks = splits = None
    if rung.name == "theory":
        verdict, reason = _compare(arch.eta, continuous.eta, "of the continuous arch")
        mode = continuous.mode if verdict is Verdict.COLLAPSES else None
        joints = closed
    elif rung.name == "limit":
        verdict, reason = _static(arch, mu, built.eta)
        falls = verdict is Verdict.COLLAPSES
        mode = built.mode if falls else None
        joints = _limit_joints(arch, built) if falls else closed
    else:
        seen = trial(
            arch,
            mu,
            rung.name,
            lean=lean,
            settings=settings,
            reduce=reduce,
            progress=progress,
        )
        verdict, reason, mode, joints = seen.verdict, seen.reason, seen.mode, seen.joints
        simulated = seen.motion.recording.times[-1] if seen.motion else 0.0
        state_hash = seen.motion.recording.state_hash if seen.motion else None
        blocks, splits = seen.blocks, seen.splits
    return Check(
        method=rung.name,
        verdict=verdict,
        reason=reason + chosen_words(method, rung),
        arch=arch,
        mu=mu,
        lean=lean,
        eta_limit=built.eta,
        eta_theory=continuous.eta,
        mode=mode,
        joints=joints,
        simulated=simulated,
        state_hash=state_hash,
        blocks=blocks,
        splits=splits,
        wall_s=time.perf_counter() - started,
    )


def _compare(eta: float, least: float | None, whose: str) -> tuple[Verdict, str]:
    if least is None:
        return Verdict.COLLAPSES, f"no thickness up to eta = 2 {whose} stands at this friction"
    share = eta / least - 1
    verdict = Verdict.STANDS if share >= 0 else Verdict.COLLAPSES
    side = "above" if share >= 0 else "below"
    return verdict, f"eta is {abs(share):.2%} {side} the least thickness {whose}, {least:.6g}"


def _static(arch: Arch, mu: float, least: float | None) -> tuple[Verdict, str]:
    """Apply the static theorem to the arch; the least thickness only words the reason."""
    verdict = Verdict.STANDS if limit.stands(arch, mu) else Verdict.COLLAPSES
    _, reason = _compare(arch.eta, least, "of the voussoirs as built")
    if verdict is Verdict.STANDS:
        spare = limit.slack(arch, mu)
        reason = f"{reason}; {spare:.2%} of thickness and friction could be taken away"
    return verdict, reason


def _limit_joints(arch: Arch, state: limit.LimitState) -> tuple[ObservedJoint, ...]:
    """Joints that turn or slide at the least thickness, mirrored onto both halves."""

    def among(angle: float, places: tuple[float, ...]) -> bool:
        return any(math.isclose(abs(angle), place, abs_tol=1e-9) for place in places)

    def joint_state(angle: float) -> JointState:
        turns_inside = among(angle, state.hinges_intrados)
        turns_outside = among(angle, state.hinges_extrados)
        if turns_inside and turns_outside:
            return JointState.OPEN
        if among(angle, state.slides):
            turns = turns_inside or turns_outside
            return JointState.HINGE_AND_SLIDES if turns else JointState.SLIDES
        if turns_inside:
            return JointState.HINGE_INTRADOS
        return JointState.HINGE_EXTRADOS if turns_outside else JointState.CLOSED

    return tuple(
        ObservedJoint(angle=float(angle), state=joint_state(float(angle)))
        for angle in arch.joint_angles
    )
