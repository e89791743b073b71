"""Coulomb's friction from friction that dilates: where blocks that move jam.

De Saxce's bipotential adds to each contact the slip that dilatation would turn into lift. While
that slip is held fixed a step is a convex quadratic programme; the slip of its solution is put
in its place, in turn (V. Acary, F. Cadoux, C. Lemarechal and J. Malick, Z. Angew. Math. Mech.
91, 2011, 155-175). Where contacts that stick and slide take turns that goes in a circle; the
mean of the slip put in and the slip found leaves it, and half as much is wrong every few turns.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.cones import Cones
from blocksim.engines.contact.interior import central_path
from blocksim.engines.contact.step import Answer, Step

TURNS, PAUSE = 40, 8
"""Most programmes solved, and after how many it is told what contacts do."""
SHARE = 0.5
"""Share of the slip found that is put in."""


def averaged(step: Step, x: Array) -> Iterator[Answer]:
    """Give what contacts do along the way, begun with the slip at accelerations x.

    `step`: With friction that is not steep.
    """
    cones, systems = Cones.of(step), 0

    def lift(x: Array) -> Array:
        slip = cones.lean * np.abs(step.velocities(x)[:, 2:])
        return np.concatenate([slip, slip], axis=1)

    lifted = lift(x)
    for turn in range(1, TURNS + 1):
        fixed = replace(cones, offset=cones.offset + lifted)
        x, pressed, count = central_path(step, fixed, dilates=True)
        lifted, systems = lifted + SHARE * (lift(x) - lifted), systems + count
        if turn % PAUSE == 0:
            yield cones.answer(step, x, pressed, systems)
