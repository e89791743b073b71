"""The onset test: whether an arch held at rest would start to move if let go.

The engine solves the contacts of a single step, in place, with as many sweeps as it
takes. Its answer is read as one of two certificates, both from the engine's own solution:

- *stands*: the largest acceleration falls below `still` of the settings (in g). The
  contact forces found balance the weights and respect contact and friction.
- *collapses*: the accelerations form a mechanism that the weight drives. No joint closes
  further (overlap below `closing` of the motion), and the weight's work on it is at least
  what goes into the motion (`WORK`): more where joints slide, the same where they turn.
  Before the sweeps have converged blocks press into each other by percents, or forces at
  parting joints do work that nobody pays for; afterwards by a millionth. An engine that
  states the residual of its contacts is held to that instead of to the work.

If neither is reached within the sweeps allowed the test is undecided, and says so. So it is
where a block is farther than `FARTHEST` from the origin: its coordinates round off by 2e-16
of that distance, which over a displacement of `PROBE` comes up to `closing` at 5e4 sizes.

Coulomb's law may have two answers, rest and motion, where joints slide: no theorem tells that
an arch that can rest does. Which one is found depends on where the search for impulses begins.
A mechanism that slides is therefore believed only if motion is found from two sides, from
nothing and from blocks that cannot slide (135.17 deg, mu 1.13695, n = 19 moves 0.2 % above its
least thickness from the one and rests from the other; 125.02 deg, mu 0.8594, n = 10 the
other way round). Few thick voussoirs with much friction can jam, and then motion is found from
both (155 deg, mu 3, n = 7: up to 10 % above the least thickness, its forces without fault). The
measure is Painleve's: a slip at a contact presses its blocks together, by friction times what
turns them of its reaction (`jamming`). From about 1 on this was seen as a rule; from `JAMMED`
on a mechanism that slides is no certificate, and the test undecided. Below, it is rare, but
it is there, as contacts act together. With the sector weight, 151.67 deg, mu 2.1503, n = 7
(measure 0.90) moves from both beginnings 2.2 % above its least thickness, 148.66 deg,
mu 2.0065, n = 12 (0.69) 2 % above, 129.59 deg, mu 0.9682, n = 24 (0.27) 1 % above. Their
accelerations do not vanish where motion ends, as those of a collapse do at the limit. Engines
that state the residual of their contacts look for rest first, and are not held to this.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from blocksim.assembly import PLANAR, Array, Assembly, displacement
from blocksim.engines.base import Settings, World, trusted
from blocksim.joints import overlap_share, slip_share
from blocksim.progress import Progress, silent
from blocksim.verdict import Verdict

WORK = 0.99
PROBE = 1e-6
"""Size of the displacement along the accelerations at which joints are looked at."""
JAMMED = 0.95
LATE = 0.1
"""Share of the sweeps allowed after which joints that slide keep impulses from converging."""
SLIPS = 0.02
"""Slip over the largest motion of a joint above which a mechanism slides."""
FARTHEST = 1e4
"""Distance of a block from the origin above which coordinates are too coarse [size]."""
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
    may_jam : bool
        Whether it starts to move where rest may be possible, too.
    too_far : bool
        Whether it was built too far from the origin to be looked at.
    """

    verdict: Verdict
    acceleration: float
    mechanism: Array
    sweeps: int
    may_jam: bool = False
    too_far: bool = False

    @property
    def reason(self) -> str:
        """The evidence in words."""
        size = f"{self.acceleration:.1e} g after {self.sweeps} sweeps"
        match self.verdict:
            case Verdict.STANDS:
                return f"held at rest, contact forces balance the weight to {size}"
            case Verdict.COLLAPSES:
                return f"held at rest, it starts as a mechanism with {size}"
            case Verdict.UNDECIDED if self.too_far:
                return f"a block is more than {FARTHEST:g} sizes from the origin"
            case Verdict.UNDECIDED if self.may_jam:
                return f"it may start with {size}, or jam: so much friction allows both"
            case Verdict.UNDECIDED:
                return f"contact forces have not converged ({size})"


