"""A problem in space in perspective, with its answer and how it begins to fall."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from blocksim.common.version import __version__
from blocksim.engines import ENGINES
from blocksim.engines.base import Quality, Settings
from blocksim.simulation.recording import Recording
from blocksim.view.acting import Acting
from blocksim.view.canvas import Canvas, Label, Panel, Shape, colour
from blocksim.view.captions import gravity_arrow, legend_of, title
from blocksim.view.solidscene import WAY, force_lines, told
from blocksim.view.stage import SolidStage
from blocksim.view.style import QUIET, THRUST
from blocksim.view.timeline import UPRIGHT
from blocksim.view.views import SpatialView

if TYPE_CHECKING:
    from blocksim.ask.check import Check
    from blocksim.blocks.space.assembly import SpatialAssembly

WIDE, TALL = 1080, 810
HEAD, FOOT = 74.0, 44.0


def solid_figure(answer: Check[SpatialAssembly]) -> Figure:
    """Draw blocks in space. Those that fall are moved as their collapse begins."""
    assembly, rates = answer.problem.assembly, answer.mechanism
    rest = np.zeros((len(assembly.blocks), 6))
    rest[:, :3] = assembly.centres / assembly.size
    moved = 0 * rest if rates is None else WAY * rates
    run = Recording(
        problem=answer.problem, engine=answer.method, engine_version=_version(answer.method),
        settings=Settings(step=1.0, sweeps=1, hold_sweeps=1), times=np.array([0.0, 1.0]),
        poses=np.stack([rest, rest + moved]), quality=Quality(),
    )  # fmt: skip
    stage, panel = SolidStage(run), Panel(0, FOOT, WIDE, TALL - HEAD - FOOT)
    view = SpatialView(stage, panel, stage.swept - [stage.middle, 0.0, 0.0])
    states = tuple(each.state for each in answer.joints)
    moment, acting = stage.at(1.0)._replace(joints=states), Acting(stage, view, panel, 1.0)
    beside, amounts = acting.aside(moment, 1.0)
    forces, loads = _forces(answer, view), [*acting.shapes(moment), *beside]
    canvas, legend = Canvas(WIDE, TALL), [*told(states), *acting.entries]
    head = title(stage, panel, answer.verdict.value.upper(), TALL, 1.0, moving=False)
    said = [] if rates is None else ["as it begins to fall, enlarged"]
    said += ["forces at joints: length and width in proportion"] if forces else []
    foot = Label(24, 15, ", ".join(said), 13.0, QUIET)
    marks, words = legend_of(legend, WIDE, 1.0)
    pull, name = gravity_arrow(stage, view, panel, 1.0)
    canvas.keep([(panel, [*view.still, *pull])], [*head, *name, *amounts, foot, *words])
    whole = Panel(0, 0, WIDE, TALL)
    canvas.draw([(panel, [*view.shapes(moment), *forces, *loads]), (whole, marks)])
    return canvas.figure()


def _version(method: str) -> str:
    """Return the version of an engine's library, or of blocksim for what has none."""
    return ENGINES[method].version if method in ENGINES else __version__


def _forces(answer: Check[SpatialAssembly], view: SpatialView) -> list[Shape]:
    """Draw the resultants of joints over the blocks, as wide as they are large."""
    assembly, carried = answer.problem.assembly, answer.resultants
    if carried is None:
        return []
    lines, shares = force_lines(assembly, carried)
    seen = view.places(lines / assembly.size @ UPRIGHT.T)
    return [
        Shape(line, edge=colour(THRUST), width=0.5 + 3.5 * share, closed=False)
        for line, share in zip(seen, shares.tolist(), strict=True)
        if share
    ]
