"""Arches over the whole map, for `onset_modes.py`.

Of ten arches five lie anywhere: half-angle even from 30 to 159 deg, friction
log-uniform from what lets any thickness stand to 4, the right edge of the map. Four have one
of the mixed modes each (srr, rrs, rsr, rs), which have little room: they are drawn in the same
way until one comes that has it. All of these stand at some thickness. The tenth lies on
the line where purely sliding arches are published, and is 1.1 to 3 times as thick as the
least there: not its thickness is critical but its friction. Purely overturning arches (r) need
boundless friction, of which engines take 1000: they are left out. Voussoirs are 20 to 40,
weight is on the centreline.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

from blocksim import Mode
from blocksim.arch.circular import ETA_MAX
from blocksim.arch.limit.bulk import which_stand
from blocksim.arch.theory.arrays import least_thicknesses
from blocksim.arch.theory.map import divide_friction
from blocksim.arch.theory.regions import at_inner_sliding
from blocksim.blocks.assembly import Array

SEED = 2024
ANYWHERE = None
TURNS = (ANYWHERE, Mode.SRR, ANYWHERE, Mode.RRS, ANYWHERE, Mode.RSR, ANYWHERE, Mode.RS)
TURNS += (ANYWHERE, Mode.SS)
"""What ten arches in a row are drawn from."""
NARROWEST, WIDEST, MOST_FRICTION = 30.0, 159.0, 4.0
BLOCK = 4096
"""Arches drawn together."""
NEAR = 0.003
"""Share of alpha or mu within which the mode changes, near a line."""


@dataclass(frozen=True)
class Drawn:
    """An arch; `eta` where friction is critical, not thickness, with that friction in `mu`."""

    alpha_deg: float
    mu: float
    voussoirs: int
    published: Mode
    near: bool
    eta: float | None = None


def draw() -> Iterator[Drawn]:
    """Draw arches, without end."""
    streams = {turn: critical_draws(turn) for turn in TURNS}
    for turn in itertools.cycle(TURNS):
        yield next(streams[turn])


def critical_draws(turn: Mode | None) -> Iterator[Drawn]:
    """Draw arches of one kind, independently of the others."""
    random = np.random.default_rng([SEED, TURNS.index(turn)])
    while True:
        alpha_deg = random.uniform(NARROWEST, WIDEST, BLOCK)
        least = np.interp(alpha_deg, *divide())
        mu = least * (MOST_FRICTION / least) ** random.random(BLOCK)
        voussoirs = random.integers(20, 41, BLOCK)
        thicker = random.uniform(1.1, 3.0, BLOCK)
        if turn is Mode.SS:
            yield from map(_on_divide, alpha_deg, voussoirs, thicker)
        else:
            yield from _critical(turn, alpha_deg, mu, voussoirs)


@cache
def divide() -> tuple[Array, Array]:
    """Half-angles [deg] and the friction below which no thickness stands."""
    angles = np.linspace(NARROWEST, WIDEST, 200)
    return angles, np.array([divide_friction(math.radians(angle)) for angle in angles])


def _critical(
    turn: Mode | None, alpha_deg: Array, mu: Array, voussoirs: Array
) -> Iterator[Drawn]:
    """Those that stand at some thickness and have the mode asked for."""
    there = least_thicknesses(np.radians(alpha_deg), mu)
    wanted = (there.eta < ETA_MAX / 1.005) & ((there.mode == turn) | (turn is ANYWHERE))
    for k in np.flatnonzero(wanted):
        mode, half_angle = Mode(str(there.mode[k])), math.radians(alpha_deg[k])
        # As far to either side as the mode may not change.
        alphas = half_angle * np.array([1 - NEAR, 1 + NEAR, 1.0, 1.0])
        mus = mu[k] * np.array([1.0, 1.0, 1 - NEAR, 1 + NEAR])
        near = bool((least_thicknesses(alphas, mus).mode != mode).any())
        yield Drawn(float(alpha_deg[k]), float(mu[k]), int(voussoirs[k]), mode, near)


def _on_divide(alpha_deg: float, voussoirs: int, thicker: float) -> Drawn:
    """Draw an arch on the line of purely sliding ones, and the friction its voussoirs need."""
    half_angle, count = math.radians(alpha_deg), int(voussoirs)
    mu = divide_friction(half_angle)
    least, _ = at_inner_sliding(mu, half_angle, "centreline")
    eta = float(min(thicker * least, ETA_MAX))
    low, high = mu / 2, mu * 2
    for _ in range(40):
        middle = (low + high) / 2
        stands = bool(which_stand(half_angle, eta, middle, count))
        low, high = (low, middle) if stands else (middle, high)
    return Drawn(float(alpha_deg), high, count, Mode.SS, False, eta)
