"""What notebooks show of things: a base class that asks for a renderer when one is needed."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from blocksim.common.words import printable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LONGEST = 60
"""Letters of a title in a `repr`."""


class Shown:
    """Something that draws itself, tells itself as plain data, and shows itself in a notebook.

    How is said in `blocksim.notebook`, which may know drawings and reports. It is loaded by
    name when it is first asked, the only place where a lower room reaches for a higher one:
    things need not know who draws them, and `import blocksim` loads no matplotlib.
    """

    def plot(self) -> Figure:
        """Draw it, as a matplotlib figure to change or to save."""
        return _notebook().figure_of(self)

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON has it: for answers what `--json` prints."""
        return _notebook().dict_of(self)

    def _repr_svg_(self) -> str:
        """Return its drawing, for a notebook."""
        return _notebook().svg_of(self)

    def _repr_html_(self) -> str:
        """Return its words and its drawing, for a notebook."""
        return _notebook().html_of(self)


def _notebook() -> Any:
    return import_module("blocksim.notebook")


def short(words: str) -> str:
    """Return words in one line that is no longer than fits into a `repr`."""
    line = " ".join(printable(words).split())
    return line if len(line) <= LONGEST else line[: LONGEST - 1] + "…"
