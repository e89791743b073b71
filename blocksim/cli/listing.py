"""The commands that list what is there: methods, their sources, structures, vehicles, kinds."""

from __future__ import annotations

import platform
from typing import TYPE_CHECKING

import click

from blocksim import __version__
from blocksim.ask import doctor as installed
from blocksim.ask.methods import METHODS
from blocksim.cli.arguments import argument, option
from blocksim.cli.options import named_options
from blocksim.cli.output import say
from blocksim.cli.terminal import Table, show
from blocksim.common.errors import InputError, perhaps
from blocksim.common.fields import fields_of
from blocksim.kinds import KINDS

if TYPE_CHECKING:
    from blocksim.blocks.entries import ExpectEntry

EVERY = ", ".join(METHODS.shipped)


def doctor() -> None:
    """Tell what is installed and what each method can do here."""
    table = Table("method", "version", "here", "finest bracket", "sees")
    for finding in installed.examine():
        finest = "exact" if finding.finest == 0 else f"{finding.finest:g}"
        here = finding.remedy or "ready"
        table.add_row(finding.method, finding.version or "-", here, finest, finding.sees)
    show(table)
    say(f"blocksim {__version__}, Python {platform.python_version()}")
    say(", ".join(f"{name} {found or '-'}" for name, found in installed.libraries().items()))


def cite(
    methods: list[str] | None = option(f"Repeatable, or all: {EVERY}.", name="--method"),
) -> None:
    """Print BibTeX of blocksim, of the paper, and of what methods rest on."""
    with named_options():
        # It is for programs: no line of it is folded.
        click.echo(installed.cite(*methods or []))


NUMBERS = {"mu", "blocks"}
"""Columns of numbers."""


def list_scenarios() -> None:
    """List the structures and vehicles that come with blocksim."""
    from blocksim.blocks.vehicles import axle_words, shipped_vehicles, vehicle_of
    from blocksim.studies.validate import structures

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
        axles = ", ".join(axle_words(each.axles, weigh=6, stand=6))
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
