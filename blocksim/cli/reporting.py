"""The command that writes a report on one structure."""

from __future__ import annotations

import shlex
import sys
from functools import partial
from pathlib import Path
from typing import Any

import click

from blocksim.ask.check import Check, check
from blocksim.ask.options import Options
from blocksim.cli.arguments import option
from blocksim.cli.options import (
    CASES,
    EXIT_CODES,
    METHOD,
    SET,
    named_options,
    require_given,
    settings_of,
)
from blocksim.cli.output import picture_kind, progress, write
from blocksim.cli.subject import Subject, anything_asked
from blocksim.common.checks import require
from blocksim.common.dates import made_at
from blocksim.report.printing import printed_page, require_browser


def report(
    asked: Subject,
    out: Path | None = option(
        "File to write: .html, .pdf (by Chromium or Chrome), .dxf; required."
    ),
    project: str = option("Project, for the title block.", default=""),
    part: str = option("Part of it that this is.", default=""),
    engineer: str = option("Who is responsible for it.", default=""),
    date: str = option("Date of the title block; today if left out.", default=""),
    method: str = METHOD,
    settings: list[str] | None = SET,
    cases: Path | None = CASES,
) -> None:
    """Write a report on one structure, to print and to sign. Exit codes are those of check.

    With --cases it compares them, and reports on the one that governs.
    """
    require_given(out=out)
    out = out or Path()
    kind = picture_kind(out, ("html", "pdf", "dxf"))
    if kind == "pdf":
        require_browser()
    as_built = "limit or an engine: it is of the blocks as built"
    require(method != "theory", "--method", method, as_built)
    own = settings_of(settings)
    from blocksim.report.sheetpage import structure_page
    from blocksim.view.sheet import Titles, answer_sheet
    from blocksim.view.sheetdxf import write_dxf

    options: Options = {"method": method, "settings": own}
    compared = None
    if cases is not None:
        from blocksim.cli.many import asked_of_cases

        compared = asked_of_cases(cases, asked, options)
    answer = compared.governing.answer if compared else _answer(asked, options)
    on = date or made_at().partition(" ")[0]
    titles = Titles(project=project, part=part, engineer=engineer, date=on)
    if kind == "dxf":
        flat = "a .html or .pdf: it is of blocks in space"
        require(not answer.problem.in_space, "--out", str(out), flat)
        made = partial(write_dxf, answer_sheet(answer, titles))
    else:
        page = structure_page(
            answer,
            mode=answer.arch and answer.arch.mode,
            command=shlex.join(["blocksim", *sys.argv[1:]]),
            settings=", ".join(f"{name} {value:g}" for name, value in own.items()),
            titles=titles,
            cases=compared,
        )
        made = printed_page(page) if kind == "pdf" else page.encode()
    write(out, made, said=f": {answer.verdict.value}, by {answer.method}")
    raise click.exceptions.Exit(EXIT_CODES[answer.verdict])


def _answer(asked: Subject, options: Options) -> Check[Any]:
    """Ask about one structure."""
    problem = anything_asked(asked, thick=True)
    with named_options(), progress() as told:
        how: Options = {**options, "progress": told}
        return check(problem, **how)
