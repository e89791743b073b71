"""Twelve structures standing and falling.

Question: does each shipped structure stand on one side of its known limit and fall on the
other, and can it be seen? Each is drawn at rest a little inside its limit, with the forces that
hold it, and let go a little beyond it by `direct`.

Expected: all stand and fall as their sources say, no energy is gained, blocks stay solid.

    python -m analysis.gallery OUT [--quick]
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from analysis.command import run
from analysis.drawing import few_colours
from blocksim import Problem, Recording, check, simulate
from blocksim.ask.families import family_of
from blocksim.blocks.assembly import Array
from blocksim.engines.ground import ground_level
from blocksim.kinds.loading import load_known
from blocksim.view.arrows import draw_forces, draw_loads
from blocksim.view.drawing import clipped
from blocksim.view.style import FONT, GROUND, INK, LIVE, QUIET, STONE

SHOWN = {
    "pointed_e0_25": ("Pointed arch", "least thickness {:.4f} m"),
    "ellipse_b0_5": ("Elliptic arch", "least thickness {:.4f} m"),
    "semicircle_point_crown": ("Weight on the crown", "load factor {:.4f}"),
    "oppenheim_7": ("Oppenheim's arch", "push of {:.4f} of its weight"),
    "jack_arch_load": ("Flat arch on piers", "load factor {:.4f}"),
    "piers_h1_c1": ("Arch on piers", "least width of piers {:.4f} m"),
    "two_spans_load_b9": ("Two spans", "load factor {:.4f}"),
    "gable": ("Two struts", "least friction {:.4f}"),
    "ferris_tinloi_5": ("Wall of two storeys", "push of {:.4f} of its weight"),
    "column_six_drums": ("Column of drums", "table tilted by {:.2f}°"),
    "harmonic_5": ("Overhang", "largest overhang {:.4f} m"),
    "box2d_arch": ("Box2D's arch", "least friction {:.4f}"),
}
"""Structures, what they are called on the sheet, and what limit of theirs is known."""
QUICK = ("oppenheim_7", "gable")
ASIDE = 0.02
"""How far inside and beyond its limit each is shown, relative."""
LONGEST = 15.0
"""Time after which a film ends though something moves [sqrt(size/g)]."""
FALLING, SHARE = 0.45, 0.6
"""How far a block has gone in the lower picture of the sheet [size], and at most of its way."""
FRICTION = 1.0
"""Of joints that are taken not to slip: it leaves their limits as they are, and blocks that
fall on each other need not stop dead."""
AROUND = 0.3
"""How far beyond the blocks the pictures of the sheet reach [size]."""
TILTED = 1e-9
"""Gravity across the plane's vertical from which on it is tilted [g]."""


@dataclass(frozen=True, eq=False)
class Shown:
    """A structure inside its limit, with the forces that hold it, and its fall beyond.

    `verdicts` are those of `direct` to either side.
    """

    name: str
    problem: Problem
    forces: Array
    fall: Recording
    verdicts: tuple[str, str]


def main(out: Path, *, quick: bool = False) -> list[Shown]:
    """Draw the sheet; of two structures in a quick run."""
    seen = [shown(name) for name in (QUICK if quick else SHOWN)]
    out.mkdir(parents=True, exist_ok=True)
    with (out / "gallery.png").open("wb") as file:
        few_colours(sheet(seen), file)
    return seen


def shown(name: str) -> Shown:
    """Let a structure stand inside its limit and fall beyond it."""
    known = load_known(name)
    expected = next(each for each in known.expect if each.over)
    rough = math.isinf(known.problem.mu)
    asked = known.problem.with_friction(FRICTION) if rough else known.problem
    family = family_of(asked, str(expected.over))
    sense = 1 if family.stands == "low" else -1
    inside, beyond = (
        family.at(float(expected.value or 0) * (1 + side * sense * ASIDE)) for side in (-1, 1)
    )
    stood, fell = (str(check(each, method="direct").verdict) for each in (inside, beyond))
    fall = simulate(beyond, method="direct", duration=LONGEST)
    forces = check(inside, method="limit").forces
    assert forces is not None  # noqa: S101
    return Shown(name, inside, forces, fall, (stood, fell))


