"""The command that writes a report on one structure."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated

import click

from blocksim.ask.check import check
from blocksim.cli.arguments import Option
from blocksim.cli.options import (
    EXIT_CODES,
    Given,
    Loading,
    MethodOption,
    Scene,
    Set,
    named_options,
    require_given,
    settings_of,
)
from blocksim.cli.output import picture_kind, progress, say
from blocksim.cli.subject import problem_asked
from blocksim.common.checks import require
from blocksim.common.dates import made_at
from blocksim.common.files import write_whole
from blocksim.report.printing import printed_page, require_browser


def report(
    given: Given,
    loading: Loading,
    out: Annotated[
        Path | None,
        Option(about="File to write: .html, .pdf (by Chromium or Chrome), .dxf; required."),
    ] = None,
    scene: Scene = None,
    project: Annotated[str, Option(about="Project, for the title block.")] = "",
    part: Annotated[str, Option(about="Part of it that this is.")] = "",
    engineer: Annotated[str, Option(about="Who is responsible for it.")] = "",
    date: Annotated[str, Option(about="Date of the title block; today if left out.")] = "",
    method: MethodOption = "auto",
    settings: Set = None,
) -> None:
    """Write a report on one structure, to print and to sign. Exit codes are those of check."""
    problem = problem_asked(scene, given, loading, thick=True, out=out)
    require_given(out=out)
    out = out or Path()
    kind = picture_kind(out, ("html", "pdf", "dxf"))
    if kind == "pdf":
        require_browser()
    as_built = "limit or an engine: it is of the blocks as built"
    require(method != "theory", "--method", method, as_built)
    own = settings_of(settings)
    # Drawing takes a second to import, which other commands need not wait for.
    from blocksim.report.sheetpage import structure_page
    from blocksim.view.sheet import Titles, answer_sheet
    from blocksim.view.sheetdxf import write_dxf

    with named_options(), progress() as told:
        answer = check(problem, method=method, settings=own, progress=told)
    titles = Titles(
        project=project, part=part, engineer=engineer, date=date or made_at().partition(" ")[0]
    )
    if kind == "dxf":
        sheet = answer_sheet(answer, titles)
        write_whole(out, lambda file: write_dxf(sheet, file))
    else:
        page = structure_page(
            answer,
            mode=answer.arch and answer.arch.mode,
            command=shlex.join(["blocksim", *sys.argv[1:]]),
            settings=", ".join(f"{name} {value:g}" for name, value in own.items()),
            titles=titles,
        )
        content = printed_page(page) if kind == "pdf" else page.encode()
        write_whole(out, lambda file: file.write(content))
    say(f"wrote {out}: {answer.verdict.value}, by {answer.method}")
    raise click.exceptions.Exit(EXIT_CODES[answer.verdict])
