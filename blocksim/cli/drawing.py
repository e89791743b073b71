"""What `map` and `render` draw that does not move: the map, its page, arches."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from blocksim.arch.theory import least_thickness
from blocksim.ask.answer import Check
from blocksim.ask.check import check
from blocksim.cli.acting import Loading
from blocksim.cli.built import Given
from blocksim.cli.filming import picture_of_leaning
from blocksim.cli.options import named_options, refuse
from blocksim.cli.output import progress, save_picture, say
from blocksim.cli.question import question
from blocksim.cli.subject import anything_asked, is_structure, problem_asked
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

    Where gravity leans out of the plane of an arch, statics in the plane say nothing: it is
    put into the engine that sees it, and drawn in perspective.
    """
    built = is_structure(scene) or loading.given
    asked = None if built else question(scene, given)
    solid = "another kind: a page to turn around (.html) is of blocks in space"
    if asked is None or (not asked.lean and asked.has_thickness):
        problem = anything_asked(scene, given, loading, thick=True)
        if problem.in_space:
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
    flat = "a .png, .svg or .pdf: it leans" if asked.lean else (
        "a .png, .svg or .pdf where no thickness is given"
    )  # fmt: skip
    require(kind != "dxf", "--out", str(out), flat)
    if asked.lean:
        picture_of_leaning(out, kind, problem_asked(scene, given, loading), height)
        return
    from blocksim.view.archfigure import arch_figure, picture_of_theory

    with named_options():
        shape = asked.arch(1.0)
        arch = shape.half_angle, asked.mu, shape.weight
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
