"""The onset test: whether an arch held at rest would start to move if let go.

The engine solves the contacts of a single step, in place, with as many sweeps as it
takes. Its answer is read as one of two certificates, both from the engine's own solution:

- *stands*: the largest acceleration falls below `still` of the settings (in g). The
  contact forces found balance the weights and respect contact and friction.
- *collapses*: the accelerations form a mechanism that the weight drives. No joint closes
  further (overlap below `OVERLAP` of the motion), and the weight's work on it is at least
  what goes into the motion (`WORK`): more where joints slide, the same where they turn.
  Before the sweeps have converged blocks press into each other by percents, or forces at
  parting joints do work that nobody pays for; afterwards by a millionth. An engine that
  states the residual of its contacts is held to that instead of to the work.

If neither is reached within the sweeps allowed the test is undecided, and says so.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from blocksim.assembly import Array, Assembly, displacement
from blocksim.engines.base import Settings, World, trusted
from blocksim.joints import overlap_share
from blocksim.progress import Progress, silent
from blocksim.verdict import Verdict

OVERLAP = 1e-3
WORK = 0.99
PROBE = 1e-6
"""Size of the displacement along the accelerations at which joints are looked at."""
FIRST_SWEEPS = 1000
GROWTH = 1.5
"""Ratio of the totals of sweeps at two looks."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Onset:
    """Outcome of the onset test.

    Parameters
    ----------
    verdict : Verdict
    acceleration : float
        Largest acceleration of any corner [g].
    mechanism : (blocks, 3) float
        Poses after a small displacement (`PROBE`) along the accelerations.
    sweeps : int
        Sweeps spent.
    """

    verdict: Verdict
    acceleration: float
    mechanism: Array
    sweeps: int

    @property
    def reason(self) -> str:
        """The evidence in words."""
        size = f"{self.acceleration:.1e} g after {self.sweeps} sweeps"
        match self.verdict:
            case Verdict.STANDS:
                return f"held at rest, contact forces balance the weight to {size}"
            case Verdict.COLLAPSES:
                return f"held at rest, it starts as a mechanism with {size}"
            case Verdict.UNDECIDED:
                return f"contact forces have not converged ({size})"


def onset(
    world: World, assembly: Assembly, settings: Settings, progress: Progress = silent
) -> Onset:
    """Run the onset test on a world whose blocks are at rest where they were built.

    Parameters
    ----------
    world : World
    assembly : Assembly
        What the world was built from.
    settings : Settings
        What counts as at rest, and the most sweeps to spend.
    progress : Progress, optional

    Returns
    -------
    Onset
        The world keeps its impulses and can be released from there.
    """
    hold_sweeps = settings.hold_sweeps
    rest = world.poses()
    # Nothing is known of the far voussoirs before impulses have crossed the assembly.
    first = min(max(FIRST_SWEEPS, len(assembly.blocks) ** 2), hold_sweeps)
    total, sweeps = 0, first
    while True:
        accelerations = world.hold(sweeps)
        total += sweeps
        largest = float(displacement(accelerations, assembly))
        mechanism = rest + accelerations * (PROBE / largest if largest > 0 else 0.0)
        if not trusted(world, settings):
            verdict = Verdict.UNDECIDED
        elif largest < settings.still:
            verdict = Verdict.STANDS
        elif overlap_share(assembly, mechanism) < OVERLAP and (
            world.quality().residual is not None
            or _driven(assembly, accelerations, settings.tilt)
        ):
            verdict = Verdict.COLLAPSES
        else:
            verdict = Verdict.UNDECIDED
        if verdict is not Verdict.UNDECIDED or total >= hold_sweeps:
            return Onset(
                verdict=verdict, acceleration=largest, mechanism=mechanism, sweeps=total
            )
        progress(np.log(total / first) / np.log(hold_sweeps / first), "onset test")
        sweeps = min(int(total * (GROWTH - 1)), hold_sweeps - total)


def _driven(assembly: Assembly, accelerations: Array, tilt: float) -> bool:
    """Tell whether the weight does the work of the motion, from rest over one step."""
    masses = assembly.spatial_masses[:, : accelerations.shape[1]]
    weight = np.array([0.0, -math.cos(tilt), 0.0, math.sin(tilt), 0.0, 0.0])
    of_weight = float((masses * accelerations * weight[: accelerations.shape[1]]).sum())
    of_motion = float((masses * accelerations**2).sum())
    return of_weight > WORK * of_motion
