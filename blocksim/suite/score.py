"""The score: what is right, what is false, and how near to the limit it stays right.

What counts as standing is the same for all: at the end of a scene no corner is farther from
where it began than the scene's bound.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any, Literal

import numpy as np

from blocksim.suite.answers import Answer, Head
from blocksim.suite.families import LEVELS, Question
from blocksim.suite.scene import Bodies
from blocksim.suite.timed import Motion

Counted = Literal["right", "false", "open"]
COUNTS: tuple[Counted, ...] = ("right", "false", "open")
MOST = 0.9
"""Share of scenes of a level that have to be right for the engine to be right at it."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """The result on one scene.

    `level`: [%]; None where motion is asked for.
    `answer`, {"right", "false", "open"}: Of motion: right where the error is known.
    `stands`: What is true.
    `drift`: Largest way of a corner at the end, in sizes of the mean body, of what stands.
    `gain`: Most by which the mean weight rose above the start, in the same.
    `asymmetry`: Largest distance of a corner from the mirror image of another at the end, in
        the same.
    `error`: Of motion: largest distance of a corner from where it should be, over the largest
        way of one.
    """

    scene: str
    group: str
    level: float | None
    answer: Counted
    stands: bool | None = None
    drift: float | None = None
    gain: float | None = None
    asymmetry: float | None = None
    error: float | None = None
    seconds: float = 0.0

    def at(self, level: float) -> Counted | None:
        """Count it at a level [%]. Motion counts at each level, by its error."""
        if self.level is not None:
            return self.answer if self.level == level else None
        if self.error is None:
            return "open"
        return "right" if self.error <= level / 100 else "false"


@dataclass(frozen=True, kw_only=True)
class Score:
    """All results of one engine."""

    head: Head
    rows: tuple[Row, ...]

    @property
    def table(self) -> dict[str, dict[float, dict[Counted, int]]]:
        """Numbers right, false and open, by group and level."""
        names = dict.fromkeys(row.group for row in self.rows)
        return {
            name: {level: counted(self.of(name), level) for level in LEVELS} for name in names
        }

    def of(self, group: str) -> list[Row]:
        """Return the rows of a group."""
        return [row for row in self.rows if row.group == group]

    def nearest(self, group: str | None = None) -> float | None:
        """Return the nearest level [%] at which it is still right, and at all farther ones.

        Right is all of a group's scenes, and of all scenes that share which is `MOST`.

        `group`: By default all scenes.
        """
        rows, share = (self.rows, MOST) if group is None else (self.of(group), 1.0)
        found = None
        for level in LEVELS:
            count = counted(rows, level)
            if not sum(count.values()) or count["right"] < share * sum(count.values()):
                break
            found = level
        return found

    @property
    def wrong(self) -> float:
        """Share of scenes, at all levels, that are not right."""
        count = [counted(self.rows, level) for level in LEVELS]
        every = sum(sum(each.values()) for each in count)
        return 1 - sum(each["right"] for each in count) / every

    def middle(self, name: str) -> float | None:
        """Return the median of drift, gain, asymmetry or error over scenes, or None."""
        known = [value for row in self.rows if (value := getattr(row, name)) is not None]
        return median(known) if known else None

    @property
    def seconds(self) -> float:
        """Time that all scenes took."""
        return sum(row.seconds for row in self.rows)

    def record(self) -> dict[str, Any]:
        """Return what is kept of it: the counts, the levels, medians and time."""
        return {
            "engine": self.head.engine,
            "version": self.head.version,
            "settings": self.head.settings,
            "nearest_level": self.nearest(),
            "wrong": round(self.wrong, 4),
            "groups": {
                name: {
                    "nearest_level": self.nearest(name),
                    "levels": {
                        f"{level:g}": list(count.values()) for level, count in levels.items()
                    },
                }
                for name, levels in self.table.items()
            },
            **{
                f"median_{name}": _short(self.middle(name))
                for name in ("drift", "gain", "asymmetry", "error")
            },
            "seconds": _short(self.seconds),
        }


def counted(rows: Iterable[Row], level: float) -> dict[Counted, int]:
    """Count rows at a level."""
    said = [row.at(level) for row in rows]
    return {name: said.count(name) for name in COUNTS}


def _short(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.3g}")


def scored(
    head: Head, answers: Mapping[str, Answer], asked: Mapping[str, Question | Motion]
) -> Score:
    """Hold answers to the truth.

    Scenes that were not answered are open. Where none was answered of those in the plane, in
    space, or that ask for motion, these are left out: engines may know only others.

    `asked`: All scenes.
    """
    known = {_sort(asked[name]) for name in answers}
    rows = [
        _row(each, answers.get(name)) for name, each in asked.items() if _sort(each) in known
    ]
    return Score(head=head, rows=tuple(rows))


def _sort(asked: Question | Motion) -> tuple[bool, bool]:
    return isinstance(asked, Question) and asked.family.spatial, isinstance(asked, Motion)


def _row(asked: Question | Motion, answer: Answer | None) -> Row:
    level, stands = (asked.level, asked.stands) if isinstance(asked, Question) else (None, None)
    known: dict[str, Any] = {"scene": asked.name, "group": asked.group, "level": level}
    if answer is None or answer.verdict == "open":
        seconds = 0.0 if answer is None else answer.seconds
        return Row(**known, answer="open", stands=stands, seconds=seconds)
    known |= {"seconds": answer.seconds, "stands": stands}
    poses = answer.poses
    if poses is None:
        right = (answer.verdict == "stands") == stands
        return Row(**known, answer="right" if right else "false")
    scene = asked.scene
    bodies = Bodies(scene)
    if isinstance(asked, Motion):
        off = bodies.corners(poses) - bodies.corners(asked.poses)
        way = float(bodies.ways(asked.poses).max())
        return Row(
            **known, answer="right", error=float(np.linalg.norm(off, axis=-1).max()) / way
        )
    way = float(bodies.ways(poses[-1]).max())
    right = (way <= scene.bound) == stands
    rose = bodies.lifted(poses)
    apart = bodies.asymmetry(poses)
    return Row(
        **known,
        answer="right" if right else "false",
        drift=way / scene.size if stands and right else None,
        gain=float((rose - rose[0]).max()) / scene.size,
        asymmetry=None if apart is None or not stands or not right else apart / scene.size,
    )


def worse(now: Mapping[str, Any], expected: Mapping[str, Any]) -> Sequence[str]:
    """Tell in which groups a record is right at fewer levels than was expected.

    `now`, `expected`: As `Score.record` returns them.
    Returns: A sentence each; none where nothing is worse.
    """
    found: list[str] = []
    pairs = [("all scenes", now, expected)]
    pairs += [
        (name, now["groups"].get(name, {}), each) for name, each in expected["groups"].items()
    ]
    for name, is_now, was in pairs:
        before, after = was["nearest_level"], is_now.get("nearest_level")
        if before is not None and (after is None or after > before):
            said = "at no level" if after is None else f"to {after:g} %"
            found.append(f"{name}: right to {before:g} % was expected, it is right {said}")
    return found
