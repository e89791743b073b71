"""Numbers quoted in pages, held to the rows they come from.

A quoted number is followed by a comment that names the file of rows and what it is of them:

    10,000<!-- random_truth: len(index) --> random problems

The file is `analysis/figures/NAME.csv`, or that packed, `.csv.gz`; its columns are arrays of
that name. A number must be what the rows say, rounded to the digits that are quoted. `python
docs/quotes.py` lists those that are not.
"""

from __future__ import annotations

import csv
import gzip
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
ROWS = ROOT / "analysis" / "figures"
QUOTE = re.compile(
    r"(?P<said>(?<![\w.,])-?\d[\d,]*(?:\.\d+)?(?:e-?\d+)?)[^\d\n<]{0,12}"
    r"<!-- (?P<file>\w+): (?P<of>.+?) -->",
    flags=re.DOTALL,
)
FUNCTIONS: dict[str, Callable[..., Any]] = {
    "count": np.count_nonzero,
    "largest": np.max,
    "least": np.min,
    "median": np.median,
    "abs": np.abs,
    "maximum": np.maximum,
    "isin": np.isin,
    "len": len,
    "says": lambda column, words: np.char.find(column, words) >= 0,
}


@dataclass(frozen=True)
class Quote:
    """A number in a page, and what its rows say."""

    page: str
    said: str
    file: str
    expression: str
    value: float

    @property
    def holds(self) -> bool:
        """Whether it is what the rows say, to the digits quoted."""
        return abs(float(self.said.replace(",", "")) - self.value) <= 0.5001 * unit(self.said)


def unit(said: str) -> float:
    """Return one in the last digit of a number as written."""
    digits, _, power = said.replace(",", "").partition("e")
    decimals = len(digits.partition(".")[2])
    return 10.0 ** (int(power or 0) - decimals)


def quotes(text: str, page: str = "") -> Iterator[Quote]:
    """Give every quote of a page."""
    for found in QUOTE.finditer(text):
        yield Quote(
            page=page,
            said=found["said"],
            file=found["file"],
            expression=" ".join(found["of"].split()),
            value=evaluated(found["file"], " ".join(found["of"].split())),
        )


def evaluated(file: str, expression: str) -> float:
    """Return what an expression is of a file's columns."""
    # The pages are our own, as the code is.
    return float(eval(expression, {"__builtins__": {}}, FUNCTIONS | columns(file)))  # noqa: S307


@cache
def columns(file: str) -> dict[str, np.ndarray]:
    """Return the columns of a file of rows: numbers where all of them are."""
    path = ROWS / f"{file}.csv"
    packed = path.with_suffix(".csv.gz")
    with (
        gzip.open(packed, "rt", encoding="utf-8")
        if packed.exists()
        else path.open(encoding="utf-8", newline="") as rows
    ):
        table = list(csv.DictReader(rows))
    return {name: _column([row[name] for row in table]) for name in table[0]}


def _column(texts: list[str]) -> np.ndarray:
    try:
        return np.array([float(text) if text else np.nan for text in texts])
    except ValueError:
        return np.array(texts)


def pages() -> list[Path]:
    """Return every page that may quote."""
    return [
        ROOT / "README.md",
        *sorted((ROOT / "docs").rglob("*.md")),
        ROOT / "analysis/README.md",
    ]


def main() -> int:
    """Print the quotes that do not hold, and return how many there are."""
    every = [
        quote
        for path in pages()
        for quote in quotes(path.read_text(encoding="utf-8"), path.relative_to(ROOT).as_posix())
    ]
    wrong = [quote for quote in every if not quote.holds]
    for quote in wrong:
        said = f"{quote.page}: {quote.said} is quoted, {quote.file}.csv says {quote.value:.6g}"
        sys.stdout.write(f"{said} ({quote.expression})\n")
    sys.stdout.write(f"{len(every) - len(wrong)} of {len(every)} numbers are what rows say\n")
    return len(wrong)


if __name__ == "__main__":
    sys.exit(main())
