"""Words of films: title, legend, outcome, where gravity pulls; words that fit."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from blocksim.common.words import counted, printable
from blocksim.simulation.motion import MOVED, UNMOVED
from blocksim.simulation.recording import Recording
from blocksim.simulation.shaken import outcome
from blocksim.simulation.verdict import Verdict
from blocksim.view.canvas import Label, Panel, Shape, arrow, colour, width_of
from blocksim.view.drawing import friction_words, loading_words
from blocksim.view.sheet import factor_words, title_of
from blocksim.view.stage import SolidStage, Stage
from blocksim.view.style import DASHES, QUIET
from blocksim.view.timeline import UPRIGHT
from blocksim.view.views import View, direction

CLOCK = 405.0
"""Width of the clock and of what stands beside it, left of the legend [pixels at 720]."""
LETTER = 13.0
"""Size of the legend's letters [pixels at 720]."""
LENGTH = 6.0
"""How long the motion takes in a film whose slowness is not given, about [s]."""
SLOW = (1, 2, 3, 4, 5, 6, 8)
"""Slow motion is one of these times a power of ten."""


def gravity_arrow(
    stage: Stage | SolidStage, view: View, panel: Panel, size: float
) -> tuple[list[Shape], list[Label]]:
    """Show where a view sees gravity pull, in the left corner, unless that is straight down."""
    problem = stage.recording.problem
    pull = UPRIGHT @ problem.gravity if problem.in_space else problem.gravity
    straight = direction(view, np.zeros(3), np.array([0.0, -1.0, 0.0]))
    way = direction(view, np.zeros(3), pull / np.linalg.norm(pull))
    if not way.any() or np.allclose(straight, way, atol=1e-9, rtol=0):
        return [], []
    middle = np.array([panel.x + 64 * size, panel.y + panel.height - 36 * size])
    half = 30 * size * way
    shapes = arrow(middle - half, middle + half, colour(QUIET), size)
    under = float(middle[1]) - 52 * size
    words = Label(float(middle[0]), under, "gravity", size=13 * size, across="center")
    return shapes, [words._replace(colour=QUIET)]


def title(
    stage: Stage | SolidStage,
    panel: Panel,
    verdict: str,
    top: float,
    size: float,
    *,
    moving: bool,
) -> list[Label]:
    """Say what it is, outcome, loading and engine, above a panel."""
    problem = stage.recording.problem
    blocks = len(stage.assembly.blocks) - len(stage.carriers)
    built = [*problem.measures, counted(blocks, "block")]
    built.append(friction_words(problem.mu))
    facts = [verdict, *(loading_words(problem) or factor_words(stage.carried))]
    head = title_of(problem) if problem.title else "   ".join(built)
    facts[1:1] = built if problem.title else []
    facts[1:1] = ["still moving as it ends"] if moving else []
    run = stage.recording
    facts[1:1] = ["contact forces not found"] if run.unsolved else []
    if (known := run.quality.known) is not None:
        sized = problem.has_size
        until = f"{known * problem.seconds:.2g} s" if sized else f"{known:.2g} √(r/g)"
        facts.append(f"known to 1 % until {until}")
    engine = printable(f"   {run.engine} {run.engine_version}")
    x, wide = panel.x + 24 * size, panel.width - 48 * size
    head = fitting(head, 20 * size, wide, bold=True)
    # Where there is little room facts are cut off: the engine tells films apart.
    # Small letters are set a little wider than they are measured.
    room = 0.94 * wide - width_of(engine, 15 * size)
    below = fitting(printable(", ".join(facts)), 15 * size, room) + engine
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
    # Small letters are set a little wider than they are measured.
    wide = [1.06 * width_of(words, LETTER * size) for words, _ in entries]
    room = (x - CLOCK * size - sum(wide)) / max(1, len(entries))
    apart = min(54 * size, max(36 * size, room))
    for (words, tone), long in zip(reversed(entries), reversed(wide), strict=True):
        x -= long
        labels.append(Label(x, y, words, size=LETTER * size))
        line = np.array([[x - 28 * size, y + 5 * size], [x - 8 * size, y + 5 * size]])
        shapes.append(
            Shape(
                line, edge=colour(tone), width=5 * size, closed=False,
                dash=DASHES.get(tone, ()),
            )
        )  # fmt: skip
        x -= apart
    return shapes, labels


def verdict_words(recording: Recording) -> str:
    """Say whether it falls, by how far it has moved."""
    if recording.problem.shaking is not None:
        return outcome(recording)[0].value
    moved = float(recording.displacement.max())
    if moved > MOVED:
        return Verdict.COLLAPSES.value
    if moved <= UNMOVED:
        return "at rest"
    if not recording.problem.has_size:
        return f"has moved {moved:.1g} r"
    return f"has moved {moved * recording.assembly.size:.1g} m"


def fitting(words: str, size: float, wide: float, *, bold: bool = False) -> str:
    """Cut words off where they would not fit into a width in pixels."""
    kept = words
    while len(kept) > 1 and (have := width_of(kept, size, bold=bold)) > wide:
        # Measuring is slow: cut in proportion.
        kept = kept[: min(len(kept) - 2, int(len(kept) * wide / have))].rstrip() + "…"
    return kept


def slowness(seconds: float) -> float:
    """Slow motion that makes a film about `LENGTH` long, never fast."""
    wanted = max(1.0, LENGTH / max(seconds, 1e-9))
    power = 10.0 ** math.floor(math.log10(wanted))
    return min((step * power for step in (*SLOW, 10)), key=lambda slow: abs(slow - wanted))


def digits_of(seconds: float) -> int:
    """Decimals of the clock: thousandths of what is shown."""
    return max(1, min(6, math.ceil(2 - math.log10(max(seconds, 1e-9)))))
