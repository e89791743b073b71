"""The paper's figures and numbers as files, with a page that shows them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from blocksim.common.files import AnyPath, make_folder, write_whole
from blocksim.common.progress import Progress, silent
from blocksim.common.sheets import sheet_of
from blocksim.common.version import __version__
from blocksim.studies.paper import CONTENTS, FIGURES, Printed, numbers
from blocksim.view.drawing import save_figure
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
    folder = Path(folder)
    make_folder(folder)
    asked = sorted(set(figures or FIGURES))
    paths = [folder / PAGE, folder / NUMBERS]
    names: dict[int, str] = {}
    for done, number in enumerate(asked):
        progress(done / len(asked), f"Fig. {number}")
        figure = paper_figure(number)
        names[number] = f"fig{number:02}.{kind}"
        paths.append(folder / names[number])
        write_whole(paths[-1], lambda file, figure=figure: save_figure(figure, file, kind))
    found = numbers()
    write_whole(paths[1], lambda file: file.write(_sheet(found)))
    page = template_of("blocksim.report", "paper.html", "templates")
    shown = [(number, names[number], CONTENTS[number]) for number in asked]
    worst = max(each.difference for each in found)
    html = page.render(figures=shown, numbers=found, worst=worst, version=__version__)
    write_whole(paths[0], lambda file: file.write(html.encode()))
    return paths, worst


def _sheet(found: Sequence[Printed]) -> bytes:
    names = ["name", "computed", "printed", "relative_difference"]
    rows = ([each.name, each.value, each.printed, each.difference] for each in found)
    return sheet_of(names, rows)
