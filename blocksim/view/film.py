"""One recording, or two side by side, as frames of a film: clock, words, legend."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, BinaryIO, Literal, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from blocksim.arch.circular import GRAVITY
from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.simulation.recording import Recording
from blocksim.view.acting import Acting
from blocksim.view.camera import EASED, eased, is_lost, needed, zoomed
from blocksim.view.canvas import Canvas, Label, Panel, Part, Shape, colour, width_of
from blocksim.view.captions import (
    digits_of,
    gravity_arrow,
    legend_of,
    slowness,
    title,
    verdict_words,
)
from blocksim.view.drawing import round_length, words_of
from blocksim.view.stage import SPOKEN, SolidStage, Stage
from blocksim.view.style import INK, JOINTS, QUIET, THRUST
from blocksim.view.views import PlanarView, SpatialView, View

ViewName = Literal["2d", "3d"]
BEFORE, AFTER = 0.8, 1.2
"""How long the first and the last frame stand [s]."""
TALL = 720
"""Height for which sizes below are given [pixels]."""
HEAD, FOOT = 74.0, 44.0
NEAR = 0.3
"""Share of the room beside blocks that films side by side begin with."""
SAMPLES = 200
"""Times at which it is seen whether blocks leave the picture."""


class Shot(NamedTuple):
    """A recording as it is shown: where, what is drawn of it, and its outcome in words."""

    stage: Stage | SolidStage
    view: View
    panel: Panel
    acting: Acting
    verdict: str

    def corners_at(self, seconds: float) -> Array:
        """Return where the corners of blocks are in the picture at a time [s], (k, 2)."""
        stage = self.stage
        return self.view.places(stage.corners_at(seconds / stage.unit).reshape(-1, 3))


class Film:
    """Frames drawn from recordings alone: equal recordings give equal frames.

    `recordings`: One, or two to show side by side on one clock.
    `view`, {"2d", "3d"}: Of blocks of the plane; those in space are seen in perspective.
    `slow`: How many times slower than it happened; by default such that the motion takes about
        six seconds.
    `height`: Of a frame [pixels]; it is 16:9.
    `rate`: Frames in a second.
    `beside`: Shown in other films beside this one: there is room for them, too, so that all
        have one scale.

    It has:
    `width`, `height`: Both even, as video asks for.
    `seconds`: How long the motion is that is shown.
    `count`: Number of frames.
    `metric`: Whether lengths and times are shown in metres and seconds: unless all are arches
        with a radius of 1, which stands for none given. Then they are in r and sqrt(r/g).
    `shots`: Of each recording.
    `moves`: Whether each recording is seen to move.
    `speed`: Of the fastest corner as it ends [m/s]; 0 where all lie still.
    """

    def __init__(
        self,
        recordings: Sequence[Recording],
        *,
        view: ViewName = "2d",
        slow: float | None = None,
        height: int = TALL,
        rate: int = 30,
        beside: Sequence[Recording] = (),
    ) -> None:
        self.height = 2 * (height // 2)
        self.width = 2 * round(height * 8 / 9)
        self.rate = rate
        # Blocks in space are seen in perspective, however it is asked.
        self._flat = view == "2d" and not any(each.problem.in_space for each in recordings)
        # Side by side there is less room beside the blocks; the camera draws back for them.
        near = 1.0 if len(recordings) == 1 else NEAR
        stages = [stage_of(each, near) for each in recordings]
        # An arch of which no radius was given is shown in units of it.
        self.metric = any(recording.problem.has_size for recording in recordings)
        self.moves = [stage.moves for stage in stages]
        self.speed = max(stage.speed for stage in stages)
        self._size = self.height / TALL
        kind: Any = PlanarView if self._flat else SpatialView
        # One scale for all, so that they can be compared.
        framed = [*stages, *map(stage_of, beside)]
        shown = [stage.swept - [stage.middle, 0.0, 0.0] for stage in framed]
        # The words of a scale bar have room, too.
        words = [[0.0, stage.ground, stage.front + SPOKEN] for stage in framed]
        shown = np.concatenate([*shown, *([] if self._flat else [words])])
        self.shots: list[Shot] = []
        for stage, panel in zip(stages, self._arrange(len(stages)), strict=True):
            seen = kind(stage, panel, shown)
            acting, said = (
                Acting(stage, seen, panel, self._size),
                verdict_words(stage.recording),
            )
            self.shots.append(Shot(stage, seen, panel, acting, said))
        self.seconds = self._duration()
        self.slow = slowness(self.seconds) if slow is None else slow
        self._canvas = Canvas(self.width, self.height)
        self._shares = self._drawn_back()
        self._canvas.keep(*self._still([set(stage.states) for stage in stages], thrust=True))
        self._last: tuple[float, NDArray[np.uint8]] | None = None
        self.count = 1 + round(rate * (BEFORE + self.seconds * self.slow + AFTER))

    def ends_before(self, at: float) -> str:
        """Say when it ends, as the clock shows it, if that is before a time."""
        shown = self.seconds / self._tick
        later = at > max(shown, round(shown, digits_of(shown)))
        return self._clock(self.seconds).removeprefix("t = ") if later else ""

    def frame(self, number: int) -> NDArray[np.uint8]:
        """Draw a frame, shape (height, width, 4): RGBA, not to be changed."""
        seconds = self._within((number / self.rate - BEFORE) / self.slow)
        # Until it is let go, and once it has ended, one frame is like the other.
        if self._last is None or self._last[0] != seconds:
            self._draw(seconds)
            self._last = seconds, self._canvas.pixels()
        return self._last[1]

    def still(self, file: BinaryIO, kind: str, at: float | None = None) -> None:
        """Write a frame as png, svg or pdf: at a time in the unit of its clock, or the end."""
        self._pose(at)
        self._canvas.save(file, kind)

    def figure(self, at: float | None = None) -> Figure:
        """Return one frame as a figure, as of `still`. The film cannot be used after that."""
        self._pose(at)
        return self._canvas.figure()

    def _pose(self, at: float | None) -> None:
        """Draw one frame with a legend of what is seen in it."""
        seconds = self._within(self.seconds if at is None else at * self._tick)
        moments = [shot.stage.at(seconds / shot.stage.unit) for shot in self.shots]
        seen = [set(moment.joints) for moment in moments]
        at_rest = any(moment.statics > 0 for moment in moments)
        self._canvas.keep(*self._still(seen, thrust=at_rest))
        self._draw(seconds)
        self._last = None

    def _within(self, seconds: float) -> float:
        return min(max(seconds, 0.0), self.seconds)

    def _drawn_back(self) -> tuple[Array, Array] | None:
        """Find times [s], and shares of their size at which all blocks are in the picture."""
        times = np.linspace(0.0, self.seconds, SAMPLES)
        shares = np.ones(len(times))
        for shot in self.shots:
            for at, seconds in enumerate(times.tolist() if shot.stage.moves else []):
                share = needed(shot.corners_at(seconds), shot.panel, shot.view.centre)
                shares[at] = min(shares[at], share)
        if shares.min() == 1:
            return None
        return eased(times, shares, EASED / self.slow)

    def share(self, seconds: float) -> float:
        """Return the share of its size at which all is drawn at a time [s]."""
        return 1.0 if self._shares is None else float(np.interp(seconds, *self._shares))

    def _draw(self, seconds: float) -> None:
        parts, labels = list[Part](), list[Label]()
        share = self.share(seconds)
        for stage, view, panel, acting, _ in self.shots:
            moment = stage.at(seconds / stage.unit)
            around = list[Shape]()
            if self._shares is not None:
                bar, words = self._scale_bar(stage, view, share)
                around = [*zoomed(view.still, share, view.centre), *bar]
                labels += words
            beside, said = acting.aside(moment, share)
            blocks = [*acting.behind(moment), *view.shapes(moment)]
            blocks += [*acting.thrust(moment), *acting.shapes(moment)]
            parts.append((panel, [*around, *zoomed(blocks, share, view.centre), *beside]))
            labels += said
        size = self._size
        clock = self._clock(seconds)
        labels.append(Label(24 * size, 15 * size, clock, size=19 * size, bold=True))
        self._canvas.draw(parts, labels)

    def _scale_bar(
        self, stage: Stage | SolidStage, view: View, share: float = 1.0
    ) -> tuple[list[Shape], list[Label]]:
        radius = stage.recording.assembly.size
        length = round_length(0.5 * radius / share)
        unit = "m" if self.metric else "r"
        return view.scale_bar(share * length / radius, f"{length:g} {unit}", self._size)

    def _duration(self) -> float:
        """Seconds shown: until the last of those that move lies still, or is out of sight."""
        stages = [shot.stage for shot in self.shots]
        moving = [stage.rested * stage.unit for stage in stages if stage.moves]
        last = max(moving or [stage.end * stage.unit for stage in stages])
        if self._lost(last):
            times = np.linspace(0.0, last, SAMPLES).tolist()
            last = next(before for before, at in pairwise(times) if self._lost(at))
        return last

    def _lost(self, seconds: float) -> bool:
        """Tell whether all that moves has left the picture, however far that is."""
        moving = [shot for shot in self.shots if shot.stage.moves]
        return bool(moving) and all(
            is_lost(shot.corners_at(seconds), shot.panel, shot.view.centre) for shot in moving
        )

    def _arrange(self, count: int) -> list[Panel]:
        head, foot = HEAD * self._size, FOOT * self._size
        wide, tall = self.width / count, self.height - head - foot
        return [Panel(i * wide, foot, wide, tall) for i in range(count)]

    def _still(
        self, states: Sequence[set[JointState]], *, thrust: bool
    ) -> tuple[list[Part], list[Label]]:
        """Return what stays the same: surroundings, scale bars, words and legend."""
        parts: list[Part] = []
        labels: list[Label] = []
        size = self._size
        for stage, view, panel, _, verdict in self.shots:
            pull, name = gravity_arrow(stage, view, panel, size)
            around = list[Shape]()
            if self._shares is None:
                # What the camera sees the same in every frame is drawn once.
                bar, words = self._scale_bar(stage, view)
                around = [*view.still, *bar]
                labels += words
            parts.append((panel, [*around, *pull]))
            moving = bool(stage.speed)
            labels += [*name, *title(stage, panel, verdict, self.height, size, moving=moving)]
        whole = Panel(0, 0, self.width, self.height)
        lines = [
            Shape(np.array([[shot.panel.x, shot.panel.y], [shot.panel.x, self.height]]),
                  edge=colour(INK, 0.25), width=1, closed=False)
            for shot in self.shots[1:]
        ]  # fmt: skip
        legend, words = legend_of(self._entries(states, thrust=thrust), self.width, size)
        return [*parts, (whole, [*lines, *legend])], [*labels, *words, self._pace()]

    @property
    def _tick(self) -> float:
        """Unit of the clock [s]."""
        return 1.0 if self.metric else math.sqrt(1 / GRAVITY)

    def _clock(self, seconds: float) -> str:
        digits = digits_of(self.seconds / self._tick)
        unit = "s" if self.metric else "√(r/g)"
        return f"t = {seconds / self._tick:.{digits}f} {unit}"

    def _pace(self) -> Label:
        words = "real time" if self.slow == 1 else f"{self.slow:g} times slower"
        if not self.metric:
            words += " if r = 1 m"
        x = 48 * self._size + width_of(self._clock(self.seconds), 19 * self._size, bold=True)
        return Label(x, 15 * self._size, words, size=14 * self._size, colour=QUIET)

    def _entries(
        self, states: Sequence[set[JointState]], *, thrust: bool
    ) -> list[tuple[str, str]]:
        """Return words and colours of what occurs, by what joints of each recording do."""
        stages = [shot.stage for shot in self.shots]
        told = [
            words_of(state, is_arch=stage.is_arch)
            for state in JOINTS
            for stage, seen in zip(stages, states, strict=True)
            if state in seen
        ]
        if thrust and any(stage.thrust for stage in stages):
            rests = all(stage.carried is None or stage.carried.stands for stage in stages)
            told.append((f"{'' if rests else 'nearest '}line of thrust at rest", THRUST))
        told += [entry for shot in self.shots for entry in shot.acting.entries]
        return list(dict.fromkeys(told))


def stage_of(recording: Recording[Any], near: float = 1.0) -> Stage | SolidStage:
    """Make a recording ready for the eye, in the plane or in space."""
    return (SolidStage if recording.problem.in_space else Stage)(recording, near)
