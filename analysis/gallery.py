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
from dataclasses import dataclass, replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.command import run
from analysis.drawing import few_colours
from blocksim import Problem, Recording, check, simulate
from blocksim.ask.families import family_of
from blocksim.blocks.assembly import Array
from blocksim.engines.ground import ground_level
from blocksim.kinds.loading import load_known
from blocksim.limit.displaced import moved
from blocksim.view.arrows import draw_forces, draw_gravity
from blocksim.view.structure import draw_structure
from blocksim.view.style import FONT, GROUND, QUIET

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
    pairs = [(each.problem, _falling(each.fall)) for each in seen]
    boxes = [_box(pair) for pair in pairs]
    tall = [float((high - low)[1] / (high - low)[0]) for low, high in boxes]
    heights = [min(1.2, max(tall[at : at + columns])) for at in range(0, len(tall), columns)]
    wide = 2.9
    size = (wide * columns, sum(2 * wide * each + 0.75 for each in heights))
    with mpl.rc_context(FONT):
        figure = Figure(figsize=size, layout="constrained")
        ratios = [wide * each + more for each in heights for more in (0.6, 0.15)]
        axes = figure.subplots(2 * lines, columns, squeeze=False, height_ratios=ratios)
        for place, (each, problems) in enumerate(zip(seen, pairs, strict=True)):
            line, column = divmod(place, columns)
            above, below = axes[2 * line : 2 * line + 2, column]
            title, words = SHOWN[each.name]
            expected = next(one for one in load_known(each.name).expect if one.over)
            above.set_title(f"{title}\n", fontsize=11)
            above.annotate(words.format(expected.value), (0, 1), xytext=(0, 6),
                           xycoords="axes fraction", textcoords="offset points",
                           color=QUIET)  # fmt: skip
            low, high = _shaped(boxes[place], heights[line])
            for panel, problem in zip((above, below), problems, strict=True):
                shown = draw_structure(panel, problem)
                draw_gravity(panel, problem, np.concatenate(shown))
                panel.axhline(ground_level(problem.assembly), color=GROUND, lw=1, zorder=0.4)
                panel.set(aspect="equal", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
            draw_forces(above, each.problem, each.forces, 2 * each.problem.assembly.size)
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


def _falling(fall: Recording) -> Problem:
    """Return a problem as its fall is seen, and not yet over; nothing is pushed any more."""
    far = np.maximum.accumulate(fall.displacement)
    frame = int(np.searchsorted(far, min(FALLING, SHARE * float(far[-1]))))
    poses = fall.poses[frame, :, :3] * [fall.assembly.size, fall.assembly.size, 1.0]
    blocks = tuple(map(moved, fall.assembly.blocks, poses))
    assembly = replace(fall.assembly, blocks=blocks, joints=())
    return replace(fall.problem, assembly=assembly, dead=(), live=(), road=(), maker=None)


def _box(problems: Sequence[Problem]) -> tuple[Array, Array]:
    """Frame the blocks at two moments [m]."""
    blocks = [block for each in problems for block in each.assembly.blocks]
    corners = np.concatenate([block.vertices for block in blocks])
    around = AROUND * problems[0].assembly.size
    return corners.min(axis=0) - [around, around / 2], corners.max(axis=0) + around


if __name__ == "__main__":
    run(main, lambda seen: "\n".join(f"{each.name}: {each.verdicts}" for each in seen))
