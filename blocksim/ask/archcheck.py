"""Does it stand? The question, asked of any method."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from blocksim.arch import limit, theory
from blocksim.arch.carried import carried_by_arch
from blocksim.arch.circular import Arch
from blocksim.arch.modes import Mode
from blocksim.arch.observed import observed_mode
from blocksim.ask.check import Check, observed_joints
from blocksim.ask.methods import choose, chosen_words, reduces
from blocksim.ask.rest import require_rest, rest_of
from blocksim.blocks.joints import JointState, ObservedJoint, closed_joints
from blocksim.common.checks import FRICTION
from blocksim.common.progress import Progress, silent
from blocksim.evidence.simulation import BY_RULE, Overrides
from blocksim.evidence.verdict import Verdict
from blocksim.kinds.circular import arch_problem
from blocksim.limit import equilibrium
from blocksim.limit.carried import Carried

if TYPE_CHECKING:
    from blocksim.arch.limit import LimitState
    from blocksim.arch.limit.mechanism import Mechanism
    from blocksim.limit.proof import Proof

TIMES = 0.5
"""Share above the least thickness from which on it is told how many times that it is."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ArchCheck(Check):
    """What a check says of an arch; its joints go from the left springing to the right.

    Parameters
    ----------
    arch : Arch
    mu : float
    lean : float
        Angle by which gravity leans out of the plane [rad].
    eta_limit, eta_theory : float or None
        Least thickness over radius, of the voussoirs as built and of the continuous arch. It is
        0 where any thickness stands (some arches of three voussoirs), and None where no
        thickness up to 2 stands.
    mode : Mode or None
        How this arch starts to collapse. An engine takes it from the mechanism of the onset
        test, `limit` from eqs (15) and (16). `theory` knows the mode at the least thickness
        only, and gives that. None where the arch stands, or where its joints form none of the
        modes.
    mode_in_motion : Mode or None
        As seen in the moving run after a displacement of `motion.EARLY`; see `Observation`.
    mode_limit : Mode or None
        Mode of the voussoirs as built at their least thickness, where `mode` may be another.
        Where no thickness up to 2 stands, it is the mode at 2.
    modes_theory : tuple of Mode
        Modes of the continuous arch at its least thickness: several on a line of the map, where
        they coincide.
    """

    arch: Arch
    mu: float
    lean: float
    eta_limit: float | None
    eta_theory: float | None
    mode: Mode | None
    mode_in_motion: Mode | None
    mode_limit: Mode | None
    modes_theory: tuple[Mode, ...]

    @property
    def mode_theory(self) -> Mode:
        """The first of `modes_theory`."""
        return self.modes_theory[0]

    @cached_property
    def proof(self) -> Proof | None:  # type: ignore[override]
        """The proof of the verdict by limit analysis; None where there is none."""
        if self.method != "limit":
            return None
        from blocksim.limit.proof import proof_of_rest

        problem, found = arch_problem(self.arch, self.mu), None
        if self.carried is not None and self.carried.forces is not None:
            found = proof_of_rest(problem, self.carried.forces)
        if found is None:
            found = equilibrium(problem).proof
        return found if found is not None and found.claim == self.verdict.value else None

    @cached_property
    def carried(self) -> Carried | None:
        """What the arch carries; None where gravity leans."""
        return (
            None if self.lean else carried_by_arch(self.arch, arch_problem(self.arch, self.mu))
        )

    def __repr__(self) -> str:
        arch = self.arch
        return (
            f"ArchCheck({self.verdict}, by {self.method}, half_angle={arch.half_angle:g}, "
            f"eta={arch.eta:g}, mu={self.mu:g}, voussoirs={arch.voussoirs})"
        )


