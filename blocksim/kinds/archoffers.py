"""What is known of symmetric circular arches under their own weight."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from blocksim.arch import limit, theory
from blocksim.arch.answers import ArchAnswer, ArchBracket
from blocksim.arch.carried import carried_by_arch, standing_forces
from blocksim.arch.circular import ETA_MAX, Arch
from blocksim.arch.limit import LimitState
from blocksim.arch.modes import Mode, observed_mode
from blocksim.arch.theory import Critical
from blocksim.blocks.joints import JointState, ObservedJoint, closed_joints
from blocksim.blocks.problem import Problem
from blocksim.kinds.offers import Offers, Static
from blocksim.limit.carried import Carried
from blocksim.limit.exact import Exact
from blocksim.limit.proof import Proof, proof_of_fall, proof_of_rest
from blocksim.simulation.simulated import Reduced
from blocksim.simulation.verdict import Evidence, Verdict

if TYPE_CHECKING:
    from blocksim.arch.limit.mechanism import Mechanism
    from blocksim.kinds.circular import CircularArch
    from blocksim.simulation.observation import Observation

THINNEST = 1e-6
"""Search below this ratio is given up."""
TIMES = 0.5
"""Share above the least thickness from which on it is told how many times that it is."""
ANY_THICKNESS = "two joints on each half, and a line of thrust through the middle of both"


class ArchOffers(Offers):
    """What is known of an arch.

    `problem`: Of this arch, under its own weight.
    `maker`: What made it, and makes it of other ratios.
    """

    methods = ("limit", "theory")

    def __init__(self, arch: Arch, problem: Problem, maker: CircularArch) -> None:
        self.arch, self.problem, self.maker = arch, problem, maker

    @cached_property
    def built(self) -> LimitState:
        """The voussoirs as built at their least thickness."""
        arch = self.arch
        return limit.least_thickness(
            arch.half_angle, self.problem.mu, arch.voussoirs, arch.weight
        )

    @cached_property
    def continuous(self) -> Critical:
        """The continuous arch at its least thickness."""
        return theory.least_thickness(self.arch.half_angle, self.problem.mu, self.arch.weight)

    @cached_property
    def mechanism(self) -> Mechanism:
        """With which the voussoirs as built begin to fall."""
        # Its linear programmes take longer to load than an arch that stands to answer.
        from blocksim.arch.limit.mechanism import mechanism

        return mechanism(self.arch, self.problem.mu)

    @property
    def stands(self) -> bool | None:  # type: ignore[override]
        """Whether forces of equilibrium exist."""
        return self.built.stands_at(self.arch.eta)

    def static(self, method: str) -> Static | None:
        """Compare the thickness with the least one."""
        arch, joints = self.arch, closed_joints(self.arch.joint_angles)
        if method == "theory":
            verdict, said = _compare(arch.eta, self.continuous.eta, "of the continuous arch")
            mode = self.continuous.mode if verdict is Verdict.COLLAPSES else None
            found = Evidence("closed form", said)
            return Static(verdict=verdict, evidence=found, joints=joints, mode=mode)
        verdict, said = _compare(arch.eta, self.built.eta, "of the voussoirs as built")
        mode = None
        if verdict is Verdict.STANDS:
            spare = limit.slack(arch, self.problem.mu)
            friction = "" if math.isinf(self.problem.mu) else " and friction could both"
            said = f"{said}; thickness{friction or ' could'} be {spare:.2%} less"
        else:
            mode, joints = self.mechanism.mode, _limit_joints(self.mechanism)
        found = Evidence("limit analysis", said)
        return Static(verdict=verdict, evidence=found, joints=joints, mode=mode)

    def carried(self, joint: int | None = None) -> Carried | None:
        """Return what the arch carries."""
        return carried_by_arch(self.arch, self.problem, joint)

    def proof(self, exact: Exact) -> Proof | None:
        """Prove it by forces well within the arch, or by its mechanism."""
        arch, problem = self.arch, self.problem
        if self.built.stands_at(arch.eta):
            forces = standing_forces(arch, problem)
            return None if forces is None else proof_of_rest(exact, forces)
        from blocksim.arch.limit.mechanism import opening

        rates, owner = opening(arch, problem.mu, self.mechanism)
        in_size = arch.radius / problem.assembly.size
        return proof_of_fall(exact, rates * [in_size, in_size, 1.0], owner)

    def mode(self, joints: tuple[ObservedJoint, ...]) -> Mode | None:
        """Return which of the seven modes it is."""
        return observed_mode(joints, self.arch)

    def reduction(self) -> Reduced | None:
        """Return half of the arch, its voussoirs merged."""
        from blocksim.arch.reduction import Reduction

        return Reduction.of(self.arch, self.problem.mu, self.problem.assembly)

    def threshold(self, over: str) -> Thinning | None:
        """Return what is known of the least thickness."""
        return Thinning(self) if over == "thickness" else None

    def facts(self, **found: Any) -> ArchAnswer:
        """Return ratios and modes."""
        return ArchAnswer(shape=self.arch, **self.known, **found)

    @property
    def known(self) -> dict[str, Any]:
        """What is known of the arch at its least thickness."""
        return {
            "eta_limit": self.built.eta,
            "eta_theory": self.continuous.eta,
            "mode_limit": self.built.mode,
            "modes_theory": self.continuous.modes,
        }


class Thinning:
    """What is known of the thickness from which on an arch stands.

    The search is over its ratio to the radius, which `value` turns into the thickness. Ratios
    are tried on arches with a radius of 1 m: size and density say nothing of them.

    `name`, `low`, `high`: Of the ratio, and its range.
    `unit`: Of the thickness.
    `start`: Where a search begins.
    `exact`: The least ratio by statics; 0 where all stand, None where none does.
    `blocks`: How many there are.
    `reduced_by`: What a reduction does, in words.
    """

    name, unit = "eta", "m"
    low, high = THINNEST, ETA_MAX
    reduced_by = "symmetry and by merging"

    def __init__(self, offers: ArchOffers) -> None:
        arch = offers.arch
        self._offers, self.blocks = offers, arch.voussoirs
        self._arch = Arch(
            half_angle=arch.half_angle,
            eta=1.0,
            voussoirs=arch.voussoirs,
            weight=arch.weight,
            depth=arch.depth / arch.radius,
        )
        self.exact = offers.built.eta
        self.start = offers.built.eta or offers.continuous.eta or ETA_MAX

    def problem(self, value: float) -> Problem:
        """Return the arch of a thickness-to-radius ratio."""
        asked, maker = self._offers.problem, self._offers.maker
        built = maker.of(replace(self._arch, eta=value), friction=asked.mu).problem()
        return replace(built, gravity=asked.gravity)

    def value(self, number: float | None) -> float | None:
        """Return the thickness of a ratio [m]; the line that was measured stays."""
        if not number:
            return number
        return number * self._offers.maker.mean_radius(number)

    def reduction(self, value: float, last: Reduced | None) -> Reduced | None:
        """Return half of the arch; what moves at one thickness is the best guess."""
        from blocksim.arch.reduction import Reduction

        built = replace(self._arch, eta=value)
        if isinstance(last, Reduction):
            return last.at(built)
        return Reduction.of(built, self._offers.problem.mu)

    def static(self, method: str) -> tuple[float | None, float | None, str]:
        """Return the largest ratio that falls, the least that stands, and what tells it."""
        if method == "theory":
            least = self._offers.continuous.eta
            return (
                ETA_MAX if least is None else least,
                least,
                "closed form of the continuous arch",
            )
        said = "static limit analysis of the voussoirs as built"
        said += f": {ANY_THICKNESS}" if self.exact == 0 else ""
        # Where any thickness stands none collapses.
        return ETA_MAX if self.exact is None else self.exact or None, self.exact, said

    def facts(
        self,
        *,
        low: float | None,
        high: float | None,
        method: str,
        seen: Observation | None = None,
    ) -> ArchBracket:
        """Return ratios, modes, thrust and hinges.

        `low`, `high`: Ratios that fell and that stood.
        `seen`: What an engine showed of the one that fell.
        """
        known, angle = self._offers.known, self._arch.half_angle
        if method == "theory":
            least = self._offers.continuous
            known |= {"mode": least.mode, "thrust": least.thrust}
            known |= {"beta_r": least.beta_r, "beta_s": least.beta_s}
        elif method == "limit":
            built = self._offers.built
            known |= {"mode": built.mode, "thrust": built.thrust}
            known["beta_r"] = _inner(built.hinges_intrados)
            known["beta_s"] = _inner(tuple(x for x in built.slides if x < angle))
        elif seen is not None:
            known["mode"] = observed_mode(seen.joints, self._arch)
            known["mode_in_motion"] = observed_mode(seen.joints_in_motion, self._arch)
        return ArchBracket(shape=self._offers.arch, eta_low=low, eta_high=high, **known)


def _inner(angles: tuple[float, ...]) -> float | None:
    return angles[0] if angles else None


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


def _limit_joints(found: Mechanism) -> tuple[ObservedJoint, ...]:
    """Tell what the joints of a mechanism do."""
    # What turns about the extrados opens at the inner end.
    return tuple(
        ObservedJoint(
            angle=angle, state=JointState.of(inner=outside, outer=inside, slides=any(slides))
        )
        for angle, (outside, inside, *slides) in zip(
            found.angles.tolist(), found.active.tolist(), strict=True
        )
    )
