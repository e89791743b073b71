"""Words around a film: title, legend, and where gravity pulls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from blocksim.common.words import counted, printable
from blocksim.view.canvas import Label, Panel, Shape, colour, width_of
from blocksim.view.drawing import friction_words, loading_words
from blocksim.view.filmwords import fitting
from blocksim.view.sheet import factor_words
from blocksim.view.stage import Stage
from blocksim.view.style import DASHES, QUIET

LETTER = 13.0
"""Size of the legend's letters [pixels at 720]."""


def gravity_arrow(stage: Stage, panel: Panel, size: float) -> tuple[list[Shape], list[Label]]:
    """Show where gravity pulls in the plane, in a corner, unless it is straight down."""
    way = stage.recording.problem.gravity[:2]
    if way[0] == 0:
        return [], []
    tone = colour(QUIET)
    way = way / np.hypot(*way)
    across = np.array([-way[1], way[0]])
    middle = np.array([panel.x + panel.width - 64 * size, panel.y + panel.height - 36 * size])
    tip = middle + 30 * size * way
    back = tip - 13 * size * way
    head = np.array([tip, back + 5.5 * size * across, back - 5.5 * size * across])
    shaft = np.array([middle - 30 * size * way, back])
    shapes = [
        Shape(shaft, edge=tone, width=2.5 * size, closed=False),
        Shape(head, fill=tone),
    ]
    under = float(middle[1]) - 52 * size
    words = Label(float(middle[0]), under, "gravity", size=13 * size, across="center")
    return shapes, [words._replace(colour=QUIET)]


def title(
    stage: Stage, panel: Panel, verdict: str, top: float, size: float, *, moving: bool
) -> list[Label]:
    """Say what it is, outcome, loading and engine, above a panel."""
    problem = stage.recording.problem
    built = [*problem.measures, counted(len(stage.assembly.blocks), "block")]
    built.append(friction_words(problem.mu))
    facts = [verdict, *(loading_words(problem) or factor_words(stage.carried))]
    head = printable(problem.title) or "   ".join(built)
    facts[1:1] = built if problem.title else []
    facts[1:1] = ["still moving as it ends"] if moving else []
    run = stage.recording
    if (known := run.quality.known) is not None:
        sized = problem.has_size
        until = f"{known * problem.seconds:.2g} s" if sized else f"{known:.2g} √(r/g)"
        facts.append(f"known to 1 % until {until}")
    below = printable(f"{', '.join(facts)}   {run.engine} {run.engine_version}")
    x, wide = panel.x + 24 * size, panel.width - 48 * size
    head = fitting(head, 20 * size, wide, bold=True)
    below = fitting(below, 15 * size, wide)
    return [
        Label(x, top - 36 * size, head, size=20 * size, bold=True),
        Label(x, top - 61 * size, below, size=15 * size, colour=QUIET),
    ]


def legend_of(
    entries: Sequence[tuple[str, str]], width: float, size: float
) -> tuple[list[Shape], list[Label]]:
    """Explain colours by words, from the lower right corner of a frame so wide."""
    shapes, labels = list[Shape](), list[Label]()
    x, y = width - 24 * size, 15 * size
    for words, tone in reversed(entries):
        x -= width_of(words, LETTER * size)
        labels.append(Label(x, y, words, size=LETTER * size))
        line = np.array([[x - 28 * size, y + 5 * size], [x - 8 * size, y + 5 * size]])
        shapes.append(
            Shape(
                line, edge=colour(tone), width=5 * size, closed=False,
                dash=DASHES.get(tone, ()),
            )
        )  # fmt: skip
        x -= 54 * size
    return shapes, labels
