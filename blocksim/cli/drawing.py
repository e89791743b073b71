"""What `map` and `render` draw that does not move: the map, its page, arches."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from blocksim.arch.theory import least_thickness
from blocksim.ask.answer import Check
from blocksim.ask.check import check
from blocksim.ask.methods import asked_as
from blocksim.cli.acting import Loading
from blocksim.cli.built import Given
from blocksim.cli.options import named_options, refuse
from blocksim.cli.output import progress, save_picture, say
from blocksim.cli.subject import anything_asked, arch_of, is_thick
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.files import write_whole


def write_still(
    out: Path,
    kind: str,
    scene: str | None,
    given: Given,
    loading: Loading,
    method: str | None,
    height: int | None,
    *,
    must_rest: bool,
) -> None:
    """Draw what stands still: a sheet of what is built, or the arch at its least thickness.

    What leans out of its plane is drawn in space, where it is asked about.
    """
    solid = "another kind: a page to turn around (.html) is of blocks in space"
    if scene is not None or loading.given or given.lean is not None or is_thick(given):
        problem = anything_asked(scene, given, loading, thick=given.lean is None)
        if problem.in_space or not problem.is_planar:
            problem = asked_as(problem)
            refuse({"must_rest": must_rest})
            perspective = "a .png, .svg or .pdf: it is drawn in perspective; or .html, to turn "
            require(kind != "dxf", "--out", str(out), f"{perspective}it around")
        else:
            require(kind != "html", "--out", str(out), solid)
            as_built = "limit or an engine: it is drawn as built"
            require(method != "theory", "--method", method, as_built)
        with named_options(), progress() as report:
            chosen = method or "auto"
            answer = check(problem, method=chosen, must_rest=must_rest, progress=report)
        _write(out, kind, answer, height)
        return
    require(kind != "html", "--out", str(out), solid)
    require(method is None, "--method", method, "left out: the picture is of no motion")
    require(not must_rest, "--must-rest", must_rest, "left out: nothing is built in its plane")
    thin = "a .png, .svg or .pdf where no thickness is given"
    require(kind != "dxf", "--out", str(out), thin)
    from blocksim.view.archfigure import arch_figure, picture_of_theory

    with named_options():
        maker = arch_of(replace(given, eta=1.0))
        shape = maker.shape
        assert shape is not None  # noqa: S101 - by its half-angle, or span and rise
        arch = shape.half_angle, maker.known_friction, shape.weight
        critical = least_thickness(*arch)
        if critical.eta is None:
            raise InputError("eta", MISSING, "given where no thickness stands")
        pictures = [picture_of_theory(critical, mode, *arch) for mode in critical.modes]
    save_picture(arch_figure(pictures), out, kind, height)


def _write(out: Path, kind: str, answer: Check[Any], height: int | None) -> None:
    """Draw an answer to scale, in space in perspective, or write a page to turn it around."""
    if kind == "html":
        from blocksim.view.turning import turning_page

        text = turning_page(answer).encode()
        write_whole(out, lambda file: file.write(text))
        say(f"wrote {out}: a page to turn it around")
        return
    if answer.problem.in_space:
        from blocksim.view.solidfigure import solid_figure

        save_picture(solid_figure(answer), out, kind, height)
        return
    from blocksim.view.sheet import answer_sheet
    from blocksim.view.sheetdxf import write_dxf
    from blocksim.view.sheetfigure import sheet_figure

    sheet = answer_sheet(answer)
    if kind == "dxf":
        write_whole(out, lambda file: write_dxf(sheet, file))
        say(f"wrote {out}")
        return
    save_picture(sheet_figure(sheet), out, kind, height)
