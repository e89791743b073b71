"""Search for the threshold between values that collapse and values that stand.

A value may be a thickness or anything else of which more is safer. Below the threshold the
acceleration that blocks start with falls with the value and vanishes there: in nearly a
straight line, as long as the mechanism is the same. So two ratios that collapsed tell where
the threshold lies, and one that collapses a little below that place tells it better. In the
end a probe to either side closes the bracket, to whatever width; what an engine answers is
never replaced by the estimate. Where the estimate leads nowhere the bracket is halved.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from blocksim.arch.circular import ETA_MAX
from blocksim.common.progress import Progress, silent
from blocksim.simulation.verdict import Verdict

FIRST_STEP = 0.01
"""First guess of the bracket's half-width, relative; doubled until it holds."""
THINNEST = 1e-6
"""Search below this ratio is given up."""
ASIDE = 0.4
"""How far to the sides of the estimate probes are made, in units of the tolerance."""
LOWER = 0.4
"""Where a bracket is divided to see a second collapse; halved, it would be just where a guess
is that was right, and that is the hardest to tell."""
CURVED = 5.0
"""Error of the estimate over the square of how far it reaches, both relative."""


class Answer(NamedTuple):
    """What a judge says of a ratio: its verdict, and the acceleration it starts with [g]."""

    verdict: Verdict
    acceleration: float


class Bisection:
    """Bisection on a judge that may answer `undecided`.

    `judge`: Value to answer.
    `floor`, `ceiling`: Values beyond which the search is given up.
    `name`: What the value is.

    It has:
    `low`, `high`: Largest ratio that collapsed, smallest that stood.
    `runs`, `undecided`: Ratios tried, and those without an answer.
    """

    def __init__(
        self,
        judge: Callable[[float], Answer],
        progress: Progress = silent,
        *,
        floor: float = THINNEST,
        ceiling: float = ETA_MAX,
        name: str = "eta",
    ) -> None:
        self._floor, self._most, self._name = floor, ceiling, name
        self._judge = judge
        self._progress = progress
        self._dark: list[float] = []
        self._falls: list[tuple[float, float]] = []
        self.low: float | None = None
        self.high: float | None = None
        self.runs = 0

    @property
    def undecided(self) -> int:
        """Ratios without an answer."""
        return len(self._dark)

    def probe(self, eta: float) -> Verdict:
        """Ask the judge and keep its answer."""
        verdict, acceleration = self._judge(eta)
        self.runs += 1
        if verdict is Verdict.COLLAPSES:
            self._falls.append((eta, acceleration))
            self.low = eta if self.low is None else max(self.low, eta)
        elif verdict is Verdict.STANDS:
            self.high = eta if self.high is None else min(self.high, eta)
        else:
            self._dark.append(eta)
        return verdict

    def expand(self, guess: float) -> None:
        """Step away from a guess, ever farther, until both answers have been had."""
        step, guess = FIRST_STEP, min(max(guess, self._floor), self._most)
        eta = lowest = min(guess * (1 + step), self._most)
        self._progress(0.0, f"trying {self._name} = {eta:.6g}")
        self.probe(eta)
        while self.high is None and eta < self._most:
            step *= 2
            eta = min(eta * (1 + step), self._most)
            self.probe(eta)
        if self._ceiling() is None:
            return
        step, eta = FIRST_STEP, guess
        while self.low is None and lowest > self._floor:
            eta *= 1 - min(step, 0.5)
            step *= 2
            lowest = max(eta, self._floor)
            self.probe(lowest)

    def bisect(self, tol: float) -> None:
        """Narrow the bracket until its relative width is `tol` or darkness fills it."""
        start, helped = self._width(), True
        while (width := self._width()) > tol:
            share = 0.9 * math.log(start / width) / math.log(start / tol)
            etas = self._around_estimate(tol) if helped else ()
            halves = not etas
            if halves:
                middle = self._inside(tol)
                if middle is None:
                    return
                etas = (middle,)
            for eta in etas:
                if self.low is not None and self.low < eta:
                    self._progress(share, f"trying {self._name} = {eta:.6g}")
                    self.probe(eta)
            # An estimate that did worse than two halvings gives way to one.
            helped = halves or self.low in etas or self._width() < width / 4

    def _ceiling(self) -> float | None:
        """Upper end of the search: what stood, or the thickest arch if it is undecided."""
        return self._most if self.high is None and self._most in self._dark else self.high

    def _width(self) -> float:
        """Relative width of the bracket, 0 while there is none."""
        high = self._ceiling()
        return 0.0 if self.low is None or high is None else 1 - self.low / high

    def _inside(self, tol: float) -> float | None:
        """Inside of the wider end part; nothing is to be learnt between undecided ratios."""
        floor, ceiling = self.low, self._ceiling()
        if floor is None or ceiling is None:
            return None
        dark = [eta for eta in self._dark if floor < eta < ceiling]
        below, above = min(dark, default=ceiling), max(dark, default=floor)
        parts = ((floor, below), (above, ceiling))
        low, high = max(parts, key=lambda part: part[1] - part[0])
        share = LOWER if len(self._falls) == 1 else 0.5
        return low + share * (high - low) if high - low > tol * ceiling / 4 else None

    def _around_estimate(self, tol: float) -> tuple[float, ...]:
        """Ratios about where the accelerations of two collapses vanish.

        Below it while that tells the place better than two halvings, at last to both sides.
        """
        if self.high is None or self._dark or len(self._falls) < 2:
            return ()
        (far, more), (near, less) = sorted(self._falls)[-2:]
        if not more > less > 0:
            return ()
        zero = near + less * (near - far) / (more - less)
        aside = zero * max(ASIDE * tol, CURVED * (1 - far / zero) * (1 - near / zero))
        below = zero - aside
        if ASIDE * tol * zero < aside < (zero - near) / 4 and below < self.high:
            return (below,)
        return tuple(eta for eta in (zero + aside, below) if near < eta < self.high)
