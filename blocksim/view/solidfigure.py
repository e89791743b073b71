"""A problem in space in perspective, with its answer and how it begins to fall."""
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from scipy.spatial.transform import Rotation

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.limit.space import SpatialEquilibrium
from blocksim.view.drawing import literal, state_of_any, words_of
from blocksim.view.solidjoints import force_lines, marks_of
from blocksim.view.solidscene import Camera, blocks_of, moving_box, supports_of
from blocksim.view.style import FONT, INK, PAPER, QUIET, THRUST, VERDICTS

if TYPE_CHECKING:
    from blocksim.ask.check import Check
    from blocksim.blocks.space.problem import SpatialProblem

WAY = 0.15
"""How far the mechanism is drawn: its largest way in units of the size."""


def solid_figure(answer: Check[SpatialProblem]) -> Figure:
    """Draw blocks in space; of what falls, moved as its collapse begins.

    Parameters
    ----------
    answer : Check

    Returns
    -------
    Figure
    """
    assembly, rates = answer.problem.assembly, answer.mechanism
    low, high = moving_box(assembly)
    if rates is None:
        rates = np.zeros((len(assembly.blocks), 6))
    turns = Rotation.from_rotvec(WAY * rates[:, 3:]).as_matrix()
    marks = marks_of(assembly, [each.state for each in answer.joints])
    pieces = supports_of(assembly, low, high)
    pieces += blocks_of(assembly, turns, WAY * assembly.size * rates[:, :3], marks)
    camera = Camera(low, high)
    with mpl.rc_context(FONT):
        figure = _figure(answer, *camera.painted(pieces))
        static = answer.static
        forces = static.point_forces if isinstance(static, SpatialEquilibrium) else None
        if forces is not None:
            _draw_forces(figure, answer.problem, forces, camera)
    return figure


def _draw_forces(
    figure: Figure, problem: SpatialProblem, forces: Array, camera: Camera
) -> None:
    """Draw the resultants of joints over the blocks, as wide as they are large."""
    lines, shares = force_lines(problem, forces)
    seen = [camera.seen(line) for line, share in zip(lines, shares, strict=True) if share]
    widths = [0.4 + 2.6 * share for share in shares.tolist() if share]
    (axes,) = figure.axes
    axes.add_collection(
        LineCollection(seen, colors=THRUST, linewidths=widths, capstyle="round",
                       gid="forces")
    )  # fmt: skip
    figure.text(0.97, 0.035, "forces at joints: length and width in proportion", ha="right",
                color=THRUST)  # fmt: skip


def _figure(answer: Check[SpatialProblem], polygons: list[Array], fills: list[Array]) -> Figure:
    """Put polygons, title and legend on paper."""
    figure = Figure(figsize=(8, 6), facecolor=PAPER)
    axes = figure.add_axes((0.03, 0.09, 0.94, 0.8))
    axes.add_collection(
        PolyCollection(polygons, facecolors=fills, edgecolors=INK, linewidths=0.4)
    )
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_axis_off()
    problem = answer.problem
    figure.text(
        0.04, 0.94, answer.verdict.value.upper(),
        color=VERDICTS[answer.verdict], fontsize=13, fontweight="bold",
    )  # fmt: skip
    words = f"{problem.title or 'blocks in space'}, {len(problem.assembly.blocks)} blocks, "
    figure.text(0.04, 0.905, literal(f"{words}mu {problem.mu:g}"), color=QUIET, fontsize=9)
    states = {state_of_any(each.state) for each in answer.joints} - {JointState.CLOSED}
    told = [words_of(each, is_arch=False) for each in sorted(states)]
    if told:
        figure.legend(
            handles=[Patch(facecolor=tone, label=said) for said, tone in told],
            loc="lower left", bbox_to_anchor=(0.03, 0.02), ncols=len(told), frameon=False,
        )  # fmt: skip
    if answer.mechanism is not None:
        figure.text(0.97, 0.035, "as it begins to fall, enlarged", ha="right", color=QUIET)
    return figure
