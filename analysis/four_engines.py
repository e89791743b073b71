"""One arch falling in four engines.

Question: does the same collapse look alike in `direct`, pymunk, pybullet and mujoco, until
blocks have come apart, and lie still in the end? The last two are seen in perspective.

Expected: alike until blocks hit the ground; from there on each throws them as it does.

    python -m analysis.four_engines OUT [--quick]
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from analysis.command import run
from analysis.drawing import few_colours
from blocksim import CircularArch, JointState, Recording, simulate
from blocksim.arch.circular import GRAVITY
from blocksim.view.drawing import words_of
from blocksim.view.film import BEFORE, FOOT, HEAD, TALL, Film, ViewName
from blocksim.view.stage import Stage
from blocksim.view.style import FONT, QUIET, THRUST

HALF_ANGLE, FRICTION, VOUSSOIRS = math.radians(90), 0.7, 15
THINNER = 0.07
"""How much thinner than the least thickness the arch is, relative."""
VIEWS: dict[str, ViewName] = {"direct": "2d", "pymunk": "2d", "pybullet": "3d", "mujoco": "3d"}
QUICK = ("direct", "pymunk")
LONGEST = 15.0
"""Time after which a recording ends though something moves [sqrt(r/g)]."""
TIMES = (0.0, 1.6, 2.8)
"""Of the frames but the last, which is the end [sqrt(r/g)]."""


def main(out: Path, *, quick: bool = False) -> dict[str, Recording]:
    """Let the arch go in each engine; draw the same moments of each."""
    arch = CircularArch(half_angle=HALF_ANGLE, ratio=1 - THINNER, voussoirs=VOUSSOIRS,
                        friction=FRICTION, weight="centreline")  # fmt: skip
    runs = {
        name: simulate(arch, method=name, duration=LONGEST)
        for name in (QUICK if quick else VIEWS)
    }
    out.mkdir(parents=True, exist_ok=True)
    with (out / "engines.png").open("wb") as file:
        few_colours(picture(runs, height=270 if quick else 540), file)
    return runs


def picture(runs: Mapping[str, Recording], height: int) -> Figure:
    """Draw frames of all engines at the same times and at the end, a line an engine."""
    beside = list(runs.values())
    scale = height / TALL
    within = slice(round(HEAD * scale), height - round(FOOT * scale))
    with mpl.rc_context(FONT):
        size = (3.0 * (len(TIMES) + 1), 1.44 * len(runs) + 0.5)
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots(len(runs), len(TIMES) + 1, squeeze=False)
        for line, (name, each) in zip(axes, runs.items(), strict=True):
            film = Film([each], view=VIEWS[name], height=height, beside=beside)
            for at, panel in zip((*TIMES, float(each.times[-1])), line, strict=True):
                shown = BEFORE + at / math.sqrt(GRAVITY) * film.slow
                frame = film.frame(min(round(shown * film.rate), film.count - 1))
                panel.imshow(frame[within, :, :3])
                panel.set_xticks([])
                panel.set_yticks([])
                panel.spines[:].set_visible(False)
                if panel in axes[0] and at in TIMES:
                    panel.set_title(f"t = {at:g} √(r/g)", fontsize=10)
            line[0].set_ylabel(name, fontsize=10)
            rests = "at rest" if each.times[-1] < LONGEST else "still moving"
            words = f"{rests}, t = {each.times[-1]:.1f} √(r/g)"
            line[-1].annotate(words, (0.03, 0.94), xycoords="axes fraction", va="top",
                              fontsize=8, color=QUIET)  # fmt: skip
        axes[0, -1].set_title("the end", fontsize=10)
        states = {state for each in beside for state in Stage(each).states}
        told = [words_of(state, is_arch=True) for state in JointState if state in states]
        told.append(("line of thrust at rest", THRUST))
        lines = [Line2D([], [], color=tone, lw=3, label=words) for words, tone in told]
        figure.legend(handles=lines, loc="outside lower right", ncols=len(lines), frameon=False,
                      fontsize=9)  # fmt: skip
    return figure


if __name__ == "__main__":
    run(
        main,
        lambda runs: "\n".join(f"{name}: {each.times[-1]:.1f}" for name, each in runs.items()),
    )
