"""The commands map and paper: the map as a picture, a page or in numbers; every figure."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import click

from blocksim.cli.arguments import argument, option
from blocksim.cli.options import JSON, require_given
from blocksim.cli.output import answer_with, picture_kind, progress, save_picture, say
from blocksim.common.checks import Range, require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.files import write_whole
from blocksim.common.words import counted

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
    numbers = table or as_json
    if not numbers:
        require_given(out=out)
        write_map(out or Path(), zoom, results, lines=lines, weight=weight, phi=phi)
        return
    require(out is None, "--out", str(out), "left out with --table or --json")
    from blocksim.report.maptable import map_lines, map_record

    answer_with(lambda: map_record(weight), lambda: map_lines(weight), as_json=as_json)


def write_map(
    out: Path,
    zoom: str,
    results: Path | None,
    *,
    lines: bool,
    weight: OfWeight = "centreline",
    phi: bool = False,
) -> None:
    """Write the map as a picture, as a page or as a table."""
    kind = picture_kind(out, ("svg", "png", "pdf", "html", "csv"))
    if kind != "html":
        page = "left out unless --out ends in .html"
        require(results is None, "--results", str(results), page)
    what = ""
    if kind in {"html", "csv"}:
        what = "left out where --out is " + ("a page" if kind == "html" else ".csv")
        require(not lines, "--lines", lines, what)
        require(zoom == "whole", "--zoom", zoom, what)
        require(not phi, "--phi", phi, what)
    if kind == "html":
        require(weight == "centreline", "--weight", weight, f"{what}: it asks")
        from blocksim.view.explorer import explorer_page, read_results

        rows = [] if results is None else read_results(results)
        page = explorer_page(rows, str(results or "")).encode()
        write_whole(out, lambda file: file.write(page))
        say(f"wrote {out}")
        return
    if kind == "csv":
        from blocksim.report.maptable import map_sheet

        sheet = map_sheet(weight)
        write_whole(out, lambda file: file.write(sheet))
        say(f"wrote {out}")
        return
    from blocksim.view.linemap import line_map_figure
    from blocksim.view.mapfigure import map_figure
    from blocksim.view.mapshapes import FrictionAxis

    zooms = LINE_ZOOMS if lines else ZOOMS
    require(zoom in zooms, "--zoom", zoom, f"one of {', '.join(zooms)}")
    friction = FrictionAxis(angle=phi)
    if lines:
        figure = line_map_figure(zooms[zoom], weight, friction)
    else:
        figure = map_figure(central=zoom == "central", weight=weight, friction=friction)
    save_picture(figure, out, kind)


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
