"""The paper's figures and numbers as files, with a page that shows them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from blocksim.common.files import AnyPath, make_folder, write_folder
from blocksim.common.progress import Progress, silent
from blocksim.common.sheets import sheet_of
from blocksim.common.version import __version__
from blocksim.studies.paper import CONTENTS, FIGURES, Printed, numbers
from blocksim.view.drawing import figure_bytes
from blocksim.view.paper import paper_figure
from blocksim.view.templates import template_of

PAGE = "index.html"
NUMBERS = "numbers.csv"


def write_paper(
    folder: AnyPath,
    figures: Sequence[int] | None = None,
    kind: str = "svg",
    *,
    progress: Progress = silent,
) -> tuple[list[Path], float]:
    """Draw figures of the paper, and write its numbers beside them.

    `figures`: Their numbers; all 25 if left out.
    `kind`, {"svg", "png"}.
    Returns `paths`: The page first.
    Returns `worst`: Largest relative difference of a number from the printed one.
    """
    make_folder(folder)
    asked = sorted(set(figures or FIGURES))
    drawn: dict[str, bytes] = {}
    for done, number in enumerate(asked):
        progress(done / len(asked), f"Fig. {number}")
        drawn[f"fig{number:02}.{kind}"] = figure_bytes(paper_figure(number), kind)
    found = numbers()
    page = template_of("blocksim.report", "paper.html", "templates")
    shown = [(at, name, CONTENTS[at]) for at, name in zip(asked, drawn, strict=True)]
    worst = max(each.difference for each in found)
    html = page.render(figures=shown, numbers=found, worst=worst, version=__version__)
    contents = {PAGE: html.encode(), NUMBERS: _sheet(found), **drawn}
    return write_folder(folder, contents), worst


def _sheet(found: Sequence[Printed]) -> bytes:
    names = ["name", "computed", "printed", "relative_difference"]
    rows = ([each.name, each.value, each.printed, each.difference] for each in found)
    return sheet_of(names, rows)
