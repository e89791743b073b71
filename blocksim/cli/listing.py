"""The commands that list what is there: scenarios and kinds."""

from __future__ import annotations

import math

from blocksim.blocks.vehicles import shipped_vehicles, vehicle_of
from blocksim.cli.arguments import argument
from blocksim.cli.output import say
from blocksim.cli.terminal import Table, show
from blocksim.common.errors import InputError, perhaps
from blocksim.common.fields import fields_of
from blocksim.kinds import KINDS
from blocksim.kinds.scenarios import load_scenario, shipped
from blocksim.studies.validate import structures

NUMBERS = {"alpha", "mu", "n", "eta", "blocks"}
"""Columns of numbers."""


def list_scenarios() -> None:
    """List the scenarios, structures and vehicles that come with blocksim."""
    table = Table("name", "alpha", "mu", "n", "eta", "title", "source", right=NUMBERS)
    for name in shipped():
        each = load_scenario(name)
        arch = each.arch(1.0)
        eta = f"{each.maker.eta:g}" if each.has_thickness else "-"
        numbers = f"{math.degrees(arch.half_angle):g}", f"{each.mu:.4g}", str(arch.voussoirs)
        table.add_row(name, *numbers, eta, each.title, each.source)
    show(table)
    say("")
    built = Table("structure", "blocks", "mu", "known", "title", "source", right=NUMBERS)
    for known in structures(quick=False):
        told = [
            f"{one.verdict}" if one.verdict else f"--over {one.over} {one.value:.6g}"
            for one in known.expect
        ]
        problem = known.problem
        size = str(len(problem.assembly.blocks)), f"{problem.mu:.4g}"
        built.add_row(known.name, *size, ", ".join(told), problem.title, problem.source)
    show(built)
    say("")
    vehicles = Table("vehicle", "axles", "title", "source")
    for name in shipped_vehicles():
        each = vehicle_of(name)
        axles = ", ".join(f"{weight / 1e3:g} kN at {x:g} m" for x, weight in each.axles)
        vehicles.add_row(name, axles, each.title, each.source)
    show(vehicles)


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
