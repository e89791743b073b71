"""What the chart refines, from coarse to fine, and what an engine then says of an arch.

Most are settings of the onset test. Two are of a *moving run alone*, which is what users of
an engine do who have no such test: the arch is let go at once, with impulses that nothing has
found yet, and stands if it has not moved. What counts as moved, and how long is waited, are
those of `motion`; an arch that has neither fallen by then nor been seen to rest stands here.

Work is counted as it is asked for. pybullet ends the sweeps of a step early where they change
next to nothing; the steps in which mujoco's contacts take up the weight are left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from blocksim.arch.circular import Arch
from blocksim.ask.methods import METHODS
from blocksim.engines import ENGINES
from blocksim.engines.base import trusted
from blocksim.kinds.circular import CircularArch
from blocksim.simulation.motion import FRAME, MOVED, QUIET
from blocksim.simulation.observation import observe
from blocksim.simulation.simulated import Simulation
from blocksim.simulation.verdict import Verdict

STEP = 1 / 60
"""Usual time step, at which sweeps are varied [sqrt(r/g)]."""
TOL = 1e-3
"""Relative width of the brackets in which something else than their width is varied."""


class Refinement(NamedTuple):
    """Something that is set from coarse to fine, as in `Method.chart`.

    It is turned on the first arches of the chart; errors are measured from `limit` analysis of
    the same voussoirs, or from `theory`.
    """

    name: str
    words: str
    arches: int
    against: str

    @property
    def values(self) -> dict[str, tuple[float, ...]]:
        """Its settings from coarse to fine, by method, as each method's file says."""
        return {
            method.name: method.chart[self.name]
            for method in METHODS.values()
            if self.name in method.chart
        }


REFINEMENTS = {
    name: Refinement(name, words, arches, against)
    for name, words, arches, against in (
        ("tolerance", "onset test alone: relative width of the bracket", 5, "limit"),
        (
            "step",
            "moving run alone: time step [sqrt(r/g)], with the usual sweeps in it",
            3,
            "limit",
        ),
        (
            "sweeps",
            "moving run alone: sweeps over the contacts in a step of usual length",
            3,
            "limit",
        ),
        ("hold_sweeps", "onset test alone, cut short: most sweeps it may spend", 2, "limit"),
        ("voussoirs", "number of voussoirs, at the finest tolerance", 2, "theory"),
    )
}
"""Refinements by name."""


@dataclass(frozen=True, kw_only=True)
class Look:
    """An engine's answer on one arch: acceleration [g] or nan, and contacts times sweeps."""

    verdict: Verdict
    acceleration: float
    work: int


def look(arch: Arch, mu: float, method: str, knob: str, value: float) -> Look:
    """Ask an engine whether an arch stands, with one setting of `REFINEMENTS` given."""
    if knob in {"step", "sweeps"}:
        given = {"step": STEP, "sweeps": ENGINES[method].usual_sweeps, knob: value}
        return let_go(
            Simulation.of(CircularArch.of(arch, mu).problem(), method, settings=given)
        )
    given = {knob: value} if knob == "hold_sweeps" else {}
    seen = observe(CircularArch.of(arch, mu).problem(), method, moving=False, settings=given)
    work = ENGINES[method].contacts * (arch.voussoirs + 1) * seen.onset.sweeps
    return Look(verdict=seen.verdict, acceleration=seen.onset.acceleration, work=work)


def let_go(simulation: Simulation, moved: float = MOVED, until: float = QUIET) -> Look:
    """Let an arch go that nothing has held before, and see whether it moves.

    `moved`: Displacement from which it counts as collapsing [size].
    `until`: Time it is watched for [sqrt(size/g)].
    Returns: Undecided only where the engine itself tells that its contacts were not solved.
    """
    world, settings = simulation.world(), simulation.settings
    built, taken = world.poses(), 0
    stride, count = max(1, round(FRAME / settings.step)), math.ceil(until / settings.step)
    verdict = Verdict.STANDS
    while taken < count and verdict is Verdict.STANDS:
        steps = min(stride, count - taken)
        world.advance(steps)
        taken += steps
        # What has become nan has moved, too.
        if not simulation.assembly.displacement(world.poses() - built) <= moved:
            verdict = Verdict.COLLAPSES
    joints = len(simulation.assembly.joints)
    return Look(
        verdict=verdict if trusted(world, settings) else Verdict.UNDECIDED,
        acceleration=math.nan,
        work=simulation.engine.contacts * joints * settings.sweeps * taken,
    )
