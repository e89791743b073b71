"""What engines say of the suite's scenes: error against time, and how near they stay right.

`python -m analysis.referee OUT` makes of the rows kept here (`referee.csv.gz`, one a scene and
engine) the scores that `blocksim suite score` shows beside a new one (`known.json`), and the
figure. With `--answers FOLDER` answers in files replace those of the same engine, settings and
scene. Scenes that an engine was not asked about are left out of its score, by dimensions.
Levels that it was not asked about have no rows; it is then in neither scores nor figure.
"""

from __future__ import annotations

import json
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from analysis.command import run
from analysis.rows import FIGURES, provenance, read_kept, write_rows
from blocksim.common.files import make_folder
from blocksim.suite.answers import Head, read_answers
from blocksim.suite.export import groups, questions
from blocksim.suite.families import LEVELS
from blocksim.suite.score import Row, Score, scored

KEPT = FIGURES / "referee.csv.gz"
MARKS = "osD^vPX*<>hp"
WHO = {"engine": "engine", "version": "engine_version", "settings": "settings"}
"""Columns of who says it: `version` is that of blocksim, in rows of any study."""
NONE = 100.0
"""Where an engine is drawn that is right at no level [%]."""


def scores_of(folder: Path) -> list[Score]:
    """Score all files of answers in a folder."""
    asked = questions()
    scenes = {name: each.scene for name, each in asked.items()}
    return [
        scored(*read_answers(path, scenes), asked) for path in sorted(folder.glob("*.jsonl"))
    ]


def rows_of(score: Score) -> list[dict[str, object]]:
    """Return rows of levels that were answered, numbers as short as they are known."""
    answered = {row.level for row in score.rows if row.seconds}
    said = {key: getattr(score.head, name) for name, key in WHO.items()}
    return [
        said | {name: _short(value) for name, value in asdict(row).items() if name != "group"}
        for row in score.rows
        if row.level in answered
    ]


def _short(value: object) -> object:
    return f"{value:.3g}" if isinstance(value, float) else "" if value is None else value


def kept(path: Path) -> list[dict[str, Any]]:
    """Read rows as they are kept; versions are text."""
    return read_kept(path, *WHO.values())


def read(path: Path) -> list[Score]:
    """Read rows."""
    asked, found = questions(), dict[Head, list[Row]]()
    for line in kept(path):
        said = {each.name: line[each.name] for each in fields(Row) if each.name in line}
        row = Row(group=asked[line["scene"]].group, **said)
        head = Head(**{name: line[key] for name, key in WHO.items()})
        found.setdefault(head, []).append(row)
    return [Score(head=head, rows=tuple(rows)) for head, rows in found.items()]


def drawn(scores: list[Score]) -> Figure:
    """Draw error against time, and the nearest level at which each engine is right by group."""
    names = groups()
    height = 2.4 + 0.26 * len(scores)
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(13, height), width_ratios=(1, 1.25), layout="constrained"
    )
    engines = list(dict.fromkeys(score.head.engine for score in scores))
    for score in scores:
        at = engines.index(score.head.engine)
        best = score.head.settings.startswith("best")
        colour = plt.get_cmap("tab20")(at % 20)
        left.loglog(
            score.seconds, 100 * max(score.wrong, 1e-3), MARKS[at % len(MARKS)], color=colour,
            markerfacecolor=colour if best else "white", markersize=8,
            label=f"{score.head.engine}, best" if best else score.head.engine,
        )  # fmt: skip
    left.set(xlabel="time of all scenes [s]", ylabel="scenes and levels not right [%]")
    left.legend(fontsize=7, ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.12))
    left.set_title("Error against time (filled: at its best settings)")
    cells = np.array([[_level(score, name) for name in names] for score in scores])
    right.imshow(np.log10(cells), cmap="Blues_r", aspect="auto", vmin=-1.3, vmax=2.3)
    for (row, column), value in np.ndenumerate(cells):
        if np.isfinite(value):
            words = "-" if value == NONE else f"{value:g}"
            ink = "white" if value <= 1 else "black"
            right.text(column, row, words, ha="center", va="center", fontsize=7, color=ink)
    right.set_xticks(range(len(names)), names, rotation=60, ha="right")
    labels = [f"{score.head.engine} ({score.head.settings.split(':')[0]})" for score in scores]
    right.set_yticks(range(len(scores)), labels, fontsize=7)
    right.set_title("Nearest level at which all scenes are right [%]")
    return figure


def _level(score: Score, group: str) -> float:
    if not score.of(group):
        return np.nan
    found = score.nearest(group)
    return NONE if found is None else found


def main(
    out: Path,
    *,
    answers: Path | None = None,
    quick: bool = False,  # noqa: ARG001 - all studies take it
) -> list[dict[str, Any]]:
    """Score answers, or read what is kept, and draw."""
    make_folder(out)
    path = KEPT
    if answers is not None:
        path = out / KEPT.name
        new = [row | provenance() for score in scores_of(answers) for row in rows_of(score)]
        same = (*WHO.values(), "scene")
        lines = {tuple(row[name] for name in same): row for row in (*kept(KEPT), *new)}
        write_rows(path, [*lines.values()])
    # Rounded as they are kept.
    whole = [each for each in read(path) if set(LEVELS) <= {row.level for row in each.rows}]
    scores = sorted(whole, key=lambda each: (each.nearest() or NONE, each.wrong))
    records = [score.record() for score in scores]
    (out / "known.json").write_text(json.dumps(records, separators=(",", ":")) + "\n")
    figure = drawn(scores)
    figure.savefig(out / "referee.png", dpi=100)  # type: ignore[reportUnknownMemberType]
    plt.close(figure)
    return [
        {name: each[name] for name in ("engine", "settings", "nearest_level", "wrong")}
        for each in records
    ]


if __name__ == "__main__":
    run(main)
