"""Tables in Markdown."""

from __future__ import annotations


def table(headings: list[str], rows: list[list[str]]) -> str:
    """Set rows as a table in Markdown."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)
