"""Inner hinges and the purely rotational mode, over arrays.

At a given thrust h the arch needs the larger of two thicknesses: one, which falls with h,
keeps the line of thrust between crown extrados and an intrados hinge; the other, which
grows with h, between shoulder extrados and an intrados hinge. They meet at the thrust of
the purely rotational mode.

The thrust enters as its shortfall v = 1 - h and the inner hinge as y = beta^2, so that
nothing cancels in flat arches; C, S, P and R are the functions of `series`. The
rotational mode depends on the half-angle alone and is interpolated between Chebyshev
nodes; its hinge goes to the crown like a square root, y does not.
"""

from __future__ import annotations

import json
import sys
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple, get_args

import numpy as np
from numpy.polynomial import chebyshev

from blocksim.arch.circular import ETA_MAX, Weight
from blocksim.arch.roots import root
from blocksim.arch.theory.equations import BEYOND
from blocksim.arch.theory.sliding import Thrusts
from blocksim.blocks.assembly import Array
from blocksim.common.files import write_whole
from blocksim.common.later import elementwise
from blocksim.common.series import p_series, r_series

EDGES = (0.0, 0.75, 0.94, 0.985, 0.996, 1.0)
"""Pieces of the interpolation in (alpha/alpha_l)^2: a branch point lies just beyond."""
NODES = 36
"""Of a piece."""
STORED = Path(__file__).with_name("rotational.json")
"""Their coefficients; `store` writes them anew where edges, nodes or equations change."""
TIGHT = 4 * sys.float_info.epsilon
ROUNDS = 100
"""Newton steps allowed; halving alone would need about as many."""
SETTLED = 1e-9
"""Relative step after which Newton's method, being quadratic, has reached round-off."""


class Rotational(NamedTuple):
    """Chebyshev coefficients in alpha^2 of the purely rotational mode.

    One array a piece; its columns are (1 - h)/alpha^2, eta/alpha^4 and
    (beta_r/alpha)^2, up to the half-angle `widest` where the thrust vanishes.
    """

    widest: float
    pieces: list[Array]


def inner_hinges(
    short: Array, extrados: Array, half_angle: Array, weight: Weight
) -> tuple[Array, Array]:
    """Thickness needed at given thrusts, and the inner hinges that demand it.

    Newton's method on eq. (4) in y = beta^2, kept in a bracket.

    `short`, (k,): 1 - h.
    `extrados`, (k,): Angle of the extrados hinge: 0 for the crown, alpha for the shoulder
        [rad].
    `half_angle`, (k,): alpha [rad].
    Returns `eta`, `square`, (k,): Largest `touching_eta` over the intrados, and beta_r^2
        [rad^2].
    """
    end = half_angle**2
    far = extrados**2
    low, high = np.zeros_like(end), end.copy()
    # h = 0 at the crown is 0/0; the limit is there next to it.
    start = np.where(extrados == 0, np.finfo(float).tiny ** 0.25, 0.0)
    eta, slope, _ = _hinge_slope(start, short, far, weight)
    at_crown = (eta > ETA_MAX) | (slope <= 0)
    at_end = ~at_crown & (_hinge_slope(end, short, far, weight)[1] >= 0)
    square = np.where(at_crown, 0.0, np.where(at_end, end, 0.1 * end))
    active = np.flatnonzero(~(at_crown | at_end))
    for _ in range(ROUNDS):
        if not active.size:
            break
        here = square[active]
        _, slope, rate = _hinge_slope(here, short[active], far[active], weight)
        low[active] = np.where(slope > 0, here, low[active])
        high[active] = np.where(slope > 0, high[active], here)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = here - slope / rate
        inside = (step >= low[active]) & (step <= high[active])
        step = np.where(inside, step, (low[active] + high[active]) / 2)
        square[active] = step
        active = active[np.abs(step - here) > SETTLED * here]
    # At the crown the thickness is that of the start, elsewhere that of the hinge.
    return _touching(np.where(at_crown, start, square), short, far, weight)[0], square


def _touching(
    y: Array, short: Array, far: Array, weight: Weight
) -> tuple[Array, Array, Array, tuple[Array, Array, Array, Array]]:
    """Give `touching_eta` in y, with its force, its drop, and R, P, C, S at y."""
    r, p = r_series(y), p_series(y)
    c = 0.5 - y * r
    s = 1.0 - y * (2 * r + p)
    if far.any():
        far_r, far_p = r_series(far), p_series(far)
        far_fall, far_side = far * (0.5 - far * far_r), far * (1 - far * (2 * far_r + far_p))
        far_gap = far * far * far_p
    else:
        far_fall = far_side = far_gap = far
    fall = y * c
    drop = far_fall - fall
    gap = far_gap - y * y * p - short * drop
    force = (1 - short) * (2 - fall - far_fall) + y * s + far_side
    if weight == "centreline":
        return 2 * gap / force, force, drop, (r, p, c, s)
    root = force * force - 4 / 3 * drop * gap
    eta = 4 * gap / (force + np.sqrt(np.maximum(root, 0.0)))
    eta = np.where((root < 0) & (gap > 0), np.maximum(eta, BEYOND), eta)
    return eta, force, drop, (r, p, c, s)


