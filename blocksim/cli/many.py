"""Many structures, as JSON lines or files of a folder, and a file of many cases of one."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from io import BufferedReader, TextIOWrapper
from itertools import count
from pathlib import Path
from typing import Annotated, Any, NoReturn, cast

import click

from blocksim.ask.bulk import BATCH, LARGEST, check_batches
from blocksim.ask.cases import Case, Cases, Factors, check_cases
from blocksim.ask.options import Options
from blocksim.blocks.entries import LoadEntry, listed
from blocksim.blocks.given import Body
from blocksim.blocks.loads import LoadsOf
from blocksim.blocks.problem import Load, Problem
from blocksim.cli.given import Loading, given_of
from blocksim.cli.options import named_options, option_of
from blocksim.cli.output import progress
from blocksim.cli.subject import STREAM, Subject, anything_asked, reading_of
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.fields import fields_of
from blocksim.common.files import json_text, read_toml
from blocksim.common.tables import Written, as_said
from blocksim.kinds.files import LARGEST_FILES, OTHERS, is_drawing

AT_ONCE = 1 << 16
"""Bytes of a stream that are read at once, or as many as there are."""
GIVEN = {"mu", "friction_angle"}
"""Options that mean something for many structures."""
OF_DRAWINGS = {"unit", "layer", "snap", "up", "tolerance"}
"""Those that mean something where drawings or meshes are among them."""


def check_each(asked: Subject, others: Mapping[str, object]) -> NoReturn:
    """Answer the command check with a line of JSON for each structure, in their order."""
    paths = [] if asked.scene == STREAM else _paths(asked.scene or "")
    known = GIVEN | OF_DRAWINGS if any(map(is_drawing, paths)) else GIVEN
    for name, value in {**asked.options, **others}.items():
        unset = value is None or value is False or name in known
        allowed = "left out with many structures: these are read as they are"
        require(unset, option_of(name), value, allowed)
    with named_options():
        friction = asked.given.friction
    given = asked.given
    reading = reading_of(given.unit, given.layer, given.snap, given.up)
    if asked.scene == STREAM:
        # Each line has its answer, an empty one as well.
        names = ({"line": number} for number in count(1))
        told = check_batches(_lines(), friction=friction)
    else:
        names = ({"file": path.name} for path in paths)
        batches = (paths[at : at + BATCH] for at in range(0, len(paths), BATCH))
        told = check_batches(
            batches, friction=friction, reading=reading, tolerance=given.tolerance
        )
    for name, each in zip(names, told, strict=False):
        title = {"title": each.title} if each.title else {}
        found = {"verdict": each.verdict, "proved": each.proved, "margin": each.margin}
        answer = {**title, **found}
        click.echo(json_text({**name, **({"error": each.error} if each.error else answer)}))
    raise click.exceptions.Exit(0)


def _paths(folder: str) -> list[Path]:
    """Return the files of a folder that are read, in their order."""
    endings = (*LARGEST_FILES, *OTHERS)
    paths = sorted(p for p in Path(folder).iterdir() if p.suffix.lower() in endings)
    if not paths:
        raise InputError("folder", MISSING, f"files in {', '.join(endings)}", where=folder)
    return paths


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


LARGEST_FILE, MOST = 1 << 20, 1000
"""Bytes of a file, and cases in it."""
Name = Annotated[str, listed(1, 100)]


@dataclass(frozen=True, kw_only=True)
class CaseEntry(Loading, Written):
    """Entry of `case`: options that say what acts, loads on blocks, and partial factors."""

    name: Name
    factors: dict[str, float] | None = None
    dead: Annotated[list[LoadEntry], listed(1, MOST)] | None = None
    live: Annotated[list[LoadEntry], listed(1, MOST)] | None = None


@dataclass(frozen=True, kw_only=True)
class CasesFile(Written):
    """A file of cases: a title, factors of all cases, and the cases."""

    case: Annotated[list[CaseEntry], listed(1, MOST)]
    title: Annotated[str, listed(0, 200)] = ""
    factors: dict[str, float] | None = None


def asked_of_cases(path: Path, asked: Subject, how: Options, *, spatial: bool = False) -> Cases:
    """Read the cases of a structure from a .toml file, and answer them.

    `asked`, `spatial`: The structure, and what acts on it in every case that says nothing else;
        as of `anything_asked`.
    """
    allowed = "left out with many structures: cases are of one"
    require(not asked.is_many, "--cases", str(path), allowed)
    where = str(path)
    table = read_toml(where, "cases", "an existing .toml file", LARGEST_FILE)
    written = as_said(CasesFile, table, where)
    found: list[Case] = []
    for at, entry in enumerate(written.case):
        field = f"case[{at}]"
        if entry.name in {each.name for each in found}:
            raise InputError(f"{field}.name", entry.name, "another than before", where=where)
        try:
            found.append(_case(entry, written.factors or {}, asked, spatial))
        except InputError as error:
            # What an option would say is said of the key.
            key = error.field.removeprefix("--").replace("-", "_")
            raise InputError(
                f"{field}.{key}", error.value, error.allowed, where=where
            ) from None
    with named_options(), progress() as report:
        return check_cases(found, written.title, **{**how, "progress": report})


def _case(
    entry: CaseEntry, factors: Mapping[str, float], asked: Subject, spatial: bool
) -> Case:
    """Put on a structure what acts in a case."""
    acting: dict[str, Any] = given_of(entry, *(each.name for each in fields(Loading)))
    for name, value in acting.items():
        # As options check themselves.
        if (numbers := fields_of(Loading)[name].range) is not None:
            numbers.require(option_of(name), value)
    known = {**factors, **(entry.factors or {})}
    names = [each.name for each in fields(Factors)]
    for name in known:
        require(name in names, f"factors.{name}", known[name], f"one of {', '.join(names)}")
    under = replace(asked, loading=replace(asked.loading, **acting))
    problem = anything_asked(under, spatial=spatial, thick=True)
    for kind in ("dead", "live"):
        if (loads := getattr(entry, kind)) is not None:
            allowed = "left out: loads on blocks of a file of cases are in the plane"
            require(not problem.in_space, kind, len(loads), allowed)
            problem = _under(problem, kind, loads, with_load=entry.load is None)
    made = Factors(**known)
    # What it cannot be put on is said here, with the case.
    made.on(problem)
    return Case(name=entry.name, problem=problem, factors=made)


def _under(problem: Problem, kind: str, loads: list[LoadEntry], *, with_load: bool) -> Problem:
    """Put loads on blocks: live ones in place of any others, dead ones besides."""
    assembly = problem.assembly
    bodies = [
        Body(polygons=each.polygons, name=each.name or str(at))
        for at, each in enumerate(assembly.blocks)
    ]
    bodies += [Body(polygons=each.polygons, name=each.name, fixed=True)
               for each in assembly.supports]  # fmt: skip
    loads_of = LoadsOf(bodies)
    found: list[Load] = []
    for at, load in enumerate(loads):
        found += loads_of(load, f"{kind}[{at}]")
    if kind == "dead":
        return replace(problem, dead=(*problem.dead, *found))
    factor = problem.load if problem.live or not with_load else 1.0
    return replace(problem, live=tuple(found), road=(), load=factor or 1.0)
