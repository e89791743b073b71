"""The score of an engine as lines, JSON, rows and a page, beside all engines known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, cast

from blocksim.common.checks import require
from blocksim.common.dates import made_at
from blocksim.common.files import (
    AnyPath,
    json_bytes,
    json_of,
    read_file,
    shipped_files,
    write_folder,
)
from blocksim.common.sheets import sheet_of
from blocksim.common.version import __version__
from blocksim.suite.families import LEVELS
from blocksim.suite.score import MOST, Row, Score
from blocksim.view.templates import template_of

LARGEST = 1 << 22
"""Bytes of a score.json."""
MEDIANS = {
    "drift": "drift",
    "gain": "energy gained",
    "asymmetry": "symmetry lost",
    "error": "error in time",
}
"""Medians by their names in a score, and what they are called."""


def known_scores() -> list[dict[str, Any]]:
    """Return the scores of the engines that are known, as `Score.record` does."""
    path = shipped_files("suite/known.json").get("known")
    return [] if path is None else json_of(path.read_bytes())


def read_score(path: AnyPath) -> dict[str, Any]:
    """Read a score.json of before."""
    allowed = "a score.json as blocksim suite score writes it"
    text = read_file(path, "--expect", allowed, LARGEST)
    found: Any = None
    try:
        found = json_of(text)
        groups = cast("dict[str, dict[str, Any]]", found["groups"])
        levels = [found["nearest_level"], *(each["nearest_level"] for each in groups.values())]
        fits = all(level is None or level in LEVELS for level in levels)
    except (ValueError, TypeError, KeyError, AttributeError):
        fits = False
    require(fits, "--expect", str(path), allowed)
    return found


def level_words(level: float | None) -> str:
    """Return a level in words, a dash where there is none."""
    return "-" if level is None else f"{level:g} %"


def _reach(record: Mapping[str, Any]) -> str:
    """Say how near to the limit an engine is right."""
    nearest = record["nearest_level"]
    return "at no level" if nearest is None else f"to {level_words(nearest)} of the limit"


def score_lines(record: Mapping[str, Any], known: Sequence[Mapping[str, Any]]) -> list[str]:
    """Tell a score in lines: the one number, then a line a group."""
    head = f"{record['engine']} {record['version']} ({record['settings']})"
    found = [
        f"RIGHT {_reach(record).upper()}  ({head})",
        f"  means   {100 * MOST:g} % or more are right there and at all levels farther away",
        f"  of all  {100 * (1 - record['wrong']):.1f} % right, in {record['seconds']:g} s; "
        "what was not answered is not right",
        "  groups  the level to which all are right, then how many are at each level",
    ]
    width = max(map(len, record["groups"]))
    for name, group in record["groups"].items():
        cells = [
            f"{level} %: {right}/{right + false + left}"
            for level, (right, false, left) in group["levels"].items()
        ]
        nearest = level_words(group["nearest_level"])
        found.append(f"  {name:{width}}  {nearest:>6}  right  {', '.join(cells)}")
    medians = [
        f"{words} {record[f'median_{name}']:g}"
        for name, words in MEDIANS.items()
        if record[f"median_{name}"] is not None
    ]
    if medians:
        found.append(f"  moved   medians, in sizes of the mean block: {', '.join(medians)}")
    found += [
        f"  beside  {each['engine']} {each['version']} ({each['settings']}): "
        f"right {_reach(each)}, {100 * (1 - each['wrong']):.1f} % of all"
        for each in known
    ]
    return found


def write_score(score: Score, folder: AnyPath) -> list[Path]:
    """Write score.html, score.json and rows.csv into a folder."""
    record = score.record()
    rows = [list(asdict(row).values()) for row in score.rows]
    contents = {
        "score.html": score_page([record, *known_scores()]).encode(),
        "score.json": json_bytes(record),
        "rows.csv": sheet_of(list(Row.__dataclass_fields__), rows),
    }
    return write_folder(folder, contents)


def score_page(records: Sequence[Mapping[str, Any]]) -> str:
    """Write a page on several engines, the first of which it is about, that loads nothing."""
    groups = list(dict.fromkeys(name for record in records for name in record["groups"]))
    return template_of("blocksim.report", "score.html", "templates", level=level_words).render(
        records=records,
        about=records[0],
        groups=groups,
        levels=[f"{level:g}" for level in LEVELS],
        medians=MEDIANS,
        most=f"{100 * MOST:g}",
        version=__version__,
        made=made_at(),
    )
