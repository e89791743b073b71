"""Files of `bracket --over push` and `--over spread`: what is borne as it moves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from blocksim.blocks.problem import Problem
from blocksim.cli.output import picture_kind, save_picture, say
from blocksim.common.checks import require
from blocksim.common.files import write_whole
from blocksim.common.sheets import write_sheet

KINDS = ("csv", "pdf", "svg", "png")
OVER = ("push", "spread")
"""What moves blocks."""


def require_curves(over: str | None, out: Sequence[Path] | None) -> None:
    """Raise `InputError` unless files can be written of what is searched over."""
    if out is not None:
        allowed = "left out, or --vehicle, --over push or --over spread beside it"
        require(over in OVER, "--out", str(out[0]), allowed)
    for path in out or ():
        picture_kind(path, KINDS)


def write_curves(problem: Problem, over: str, out: Sequence[Path], *, silent: bool) -> None:
    """Write tables and pictures of what is borne as it moves."""
    # Drawing and motion take a second to import, which other commands need not wait for.
    from blocksim.view.curvefigure import Line, curve_figure
    from blocksim.view.sheet import title_of

    title = title_of(problem)
    if over == "push":
        from blocksim.ask.push import WAYS, curve

        found = [curve(problem, way) for way in WAYS]
        names = ["way", "moved_m", "push_g"]
        rows = [
            [each.way, moved, push]
            for each in found
            for moved, push in zip(each.moved, each.pushes, strict=True)
        ]
        words = f"{title}: push that is borne as the first mechanism moves"
        lines = [Line(f"to the {each.way}", each.moved, each.pushes) for each in found]
        axes = "way of the centre of mass [m]", "push over weight [g]"
    else:
        from blocksim.ask.moved import thrusts_over

        points = thrusts_over(problem)
        names = ["spread_m", "thrust_min_kN", "thrust_max_kN"]
        rows = [
            [value, *(None if math.isnan(each) else each / 1e3 for each in ends)]
            for value, *ends in points
        ]
        words = f"{title}: thrust at the crown as the supports move apart, until it falls"
        lines = [
            Line(name, [each[0] for each in points], [each[place] / 1e3 for each in points])
            for name, place in (("least thrust", 1), ("greatest thrust", 2))
        ]
        axes = "way of the supports [m]", "thrust [kN]"
    for path in out:
        kind = path.suffix.removeprefix(".")
        if kind == "csv":
            write_whole(path, lambda file: write_sheet(file, names, rows))
            if not silent:
                say(f"wrote {path}")
        else:
            figure = curve_figure(words, *axes, lines)
            if silent:
                from blocksim.view.drawing import save_figure

                write_whole(path, lambda file, f=figure, k=kind: save_figure(f, file, k))
            else:
                save_picture(figure, path, kind)
