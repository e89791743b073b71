"""One arch falling in four engines, side by side.

Question: does the same collapse look alike in `direct`, pymunk, pybullet and mujoco, until
blocks have come apart, and lie still in the end? The last two are seen in perspective. All
have one clock and one scale.

Expected: alike until blocks hit the ground; from there on each throws them as it does.

    python -m analysis.four_engines OUT [--quick]

Writes a film (engines.mp4), some of its frames as a picture (engines.png), and rows.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from analysis.command import run
from analysis.drawing import few_colours
from analysis.rows import write_rows
from blocksim.arch.circular import GRAVITY, Arch
from blocksim.arch.limit import least_thickness
from blocksim.ask.simulate import simulate
from blocksim.blocks.joints import JointState
from blocksim.kinds.circular import CircularArch
from blocksim.simulation.recording import Recording
from blocksim.view.canvas import Canvas, Label
from blocksim.view.drawing import words_of
from blocksim.view.film import BEFORE, FOOT, HEAD, TALL, Film, ViewName
from blocksim.view.stage import Stage
from blocksim.view.style import FONT, QUIET, THRUST
from blocksim.view.video import write_film

HALF_ANGLE, FRICTION, VOUSSOIRS = math.radians(90), 0.7, 15
THINNER = 0.07
"""How much thinner than the least thickness the arch is, relative."""
VIEWS: dict[str, ViewName] = {"direct": "2d", "pymunk": "2d", "pybullet": "3d", "mujoco": "3d"}
QUICK = ("direct", "pymunk")
LONGEST = 15.0
"""Time after which a film ends though something moves [sqrt(r/g)]."""
TIMES = (0.0, 1.6, 2.8)
"""Of the frames of the picture but the last, which is the end [sqrt(r/g)]."""
COMPARED = 2.0
"""Time at which engines are compared, before blocks hit the ground [sqrt(r/g)]."""
ACROSS = 2
"""Films beside each other."""
NAMED = 24
"""Height of the line above a film that says its engine, in a frame of 1080 [pixels]."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One engine's collapse.

    Parameters
    ----------
    engine : str
    fallen : float
        By how much the keystone is lower at `COMPARED` [r].
    lopsided : float
        By how much places of blocks are no mirror images then [r].
    ended : float
        Time at which the recording ends [sqrt(r/g)].
    rested : bool
        Whether it ends because the rubble lies still.
    overlap : float
        Deepest overlap of blocks, as the engine says [r].
    gain : float
        Energy gained over what fell, as the engine says.
    """

    engine: str
    fallen: float
    lopsided: float
    ended: float
    rested: bool
    overlap: float
    gain: float


@dataclass(frozen=True)
class Result:
    """A row an engine."""

    rows: tuple[Row, ...]


def main(out: Path, *, quick: bool = False) -> Result:
    """Let the arch go in each engine; write a film of all and a picture of its frames."""
    least = least_thickness(HALF_ANGLE, FRICTION, VOUSSOIRS).eta
    assert least is not None  # noqa: S101
    arch = Arch(half_angle=HALF_ANGLE, eta=(1 - THINNER) * least, voussoirs=VOUSSOIRS)
    problem = CircularArch.of(arch, FRICTION).problem()
    runs = {
        name: simulate(problem, method=name, duration=LONGEST)
        for name in (QUICK if quick else VIEWS)
    }
    out.mkdir(parents=True, exist_ok=True)
    tiled = Tiled(runs, height=360 if quick else 1080)
    write_film(tiled, out / "engines.mp4")
    with (out / "engines.png").open("wb") as file:
        few_colours(picture(tiled), file)
    rows = tuple(measured(name, run) for name, run in runs.items())
    write_rows(out / "four_engines.csv", [asdict(row) for row in rows])
    return Result(rows)


def measured(name: str, run: Recording) -> Row:
    """Measure one engine's collapse."""
    moved = (run.poses - run.poses[0])[..., :2].reshape(len(run.times), -1)
    found = [float(np.interp(COMPARED, run.times, way)) for way in moved.T]
    places = np.reshape(found, (-1, 2))
    return Row(
        engine=name,
        fallen=-float(places[VOUSSOIRS // 2, 1]),
        lopsided=float(np.abs(places - places[::-1] * (-1, 1)).max()),
        ended=float(run.times[-1]),
        rested=bool(run.times[-1] < LONGEST),
        overlap=run.quality.penetration or 0.0,
        gain=run.quality.gain or 0.0,
    )


class Tiled:
    """Films of one collapse, with one heading, clock, scale and legend.

    Parameters
    ----------
    runs : mapping of str to Recording
        By the name of an engine.
    height : int
        Of a frame [pixels].
    """

    def __init__(self, runs: Mapping[str, Recording], height: int) -> None:
        each = list(runs.values())
        self.runs = runs
        # Words, clock and legend are those of a film of all.
        self.whole = Film(each, height=height)
        self.rate, self.count = self.whole.rate, self.whole.count
        self.width, wide = self.whole.width, self.whole.width // ACROSS
        self.films = {
            name: Film(
                [run],
                view=VIEWS[name],
                slow=self.whole.slow,
                height=wide * 9 // 16,
                beside=each,
            )
            for name, run in runs.items()
        }
        self._named = round(NAMED * height / 1080)
        self._foot = round(FOOT * height / TALL)
        lines = math.ceil(len(each) / ACROSS)
        self._tall = self.panel(next(iter(runs)), 0).shape[0]
        self._head = height - self._foot - 2 * (self._tall + self._named)
        self.height = self._head + lines * (self._tall + self._named) + self._foot
        self.height += self.height % 2
        self._canvas = Canvas(self.width, self.height)
        self._canvas.keep([], self._still())

    def panel(self, name: str, number: int) -> NDArray[np.uint8]:
        """Draw a frame of one engine without words; one that has ended shows its last."""
        film = self.films[name]
        scale = film.height / TALL
        picture = film.frame(min(number, film.count - 1))
        return picture[round(HEAD * scale) : film.height - round(FOOT * scale)]

    def at(self, time: float) -> int:
        """Return the number of the frame at a time [sqrt(r/g)]."""
        return round((BEFORE + time / math.sqrt(GRAVITY) * self.whole.slow) * self.rate)

    def frame(self, number: int) -> NDArray[np.uint8]:
        """Draw a frame."""
        ended = [
            self._label(place, f"at rest by t = {run.times[-1]:.1f} √(r/g)", right=True)
            for place, run in enumerate(self.runs.values())
            if run.times[-1] < LONGEST and number >= self.at(float(run.times[-1]))
        ]
        self._canvas.draw([], ended)
        whole = self._canvas.pixels()
        for place, name in enumerate(self.runs):
            left, below = self._corner(place)
            picture = self.panel(name, number)
            top = self.height - below
            whole[top - self._tall : top, left : left + picture.shape[1]] = picture
        whole[-self._foot :] = self.whole.frame(number)[-self._foot :]
        return whole

    def _corner(self, place: int) -> tuple[int, int]:
        """Return the lower left corner of a film [pixels]."""
        line, column = divmod(place, ACROSS)
        above = self._head + (line + 1) * (self._tall + self._named)
        return column * self.width // ACROSS, self.height - above

    def _label(self, place: int, words: str, *, right: bool = False) -> Label:
        """Place words above a film: its name, or at its right what is said more softly."""
        left, below = self._corner(place)
        scale = self._named / NAMED
        x, y = left + 24 * scale, below + self._tall + 6 * scale
        if not right:
            return Label(x, y, words, size=19 * scale, bold=True)
        x = left + self.width / ACROSS - 24 * scale
        return Label(x, y, words, size=15 * scale, across="right")

    def _still(self) -> list[Label]:
        """Say what it is, and which engine is where."""
        words = (
            f"A semicircular arch of {VOUSSOIRS} voussoirs, friction coefficient {FRICTION:g}, "
            f"{100 * THINNER:g} % thinner than the thinnest that stands"
        )
        scale, top = self._named / NAMED, self.height - 0.66 * self._head
        head = Label(24 * scale, top, words, size=25 * scale, bold=True)
        names = [
            self._label(place, f"{name} {run.engine_version}")
            for place, (name, run) in enumerate(self.runs.items())
        ]
        return [head, *names]


def picture(tiled: Tiled) -> Figure:
    """Draw frames of all engines at the same times and at the end, a line an engine."""
    with mpl.rc_context(FONT):
        size = (3.0 * (len(TIMES) + 1), 1.44 * len(tiled.films) + 0.5)
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots(len(tiled.films), len(TIMES) + 1, squeeze=False)
        for line, (name, run) in zip(axes, tiled.runs.items(), strict=True):
            for at, panel in zip((*TIMES, float(run.times[-1])), line, strict=True):
                panel.imshow(tiled.panel(name, tiled.at(at))[..., :3])
                panel.set_xticks([])
                panel.set_yticks([])
                panel.spines[:].set_visible(False)
                if panel in axes[0] and at in TIMES:
                    panel.set_title(f"t = {at:g} √(r/g)", fontsize=10)
            line[0].set_ylabel(name, fontsize=10)
            rests = "at rest" if run.times[-1] < LONGEST else "still moving"
            words = f"{rests}, t = {run.times[-1]:.1f} √(r/g)"
            line[-1].annotate(words, (0.03, 0.94), xycoords="axes fraction", va="top",
                              fontsize=8, color=QUIET)  # fmt: skip
        axes[0, -1].set_title("the end", fontsize=10)
        states = {state for run in tiled.runs.values() for state in Stage(run).states}
        told = [words_of(state, is_arch=True) for state in JointState if state in states]
        told.append(("line of thrust at rest", THRUST))
        lines = [Line2D([], [], color=tone, lw=3, label=words) for words, tone in told]
        figure.legend(handles=lines, loc="outside lower right", ncols=len(lines), frameon=False,
                      fontsize=9)  # fmt: skip
    return figure


if __name__ == "__main__":
    run(main)
