"""Whether Coulomb friction lets an arch move although an equilibrium exists.

At rest, forces in equilibrium and within the friction cones are themselves a solution of
Coulomb's problem, so an arch held and let go starts to move exactly where `limit` finds
none. But Coulomb's law does not make that solution the only one: an arch that stands may
depend on how it was brought there. Each arch that slides at its limit, a little thicker than
that, is put to three starts, and one that only turns with them as a control:

- held: let go from rest;
- lowered: friction starts at twice its value and falls to it step by step while it stands;
- pushed: velocities along the mechanism it has just below the limit.

Result (`quick` off): of 25 arches with an equilibrium, from 1e-6 to 3 % above the limit, none
moved when held and let go, none when friction was lowered: there Coulomb's non-associated
friction and limit analysis agree. A push along the mechanism carries those close to the limit
past 0.02 r; no arch that slides needed a larger margin to resist it than the one that only
turns. So nothing here needs the friction law to explain it, but push and friction law were
not told apart.

Run: python -m analysis.direct_coulomb OUT
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from analysis.command import run
from blocksim.arch import limit
from blocksim.arch.circular import Arch
from blocksim.blocks.assembly import Array, displacement
from blocksim.blocks.problem import Problem
from blocksim.engines.direct import ENGINE, Blocks
from blocksim.view.style import QUIET

ARCHES = (
    (90.0, 0.9, 27),
    (90.0, 0.37, 30),
    (125.0, 0.9, 27),
    (145.0, 1.6, 30),
    (150.0, 2.0, 30),
)
"""Half-angle [deg], friction, voussoirs: modes rrr, srr, srr, rrs, rs."""
MARGINS = (1e-6, 1e-4, 1e-3, 1e-2, 3e-2)
PUSHES = (1e-4, 1e-3, 1e-2)
"""Velocity of the fastest block [sqrt(g r)]."""
MOVED = 0.02
TIME = 6.0


@dataclass(frozen=True)
class Outcome:
    """What was found.

    Parameters
    ----------
    held, lowered : int
        Arches with an equilibrium that moved from rest, and with friction lowered.
    cases : int
        Arches and margins tried.
    threshold : dict
        Arch and push to the least margin at which it moved less than `MOVED` (inf: at none).
    """

    held: int
    lowered: int
    cases: int
    threshold: dict[tuple[str, float], float]


def world(arch: Arch, mu: float) -> Blocks:
    """Put an arch into the engine."""
    assembly = arch.assembly()
    return Blocks(Problem(assembly=assembly, mu=mu), ENGINE.rule(assembly))


def way(blocks: Blocks, start: Array, arch: Arch, until: float) -> float:
    """Let it move and return how far it went."""
    gone, assembly = 0.0, arch.assembly()
    for _ in range(round(until / 0.1)):
        blocks.advance(10)
        gone = float(displacement(blocks.poses() - start, assembly))
        if gone > MOVED or np.abs(blocks.velocities).max() < 1e-10:
            break
    return gone


def main(out: Path, quick: bool = False) -> Outcome:
    """Run the study and draw its figure."""
    arches = ((125.0, 0.9, 10),) if quick else ARCHES
    margins = MARGINS[2:4] if quick else MARGINS
    pushes = PUSHES[1:2] if quick else PUSHES
    held = lowered = 0
    threshold: dict[tuple[str, float], float] = {}
    figure, axes = plt.subplots(figsize=(7, 4.5))
    for half_angle_deg, mu, voussoirs in arches:
        half_angle = math.radians(half_angle_deg)
        state = limit.least_thickness(half_angle, mu, voussoirs)
        if state.eta is None:
            continue
        name = f"{state.mode}, {half_angle_deg:g} deg, mu {mu:g}"
        arch = Arch(half_angle=half_angle, eta=state.eta, voussoirs=voussoirs)
        falling = world(replace(arch, eta=state.eta * 0.999), mu)
        assembly = arch.assembly()
        mechanism = falling.hold(1)
        mechanism = mechanism / float(displacement(mechanism, assembly))
        for margin in margins:
            thicker = replace(arch, eta=state.eta * (1 + margin))
            held += bool(np.abs(world(thicker, mu).hold(1)).max() > 1e-9)
            # Quasi-static: forces of the last friction are where the next one starts.
            step = world(thicker, 2 * mu)
            step.hold(1)
            for share in np.linspace(2, 1, 21):
                following = world(thicker, float(share * mu))
                following.start_from(step)
                following.advance(5)
                step = following
            lowered += way(step, step.poses(), thicker, 1.0) > 1e-9
        for push in pushes:
            gone: list[float] = []
            for margin in margins:
                thicker = replace(arch, eta=state.eta * (1 + margin))
                blocks = world(thicker, mu)
                start = blocks.poses()
                blocks.hold(1)
                blocks.push(mechanism * push)
                gone.append(way(blocks, start, thicker, TIME))
            stays = [m for m, g in zip(margins, gone, strict=True) if g <= MOVED]
            threshold[name, push] = min(stays, default=math.inf)
            if push == pushes[-1]:
                axes.loglog(margins, gone, "o-", label=name)
    axes.axhline(MOVED, color=QUIET, linewidth=1)
    axes.set_xlabel("thickness above the limit, relative")
    axes.set_ylabel("largest displacement [r]")
    axes.set_title(f"Pushed along its mechanism with {pushes[-1]:g} sqrt(g r)")
    axes.legend(fontsize=8)
    out.mkdir(parents=True, exist_ok=True)
    figure.savefig(out / "direct_coulomb.png", dpi=150, bbox_inches="tight")
    plt.close(figure)
    return Outcome(held, lowered, len(arches) * len(margins), threshold)


if __name__ == "__main__":
    run(main)