def onset(
    world: World,
    assembly: Assembly,
    mu: float,
    settings: Settings,
    progress: Progress = silent,
    *,
    simulated: Assembly | None = None,
) -> Onset:
    """Run the onset test on a world whose blocks are at rest where they were built.

    Parameters
    ----------
    world : World
    assembly : Assembly
        The blocks of the world.
    mu : float
        Their friction coefficient.
    settings : Settings
        What counts as at rest, and the most sweeps to spend.
    progress : Progress, optional
    simulated : Assembly, optional
        Those blocks the engine knows, where they are others (`blocksim.reduction`).

    Returns
    -------
    Onset
        The world keeps its impulses and can be released from there.
    """
    if np.abs(assembly.centres).max() > FARTHEST * assembly.size:
        return Onset(
            verdict=Verdict.UNDECIDED,
            acceleration=math.nan,
            mechanism=world.poses(),
            sweeps=0,
            too_far=True,
        )
    allowed, built = settings.hold_sweeps, world.poses()
    # Nothing is known of the far voussoirs before impulses have crossed the assembly.
    total, sweeps = 0, min(max(FIRST_SWEEPS, len(assembly.blocks) ** 2), allowed)
    exact, from_nothing = world.quality().residual is not None, True
    while True:
        accelerations = world.hold(sweeps)
        total += sweeps
        seen = _look(world, assembly, settings, built, accelerations, total)
        falls = seen.verdict is Verdict.COLLAPSES
        slides = not exact and slip_share(assembly, seen.mechanism) > SLIPS
        if slides and from_nothing and (falls or total > LATE * allowed):
            from_nothing = False
            if spent := world.stick(total):
                sweeps = total
                total += spent
                allowed += 2 * spent
                continue
        if falls and slides and jamming(simulated or assembly, mu) > JAMMED:
            return replace(seen, verdict=Verdict.UNDECIDED, may_jam=True)
        if seen.verdict is not Verdict.UNDECIDED or total >= allowed:
            return seen
        progress(total / allowed, "onset test")
        sweeps = min(int(total * (GROWTH - 1)), allowed - total)


def _look(
    world: World,
    assembly: Assembly,
    settings: Settings,
    built: Array,
    accelerations: Array,
    sweeps: int,
) -> Onset:
    """Read the accelerations that a number of sweeps have led to."""
    largest = float(displacement(accelerations, assembly))
    mechanism = built + accelerations * (PROBE / largest if largest > 0 else 0.0)
    verdict = Verdict.UNDECIDED
    if trusted(world, settings):
        if largest < settings.still:
            verdict = Verdict.STANDS
        elif overlap_share(assembly, mechanism) < settings.closing and (
            world.quality().residual is not None
            or _driven(assembly, accelerations, settings.tilt)
        ):
            verdict = Verdict.COLLAPSES
    return Onset(verdict=verdict, acceleration=largest, mechanism=mechanism, sweeps=sweeps)


def _driven(assembly: Assembly, accelerations: Array, tilt: float) -> bool:
    """Tell whether the weight does the work of the motion, from rest over one step."""
    masses = assembly.spatial_masses[:, : accelerations.shape[1]]
    weight = np.array([0.0, -math.cos(tilt), 0.0, math.sin(tilt), 0.0, 0.0])
    of_weight = float((masses * accelerations * weight[: accelerations.shape[1]]).sum())
    of_motion = float((masses * accelerations**2).sum())
    return of_weight > WORK * of_motion


def jamming(assembly: Assembly, mu: float) -> float:
    """Friction times the largest coupling of slip and closing at any contact.

    A contact at the end of a joint answers an impulse along the joint by motion along and
    across it, the second because the impulse turns the blocks. Where friction times the
    ratio of the part across to what an impulse across would give exceeds 1, Coulomb's law
    has no unique answer (Painleve 1895, for one contact).

    Parameters
    ----------
    assembly : Assembly
    mu : float
        Friction coefficient.

    Returns
    -------
    float
    """
    before, after, ends, normal, tangent, _, smooth = assembly.joint_arrays
    # The support is appended as a block that nothing moves, index -1.
    mobility = np.vstack([1 / assembly.masses, np.zeros(PLANAR)])
    centres = np.vstack([assembly.centres / assembly.size, np.zeros(2)])
    across = along = np.zeros(ends.shape[:2])
    for block in (before, after):
        arm = ends - centres[block][:, None]
        turned = np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
        presses = np.einsum("jek,jk->je", turned, normal)
        shears = np.einsum("jek,jk->je", turned, tangent)
        shift, spin = mobility[block, 0][:, None], mobility[block, 2][:, None]
        across = across + shift + spin * presses**2
        along = along + spin * presses * shears
    return float(mu * (np.abs(along) / across)[~smooth].max())
