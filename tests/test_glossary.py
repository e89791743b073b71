"""The glossary: every quantity that is printed is one of its words; the sketch shows them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from running import answered

DOCS = Path(__file__).parent.parent / "docs"
GLOSSARY = (DOCS / "glossary.md").read_text(encoding="utf-8")
OF_THE_ANSWER = {
    "version", "method", "problem", "title", "runs", "undecided", "confirmed", "splits", "tol",
    "simulated_s", "state_hash", "wall_s", "over", "unit", "low", "high", "limit", "stands",
    "events", "intervals", "falls", "proved", "evidence", "test", "found", "arch", "x", "y",
    "rotation", "block", "angle_deg",
}  # fmt: skip
"""What tells of the asking, not of the structure; coordinates."""


def words() -> list[str]:
    """The first column of its tables."""
    rows = re.findall(r"^\| ([^|]+?) \|", GLOSSARY, flags=re.MULTILINE)
    return [word for word in rows if word not in {"word", "---"}]


def told(key: str) -> bool:
    """Whether a key stands in the last column, `...` for the ends of a bracket."""
    ends = re.sub(r"_(low|high|limit|theory)(?=_|$)", "_...", key)
    return f"`{key}`" in GLOSSARY or f"`{ends}`" in GLOSSARY


def keys(record: Any) -> set[str]:
    """All keys of a record, those of its parts included."""
    if isinstance(record, list):
        return set().union(*(keys(each) for each in record)) if record else set()
    if not isinstance(record, dict):
        return set()
    return set(record) | keys(list(record.values()))


def test_there_are_the_words_of_an_engineer() -> None:
    assert len(words()) == len(set(words())) >= 33


@pytest.mark.parametrize(
    "asked",
    [
        "check --span 8 --rise 3 --thickness 0.3 --mu 0.6",
        "check --span 8 --rise 3 --thickness 0.1 --mu 0.6",
        "check portal --mu 0.6 --unit-weight 20 --fill 0.4 --point-load 0.3 5",
        "check portal --mu 0.6 --tilt 30",
        "bracket --span 8 --rise 3 --mu 0.6",
        "bracket portal --mu 0.6 --over tilt",
    ],
)
def test_every_printed_quantity_is_a_word_of_the_glossary(asked: str) -> None:
    record = answered(*asked.split(), code=None)
    assert sorted(key for key in keys(record) - OF_THE_ANSWER if not told(key)) == []


def test_the_sketch_has_the_words_of_what_is_built() -> None:
    drawn = (DOCS / "sketch.svg").read_text(encoding="utf-8")
    shown = [" ".join(text.split()) for text in re.findall(r">([^<>]+)</text>", drawn)]
    for word in (
        "crown", "extrados", "intrados", "centreline", "voussoir", "joint", "springing",
        "support", "span", "rise", "thickness t", "radius r", "half-angle alpha",
        "line of thrust",
    ):  # fmt: skip
        assert shown.count(word) == 1, word
