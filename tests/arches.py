"""Arches and blocks that several tests ask about, and the onset test of them."""

import math
from functools import cache
from typing import Any

import numpy as np
from worlds import Engine, Simulation, onset

from blocksim import (
    Arch,
    Assembly,
    Block,
    Bracket,
    CircularArch,
    Joint,
    Mode,
    Problem,
    Verdict,
    bracket,
)

ARCHES: dict[str, list[tuple[Any, ...]]] = {
    "pymunk": [
        (90, 0.7, 27, "centreline", Mode.RRR),
        (90, 0.7, 20, "sector", Mode.RRR),
        (60, 0.9, 15, "centreline", Mode.RRR),
        (90, 0.35, 20, "centreline", Mode.SRR),
        (125, 0.9, 21, "sector", Mode.SRR),
        (145, 1.6, 17, "centreline", Mode.RRS),
        (145, 1.7, 20, "sector", Mode.RRS),
        (149.15618426323448, 1.79, 42, "centreline", Mode.RSR),
        (155, 3.0, 15, "centreline", Mode.RS),
        (148, 1.8, 16, "sector", Mode.RS),
        (155, math.inf, 14, "centreline", Mode.R),
    ],
    "pybullet": [
        (90, 0.7, 9, "centreline", Mode.RRR),
        (90, 0.35, 10, "centreline", Mode.SRR),
        (145, 1.6, 17, "centreline", Mode.RRS),
        (155, 3.0, 11, "centreline", Mode.RS),
    ],
    "mujoco": [
        (90, 0.7, 10, "centreline", Mode.RRR),
        (90, 0.35, 12, "sector", Mode.SRR),
        (145, 1.6, 17, "centreline", Mode.RRS),
        (155, 3.0, 15, "centreline", Mode.RS),
    ],
}
"""Half-angle [deg], mu, voussoirs, weight, and the mode a little below the least thickness."""

_RADIUS = (4**2 + 3**2) / 6 + 0.45 / 2
ENGINEERS = Arch(
    half_angle=math.asin(4 / (_RADIUS - 0.225)), eta=0.45 / _RADIUS, voussoirs=31,
    weight="sector", radius=_RADIUS,
)  # fmt: skip
"""Of 8 by 3 m clear, 0.45 m thick, by the chord theorem."""


@cache
def least(half_angle: float, mu: float, voussoirs: int = 27, weight: str = "centreline") -> Any:
    """Least thickness, mode and thrust of an arch in theory, and of its voussoirs as built."""
    arch = CircularArch(half_angle=half_angle, friction=mu, voussoirs=voussoirs, weight=weight)
    return bracket(arch, method="theory").arch


def arch_at(
    ratio: float, angle: float, mu: float, count: int, weight: str = "centreline"
) -> Arch:
    """An arch at a ratio of the least thickness of its voussoirs; its half-angle in degrees."""
    alpha = math.radians(angle)
    eta = ratio * least(alpha, mu, count, weight).eta_limit
    return Arch(half_angle=alpha, eta=eta, voussoirs=count, weight=weight)


def problem_at(
    ratio: float, angle: float, mu: float, count: int, weight: str = "centreline"
) -> Problem:
    """The same as a problem."""
    return CircularArch.of(arch_at(ratio, angle, mu, count, weight), mu).problem()


def bracket_at(
    angle: float,
    mu: float,
    count: int,
    weight: str = "centreline",
    *,
    method: str,
    tol: float,
    confirm: bool = True,
) -> Bracket:
    """The bracket of an arch whose half-angle is given in degrees."""
    return bracket(
        CircularArch(
            half_angle=math.radians(angle), friction=mu, voussoirs=count, weight=weight
        ),
        method=method,
        tol=tol,
        confirm=confirm,
    )


def held_in(
    engine: Engine, assembly: Assembly, mu: float, *, sweeps: int
) -> tuple[Verdict, np.ndarray]:
    """Verdict of the onset test, and the accelerations after so many sweeps more."""
    simulation = Simulation.of(Problem(assembly=assembly, mu=mu), engine)
    world = simulation.world()
    seen = onset(world, simulation)
    return seen.verdict, world.hold(sweeps)


def box(corner: np.ndarray, along: np.ndarray, width: float, height: float) -> Block:
    """A box of unit density whose base starts at `corner` and runs `along`."""
    up = np.array([-along[1], along[0]])
    base, rise = along * width, up * height
    return Block(
        vertices=np.array([corner, corner + base, corner + base + rise, corner + rise]),
        centre=corner + (base + rise) / 2,
        mass=width * height,
        inertia=width * height * (width**2 + height**2) / 12,
        depth=1.0,
    )


def on_a_slope(angle: float, width: float, height: float) -> Assembly:
    """A box on a plane that rises to the right."""
    uphill = np.array([math.cos(angle), math.sin(angle)])
    block = box(np.zeros(2), uphill, width, height)
    # Seen from the ground to the block, inner lies to the right: uphill.
    joint = Joint(before=-1, after=0, inner=uphill * width, outer=np.zeros(2))
    return Assembly(blocks=(block,), joints=(joint,), size=1.0)
