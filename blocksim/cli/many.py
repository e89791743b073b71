"""Many structures on the command line: JSON lines, or the files of a folder."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from io import BufferedReader, TextIOWrapper
from itertools import count
from pathlib import Path
from typing import NoReturn, cast

import click

from blocksim.ask.bulk import BATCH, LARGEST, check_batches
from blocksim.cli.acting import Loading
from blocksim.cli.built import Given
from blocksim.cli.options import named_options, option_of
from blocksim.cli.subject import STREAM
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.files import json_text
from blocksim.kinds.files import LARGEST_FILES, OTHERS

AT_ONCE = 1 << 16
"""Bytes of a stream that are read at once, or as many as there are."""
GIVEN = {"mu", "friction_angle"}
"""Options that mean something for many structures."""


def check_each(
    scene: str, given: Given, loading: Loading, others: Mapping[str, object]
) -> NoReturn:
    """Answer the command check with a line of JSON for each structure, in their order."""
    for name, value in {**asdict(given), **asdict(loading), **others}.items():
        unset = value is None or value is False or value == [] or name in GIVEN
        allowed = "left out with many structures: these are read as they are"
        require(unset, option_of(name), value, allowed)
    with named_options():
        friction = given.friction
    if scene == STREAM:
        # Each line has its answer, an empty one as well.
        names = ({"line": number} for number in count(1))
        told = check_batches(_lines(), friction=friction)
    else:
        endings = (*LARGEST_FILES, *OTHERS)
        paths = sorted(p for p in Path(scene).iterdir() if p.suffix.lower() in endings)
        if not paths:
            raise InputError("folder", MISSING, f"files in {', '.join(endings)}", where=scene)
        names = ({"file": path.name} for path in paths)
        batches = (paths[at : at + BATCH] for at in range(0, len(paths), BATCH))
        told = check_batches(batches, friction=friction)
    for name, each in zip(names, told, strict=False):
        title = {"title": each.title} if each.title else {}
        found = {"verdict": each.verdict, "proved": each.proved, "margin": each.margin}
        answer = {**title, **found}
        click.echo(json_text({**name, **({"error": each.error} if each.error else answer)}))
    raise click.exceptions.Exit(0)


def _lines() -> Iterator[list[bytes]]:
    """Give lines as soon as they are there, of one that is too long its start."""
    pieces, size = list[bytes](), 0
    # None where it was closed.
    stream = cast("TextIOWrapper | None", sys.stdin)
    if stream is None:
        return
    source = cast("BufferedReader", stream.buffer)
    while data := source.read1(AT_ONCE):
        *ended, rest = data.split(b"\n")
        if ended:
            pieces.append(ended[0])
            yield [b"".join(pieces), *ended[1:]]
            pieces, size = [], 0
        if size <= LARGEST:
            pieces.append(rest)
        size += len(rest)
    if size:
        yield [b"".join(pieces)]
