"""Coulomb's friction from friction that dilates: where blocks that move jam.

De Saxce's bipotential adds to each contact the slip that dilatation would turn into lift. While
that slip is held fixed a step is a convex quadratic programme; the slip of its solution is put
in its place, in turn (V. Acary, F. Cadoux, C. Lemarechal and J. Malick, Z. Angew. Math. Mech.
91, 2011, 155-175). In heaps that comes near slowly. So what the last turns have changed is
combined such that least is left (D. G. Anderson, J. ACM 12, 1965, 547-560), and begun anew
where more is left than before.
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
TOGETHER, NO_RANK = 10, 1e-8
"""Most turns combined, and what of their changes is round-off."""
TIRED, SHARE = 20, 0.5
"""Turns from which every other one puts in a share only of what is found: it leaves circles."""


def averaged(step: Step, x: Array, enough: float) -> Iterator[Answer]:
    """Give what contacts do along the way, begun with the slip at accelerations x.

    `step`: With friction that is not steep.
    `enough`: Residual of an answer that ends it.
    """
    cones, systems, left = Cones.of(step), 0, np.inf
    seen: list[tuple[Array, Array]] = []

    def lift(x: Array) -> Array:
        return cones.lean * np.abs(step.velocities(x)[:, 2:])

    lifted = lift(x)
    for turn in range(1, TURNS + 1):
        fixed = replace(cones, offset=cones.offset + np.tile(lifted, 2))
        x, pressed, count = central_path(step, fixed, dilates=True, moves=True)
        systems += count
        found = cones.answer(step, x, pressed, systems)
        found = replace(found, residual=step.residual(x, found.forces))
        if turn % PAUSE == 0 or found.residual <= enough:
            yield found
        wanting = lift(x) - lifted
        last, left = left, float(np.linalg.norm(wanting))
        seen = [*(seen if left <= last else []), (lifted, wanting)][-1 - TOGETHER :]
        lifted = combined(seen, SHARE if turn > TIRED and turn % 2 else 1.0)


def combined(seen: list[tuple[Array, Array]], share: float) -> Array:
    """Return what is put in next, of what was put in and what was wanting in the last turns."""
    lifted, wanting = seen[-1]
    following = lifted + share * wanting
    if len(seen) > 1:
        changes, less = (
            np.diff([each.ravel() for each in column], axis=0).T
            for column in zip(*seen, strict=True)
        )
        parts = np.linalg.lstsq(less, wanting.ravel(), rcond=NO_RANK)[0]
        following = following - ((changes + share * less) @ parts).reshape(lifted.shape)
    return np.maximum(following, 0.0)
