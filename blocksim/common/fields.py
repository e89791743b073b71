"""What may be given, said once: files, options, Python, designs and pages follow from it."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Literal

from blocksim.common.checks import Range, require

Stands = Literal["low", "high"]


@dataclass(frozen=True, kw_only=True)
class Field:
    """A value that may be given: what it is, and which values it may have.

    `about`: In a line.
    `range`: Of a number, with its unit.
    `choices`: Words, where it is one of them.
    `optional`: Whether it may be left out for nothing.
    `nested`, {"", "table", "tables"}: Whether it is a table of an arch, or a list of tables.
    `stands`, {"low", "high"} or None: On which side structures stand, where it may be bracketed
        over.
    """

    about: str = ""
    range: Range | None = None
    choices: tuple[str, ...] = ()
    optional: bool = False
    nested: Literal["", "table", "tables"] = ""
    stands: Stands | None = None

    @property
    def unit(self) -> str:
        """The unit of a number."""
        return "" if self.range is None else self.range.unit

    @property
    def whole(self) -> bool:
        """Whether it is a whole number."""
        return self.range is not None and self.range.whole

    @property
    def allowed(self) -> str:
        """Which values it may have, in words."""
        if self.nested:
            return (
                "a list of tables" if self.nested == "tables" else "a table with a kind of arch"
            )
        return f"one of {', '.join(self.choices)}" if self.range is None else self.range.words

    def said(self, value: object) -> str:
        """Say a value, as pages and lists do."""
        if self.nested:
            return "none" if self.nested == "tables" else str(getattr(value, "name", value))
        return f"{value:g}" if isinstance(value, float) else str(value).lower()

    def require(
        self, name: str, value: object, within: tuple[float, float] | None = None
    ) -> None:
        """Raise `InputError` unless a value is one, in its own range or a narrower one."""
        if self.nested or (self.optional and value is None):
            return
        if self.range is None:
            require(value in self.choices, name, value, self.allowed)
        else:
            known = self.range if within is None else self.range.within(*within)
            known.require(name, value)


def same(of: object, *names: str) -> dict[str, Any]:
    """Return what a thing has, by the same names."""
    return {name: getattr(of, name) for name in names}


def fields_of(table: type) -> dict[str, Field]:
    """Return what is known of each field of a dataclass that says it, by name, in order."""
    known = {each.name: each.metadata.get(Field.__name__) for each in fields(table)}
    return {name: each for name, each in known.items() if each is not None}
