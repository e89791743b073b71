"""The command map: the map as a picture or as a page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from blocksim.cli.arguments import Option
from blocksim.cli.options import require_given
from blocksim.cli.output import picture_kind, save_picture, say
from blocksim.common.checks import require
from blocksim.common.files import write_whole

ZOOMS = {"whole": (0.0, 2.0), "central": (0.6, 1.2)}
LINE_ZOOMS = {"whole": (0.0, 2.0), "lower": (0.0, 1.0), "upper": (0.6, 2.0)}


def draw_map(
    out: Annotated[
        Path | None,
        Option(help="Picture, .svg, .png or .pdf, or a page, .html; required."),
    ] = None,
    lines: Annotated[
        bool, Option(name="--lines", help="Dividing lines and lines of equal alpha instead.")
    ] = False,
    zoom: Annotated[
        str, Option(help="whole, central; with --lines: whole, lower, upper.")
    ] = "whole",
    results: Annotated[
        Path | None, Option(help="validate.json of a `validate` run, shown on the page.")
    ] = None,
) -> None:
    """Draw the analytical map of least thickness and collapse modes.

    As a page (.html) it can be explored: any point's arch, its lines of thrust and
    friction, and its collapse.
    """
    require_given(out=out)
    write_map(out or Path(), zoom, results, lines=lines)


def write_map(out: Path, zoom: str, results: Path | None, *, lines: bool) -> None:
    """Write the map as a picture or as a page."""
    kind = picture_kind(out, ("svg", "png", "pdf", "html"))
    if kind == "html":
        require(not lines, "--lines", lines, "left out where --out is a page")
        require(zoom == "whole", "--zoom", zoom, "left out where --out is a page")
        _map_page(out, results)
        return
    require(results is None, "--results", str(results), "left out unless --out ends in .html")
    # matplotlib takes a second to import, which other commands need not wait for.
    from blocksim.view.linemap import line_map_figure
    from blocksim.view.mapfigure import map_figure

    zooms = LINE_ZOOMS if lines else ZOOMS
    require(zoom in zooms, "--zoom", zoom, f"one of {', '.join(zooms)}")
    figure = line_map_figure(zooms[zoom]) if lines else map_figure(central=zoom == "central")
    save_picture(figure, out, kind)


def _map_page(out: Path, results: Path | None) -> None:
    from blocksim.view.explorer import explorer_page, read_results

    rows = [] if results is None else read_results(results)
    html = explorer_page(rows, str(results or ""))
    write_whole(out, lambda file: file.write(html.encode()))
    say(f"wrote {out}")
