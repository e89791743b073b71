"""The suite as files: a scene each, in neutral JSON and in formats that engines read."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from functools import cache
from pathlib import Path

from blocksim.common.checks import require
from blocksim.common.errors import perhaps
from blocksim.common.files import AnyPath, json_text, make_folder, shipped_files, write_whole
from blocksim.suite.families import LEVELS, Question, families
from blocksim.suite.formats import mjcf, sdf
from blocksim.suite.scene import Scene
from blocksim.suite.timed import Motion, motions

WRITERS: dict[str, tuple[str, Callable[[Scene], bytes | None]]] = {
    "scenes": ("json", lambda scene: json_text(scene.record(), indent=1).encode() + b"\n"),
    "mjcf": ("xml", mjcf),
    "sdf": ("sdf", sdf),
}
"""What is written into which folder, with which ending; None is left out."""


@cache
def questions() -> dict[str, Question | Motion]:
    """Return all scenes by name, with their answers."""
    asked: list[Question | Motion] = [
        each for family in families() for each in family.questions
    ]
    return {each.name: each for each in (*asked, *motions())}


def groups() -> list[str]:
    """Return the groups of scenes, in order."""
    return list(dict.fromkeys(each.group for each in questions().values()))


def chosen(levels: Collection[float] = (), within: Collection[str] = ()) -> Iterator[Scene]:
    """Return scenes at some levels [%] of some groups; all where none is named.

    Scenes whose motion is asked for have no level, and come where no level is named.

    Raises
    ------
    InputError
        If there is no such level or group.
    """
    for level in levels:
        known = ", ".join(f"{each:g}" for each in LEVELS)
        require(level in LEVELS, "--level", level, f"one of {known}")
    for group in within:
        known = groups()
        allowed = f"one of {', '.join(known)}{perhaps(group, known)}"
        require(group in known, "--group", group, allowed)
    for each in questions().values():
        if within and each.group not in within:
            continue
        if levels and (isinstance(each, Motion) or each.level not in levels):
            continue
        yield each.scene


def export(folder: AnyPath, scenes: Iterator[Scene]) -> dict[str, int]:
    """Write scenes, their schemas and the page that explains them.

    Parameters
    ----------
    folder : str or path
    scenes : iterator of Scene

    Returns
    -------
    dict
        Number of files of each kind.

    Raises
    ------
    InputError, MachineError
        If they cannot be written.
    """
    folder, count = Path(folder), dict.fromkeys(WRITERS, 0)
    for name in WRITERS:
        make_folder(folder / name)
    for path in (
        *shipped_files("suite/*.md").values(),
        *shipped_files("suite/*.schema.json").values(),
    ):
        text = path.read_bytes()
        write_whole(folder / path.name, lambda file, text=text: file.write(text))
    for scene in scenes:
        for name, (ending, written) in WRITERS.items():
            text = written(scene)
            if text is None:
                continue
            place = folder / name / f"{scene.name}.{ending}"
            write_whole(place, lambda file, text=text: file.write(text))
            count[name] += 1
    return count
