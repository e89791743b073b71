"""Figures 3-11 and 13-25 of Cocchetti and Rizzi (2024), with their numbers.

Question: does the software give what the paper prints? Every constant of the text, of
Table 1 and of the captions is computed from what defines it, compared with the printed one,
and the figures are drawn from the same numbers.

Expected: 1e-12 relative at most. Fig. 15's eta for 145 deg, 0.764335711953571, lacks a digit
that Fig. 16 prints, 0.7643357111953571; it is compared with the latter. Fig. 22 prints phi as
73.6 deg for arctan 3.385846504480999 = 73.546 deg, which is 73.5; phi is not compared.
"""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import brentq

from analysis.command import run
from blocksim import Mode
from blocksim.arch.theory import landmarks, least_thickness, least_thicknesses, regions
from blocksim.arch.theory.critical import Critical, inner_sliding, rotational_thrust
from blocksim.arch.theory.equations import hinge_slope
from blocksim.arch.theory.map import divide_friction, special_angles
from blocksim.view.archfigure import arch_figure, picture_of_theory
from blocksim.view.drawing import save_figure
from blocksim.view.linemap import line_map_figure
from blocksim.view.mapregions import CENTRAL, WHOLE, draw_regions
from blocksim.view.style import FONT, INK, QUIET

TOLERANCE = 1e-12
DASHED = (0, (5, 2))
ZOOMS = {6: (0.0, 2.0), 7: (0.0, 1.0), 8: (0.6, 2.0)}
FILLED = (9, 10, 11)

TABLE_1 = {
    "T": (0.6796047320988860, 1.415270827756886, 2.487161163767182, 0.09780581933963814,
          1.037485213550072, 0.2970519164101457),
    "S": (0.9533663968209255, 1.765868462744654, 2.600211150484514, 0.06791978142522512,
          0.2516081968386061, 0.2516081968386061),
    "J": (0.9652414772084208, 1.777213608388237, 2.603266515104794, 0.06718190191428895,
          0.0, 0.2503367611228279),
    "B": (2.0, 2.690297881776622, 2.774176793356034, 0.03200476409857036,
          0.0, 0.1760126676508405),
}  # fmt: skip
"""eta, mu, alpha, h, beta_r, beta_s."""


def numbers() -> dict[str, tuple[float, float]]:
    """Every printed number: computed and published, by name."""
    found: dict[str, tuple[float, float]] = {}
    for name, published in TABLE_1.items():
        mark = landmarks()[name]
        values = (mark.eta, mark.mu, mark.half_angle, mark.thrust, mark.beta_r, mark.beta_s)
        for symbol, value, printed in zip(
            ("eta", "mu", "alpha", "h", "beta_r", "beta_s"), values, published, strict=True
        ):
            found[f"Table 1 {symbol}_{name}"] = (value, printed)
    special = special_angles()
    found["beta_s-beta"] = (special.hinge, 1.129085087576187)
    found["alpha_s-beta"] = (special.widest_hinge, 2.230312828619947)
    found["alpha_l"] = (special.zero_thrust, 2.648388899151005)
    found["alpha_L"] = (special.limit, 2.786498150651177)
    for degrees, *printed in (
        (125, 0.8477497839674316, 0.5081418006878796, 0.9245590639478306, 0.3849612500740051),
        (145, 1.536310506737699, 0.7643357111953571, 1.761938080825641, 0.7406376307743147),
    ):
        alpha = math.radians(degrees)
        mu = divide_friction(alpha)
        eta, _ = regions.at_inner_sliding(mu, alpha, "centreline")
        first = regions.first_sliding(np.array([alpha]))
        values = (mu, eta, float(first.mu[0]), float(first.eta[0]))
        names = ("mu at the divide", "eta at the divide", "mu at first sliding", "eta there")
        for name, value, one in zip(names, values, printed, strict=True):
            found[f"{degrees} deg, {name}"] = (value, one)
    found["Fig. 17 eta, 145 deg"] = (_eta(math.radians(145), 1.6), 0.7566761737936022)
    found["Fig. 17 eta, 125 deg"] = (_eta(math.radians(125), 0.9), 0.4208869235292454)
    wide = landmarks()["J"].half_angle
    found["Fig. 21 eta at mu = 1.79"] = (_eta(wide, 1.79), 0.9630759684607590)
    equal = _equal_angles_friction(wide)
    found["Fig. 21 mu, equal angles"] = (equal, 1.832508693777595)
    found["Fig. 21 eta, equal angles"] = (_eta(wide, equal), 0.9563124518512550)
    first = regions.first_sliding(np.array([wide]))
    found["Fig. 22 mu"] = (float(first.mu[0]), 3.385846504480999)
    found["Fig. 22 eta"] = (float(first.eta[0]), 0.8679273523649103)
    mu = _unit_friction()
    found["Fig. 23 mu"] = (mu, 1.809583028035458)
    found["Fig. 23 alpha"] = (regions.divide_half_angle(mu), 2.611810358168302)
    return found


