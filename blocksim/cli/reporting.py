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
from blocksim.cli.output import progress, say
from blocksim.cli.subject import problem_asked
from blocksim.common.checks import require
from blocksim.common.files import require_place, write_whole


def report(
    given: Given,
    loading: Loading,
    out: Annotated[Path | None, Option(about="Page to write, .html; required.")] = None,
    scene: Scene = None,
    method: MethodOption = "auto",
    settings: Set = None,
) -> None:
    """Write a report on one structure, a page to print. Exit codes are those of check."""
    problem = problem_asked(scene, given, loading, thick=True, out=out)
    require_given(out=out)
    out = out or Path()
    require(out.suffix == ".html", "--out", str(out), "a file name ending in .html")
    require_place(out)
    as_built = "limit or an engine: it is of the blocks as built"
    require(method != "theory", "--method", method, as_built)
    own = settings_of(settings)
    # Drawing takes a second to import, which other commands need not wait for.
    from blocksim.report.sheetpage import structure_page

    with named_options(), progress() as told:
        answer = check(problem, method=method, settings=own, progress=told)
    page = structure_page(
        answer,
        mode=answer.arch and answer.arch.mode,
        command=shlex.join(["blocksim", *sys.argv[1:]]),
        settings=", ".join(f"{name} {value:g}" for name, value in own.items()),
    )
    write_whole(out, lambda file: file.write(page.encode()))
    say(f"wrote {out}: {answer.verdict.value}, by {answer.method}")
    raise click.exceptions.Exit(EXIT_CODES[answer.verdict])
