"""What an engine says of scenes: JSON lines of a stranger, checked line by line."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal, cast, get_args

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import STANDARD_GRAVITY
from blocksim.common.checks import is_number, require
from blocksim.common.errors import LONGEST, MISSING, InputError, perhaps
from blocksim.common.files import AnyPath, json_of, opened
from blocksim.common.later import transform
from blocksim.engines.base import Settings
from blocksim.simulation.recording import Recording
from blocksim.suite.families import Question
from blocksim.suite.scene import PLANAR, SPATIAL, Bodies, Scene
from blocksim.suite.timed import Motion

FORMAT = "blocksim answers 1"
LARGEST = 1 << 28
"""Bytes of a file of answers."""
FARTHEST = 1e9
"""Largest number in a pose; an engine that went beyond has lost its bodies: it is open."""
LONGEST_RUN = 1e7
"""Seconds of a scene, at most."""
HEAD = ("format", "engine", "version", "settings")
KEYS = ("scene", "seconds", "verdict", "poses")
Said = Literal["stands", "falls", "open"]


@dataclass(frozen=True, kw_only=True)
class Head:
    """Who answers: an engine, its version, and the settings it ran with."""

    engine: str
    version: str
    settings: str


@dataclass(frozen=True, kw_only=True, eq=False)
class Answer:
    """The answer to one scene.

    `verdict`, {"stands", "falls", "open"} or None: None where poses say it.
    `poses`, (frames, bodies, 3 or 7).
    `seconds`: That the engine took.
    """

    scene: str
    verdict: Said | None
    poses: Array | None
    seconds: float


def read_answers(
    path: AnyPath, asked: Mapping[str, Question | Motion]
) -> tuple[Head, dict[str, Answer]]:
    """Read a file of answers.

    `path`: Of JSON lines: who answers, then a line a scene.
    `asked`: The scenes that may be answered, by name.
    """
    said, found = str(path), dict[str, Answer]()
    with opened(path, "answers", "a file of JSON lines", LARGEST) as file:
        lines = enumerate(file, 1)
        try:
            nothing: dict[str, Any] = {}
            head = _head(*next(_tables(lines), (1, nothing)))
            for number, table in _tables(lines):
                where = f"line {number}"
                name = table.get("scene", MISSING)
                allowed = "the name of a scene" + (
                    perhaps(name, asked) if isinstance(name, str) else ""
                )
                known = isinstance(name, str) and name in asked
                require(known, f"{where}: scene", name, allowed)
                require(name not in found, f"{where}: scene", name, "answered once")
                found[name] = _answer(where, table, asked[name])
            require(bool(found), "answers", MISSING, "a line a scene, after the first")
        except InputError as error:
            raise InputError(error.field, error.value, error.allowed, where=said) from None
    return head, found


def _tables(lines: Iterator[tuple[int, bytes]]) -> Iterator[tuple[int, dict[str, Any]]]:
    """Read the lines that are not empty, a table each."""
    for number, line in lines:
        if not line.strip():
            continue
        try:
            table: Any = json_of(line)
        except ValueError as error:
            words = " ".join(str(error).split())
            raise InputError(f"line {number}", words, "one JSON object in a line") from None
        require(isinstance(table, dict), f"line {number}", table, "a JSON object")
        yield number, cast("dict[str, Any]", table)


def _head(number: int, table: dict[str, Any]) -> Head:
    where = f"line {number}"
    require(
        table.get("format") == FORMAT,
        f"{where}: format",
        table.get("format", MISSING),
        repr(FORMAT),
    )
    _require_keys(where, table, HEAD)
    texts: dict[str, str] = {}
    for name in HEAD[1:]:
        value = table.get(name, MISSING)
        fits = isinstance(value, str) and 0 < len(value) <= LONGEST
        require(fits, f"{where}: {name}", value, f"a text of 1 to {LONGEST} letters")
        texts[name] = cast("str", value)
    return Head(**texts)


def _require_keys(where: str, table: dict[str, Any], known: tuple[str, ...]) -> None:
    for key in table:
        near = perhaps(key, known)
        require(key in known, f"{where}: {key}", table[key], f"left out: no such key{near}")


def _answer(where: str, table: dict[str, Any], asked: Question | Motion) -> Answer:
    """Check what was said of a scene."""
    _require_keys(where, table, KEYS)
    seconds = table.get("seconds", MISSING)
    allowed = "the time it took in s, 0 or more"
    require(is_number(seconds, -1e-300, LONGEST_RUN), f"{where}: seconds", seconds, allowed)
    verdict, poses = table.get("verdict"), table.get("poses")
    if (verdict is None) == (poses is None):
        value = MISSING if poses is None else "given beside poses"
        raise InputError(f"{where}: verdict", value, "given, or poses, one of the two")
    if verdict is not None:
        # A motion is told by poses.
        words = get_args(Said) if isinstance(asked, Question) else ("open",)
        require(verdict in words, f"{where}: verdict", verdict, f"one of {', '.join(words)}")
    return Answer(
        scene=asked.name,
        verdict=verdict,
        poses=None if poses is None else _poses(f"{where}: poses", poses, asked.scene),
        seconds=float(seconds),
    )


def _poses(where: str, given: Any, scene: Scene) -> Array:
    """Check frames, bodies and numbers of poses, and that they begin where the scene does."""
    numbers = PLANAR if scene.dimensions == 2 else SPATIAL
    wanted = {"frames": len(scene.times), "bodies": len(scene.moving), "numbers": numbers}
    level = [given]
    for what, count in wanted.items():
        for each in level:
            fits = isinstance(each, list) and len(cast("list[Any]", each)) == count
            value = f"{len(cast('list[Any]', each))}" if isinstance(each, list) else each
            require(fits, f"{where}: number of {what}", value, f"{count}, as of {scene.name}")
        level = [each for inside in level for each in inside]
    for value in level:
        fine = is_number(value, -FARTHEST, FARTHEST)
        allowed = f"a number within {FARTHEST:g}; of an engine that lost it, verdict open"
        require(fine, where, value, allowed)
    poses = np.array(given, dtype=np.float64)
    bodies = Bodies(scene)
    away = float(bodies.ways(poses[0]).max())
    near = away <= max(scene.bound, 1e-6 * float(np.ptp(bodies.corners(bodies.start))))
    allowed = "where the scene begins: centres of mass, and angles from there in rad"
    require(near, f"{where}[0]", f"a corner {away:.3g} m away", allowed)
    return poses


def recording_of(head: Head, poses: Array, question: Question) -> Recording[Any]:
    """Return an engine's poses of a scene as a recording, to be seen like any other.

    Of its settings a recording can hold none: they are words.
    """
    problem = question.problem
    size = problem.assembly.size
    if problem.in_space:
        # Ours have the real part last.
        turns = transform.Rotation.from_quat(
            poses[..., [4, 5, 6, 3]].reshape(-1, 4)
        ).as_rotvec()
        moved = np.concatenate([poses[..., :3] / size, turns.reshape(*poses.shape[:2], 3)], -1)
    else:
        moved = poses / [size, size, 1.0]
    times = question.scene.times
    return Recording(
        problem=problem,
        engine=head.engine,
        engine_version=head.version,
        settings=Settings(step=float(times[1]), sweeps=1, hold_sweeps=1),
        times=times * np.sqrt(STANDARD_GRAVITY / size),
        poses=moved,
    )
