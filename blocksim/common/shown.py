"""What notebooks show of things: a base class; who draws and tells them is said from above."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LONGEST = 60
"""Letters of a title in a `repr`."""


_renderers: list[Callable[[], Any]] = []


def show_by(renderer: Callable[[], Any]) -> None:
    """Say what loads the renderer (`blocksim.notebook`) when something is first shown."""
    _renderers[:] = [renderer]


def renderer() -> Any:
    """Return what draws and tells things."""
    return _renderers[0]()


class Shown:
    """Something that draws itself, tells itself as plain data, and shows itself in a notebook.

    Who does that registers from above (`show_by`): things need not know who draws them, and
    `import blocksim` loads no matplotlib.
    """

    def plot(self) -> Figure:
        """Draw it, as a matplotlib figure to change or to save."""
        return renderer().figure_of(self)

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON has it: for answers what `--json` prints."""
        return renderer().dict_of(self)

    def _repr_svg_(self) -> str:
        """Return its drawing, for a notebook."""
        return renderer().svg_of(self)

    def _repr_html_(self) -> str:
        """Return its words and its drawing, for a notebook."""
        return renderer().html_of(self)


def short(words: str) -> str:
    """Return words in one line that is no longer than fits into a `repr`."""
    line = " ".join(words.split())
    return line if len(line) <= LONGEST else line[: LONGEST - 1] + "…"
