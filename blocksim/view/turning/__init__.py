"""A page in which blocks are turned around: words, a model and a viewer of models."""

from __future__ import annotations

import base64
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import blocksim
from blocksim.view.models import mechanism_model
from blocksim.view.sheet import built_words, title_of
from blocksim.view.solidscene import told
from blocksim.view.stage import SolidStage
from blocksim.view.style import INK, PAPER, QUIET, VERDICTS
from blocksim.view.templates import template_of

if TYPE_CHECKING:
    from blocksim.ask.check import Check
    from blocksim.blocks.problem import Problem
    from blocksim.blocks.space.assembly import SpatialAssembly

VIEWER = Path(__file__).parent / "model-viewer.min.js"
"""<model-viewer> as the registry of npm has it, @google/model-viewer."""
VERSION = "4.4.0"


def turning_page(answer: Check[SpatialAssembly]) -> str:
    """Return the page as HTML, complete in itself."""
    problem: Problem[Any] = answer.problem
    turned, raised = map(math.degrees, SolidStage.eye)
    return template_of("blocksim.view.turning", "page.html").render(
        title=title_of(problem),
        verdict=f"{answer.verdict.value}, by {answer.method}",
        about=", ".join(built_words(problem)),
        model=base64.b64encode(mechanism_model(answer)).decode(),
        told=told(each.state for each in answer.joints),
        # As pictures are seen: about the vertical from the front, and from the zenith.
        orbit=f"{turned:g}deg {90 - raised:g}deg",
        moves=answer.mechanism is not None,
        tone=VERDICTS[answer.verdict],
        paper=PAPER,
        ink=INK,
        quiet=QUIET,
        script=VIEWER.read_text(encoding="utf-8"),
        viewer=VERSION,
        version=blocksim.__version__,
    )
