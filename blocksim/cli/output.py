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
CURVES = ("csv", "pdf", "svg", "png")
"""Kinds of files of a curve."""
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


def write(
    out: Path,
    made: bytes | Callable[[BinaryIO], object] | Figure,
    *,
    height: int | None = None,
    said: str = "",
    silent: bool = False,
) -> None:
    """Write a file whole, and say so.

    `made`: What is in it, what writes it, or a picture, so many pixels high if it is a png.
    `said`: What is said of it besides.
    """
    if isinstance(made, bytes):
        write_whole(out, lambda file: file.write(made))
    elif callable(made):
        write_whole(out, made)
    else:
        from blocksim.view.drawing import save_figure

        kind = out.suffix.removeprefix(".")
        write_whole(out, lambda file: save_figure(made, file, kind, height=height))
    if not silent:
        say(f"wrote {out}{said}")


def write_files(
    paths: Iterable[Path],
    tables: Mapping[str, Callable[[BinaryIO], object]],
    figure: Callable[[], Figure],
    *,
    silent: bool = False,
) -> None:
    """Write files by their endings, one of `tables` or else a picture, and say so."""
    for path in paths:
        write(path, tables.get(path.suffix.removeprefix(".")) or figure(), silent=silent)


def answer_with(
    record: Callable[..., Mapping[str, object]],
    lines: Callable[..., list[str]],
    *answer: object,
    as_json: bool,
) -> None:
    """Print an answer as one JSON object or as lines, of which only one is made."""
    if as_json:
        click.echo(printable(json_text(record(*answer))))
    else:
        say(*lines(*answer))


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
