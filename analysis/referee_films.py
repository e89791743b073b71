"""What engines get wrong, filmed: of each the simplest scene that it gets plainly wrong.

Question: what does an engine do with blocks of which it is not right?

Of the scenes that an engine gets plainly wrong at its best settings, those farthest from their
limit are looked at, and of these the one with the fewest bodies is filmed. Plainly wrong is
what stands and has moved by two bounds or more, or falls and has not moved by one. An engine
that gets none plainly wrong is filmed where it is wrong at all.

`python -m analysis.referee_films OUT` films the answers kept in `referee_films.jsonl.gz`. With
`--answers FOLDER` scenes are chosen anew of files of answers, one of each engine, and kept.
"""

from __future__ import annotations

import gzip
import json
import re
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from analysis.command import run
from analysis.rows import FIGURES
from blocksim.common.files import make_folder
from blocksim.suite.answers import Head, read_answers, recording_of
from blocksim.suite.export import questions
from blocksim.suite.families import Question
from blocksim.suite.scene import Bodies
from blocksim.view.video import render

KEPT = "referee_films.jsonl.gz"
PLAIN = 2.0
"""Bounds by which what stands has moved if it is plainly wrong."""
HEIGHT = 316


def asked() -> dict[str, Question]:
    """Return the scenes that stand or fall, by name."""
    return {name: each for name, each in questions().items() if isinstance(each, Question)}


def bounds_moved(question: Question, poses: Any) -> float:
    """Return how far a corner is at the end, in bounds."""
    scene = question.scene
    return float(Bodies(scene).ways(poses[-1]).max()) / scene.bound


def plainest(path: Path) -> dict[str, Any]:
    """Return who answers and what it said of the simplest scene that it gets plainly wrong."""
    scenes = asked()
    head, said = read_answers(path, {name: each.scene for name, each in questions().items()})
    wrong: list[tuple[bool, float, int, str]] = []
    for name in said.keys() & scenes.keys():
        question, poses = scenes[name], said[name].poses
        if poses is None:
            continue
        moved = bounds_moved(question, poses)
        if (moved > 1) == question.stands:
            slight = 1 < moved < PLAIN
            wrong.append((slight, -question.level, len(question.scene.moving), name))
    *_, name = min(wrong)
    poses = np.round(np.asarray(said[name].poses), 7).tolist()
    return asdict(head) | {"scene": name, "seconds": said[name].seconds, "poses": poses}


def kept(path: Path) -> Iterator[tuple[Head, str, Any]]:
    """Read answers that are kept: who says it, of which scene, and the poses."""
    for line in gzip.decompress(path.read_bytes()).decode().splitlines():
        said = json.loads(line)
        head = Head(**{name: said[name] for name in ("engine", "version", "settings")})
        yield head, said["scene"], np.array(said["poses"])


def main(
    out: Path, *, answers: Path | None = None, quick: bool = False
) -> list[dict[str, object]]:
    """Film what is kept; in a quick run draw the end of the first."""
    make_folder(out)
    path = FIGURES / KEPT
    if answers is not None:
        path = out / KEPT
        lines = [plainest(each) for each in sorted(answers.glob("*.jsonl"))]
        text = "".join(json.dumps(line, separators=(",", ":")) + "\n" for line in lines)
        path.write_bytes(gzip.compress(text.encode(), mtime=0))
    scenes, found = asked(), list[dict[str, object]]()
    for head, name, poses in kept(path):
        question = scenes[name]
        film = out / f"referee_{re.sub('[ .]', '_', head.engine.lower())}.mp4"
        if not quick or not found:
            shown = film.with_suffix(".png") if quick else film
            render([recording_of(head, poses, question)], shown, height=HEIGHT)
        found.append(
            {
                "film": film.name,
                "scene": name,
                "level": question.level,
                "truth": "stands" if question.stands else "falls",
                "bounds_moved": round(bounds_moved(question, poses), 2),
            }
        )
    return found


if __name__ == "__main__":
    run(main, lambda found: "\n".join(map(str, found)))
