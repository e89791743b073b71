"""The map for the weight of true annular sectors, beside the paper's.

Question: how does the map change where each slice weighs at its own centroid, at the radius
1 + eta^2/12? Derivation in `sector.md`. Landmark points come from their definitions; the least
thickness is compared with limit analysis whose joints close in on those that act, which is
the limit of infinitely many.

Expected: agreement to 1e-7; sliding at the same half-angles; more thickness where the shoulder
turns, less where it slides.
"""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.command import run
from blocksim.arch.circular import WEIGHTS, Weight
from blocksim.arch.limit.halfplanes import Joints
from blocksim.arch.limit.statics import Bound, admissible, spread_of, thrust_bounds
from blocksim.arch.theory import landmarks, least_thickness, least_thicknesses, regions
from blocksim.arch.theory.map import special_angles
from blocksim.blocks.assembly import Array
from blocksim.view.drawing import save_figure
from blocksim.view.style import FONT, INK

CHECKS = ((1.2, 0.6), (math.pi / 2, math.inf), (math.pi / 2, 0.37), (2.18, 0.9), (2.43, 1.35),
          (2.53, 1.6), (2.56, 2.5), (2.6, 3.0), (2.64, 40.0), (2.62, math.inf))  # fmt: skip
"""Half-angle and friction, at least one in every region."""
TOLERANCE = 1e-7
ZOOMS, QUICK_ZOOMS = 8, 7


def limit_eta(half_angle: float, mu: float, weight: Weight, zooms: int) -> float:
    """Least thickness as joints close in on those that act; nan where none stands."""
    joints: Array = np.linspace(0, half_angle, 41)
    spacing, eta = half_angle / 40, math.nan
    for _ in range(zooms):
        low, high = 0.0, 2.0
        if not admissible(_bounds(joints, high, mu, weight)):
            return math.nan
        while (eta := (low + high) / 2) not in (low, high):
            stands = admissible(_bounds(joints, eta, mu, weight))
            low, high = (low, eta) if stands else (eta, high)
        eta = high
        found = _bounds(joints, eta, mu, weight)
        active = {i for bound in found for i in bound[2:] if i >= 0}
        spacing /= 4
        near = [joints[i] + spacing * np.arange(-4, 5) for i in active]
        joints = np.unique(np.clip(np.concatenate([joints, *near]), 0, half_angle))
    return eta


def _bounds(joints: Array, eta: float, mu: float, weight: Weight) -> tuple[Bound, Bound]:
    return thrust_bounds(Joints(joints[None]), eta, mu, spread_of(eta, weight))


def main(out: Path, quick: bool = False) -> dict[str, float]:
    """Compute, check and draw.

    Parameters
    ----------
    out : Path
        Folder of `sector_map.svg`, `.png` and `sector_landmarks.md`.
    quick : bool
        Joints one step coarser, no SVG.

    Returns
    -------
    dict of str to float
        Largest difference from limit analysis, and the sector's landmark points.

    Raises
    ------
    ValueError
        If theory and limit analysis are farther apart than `TOLERANCE`.
    """
    worst = 0.0
    for half_angle, mu in CHECKS:
        eta = least_thickness(half_angle, mu, "sector").eta
        found = limit_eta(half_angle, mu, "sector", QUICK_ZOOMS if quick else ZOOMS)
        worst = max(worst, abs((math.nan if eta is None else eta) - found))
        if not worst <= TOLERANCE:
            message = f"alpha = {half_angle}, mu = {mu}: theory {eta}, limit {found}"
            raise ValueError(message)
    out.mkdir(parents=True, exist_ok=True)
    (out / "sector_landmarks.md").write_text(_table())
    figure = _figure()
    for kind in ("png",) if quick else ("png", "svg"):
        with (out / f"sector_map.{kind}").open("wb") as file:
            save_figure(figure, file, kind)
    numbers = {"largest_difference": worst}
    for name, mark in landmarks("sector").items():
        numbers |= {f"eta_{name}": mark.eta, f"mu_{name}": mark.mu}
        numbers |= {f"half_angle_{name}": mark.half_angle}
    return numbers


def _table() -> str:
    lines: list[str] = []
    for weight in WEIGHTS:
        marks = landmarks("sector" if weight == "sector" else "centreline")
        special = special_angles("sector" if weight == "sector" else "centreline")
        for symbol in ("eta", "mu", "half_angle", "thrust", "beta_r", "beta_s"):
            values = [f"{getattr(mark, symbol):.12f}" for mark in marks.values()]
            if symbol == "half_angle":
                angles = (special.widest_hinge, special.zero_thrust, special.limit)
                values += [f"{angle:.12f}" for angle in angles]
            else:
                values += [""] * 3
            lines.append(f"| {weight}: {symbol} | " + " | ".join(values) + " |")
    return "\n".join(lines) + "\n"


def _figure() -> Figure:
    """Draw both maps, and how much more thickness the sector needs."""
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(11.0, 5.6), layout="constrained")
        axes, more = figure.subplots(1, 2)
        for weight, colour, style in (
            ("centreline", INK, "-"),
            ("sector", "#D55E00", "--"),
        ):
            marks = landmarks(weight)
            alpha = (
                0.995 * special_angles(weight).zero_thrust * np.sqrt(np.linspace(0.02, 1, 200))
            )
            lines = (
                regions.divide(np.linspace(0.02, marks["B"].mu, 160), weight),
                regions.first_sliding(alpha, weight),
                regions.equal_angles(np.linspace(marks["S"].mu + 1e-6, 4, 80), weight),
                regions.crown_hinge(np.linspace(marks["J"].mu + 1e-6, 4, 80), weight),
            )
            for k, line in enumerate(lines):
                axes.plot(line.mu, line.eta, color=colour, ls=style, lw=1.7 if k == 0 else 1.1,
                          label=weight if k == 0 else None)  # fmt: skip
            for mark in marks.values():
                axes.plot(mark.mu, mark.eta, "o", ms=5, mfc="white", mec=colour, zorder=4)
                place = (-12, 3) if weight == "sector" else (5, -10)
                if mark.name != "S":
                    axes.annotate(mark.name, (mark.mu, mark.eta), xytext=place, color=colour,
                                  textcoords="offset points")  # fmt: skip
        axes.set(xlim=(0, 4), ylim=(0, 2), xlabel=r"friction coefficient $\mu$",
                 ylabel=r"thickness-to-radius ratio $\eta$")  # fmt: skip
        axes.set_title("Lines of the map")
        axes.legend(frameon=False, loc="lower right")
        alpha = np.linspace(0.3, 2.648, 600)
        for mu, style in ((math.inf, "-"), (2.5, "--"), (1.6, "-."), (0.9, ":")):
            thin, thick = (least_thicknesses(alpha, mu, weight).eta for weight in WEIGHTS)
            name = r"\infty" if math.isinf(mu) else f"{mu:g}"
            more.plot(np.degrees(alpha), 100 * (thick / thin - 1), color=INK, ls=style,
                      lw=1.4, label=rf"$\mu = {name}$")  # fmt: skip
        more.set(xlabel=r"half-angle $\alpha$ [°]", title="Thickness beyond the centreline's",
                 ylabel=r"$\eta_{sector}/\eta_{centreline} - 1$ [%]")  # fmt: skip
        more.set_yscale("symlog", linthresh=0.1)
        more.grid(color="#dddddd", lw=0.6)
        more.legend(frameon=False, loc="upper left")
    return figure


if __name__ == "__main__":
    run(main)