def check(
    arch: Arch,
    *,
    mu: float,
    method: str = "auto",
    lean: float = 0.0,
    settings: Overrides = BY_RULE,
    reduce: bool | None = None,
    must_rest: bool = False,
    progress: Progress = silent,
) -> ArchCheck:
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
        Settings that replace those of the engine's rule;
        `blocksim.evidence.simulation.SETTINGS` has their names.
    reduce : bool, optional
        Simulate half of the arch, and voussoirs that stay together as one block
        (`blocksim.arch.reduction`). By default the engine decides (`Engine.reduces`); not where
        gravity leans out of the plane.
    must_rest : bool
        Find out as well whether it must rest, or friction may let it move
        (`blocksim.ask.check`). This is asked of the voussoirs as built, whatever the method.
    progress : Progress, optional

    Returns
    -------
    ArchCheck

    Raises
    ------
    InputError
        If a value is out of range or the method is unknown.
    MissingPart
        If the engine's library is not installed.
    """
    started = time.perf_counter()
    FRICTION.require("mu", mu)
    # Static methods need no blocks, which take longer to make than an answer.
    leaning = arch_problem(arch, mu, lean) if lean else None
    rung = choose(method, problem=leaning, settings=settings, reduce=reduce)
    if must_rest:
        require_rest(arch_problem(arch, mu, lean))
    built = limit.least_thickness(arch.half_angle, mu, arch.voussoirs, arch.weight)
    continuous = theory.least_thickness(arch.half_angle, mu, arch.weight)
    mode = later = seen = None
    joints = closed_joints(arch.joint_angles)
    if rung.name == "theory":
        verdict, reason = _compare(arch.eta, continuous.eta, "of the continuous arch")
        mode = continuous.mode if verdict is Verdict.COLLAPSES else None
    elif rung.name == "limit":
        verdict, reason = _static(arch, mu, built)
        if verdict is Verdict.COLLAPSES:
            # Its linear programmes take longer to load than an arch that stands to answer.
            from blocksim.arch.limit.mechanism import mechanism

            found = mechanism(arch, mu)
            mode, joints = found.mode, _limit_joints(found)
    else:
        # What moves blocks is loaded where it is asked for.
        from blocksim.arch.reduction import Reduction
        from blocksim.evidence.observation import observe

        reduced = reduces(rung, reduce, is_planar=not lean)
        seen = observe(
            leaning or arch_problem(arch, mu),
            rung.name,
            settings=settings,
            reduction=Reduction.of(arch, mu) if reduced else None,
            progress=progress,
        )
        verdict, reason, joints = seen.verdict, seen.reason, seen.joints
        mode = observed_mode(joints, arch)
        later = observed_mode(seen.joints_in_motion, arch)
    rest, motion = rest_of(
        arch_problem(arch, mu) if must_rest else None,
        exists=None if lean else built.stands_at(arch.eta),
        moved=seen is not None and seen.moved,
        progress=progress,
    )
    if motion is not None:
        joints = observed_joints(arch_problem(arch, mu), motion.accelerations)
    return ArchCheck(
        method=rung.name,
        verdict=verdict,
        reason=reason + chosen_words(method, rung),
        arch=arch,
        mu=mu,
        lean=lean,
        eta_limit=built.eta,
        eta_theory=continuous.eta,
        mode=mode,
        mode_in_motion=later,
        mode_limit=built.mode,
        modes_theory=continuous.modes,
        rest=rest,
        asked_rest=must_rest,
        motion=motion,
        joints=joints,
        simulated=seen and seen.simulated,
        state_hash=seen and seen.state_hash,
        blocks=seen and seen.blocks,
        splits=seen and seen.splits,
        wall_s=time.perf_counter() - started,
    )


def _compare(eta: float, least: float | None, whose: str) -> tuple[Verdict, str]:
    if least is None:
        return Verdict.COLLAPSES, f"no thickness up to eta = 2 {whose} stands at this friction"
    if least == 0:
        return Verdict.STANDS, f"any thickness {whose} stands at this friction"
    share = eta / least - 1
    verdict = Verdict.STANDS if share >= 0 else Verdict.COLLAPSES
    side = "above" if share >= 0 else "below"
    if share > TIMES:
        return verdict, f"eta is {1 + share:.5g} times the least thickness {whose}, {least:.6g}"
    return verdict, f"eta is {abs(share):.2%} {side} the least thickness {whose}, {least:.6g}"


def _static(arch: Arch, mu: float, built: LimitState) -> tuple[Verdict, str]:
    """Apply the static theorem to the arch, and tell what it has to spare."""
    verdict, reason = _compare(arch.eta, built.eta, "of the voussoirs as built")
    if verdict is Verdict.STANDS:
        spare = limit.slack(arch, mu)
        reason = f"{reason}; {spare:.2%} of thickness and friction could be taken away"
    return verdict, reason


def _limit_joints(found: Mechanism) -> tuple[ObservedJoint, ...]:
    """Tell what the joints of a mechanism do."""

    def state(outside: bool, inside: bool, *slides: bool) -> JointState:
        if outside and inside:
            return JointState.OPEN
        if any(slides):
            return JointState.HINGE_AND_SLIDES if outside or inside else JointState.SLIDES
        if inside:
            return JointState.HINGE_INTRADOS
        return JointState.HINGE_EXTRADOS if outside else JointState.CLOSED

    return tuple(
        ObservedJoint(angle=angle, state=state(*row))
        for angle, row in zip(found.angles.tolist(), found.active.tolist(), strict=True)
    )