def _eta(half_angle: float, mu: float) -> float:
    eta = least_thickness(half_angle, mu).eta
    return math.nan if eta is None else eta


def _equal_angles_friction(half_angle: float) -> float:
    """Friction at which beta_r = beta_s, at a given half-angle."""

    def slope(mu: float) -> float:
        thrust, beta_s = inner_sliding(mu)
        return hinge_slope(thrust, half_angle, beta_s, "centreline")

    return float(brentq(slope, 1.8, 1.9, xtol=1e-15))


def _unit_friction() -> float:
    """Friction at which the divide passes eta = 1."""

    def excess(mu: float) -> float:
        return regions.at_inner_sliding(mu, regions.divide_half_angle(mu), "centreline")[0] - 1

    return float(brentq(excess, 1.79, 1.9, xtol=1e-15))


def check(found: dict[str, tuple[float, float]]) -> float:
    """Compare with the printed numbers.

    Returns
    -------
    float
        Largest relative difference (absolute, of a printed 0).

    Raises
    ------
    ValueError
        If one is over `TOLERANCE`.
    """
    worst = 0.0
    for name, (value, printed) in found.items():
        difference = abs(value - printed) / (abs(printed) or 1.0)
        worst = max(worst, difference)
        if not difference <= TOLERANCE:
            message = f"{name}: {value!r}, but the paper prints {printed!r}"
            raise ValueError(message)
    return worst


def mechanisms() -> dict[int, list[tuple[float, float, Mode, Critical]]]:
    """Half-angle, friction, mode and critical state of every arch of Figs 13-25."""
    marks = landmarks()
    special = special_angles()
    pond, basin, wide = math.radians(125), math.radians(145), marks["J"].half_angle
    sides = {
        alpha: (divide_friction(alpha), float(regions.first_sliding(np.array([alpha])).mu[0]))
        for alpha in (pond, basin, wide)
    }
    unit = _unit_friction()
    unit_angle = regions.divide_half_angle(unit)
    t, j, b = marks["T"], marks["J"], marks["B"]
    arches: dict[int, list[tuple[float, float, Mode]]] = {
        13: [(pond, sides[pond][0], Mode.SS), (pond, sides[pond][1], Mode.RRR)],
        14: [(pond, sides[pond][0], Mode.SRR), (pond, sides[pond][1], Mode.SRR)],
        15: [(basin, sides[basin][0], Mode.SS), (basin, sides[basin][1], Mode.RRR)],
        16: [(basin, sides[basin][0], Mode.RRS), (basin, sides[basin][1], Mode.RRS)],
        17: [(basin, 1.6, Mode.RRS), (pond, 0.9, Mode.SRR)],
        18: [(t.half_angle, t.mu, Mode.SS), (t.half_angle, t.mu, Mode.RRR)],
        19: [(t.half_angle, t.mu, Mode.RRS), (t.half_angle, t.mu, Mode.SRR)],
        20: [(wide, j.mu, Mode.SS), (wide, j.mu, Mode.RS)],
        21: [(wide, 1.79, Mode.RSR), (wide, _equal_angles_friction(wide), Mode.RRS)],
        22: [(wide, sides[wide][1], Mode.RRS), (wide, sides[wide][1], Mode.RRR)],
        23: [(unit_angle, unit, Mode.SS), (unit_angle, unit, Mode.RS)],
        24: [(b.half_angle, b.mu, Mode.SS), (b.half_angle, b.mu, Mode.RS)],
        25: [(special.limit, math.inf, Mode.R), (special.zero_thrust, math.inf, Mode.R)],
    }
    return {
        figure: [(a, mu, mode, least_thickness(a, mu)) for a, mu, mode in rows]
        for figure, rows in arches.items()
    }


def main(out: Path, quick: bool = False) -> dict[str, float]:
    """Check the numbers and draw the figures.

    Parameters
    ----------
    out : Path
        Folder of `fig03.svg`, `fig03.png` and so on.
    quick : bool
        Every number, but figures 5, 7 and 17 only, as PNG.

    Returns
    -------
    dict of str to float
        How many numbers were compared, and the largest relative difference.
    """
    found = numbers()
    worst = check(found)
    out.mkdir(parents=True, exist_ok=True)
    (out / "numbers.txt").write_text(
        "".join(
            f"{name}: {value!r} (printed {one!r})\n" for name, (value, one) in found.items()
        )
    )
    figures = (5, 7, 17) if quick else (*range(3, 12), *range(13, 26))
    arches = mechanisms()
    for number in figures:
        if number in arches:
            figure = arch_figure(
                [
                    picture_of_theory(critical, mode, alpha, mu)
                    for alpha, mu, mode, critical in arches[number]
                ]
            )
        else:
            with mpl.rc_context(FONT):
                figure = _figure(number)
        for kind in ("png",) if quick else ("png", "svg"):
            with (out / f"fig{number:02}.{kind}").open("wb") as file:
                save_figure(figure, file, kind)
    return {"compared": float(len(found)), "largest_difference": worst}