def _hinge_slope(
    y: Array, short: Array, far: Array, weight: Weight
) -> tuple[Array, Array, Array]:
    """Give `touching_eta`, `hinge_slope` and the derivative of the latter by y."""
    if y.shape == (1,):
        # A single arch goes through in numbers, to the same bits and far sooner.
        eta, slope, rate = _hinge_slope(y[0], short[0], far[0], weight)
        return np.array([eta]), np.array([slope]), np.array([rate])
    eta, force, drop, (r, p, c, s) = _touching(y, short, far, weight)
    cosine = 1.0 - y * c
    turn = short - y * (c - p - 2 * r) / s  # beta cot beta - h
    turn_rate = -(c + (2 * r + p) * cosine) / (2 * s * s)
    eta_rate = (cosine - (1 - short) * s) - eta * (short * s + cosine) / 2
    if weight == "centreline":
        eta_rate = eta_rate / force
        return eta, 2 * turn - eta * (1 + turn), turn_rate * (2 - eta) - eta_rate * (1 + turn)
    eta_rate = (eta_rate - eta * eta * s / 12) / (force - drop * eta / 3)
    slope = 2 * turn - eta * (1 + turn) - eta * eta / 6
    return eta, slope, turn_rate * (2 - eta) - eta_rate * (1 + turn + eta / 3)


def rotational_mode(alpha: Array, weight: Weight) -> tuple[Thrusts, Array, Array]:
    """Solve eqs (1), (3) and (4), up to the half-angle alpha_l.

    `alpha`, (k,): Half-angles [rad].
    Returns `thrusts`: 0 from alpha_l on, where each half overturns by itself.
    Returns `eta`, `square`, (k,): Thickness and beta_r^2 [rad^2]; nan from alpha_l on
        (`inner_hinges` has them).
    """
    widest, pieces = _rotational(weight)
    square = alpha * alpha
    share = square / widest**2
    short, eta, hinge = np.full((3, alpha.size), np.nan)
    for (left, right), coefficients in zip(pairwise(EDGES), pieces, strict=True):
        where = np.flatnonzero((share >= left) & (share < right))
        if where.size:
            place = (2 * share[where] - left - right) / (right - left)
            short[where], eta[where], hinge[where] = chebyshev.chebval(place, coefficients)
    hinge = np.maximum(hinge, 0.0) * square
    short, eta = np.minimum(short * square, 1.0), eta * square**2
    thrust = np.where(short < 0.5, 1 - short, _thrust(hinge, eta, weight))
    wide = share >= 1.0
    thrust[wide], short[wide] = 0.0, 1.0
    return Thrusts(thrust, short), eta, hinge


def _thrust(y: Array, eta: Array, weight: Weight) -> Array:
    """Thrust of (1): towards overturning it vanishes like y^2, and 1 - h has lost it."""
    r, p = r_series(y), p_series(y)
    c, s = 0.5 - y * r, 1.0 - y * (2 * r + p)
    lever = 1.0 if weight == "centreline" else 1.0 + eta * eta / 12
    rise = (2 - eta) * s - 2 * lever * c
    return np.maximum(y * rise / (2 * eta + (2 - eta) * y * c), 0.0)


def widest_rotational(weight: Weight) -> float:
    """Half-angle alpha_l at which the thrust of the rotational mode vanishes [rad]."""
    return _rotational(weight).widest


@cache
def _rotational(weight: Weight) -> Rotational:
    """Read what `solved` found, which takes longer than all else in an answer."""
    stored = json.loads(STORED.read_text(encoding="utf-8"))[weight]
    return Rotational(stored["widest"], [np.array(piece) for piece in stored["pieces"]])


def store() -> None:
    """Solve for both weights and write the file that is read."""
    weights: tuple[Weight, ...] = get_args(Weight)
    found = {weight: solved(weight) for weight in weights}
    table = {
        weight: {"widest": each.widest, "pieces": [piece.tolist() for piece in each.pieces]}
        for weight, each in found.items()
    }
    text = json.dumps(table, indent=0) + "\n"
    write_whole(STORED, lambda file: file.write(text.encode()))


def solved(weight: Weight) -> Rotational:
    """Solve eqs (1), (3) and (4) at the Chebyshev nodes of every piece."""

    def excess(short: Array, alpha: Array) -> Array:
        """Thickness the shoulder asks for beyond that of the crown."""
        shoulder, _ = inner_hinges(short, alpha, alpha, weight)
        return shoulder - inner_hinges(short, np.zeros_like(alpha), alpha, weight)[0]

    def at_zero_thrust(angle: float) -> float:
        return float(excess(np.ones(1), np.array([angle]))[0])

    widest = root(at_zero_thrust, 2.3, 2.9)
    points = chebyshev.chebpts1(NODES)
    places = [(left + right + (right - left) * points) / 2 for left, right in pairwise(EDGES)]
    square = np.concatenate(places) * widest**2
    alpha = np.sqrt(square)
    # The shoulder asks for less as the thrust falls.
    ends = np.zeros_like(alpha), np.minimum(square, 1.0)
    find: Any = elementwise.find_root
    short: Array = find(excess, ends, args=(alpha,), tolerances={"xrtol": TIGHT}).x
    # Near alpha_l the thickness the crown asks for is all but undetermined.
    eta, hinge = inner_hinges(short, alpha, alpha, weight)
    values = np.stack([short / square, eta / square**2, hinge / square], axis=1)
    pieces: list[Array] = [
        np.asarray(chebyshev.chebfit(points, piece, NODES - 1), dtype=float)
        for piece in np.split(values, len(places))
    ]
    return Rotational(widest, pieces)
