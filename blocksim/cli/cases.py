"""A file of cases: what acts in each, as options say it, and partial factors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Annotated, Any

from blocksim.ask.cases import Case, Cases, Factors, check_cases
from blocksim.ask.options import Options
from blocksim.blocks.entries import LoadEntry, listed
from blocksim.blocks.given import Body
from blocksim.blocks.loads import LoadsOf
from blocksim.blocks.problem import Load, Problem
from blocksim.cli.acting import Loading
from blocksim.cli.built import Given
from blocksim.cli.options import named_options, option_of
from blocksim.cli.output import progress
from blocksim.cli.subject import anything_asked, is_many
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.fields import fields_of
from blocksim.common.files import read_toml
from blocksim.common.tables import Written, as_said

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


def asked_of_cases(
    path: Path, scene: str | None, given: Given, loading: Loading, how: Options, *,
    spatial: bool = False,
) -> Cases:  # fmt: skip
    """Read the cases of a structure from a .toml file, and answer them.

    `scene`, `given`, `loading`, `spatial`: The structure, and what acts on it in every case
        that says nothing else; as of `anything_asked`.
    """
    allowed = "left out with many structures: cases are of one"
    require(scene is None or not is_many(scene), "--cases", str(path), allowed)
    where = str(path)
    table = read_toml(where, "cases", "an existing .toml file", LARGEST_FILE)
    written = as_said(CasesFile, table, where)
    found: list[Case] = []
    for at, entry in enumerate(written.case):
        field = f"case[{at}]"
        once = entry.name not in {each.name for each in found}
        if not once:
            raise InputError(f"{field}.name", entry.name, "another than before", where=where)
        try:
            found.append(_case(entry, written.factors or {}, scene, given, loading, spatial))
        except InputError as error:
            # What an option would say is said of the key.
            key = error.field.removeprefix("--").replace("-", "_")
            raise InputError(
                f"{field}.{key}", error.value, error.allowed, where=where
            ) from None
    with named_options(), progress() as report:
        return check_cases(found, written.title, **{**how, "progress": report})


def _case(
    entry: CaseEntry, factors: Mapping[str, float], scene: str | None, given: Given,
    loading: Loading, spatial: bool,
) -> Case:  # fmt: skip
    """Put on a structure what acts in a case."""
    own = {each.name: getattr(entry, each.name) for each in fields(Loading)}
    _require_ranges(own)
    acting = {name: value for name, value in own.items() if value is not None}
    known = {**factors, **(entry.factors or {})}
    for name in known:
        names = [each.name for each in fields(Factors)]
        require(name in names, f"factors.{name}", known[name], f"one of {', '.join(names)}")
    problem = anything_asked(
        scene, given, replace(loading, **acting), spatial=spatial, thick=True
    )
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


def _require_ranges(own: Mapping[str, Any]) -> None:
    """Check what options would check of themselves."""
    known = fields_of(Loading)
    for name, value in own.items():
        if (numbers := known[name].range) is not None and value is not None:
            numbers.require(option_of(name), value)
