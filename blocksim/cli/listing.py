"""The commands that list what is there: structures, vehicles and kinds."""

from __future__ import annotations

from blocksim.blocks.entries import ExpectEntry
from blocksim.blocks.vehicles import shipped_vehicles, vehicle_of
from blocksim.cli.arguments import argument
from blocksim.cli.output import say
from blocksim.cli.terminal import Table, show
from blocksim.common.errors import InputError, perhaps
from blocksim.common.fields import fields_of
from blocksim.kinds import KINDS
from blocksim.studies.validate import structures

NUMBERS = {"mu", "blocks"}
"""Columns of numbers."""


def list_scenarios() -> None:
    """List the structures and vehicles that come with blocksim."""
    headings = ("structure", "blocks", "mu", "known", "title", "source")
    built = Table(*headings, right=NUMBERS, below=3)
    for known in structures(quick=False):
        problem, told = known.problem, ", ".join(map(_expected, known.expect))
        size = str(len(problem.assembly.blocks)), f"{problem.mu:.4g}"
        built.add_row(known.name, *size, told, problem.title, problem.source)
    show(built)
    say("")
    vehicles = Table("vehicle", "axles", "title", "source", below=3)
    for name in shipped_vehicles():
        each = vehicle_of(name)
        axles = ", ".join(f"{weight / 1e3:g} kN at {x:g} m" for x, weight in each.axles)
        vehicles.add_row(name, axles, each.title, each.source)
    show(vehicles)


def _expected(known: ExpectEntry) -> str:
    """Say what the source of a structure says of it."""
    if known.modes is not None:
        least = "none stands" if known.eta is None else f"eta {known.eta:.6g}"
        return f"{'/'.join(known.modes)} {least}"
    return known.verdict or f"--over {known.over} {known.value:.6g}"


def list_kinds(
    name: str | None = argument("One of them, whose parameters are to be listed."),
) -> None:
    """List the kinds of structures, or the parameters of one."""
    if name is None:
        table = Table("kind", "what it is", "parameters")
        for kind in KINDS.values():
            where = " (in space)" if kind.in_space else ""
            table.add_row(kind.name, kind.about + where, ", ".join(fields_of(kind)))
        show(table)
        return
    if name not in KINDS:
        raise InputError("kind", name, f"one of {', '.join(KINDS)}{perhaps(name, KINDS)}")
    table = Table("parameter", "if left out", "may be", "what it is", "--over")
    usual = KINDS[name]()
    for each, known in fields_of(type(usual)).items():
        over = ", ".join(over for over in usual.bracketed if over.partition(".")[0] == each)
        table.add_row(each, known.said(getattr(usual, each)), known.allowed, known.about, over)
    show(table)
