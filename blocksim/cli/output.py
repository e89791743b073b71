"""What is said and written: lines, JSON, pictures, a bar where somebody sees it."""

from __future__ import annotations

import os
import re
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import click

from blocksim.common.checks import require
from blocksim.common.files import json_text, require_place, write_whole
from blocksim.common.progress import Progress, silent
from blocksim.common.words import printable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = {"STANDS": "green", "COLLAPSES": "red", "UNDECIDED": "yellow"}
"""Colour of the word with which an answer begins."""
_LABEL = re.compile(r"  \S{1,7} +(?=\S)|\s*")
_UNIT = re.compile(r"(?<=\d) (?=[A-Za-z%])")
"""Space between a number and what it counts, where no line ends."""


def progress() -> AbstractContextManager[Progress]:
    """Show a bar on standard error while something goes on, where that is a terminal."""
    # None where it was closed.
    if not (sys.stderr and sys.stderr.isatty()):
        return nullcontext(silent)
    from blocksim.cli.terminal import bar

    return bar()


def picture_kind(out: Path, kinds: tuple[str, ...], option: str = "--out") -> str:
    """Return the kind of a picture, by the ending of a file that can be written."""
    kind = out.suffix.removeprefix(".")
    *most, last = (f".{each}" for each in kinds)
    allowed = f"a file name ending in {', '.join(most)} or {last}"
    require(kind in kinds, option, str(out), allowed)
    require_place(out)
    return kind


def save_picture(figure: Figure, out: Path, kind: str, height: int | None = None) -> None:
    """Write a picture whole, so many pixels high if it is a png, and say so."""
    from blocksim.view.drawing import save_figure

    write_whole(out, lambda file: save_figure(figure, file, kind, height=height))
    say(f"wrote {out}")


def write_files(
    paths: Iterable[Path],
    tables: Mapping[str, Callable[[BinaryIO], object]],
    figure: Callable[[], Figure],
    *,
    silent: bool = False,
) -> None:
    """Write files by their endings, one of `tables` or else a picture, and say so."""
    for path in paths:
        kind = path.suffix.removeprefix(".")
        if kind in tables:
            write_whole(path, tables[kind])
        else:
            from blocksim.view.drawing import save_figure

            write_whole(path, lambda file, kind=kind: save_figure(figure(), file, kind))
        if not silent:
            say(f"wrote {path}")


def answer_with(
    record: Callable[[], Mapping[str, object]],
    lines: Callable[[], list[str]],
    *,
    as_json: bool,
) -> None:
    """Print an answer as one JSON object or as lines, of which only one is made."""
    if as_json:
        click.echo(printable(json_text(record())))
    else:
        say(*lines())


def say(*lines: str) -> None:
    """Print lines on standard output, with nothing in them that a terminal would obey.

    They are folded at the window's edge, at 80 characters where there is none; on a terminal
    verdicts have colours.
    """
    click.echo("\n".join(fitted([printable(line) for line in lines])))


def fitted(lines: Iterable[str]) -> list[str]:
    """Return lines folded at the width of the window. Folded parts hang below the words."""
    width = shutil.get_terminal_size().columns
    # None where it was closed.
    coloured = sys.stdout and sys.stdout.isatty() and "NO_COLOR" not in os.environ
    shown: list[str] = []
    for line in lines:
        label = _LABEL.match(line)
        indent = " " * (len(label[0]) if label and label[0] else 2)
        folded = textwrap.wrap(
            _UNIT.sub("\xa0", line), width, subsequent_indent=indent, break_on_hyphens=False,
            break_long_words=False, drop_whitespace=True, replace_whitespace=False,
        )  # fmt: skip
        folded = [each.replace("\xa0", " ") for each in folded]
        word, space, rest = (folded or [""])[0].partition(" ")
        if word in COLOURS and coloured:
            folded[0] = click.style(word, fg=COLOURS[word], bold=True) + space + rest
        shown += folded or [""]
    return shown
