"""Arches whose supports move: hinges followed by the linear programme, and by `direct`.

Question: how far do the supports of an arch move until it falls? Limit analysis on the
displaced blocks follows the hinges (`blocksim.limit.spreading`). `direct` knows no hinges: it
moves the supports slowly and stops them at times, and blocks stay where they are, or fall.

Expected: semicircles of t/r 0.12, 0.15 and 0.2 (n = 20) fall when their span has grown by
1.668, 5.393 and 15.252 % (`tests/structures/cases/spread_*`), to 1e-4 of it by continuation, to
1 % by `direct`; both agree on other arches and motions, hinges that jump included.

    python -m analysis.spreading OUT [--quick]
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from analysis.command import run
from analysis.rows import write_rows
from blocksim import JointState, structure_of
from blocksim.ask.spread import Spreading
from blocksim.limit.displaced import Frame
from blocksim.limit.spreading import displaced_at
from blocksim.view.style import FONT, GROUND, INK, MECHANISM, PAPER, QUIET, STONE
from tests.structure_cases import case

TOL = 0.005
"""Relative width of the brackets by `direct`."""
SMALL = 1e-6
"""Way of the supports below which a jump is one of round-off [m]."""
KNOWN = {0.12: "spread_90_12_20", 0.15: "spread_90_15_20", 0.2: "spread_90_20_20"}
CURVE = np.linspace(0.11, 0.21, 21)
"""Thicknesses of semicircles followed by continuation alone."""
DOWN, IN = [0, -1], [-1, 0]
OTHERS: dict[str, dict[str, Any]] = {
    "27 voussoirs": {"voussoirs": 27, "thickness": 0.15},
    "friction 0.5": {"thickness": 0.12, "friction": 0.5},
    "segment of 120 deg": {"thickness": 0.1, "left_deg": 60, "right_deg": 60},
    "one support settles": {
        "voussoirs": 12,
        "thickness": 0.13,
        "move": [{"block": "right", "direction": DOWN}],
    },
    "supports approach": {
        "voussoirs": 12,
        "thickness": 0.15,
        "move": [{"block": "right", "direction": IN}],
    },
    "one support turns": {
        "voussoirs": 12,
        "thickness": 0.12,
        "move": [{"block": "right", "turn_deg": 30}],
    },
}


@dataclass(frozen=True, kw_only=True)
class Row:
    """One arch whose supports move.

    Parameters
    ----------
    arch : str
    known : float or None
        How far its supports can move, from outside this code [r].
    limit : float
        By continuation; inf where it does not fall.
    gives : float
        By continuation: where blocks first move by themselves, by more than round-off; less
        than `limit` where they are caught, their hinges having jumped.
    low, high : float or None
        By `direct`: the farthest at which it stayed, and the nearest at which it fell.
    seconds_limit, seconds_direct : float
        Processor time.
    """

    arch: str
    known: float | None
    limit: float
    gives: float
    low: float | None
    high: float | None
    seconds_limit: float
    seconds_direct: float

    @property
    def error(self) -> float:
        """Of the middle of the bracket against where blocks first move, relative."""
        if self.low is None or self.high is None:
            return math.inf
        return abs((self.low + self.high) / 2 / self.gives - 1)


@dataclass(frozen=True)
class Result:
    """All arches, and the curve of span at collapse [r] over thickness [r]."""

    rows: tuple[Row, ...]
    curve: tuple[tuple[float, float], ...]

    @property
    def worst_known(self) -> float:
        """Largest relative error of continuation."""
        return max(abs(row.limit / row.known - 1) for row in self.rows if row.known)

    @property
    def worst_direct(self) -> float:
        """Largest relative difference of `direct` from continuation."""
        return max(row.error for row in self.rows)


def arch(thickness: float, **more: Any) -> Spreading:
    """Make a semicircle of 20 voussoirs without slip, or what else is said."""
    table = {"kind": "circular-arch", "friction": "inf", "voussoirs": 20}
    return Spreading(structure_of({**table, "thickness": thickness, **more}))


def asked(name: str, spreading: Spreading, known: float | None) -> Row:
    """Ask both methods."""
    begin = time.process_time()
    path = spreading.path
    middle = time.process_time()
    seen = spreading.slowly(TOL, spreading.farthest)
    return Row(
        arch=name,
        known=known,
        limit=path.value if path.ends == "collapse" else math.inf,
        gives=next(
            each.value
            for each in path.events
            if each.what in {"snaps", "collapse", "falls-slides", "falls-parts"}
            and each.value > SMALL
        ),
        low=seen.low,
        high=seen.high,
        seconds_limit=round(middle - begin, 2),
        seconds_direct=round(time.process_time() - middle, 2),
    )


def main(out: Path, *, quick: bool = False) -> Result:
    """Run the study, write its table and figure, and return its numbers."""
    rows = [
        asked(f"t/r {thickness:g}", arch(thickness), case(name)["expected"]["value"])
        for thickness, name in list(KNOWN.items())[: 1 if quick else None]
    ]
    others = {"friction 0.5": OTHERS["friction 0.5"]} if quick else OTHERS
    rows += [asked(name, arch(**table), None) for name, table in others.items()]
    curve = [
        (float(each), arch(float(each)).path.value) for each in CURVE[:: 10 if quick else 1]
    ]
    out.mkdir(parents=True, exist_ok=True)
    write_rows(out / "spreading.csv", [asdict(row) for row in rows])
    result = Result(tuple(rows), tuple(curve))
    _figure(result, out / "spreading.png")
    return result


def _figure(result: Result, path: Path) -> None:
    with mpl.rc_context(FONT):
        figure = Figure(figsize=(9, 6.2), layout="constrained")
        axes = figure.subplot_mosaic("abc;ddd", height_ratios=(1, 1.3))
        spreading = arch(0.15)
        frames = [spreading.path.frames[0], *_between(spreading, (0.5, 1.0))]
        for place, frame in zip("abc", frames, strict=True):
            _draw(axes[place], spreading, frame)
        _curve(axes["d"], result)
        figure.savefig(path, dpi=150)


def _between(spreading: Spreading, shares: Sequence[float]) -> list[Frame]:
    """Frames of a path at shares of its length."""
    frames = spreading.path.frames
    return [min(frames, key=lambda each: abs(each.value - share * frames[-1].value))
            for share in shares]  # fmt: skip


def _draw(axes: Axes, spreading: Spreading, frame: Frame) -> None:
    """Draw the blocks where they lie, with their hinges, over where they were built."""
    problem = spreading.problem
    now = displaced_at(problem, replace(spreading.path, frames=(frame,)), frame.value)
    for block in problem.assembly.blocks:
        axes.add_patch(Polygon(block.vertices, fc="none", ec=QUIET, lw=0.4, alpha=0.6))
    for block in now.assembly.blocks:
        axes.add_patch(Polygon(block.vertices, fc=STONE, ec=INK, lw=0.6))
    for move in problem.moves:
        for part in problem.assembly.supports[move.support].polygons:
            axes.add_patch(
                Polygon(part + move.direction * frame.value, fc=PAPER, ec=GROUND, hatch="////")
            )
    hinges = [each.inner for each in now.assembly.joints if each.is_corner]
    if hinges:
        axes.plot(*np.array(hinges).T, "o", ms=5, mfc="white", mec=MECHANISM, mew=1.6)
    axes.set_aspect("equal")
    axes.set_xlim(-1.35, 1.35)
    axes.set_ylim(-0.2, 1.25)
    axes.axis("off")
    closed = sum(state is JointState.CLOSED for state in frame.states) == len(frame.states)
    words = "as built" if closed else f"span {50 * frame.value:+.3f} %"
    axes.set_title(f"t/r 0.15, {words}", fontsize=9)


def _curve(axes: Axes, result: Result) -> None:
    thickness, value = np.array(result.curve).T
    axes.plot(thickness, 50 * value, color=MECHANISM, lw=1.5, label="continuation")
    known = [row for row in result.rows if row.known]
    at = [float(row.arch.split()[-1]) for row in known]
    axes.plot(at, [50 * (row.known or 0) for row in known], "o", ms=9, mfc="none", mec=INK,
              label="independent calculation")  # fmt: skip
    axes.plot(at, [50 * (row.low or math.nan) for row in known], "x", color="#0072B2", ms=7,
              label="direct, supports moved slowly")  # fmt: skip
    axes.set_xlabel("thickness over radius")
    axes.set_ylabel("growth of the span at collapse [%]")
    axes.set_title("Semicircles of 20 voussoirs on spreading supports", fontsize=10)
    axes.legend(frameon=False)


if __name__ == "__main__":
    run(main, lambda found: "\n".join(map(str, found.rows)))
