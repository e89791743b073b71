"""Speed against accuracy, for every method that simulates.

Question: what does accuracy cost, and how much does solving each step's contacts to their
end gain over sweeping them? The chart of `blocksim chart`: five arches, hard ones too (thin,
long, steep), bracketed by onset test alone to finer and finer tolerances; error is that of
the bracket's farther end against limit analysis.

The bisection is the same for all, so at equal tolerance errors are equal and times compare.

Expected: at the time pymunk needs for its finest bracket, `direct` is a hundred times nearer
in every arch; so it is at the time pybullet needs.

    python analysis/speed_accuracy.py OUT
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from blocksim.report.chart import write_chart
from blocksim.workprec import cases, gain, measure


@dataclass(frozen=True)
class Result:
    """Headline numbers, by arch: error of each engine over that of `direct` in its time."""

    over_pymunk: dict[str, float]
    over_pybullet: dict[str, float]


def main(out: Path, *, quick: bool = False) -> Result:
    """Measure, draw, and return the gain of `direct` at equal time."""
    chosen = cases(quick=quick)
    points = measure(chosen, repeats=1 if quick else 3)
    write_chart(points, out)
    own = {case.name: [p for p in points if p.case == case.name] for case in chosen}

    def over(engine: str) -> dict[str, float]:
        return {
            name: gain(here, "direct", engine)
            for name, here in own.items()
            if any(p.method == engine for p in here)
        }

    return Result(over_pymunk=over("pymunk"), over_pybullet=over("pybullet"))


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out/speed_accuracy")
    sys.stdout.write(f"{main(folder)}\n")
