"""The commands map and paper: the map as a picture, a page or in numbers; every figure."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from blocksim.cli.arguments import argument, option
from blocksim.cli.options import JSON, refuse, require_given
from blocksim.cli.output import answer_with, picture_kind, progress, say, write
from blocksim.common.checks import Range, require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.words import counted

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ZOOMS = {"whole": (0.0, 2.0), "central": (0.6, 1.2)}
LINE_ZOOMS = {"whole": (0.0, 2.0), "lower": (0.0, 1.0), "upper": (0.6, 2.0)}
OfWeight = Literal["centreline", "sector"]


def draw_map(
    out: Path | None = option(
        "Picture, .svg, .png or .pdf, page, .html, or numbers, .csv; required "
        "without --table or --json."
    ),
    lines: bool = option(
        "Dividing lines and lines of equal alpha instead.", default=False, name="--lines"
    ),
    zoom: str = option("whole, central; with --lines: whole, lower, upper.", default="whole"),
    weight: OfWeight = option(
        "Where weight acts: of the paper, or of true voussoirs.", default="centreline"
    ),
    phi: bool = option(
        "Over the friction angle in degrees, up to 90.", default=False, name="--phi"
    ),
    table: bool = option(
        "Print Table 1, special angles and rates of the modes.", default=False, name="--table"
    ),
    as_json: bool = JSON,
    results: Path | None = option("validate.json of a `validate` run, shown on the page."),
) -> None:
    """Draw the analytical map of least thickness and collapse modes.

    As a page (.html) it can be explored: any point's arch, its lines of thrust and
    friction, and its collapse. In numbers (.csv, --table, --json) it has Table 1, the
    special angles, points on all lines, and the rates of every mode there.
    """
    if table or as_json:
        require(out is None, "--out", str(out), "left out with --table or --json")
        from blocksim.report.maptable import map_lines, map_record

        answer_with(map_record, map_lines, weight, as_json=as_json)
        return
    require_given(out=out)
    out = out or Path()
    kind = picture_kind(out, ("svg", "png", "pdf", "html", "csv"))
    page = "left out unless --out ends in .html"
    require(results is None or kind == "html", "--results", str(results), page)
    if kind not in {"html", "csv"}:
        write(out, _picture(zoom, weight, lines=lines, phi=phi))
        return
    what = "left out where --out is " + ("a page" if kind == "html" else ".csv")
    refuse({"lines": lines, "zoom": zoom != "whole" and zoom, "phi": phi}, why=what)
    if kind == "csv":
        from blocksim.report.maptable import map_sheet

        write(out, map_sheet(weight))
        return
    require(weight == "centreline", "--weight", weight, f"{what}: it asks")
    from blocksim.view.explorer import explorer_page, read_results

    rows = [] if results is None else read_results(results)
    write(out, explorer_page(rows, str(results or "")).encode())


def _picture(zoom: str, weight: OfWeight, *, lines: bool, phi: bool) -> Figure:
    """Draw the map, or its lines."""
    from blocksim.view.linemap import line_map_figure
    from blocksim.view.mapfigure import map_figure
    from blocksim.view.mapshapes import FrictionAxis

    zooms = LINE_ZOOMS if lines else ZOOMS
    require(zoom in zooms, "--zoom", zoom, f"one of {', '.join(zooms)}")
    friction = FrictionAxis(angle=phi)
    if lines:
        return line_map_figure(zooms[zoom], weight, friction)
    return map_figure(central=zoom == "central", weight=weight, friction=friction)


MET = 1e-12
"""Relative difference up to which a printed number is met."""

FIGURES = Range(low=1, high=25, whole=True)


def paper(
    out: Path | None = argument(
        "Folder for the figures and a page, index.html; required.", folder=True
    ),
    figures: list[int] | None = option(
        "Only this one; repeatable.",
        name="--figure",
        metavar="N",
        range=FIGURES,
    ),
    kind: Literal["svg", "png"] = option("Of the pictures.", default="svg", name="--format"),
) -> None:
    """Draw every figure of the paper, and compare every number that it prints.

    Exit code 1 where a number is not met.
    """
    if out is None:
        raise InputError("OUT", MISSING, "a folder")
    from blocksim.report.paperpage import write_paper

    with progress() as report:
        paths, worst = write_paper(out, figures, kind, progress=report)
    say(
        f"every number printed is met to {worst:.0e}"
        if worst <= MET
        else f"MISSES a number: {worst:.0e}"
    )
    say(f"wrote {paths[0]}, with {counted(len(paths) - 2, 'figure')} and {paths[1].name}")
    raise click.exceptions.Exit(int(worst > MET))
