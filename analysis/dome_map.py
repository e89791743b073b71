"""Least thickness of a hemispherical dome over friction and number of lunes.

Question: how thin can a dome of voussoirs be, and does it fall by turning or by sliding? Each
dome has seven courses and an eye of 8 degrees. Limit analysis in space brackets its thickness;
the mechanism just below says what joints do. Beside it the continuous hemisphere with open
meridians, usually given as 0.042 to 0.043 of the radius (Heyman 1967, Lau 2006).
"""
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

import blocksim
from analysis.command import run
from analysis.rows import FIGURES, read_kept, write_rows
from blocksim import Dome, JointState
from blocksim.common.files import make_folder
from blocksim.view.drawing import save_figure

FRICTIONS = (0.18, 0.2, 0.21, 0.22, 0.24, 0.26, 0.3, 0.35, 0.4, 0.5, 0.7)
LUNES = (4, 6, 12, 24)
PUBLISHED = (0.042, 0.043)
SLIDING = {JointState.SLIDES, JointState.HINGE_AND_SLIDES}
COLOURS = ("#332288", "#0072B2", "#009E73", "#B8860B", "#D55E00", "#AA4499")
MARKERS = "PosD^v"


def row(lunes: int, mu: float, courses: int = 7) -> dict[str, Any]:
    """Bracket one dome.

    Returns: `least` thickness over the radius, None where none up to it stands; `low` and
        `high`, where it was told to fall, and to stand; just below, how many joints between
        lunes open or turn (`meridians_part`), beds turn (`beds_turn`) and joints slide.
    """
    dome = Dome(lunes=lunes, courses=courses, friction=mu)
    found = blocksim.bracket(dome.problem(), over="thickness")
    parts = turns = slides = 0
    if found.low is not None:
        problem = dome.but(thickness=found.low * (1 - 1e-4)).problem()
        states = [each.state for each in blocksim.check(problem).joints]
        for joint, state in zip(problem.assembly.joints, states, strict=True):
            # Meridian joints stand upright; beds do not.
            upright = abs(joint.normal[2]) < 1e-9
            slides += int(state in SLIDING)
            if state is not JointState.CLOSED and state not in SLIDING:
                parts, turns = parts + int(upright), turns + int(not upright)
    return {
        "lunes": lunes,
        "courses": courses,
        "mu": mu,
        "least": found.limit,
        "low": found.low,
        "high": found.high,
        "meridians_part": parts,
        "beds_turn": turns,
        "slide": slides,
    }


def figure(rows: list[dict[str, Any]]) -> Figure:
    """Draw thickness over friction, a line a number of lunes; hollow where joints slide."""
    drawn = Figure(figsize=(7.5, 5))
    axes = drawn.add_subplot()
    axes.axhspan(*PUBLISHED, color="#dddddd", label="continuous hemisphere, published")
    for at, lunes in enumerate(sorted({each["lunes"] for each in rows})):
        mine = [each for each in rows if each["lunes"] == lunes and each["least"]]
        tone = COLOURS[at % len(COLOURS)]
        axes.plot([e["mu"] for e in mine], [e["least"] for e in mine], color=tone, lw=1)
        for each in mine:
            axes.plot(
                each["mu"], each["least"], MARKERS[at % len(MARKERS)], color=tone,
                markerfacecolor="white" if each["slide"] else tone,
            )  # fmt: skip
        if mine:
            # Where they turn all lie on each other: each is named where it begins.
            axes.annotate(
                f"{lunes} lunes", (mine[0]["mu"], mine[0]["least"]), xytext=(6, 2),
                textcoords="offset points", color=tone,
            )  # fmt: skip
    axes.set_xlabel("friction coefficient mu")
    axes.set_ylabel("least thickness over radius")
    axes.set_title("Dome of seven courses, eye of 8 deg; hollow: joints slide", loc="left")
    axes.set_xlim(0.15, 0.75)
    axes.legend(frameon=False, loc="upper right")
    return drawn


def drawn_again(path: Path) -> None:
    """Draw what the rows that are kept say."""
    with path.open("wb") as file:
        save_figure(figure(read_kept(FIGURES / "dome_map.csv")), file, "png")


def main(out: Path, *, quick: bool = False) -> list[dict[str, Any]]:
    """Bracket all domes, and draw their least thickness."""
    lunes, frictions = ((4, 8), (0.25, 0.7)) if quick else (LUNES, FRICTIONS)
    rows = [row(each, mu, 3 if quick else 7) for each in lunes for mu in frictions]
    make_folder(out)
    write_rows(out / "dome_map.csv", rows)
    with (out / "dome_map.png").open("wb") as file:
        save_figure(figure(rows), file, "png")
    return rows


if __name__ == "__main__":
    run(main)