def sheet(seen: Sequence[Shown]) -> Figure:
    """Draw all structures: above as they stand, below as they fall."""
    columns = min(4, len(seen))
    lines = math.ceil(len(seen) / columns)
    frames = [_falling(each.fall) for each in seen]
    boxes = [
        _box(each.fall, (each.fall.poses[0], each.fall.poses[frame]))
        for each, frame in zip(seen, frames, strict=True)
    ]
    tall = [float((high - low)[1] / (high - low)[0]) for low, high in boxes]
    heights = [min(1.2, max(tall[at : at + columns])) for at in range(0, len(tall), columns)]
    wide = 2.9
    size = (wide * columns, sum(2 * wide * each + 0.75 for each in heights))
    with mpl.rc_context(FONT):
        figure = Figure(figsize=size, layout="constrained")
        ratios = [wide * each + more for each in heights for more in (0.6, 0.15)]
        axes = figure.subplots(2 * lines, columns, squeeze=False, height_ratios=ratios)
        for place, each in enumerate(seen):
            problem, fall = each.problem, each.fall
            line, column = divmod(place, columns)
            above, below = axes[2 * line, column], axes[2 * line + 1, column]
            title, words = SHOWN[each.name]
            expected = next(one for one in load_known(each.name).expect if one.over)
            above.set_title(f"{title}\n", fontsize=11)
            above.annotate(words.format(expected.value), (0, 1), xytext=(0, 6),
                           xycoords="axes fraction", textcoords="offset points",
                           color=QUIET)  # fmt: skip
            box = _shaped(boxes[place], heights[line])
            _blocks(above, problem, None, box)
            extent = 2 * problem.assembly.size
            draw_forces(above, problem, each.forces, extent)
            _actions(above, problem)
            _blocks(below, fall.problem, _placed(fall, fall.poses[frames[place]]), box)
        for empty in axes.ravel():
            empty.axis("off")
    return figure


def _shaped(box: tuple[Array, Array], tall: float) -> tuple[Array, Array]:
    """Widen a frame, or heighten it upwards, to a height over its width."""
    (left, bottom), (right, top) = box[0].tolist(), box[1].tolist()
    wide = max(right - left, (top - bottom) / tall)
    middle = (left + right) / 2
    return (
        np.array([middle - wide / 2, bottom]),
        np.array([middle + wide / 2, bottom + tall * wide]),
    )


def _falling(fall: Recording) -> int:
    """Choose a frame of a fall at which it is seen, and not yet over."""
    moved = np.maximum.accumulate(fall.displacement)
    return int(np.searchsorted(moved, min(FALLING, SHARE * float(moved[-1]))))


def _actions(axes: Axes, problem: Problem) -> None:
    """Draw a load on a block where it acts; what acts on all blocks as one arrow beside."""
    if problem.live and not problem.live[0].per_weight:
        draw_loads(axes, problem, 2 * problem.assembly.size)
        return
    pull = problem.gravity[:2]
    tilted = abs(float(pull[0])) > TILTED
    way, tone = (
        (pull, QUIET) if tilted else (problem.live[0].force if problem.live else None, LIVE)
    )
    if way is None:
        return
    corners = np.concatenate([block.vertices for block in problem.assembly.blocks])
    long = AROUND * problem.assembly.size * way / np.hypot(*way)
    # To the left of the blocks, half way up.
    left = float(corners[:, 0].min()) - 0.1 * problem.assembly.size
    tip = np.array([left, float(corners[:, 1].mean()) + min(0.0, float(long[1])) / 2])
    start = tip - long
    axes.annotate("", tip, start, annotation_clip=False,
                  arrowprops={"arrowstyle": "-|>", "color": tone, "lw": 1.6})  # fmt: skip


def _box(fall: Recording, poses: Sequence[Array]) -> tuple[Array, Array]:
    """Frame the blocks at two moments [m]."""
    corners = np.concatenate(
        [corner for pose in poses for parts in _placed(fall, pose) for corner in parts]
    )
    around = AROUND * fall.assembly.size
    low, high = corners.min(axis=0) - around, corners.max(axis=0) + around
    low[1] += around / 2
    return low, high


def _placed(run: Recording, poses: Array) -> list[list[Array]]:
    """Return the polygons of each block where it is [m]."""
    size = run.assembly.size
    placed: list[list[Array]] = []
    for block, (x, y, turn) in zip(run.assembly.blocks, poses[:, :3].tolist(), strict=True):
        cos, sin = math.cos(turn), math.sin(turn)
        spun = np.array([[cos, sin], [-sin, cos]])
        at = np.array([x, y]) * size
        placed.append([(part - block.centre) @ spun + at for part in block.polygons])
    return placed


def _blocks(
    axes: Axes, problem: Problem, placed: list[list[Array]] | None, box: tuple[Array, Array]
) -> None:
    """Draw blocks where they are, on what they stand."""
    low, high = box
    assembly = problem.assembly
    for support in assembly.supports:
        for part in support.polygons:
            foot = clipped(part, low, high)
            if len(foot):
                axes.add_patch(Polygon(foot, fc=GROUND, ec="none", zorder=0.5))
    polygons = placed or [list(block.polygons) for block in assembly.blocks]
    for parts in polygons:
        for part in parts:
            axes.add_patch(Polygon(part, fc=STONE, ec=INK, lw=0.6, zorder=1))
    axes.set_aspect("equal")
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    level = ground_level(assembly)
    if low[1] < level:
        axes.axhline(level, color=GROUND, lw=1, zorder=0.4)


if __name__ == "__main__":
    run(main, lambda seen: "\n".join(f"{each.name}: {each.verdicts}" for each in seen))
