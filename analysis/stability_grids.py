"""What `stability.py` asks each engine: arches, settings, and how far lines go."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

Case = tuple[float, float, int]
"""Half-angle [deg], friction, voussoirs."""
ARCHES: tuple[Case, ...] = (
    (90, 0.7, 27),
    (125, 0.9, 26),
    (145, 1.6, 27),
    (154, 2.6, 27),
    (45, 0.9, 13),
)


@dataclass(frozen=True)
class Grid:
    """What one engine is asked."""

    arches: tuple[Case, ...] = ARCHES
    steps: tuple[float, ...] = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
    sweeps: tuple[float, ...] = (1 / 64, 1 / 16, 1 / 4, 1 / 2, 1.0, 4.0)
    held: tuple[Case, ...] = (
        *(
            (alpha, 0.9 if alpha < 100 else 1.6, 7)
            for alpha in (20, 25, 30, 35, 45, 60, 90, 145)
        ),
        *((alpha, 0.9 if alpha < 100 else 1.6, 14) for alpha in (30, 35, 45, 60, 90, 145)),
        *((alpha, 0.9 if alpha < 100 else 1.6, 28) for alpha in (45, 60, 90, 145)),
    )
    allowed: tuple[float, ...] = (3, 10, 30, 100, 300, 1000, 3000, 10000, 30000)
    """Sweeps over voussoirs squared."""
    alphas: tuple[float, ...] = (20, 25, 30, 40, 60, 80, 100, 120, 140, 150, 155, 159)
    mus: tuple[float, ...] = (0.32, 0.4, 0.5, 0.7, 1.0, 2.0, 10.0, math.inf)
    counts: tuple[int, ...] = (5, 7, 9, 15, 27, 51, 101, 201)
    number: int = 9
    """Of voussoirs where not said."""
    radii: tuple[float, ...] = (0.01, 0.1, 1.0, 10.0, 100.0, 1000.0)
    lasting: tuple[Case, ...] = (ARCHES[0], ARCHES[1], (45, 0.9, 13))
    last: float = 500.0
    away: tuple[Case, ...] = ((90, 0.7, 9), (125, 0.9, 9))
    distances: tuple[float, ...] = tuple(10.0**k for k in range(9))


GRIDS = {
    "direct": replace(Grid(), sweeps=(1.0,), allowed=(1.0,)),
    "pymunk": Grid(),
    "pybullet": replace(
        Grid(),
        # With nine voussoirs friction allows both answers in the fourth.
        arches=tuple((alpha, mu, 9 if alpha < 150 else 13) for alpha, mu, _ in ARCHES),
        steps=(0.5, 1.0, 2.0, 4.0),
        sweeps=(1 / 16, 1 / 4, 1 / 2, 1.0),
        held=(
            (35, 0.9, 7),
            (45, 0.9, 7),
            (60, 0.9, 7),
            (90, 0.9, 7),
            (45, 0.9, 14),
            (90, 0.9, 14),
        ),
        alphas=(30, 35, 40, 60, 80, 100, 120, 140, 150, 155),
        counts=(5, 7, 9, 15, 27, 41),
        lasting=((90, 0.7, 5),),
    ),
}
GRIDS["mujoco"] = replace(
    GRIDS["pybullet"],
    # Its sweeps are steps of its own.
    sweeps=(1 / 4, 1 / 2, 1.0),
    held=((40, 0.9, 7), (60, 0.9, 7), (90, 0.9, 7), (90, 0.9, 14)),
    alphas=(40, 60, 80, 100, 120, 140, 150, 155),
    counts=(5, 7, 9, 15, 27),
    away=((90, 0.7, 9),),
    last=50.0,
)
QUICK = Grid(
    arches=((90, 0.7, 9),),
    steps=(1.0, 16.0),
    sweeps=(1 / 64, 1.0),
    held=((90, 0.7, 9),),
    allowed=(3, 1000),
    alphas=(90.0,),
    mus=(0.7,),
    counts=(9,),
    radii=(1000.0,),
    lasting=((90, 0.7, 9),),
    last=20.0,
    away=((90, 0.7, 9),),
    distances=(1.0, 1e8),
)
