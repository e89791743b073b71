"""What `map` and `render` draw that does not move: the map, its page, arches."""

from __future__ import annotations

from pathlib import Path

from blocksim.arch.theory import least_thickness
from blocksim.cli.console import picture_kind, save_picture, say
from blocksim.cli.filming import picture_of_leaning
from blocksim.cli.options import Given, named_options
from blocksim.cli.question import arch_of, question
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.files import write_whole

ZOOMS = {"whole": (0.0, 2.0), "central": (0.6, 1.2)}
LINE_ZOOMS = {"whole": (0.0, 2.0), "lower": (0.0, 1.0), "upper": (0.6, 2.0)}


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


def write_arch(
    out: Path, kind: str, scene: str | None, given: Given, height: int | None
) -> None:
    """Draw the voussoirs as built, or the continuous arch at its least thickness.

    Where gravity leans out of the plane, statics in the plane say nothing: the arch is put
    into the engine that sees it, and drawn in perspective.
    """
    # matplotlib takes a second to import, which other commands need not wait for.
    from blocksim.view.archfigure import arch_figure, picture_of_arch, picture_of_theory

    asked = question(scene, given)
    if asked.lean:
        picture_of_leaning(out, kind, arch_of(asked, given.ratio), asked, height)
        return
    with named_options():
        if asked.eta is not None or given.ratio is not None:
            pictures = [picture_of_arch(arch_of(asked, given.ratio), asked.mu)]
        else:
            critical = least_thickness(asked.half_angle, asked.mu, asked.weight)
            if critical.eta is None:
                raise InputError("eta", MISSING, "given where no thickness stands")
            arch = asked.half_angle, asked.mu, asked.weight
            pictures = [picture_of_theory(critical, mode, *arch) for mode in critical.modes]
    save_picture(arch_figure(pictures), out, kind, height)
