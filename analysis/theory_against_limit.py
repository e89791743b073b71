"""Closed form against limit analysis with very many joints, over the whole domain.

Question: does the theory agree with the statics of the voussoirs as their number grows?
Random (alpha, mu) over the whole domain, both weights. The limit analysis of 4000 voussoirs
is solved by cutting planes: a few joints at first, then those where the solution breaks a
strength condition, until none does. New joints go between those of the 4000, where a parabola
through three of them peaks: that takes the place of an extrapolation to infinite n.

Expected: no disagreement over 1e-6 in eta; where one stands and the other does not, the
arch is within 1e-5 of the divide or of eta = 2; the same mode farther than 1e-3 from a line.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analysis.command import run
from blocksim.arch.circular import Weight
from blocksim.arch.limit.bulk import (
    joints_of,
    least_thickness_of_joints,
    short_intervals,
    spreads,
)
from blocksim.arch.limit.halfplanes import Joints
from blocksim.arch.theory import CriticalArrays, least_thicknesses
from blocksim.blocks.assembly import Array

SEED = 1729
POINTS, QUICK_POINTS = 100_000, 1_000
VOUSSOIRS = 4000
ROUNDS = 12
BROKEN = 1e-9
CHUNK = 500
FROM_LINES = 1e-3
FROM_BORDER = 1e-5


def limit_of_many(half_angle: Array, mu: Array, weight: Weight) -> tuple[Array, Array]:
    """Least thickness (nan where none stands) and thrust, shapes (k,)."""
    every = joints_of(half_angle, VOUSSOIRS)
    joints = every[:, np.linspace(0, every.shape[1] - 1, 7).astype(int)]
    size, cosine = every, np.cos(every)
    weightless, lift = size * np.sin(every), 1 - cosine
    shear_0, sine = size * cosine, np.sin(every)
    eta = thrust = np.zeros(mu.size)
    for _ in range(ROUNDS):
        eta = least_thickness_of_joints(joints, mu, weight)
        known = np.nan_to_num(eta, nan=2.0)
        spread = spreads(known, weight)
        most, least = short_intervals(Joints(joints), known, mu, spread)
        ends = np.clip(1 - (most + least) / 2, -1e3, 1e3)
        thrust = np.where(np.isnan(eta), np.nan, ends)
        h, factor, depth = ends[:, None], 1 + spread[:, None], known[:, None] / 2
        force = h * cosine + weightless
        unforced = factor * lift - force
        few = h * np.cos(joints) + joints * np.sin(joints)
        few_moment = factor * (1 - np.cos(joints)) - few
        highest = (depth * few - few_moment).min(axis=1)
        lowest = (-depth * few - few_moment).max(axis=1)
        moment = unforced + ((highest + lowest) / 2)[:, None]
        shear = h * sine - shear_0
        grip = np.where(np.isinf(mu), 1e300, mu)[:, None] * force
        excess = np.stack(
            [moment - depth * force, -moment - depth * force, shear - grip, -shear - grip]
        )
        joints = np.concatenate([joints, _peaks(every, excess)], axis=1)
        if not (excess.max(axis=2)[:, ~np.isnan(eta)] > BROKEN).any():
            break
    return eta, thrust


def _peaks(every: Array, excess: Array) -> Array:
    """Angles where each condition is broken most: between joints, by a parabola."""
    inside = np.clip(excess.argmax(axis=2), 1, every.shape[1] - 2)[:, :, None]
    before, at, after = (
        np.take_along_axis(excess, inside + step, axis=2)[:, :, 0] for step in (-1, 0, 1)
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        shift = np.nan_to_num((before - after) / (before - 2 * at + after) / 2)
    # At an end of the arch the parabola's step leads back to it.
    shift = np.clip(shift, -1, 1)
    step = every[:, 1] - every[:, 0]
    return np.take_along_axis(every, inside[:, :, 0].T, axis=1) + shift.T * step[:, None]


def from_lines(
    theory: CriticalArrays, half_angle: Array, mu: Array, weight: Weight
) -> NDArray[np.bool_]:
    """Whether the mode is the same all around, at `FROM_LINES` in alpha and arctan mu."""
    same = np.ones(mu.size, dtype=bool)
    for turn in np.linspace(0, 2 * math.pi, 8, endpoint=False):
        angle = np.clip(half_angle + FROM_LINES * math.cos(turn), 1e-3, 3.14)
        friction = np.arctan(mu) + FROM_LINES * math.sin(turn)
        near = np.tan(np.clip(friction, 1e-6, math.pi / 2 - 1e-9))
        same &= least_thicknesses(angle, near, weight).modes == theory.modes
    return same


def slides(half_angle: Array, mu: Array, thrust: Array) -> NDArray[np.bool_]:
    """Whether shoulder and inner joint slide at a thrust: columns 0 and 1."""
    # Denser at the crown: there the sliding joint is at large frictions.
    x = np.linspace(0, 1, 2001) ** 2 * half_angle[:, None]
    h = thrust[:, None]
    with np.errstate(invalid="ignore"):
        ratio = (h * np.sin(x) - x * np.cos(x)) / (h * np.cos(x) + x * np.sin(x))
    lean, grip = np.arctan(ratio), np.arctan(mu) - FROM_LINES / 10
    return np.column_stack([lean[:, -1] >= grip, -lean.min(axis=1) >= grip])


def main(out: Path, quick: bool = False) -> dict[str, float]:
    """Run the fuzz.

    Parameters
    ----------
    out : Path
        Folder of `theory_against_limit.txt`.
    quick : bool
        1,000 points instead of 100,000, a weight.

    Returns
    -------
    dict of str to float
        Largest disagreement, disagreements on standing, on sliding joints.
    """
    random = np.random.default_rng(SEED)
    count = QUICK_POINTS if quick else POINTS
    worst, beyond, wrong, compared = 0.0, 0, 0, 0
    for weight in ("centreline", "sector"):
        half_angle = random.uniform(0.01, 3.0, count)
        half_angle[::2] = random.uniform(2.0, 2.79, half_angle[::2].size)
        mu = np.tan(random.uniform(0.005, math.pi / 2, count))
        mu[::20] = np.inf
        theory = least_thicknesses(half_angle, mu, weight)
        for start in range(0, count, CHUNK):
            part = slice(start, start + CHUNK)
            a, m = half_angle[part], mu[part]
            eta, thrust = limit_of_many(a, m, weight)
            one = CriticalArrays(
                eta=theory.eta[part],
                modes=theory.modes[part],
                thrust=theory.thrust[part],
                beta_r=theory.beta_r[part],
                beta_s=theory.beta_s[part],
            )
            both = ~np.isnan(eta) & ~np.isnan(one.eta)
            worst = max(worst, float(np.abs(eta - one.eta)[both].max(initial=0)))
            odd = np.isnan(eta) != np.isnan(one.eta)
            if odd.any():
                steps = [
                    np.isnan(least_thicknesses(a[odd] + d, m[odd], weight).eta)
                    for d in (-FROM_BORDER, FROM_BORDER)
                ]
                beyond += int((steps[0] == steps[1]).sum())
            clear = both & from_lines(one, a, m, weight)
            names = one.mode[clear]
            seen = slides(a[clear], m[clear], thrust[clear])
            expected = np.column_stack(
                [
                    np.char.startswith(names, "s"),
                    np.isin(names, ["rrs", "rsr", "rs"]),
                ]
            )
            wrong += int((seen != expected).any(axis=1).sum())
            compared += int(clear.sum())
    out.mkdir(parents=True, exist_ok=True)
    numbers = {
        "points": 2.0 * count,
        "largest_difference": worst,
        "standing_differs": float(beyond),
        "modes_compared": float(compared),
        "modes_differ": float(wrong),
    }
    text = "\n".join(f"{key} {value:.6g}" for key, value in numbers.items())
    (out / "theory_against_limit.txt").write_text(text + "\n")
    return numbers


if __name__ == "__main__":
    run(main)