def _figure(number: int) -> Figure:
    if number in ZOOMS:
        return line_map_figure(ZOOMS[number])
    if number in FILLED:
        figure = Figure(figsize=(8.6, 7.0), layout="constrained")
        axes = figure.add_subplot()
        draw_regions(axes, CENTRAL if number == 11 else WHOLE)
        for text in axes.texts:
            text.set_visible(number != 10)  # Fig. 10 is without words
        return figure
    rows = {3: 3, 4: 2, 5: 3}[number]
    figure = Figure(figsize=(7.0, 2.6 * rows), layout="constrained")
    panels = [figure.add_subplot(rows, 1, row + 1) for row in range(rows)]
    {3: _rotational, 4: _inner_sliding, 5: _sliding}[number](panels)
    for axes in panels:
        axes.grid(color="#dddddd", lw=0.6)
    return figure


def _rotational(panels: list[Axes]) -> None:
    """Fig. 3: beta_r, eta and h of the rotational mode."""
    special = special_angles()
    # Denser towards alpha_l, where the hinge falls back to the crown.
    alpha = special.zero_thrust * (1 - np.linspace(0.995, 0.0, 400) ** 2)
    state = least_thicknesses(alpha, math.inf)
    curves = ((state.beta_r, r"$\beta_r$"), (state.eta, r"$\eta$"), (state.thrust, "$h$"))
    for axes, (values, name) in zip(panels, curves, strict=True):
        axes.plot(alpha, values, color=INK, lw=1.6)
        axes.set(ylabel=name, xlim=(0, math.pi), ylim=(0, None))
        axes.axvline(special.zero_thrust, color=QUIET, lw=0.8, ls=":")
    panels[0].plot(special.widest_hinge, special.hinge, "o", mfc="white", mec=INK)
    panels[0].annotate(r"$\alpha_{s\beta}$", (special.widest_hinge, special.hinge),
                       xytext=(-4, -16), textcoords="offset points")  # fmt: skip
    panels[0].annotate(r"$\alpha_l$", (special.zero_thrust, 0.05), xytext=(4, 0),
                       textcoords="offset points")  # fmt: skip
    panels[-1].set_xlabel(r"half-angle $\alpha$ [rad]")


def _inner_sliding(panels: list[Axes]) -> None:
    """Fig. 4: h and beta_s at inner sliding."""
    mu = np.linspace(1e-3, 4, 400)
    values = np.array([inner_sliding(float(m)) for m in mu]).T
    for axes, value, name in zip(panels, values, ("$h$", r"$\beta_s$"), strict=True):
        axes.plot(mu, value, color=INK, lw=1.6)
        axes.set(ylabel=name, xlim=(0, 4), ylim=(0, None))
    panels[-1].set_xlabel(r"friction coefficient $\mu$")


def _sliding(panels: list[Axes]) -> None:
    """Fig. 5: beta_s, mu and h of the sliding mode; dashed beyond eta = 2."""
    mu = np.tan(np.geomspace(1e-3, 1.45, 400))
    alpha = np.array([regions.divide_half_angle(float(m)) for m in mu])
    thrust, beta_s = np.array([inner_sliding(float(m)) for m in mu]).T
    real = alpha <= landmarks()["B"].half_angle
    curves = ((beta_s, r"$\beta_s$"), (mu, r"$\mu$"), (thrust, "$h$"))
    for axes, (values, name) in zip(panels, curves, strict=True):
        for where, style in ((real, "-"), (~real, DASHED)):
            axes.plot(alpha[where], values[where], color="#D55E00", lw=1.6, ls=style,
                      label="purely sliding" if style == "-" else None)  # fmt: skip
        axes.set(ylabel=name, xlim=(0, math.pi), ylim=(0, None))
    panels[1].set_ylim(0, 5)
    panels[2].set_ylim(0, 1.02)
    angles = np.linspace(0.05, special_angles().zero_thrust, 200)
    free = [rotational_thrust(float(a), "centreline") for a in angles]
    panels[2].plot(angles, free, color=INK, lw=1.2, ls=(0, (1, 1)), label="purely rotational")
    point = landmarks()["T"]
    panels[2].plot(point.half_angle, point.thrust, "o", mfc="white", mec=INK)
    panels[2].annotate("T", (point.half_angle, point.thrust), xytext=(4, 5),
                       textcoords="offset points", fontweight="bold")  # fmt: skip
    panels[2].legend(frameon=False)
    panels[-1].set_xlabel(r"half-angle $\alpha$ [rad]")


if __name__ == "__main__":
    run(main)
