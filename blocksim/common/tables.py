"""Tables of files as dataclasses say them: the one place where pydantic checks them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar, TypeVar, cast

from pydantic import TypeAdapter, ValidationError

from blocksim.common.errors import MISSING, InputError

Said = TypeVar("Said")
UNKNOWN = "unexpected_keyword_argument"
"""What pydantic calls a key that a table has not."""
COUNTED = re.compile(r"^\w+ should have (at \w+ \d+ \w+) after validation, not .*$")
"""What pydantic says of a list with too few or too many entries."""


class Written:
    """A table of a file, in which no other keys may stand."""

    __pydantic_config__: ClassVar = {"extra": "forbid"}


@dataclass(frozen=True)
class Words:
    """What is said of a value of several types, in an annotation of it."""

    words: str

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> dict[str, Any]:
        """Return the schema of the type, with these words in place of its complaints."""
        return {
            "type": "custom-error",
            "schema": handler(source),
            "custom_error_type": "words",
            "custom_error_message": self.words,
        }


def as_said(
    schema: type[Said],
    table: object,
    where: str | None = None,
    unknown: str = "there is no such key",
) -> Said:
    """Check what a table of a file says.

    `schema`: A dataclass.
    `where`: The file.
    `unknown`: What is said of a key that the table has not.
    """
    try:
        return _adapter(schema).validate_python(table)
    except ValidationError as error:
        raise _first_of(error, table, where, unknown) from None


@cache
def _adapter(schema: type[Said]) -> TypeAdapter[Said]:
    return TypeAdapter(schema)


def _first_of(
    error: ValidationError, table: object, where: str | None, unknown: str
) -> InputError:
    """Turn the first of pydantic's complaints into one line."""
    errors = error.errors(include_url=False, include_context=False)
    # A misspelt key shows twice, as unknown and as missing: the first says more.
    same = [each for each in errors if each["loc"][:-1] == errors[0]["loc"][:-1]]
    first = min(same, key=lambda each: each["type"] != UNKNOWN)
    missing = first["type"] in {"missing", "missing_argument"}
    field = _place(first["loc"], table, missing=missing)
    if first["type"] == UNKNOWN:
        return InputError(field, first["input"], f"left out: {unknown}", where=where)
    if missing:
        return InputError(field, MISSING, "given", where=where)
    said = COUNTED.sub(r"\1", first["msg"].removeprefix("Input should be "))
    return InputError(field, first["input"], said, where=where)


def _place(path: tuple[int | str, ...], table: Any, *, missing: bool) -> str:
    """Say where an entry stands, without the names of types that pydantic tried there."""
    field, inside = "", table
    for at, part in enumerate(path):
        keys = cast("dict[str, Any]", inside) if isinstance(inside, dict) else {}
        if isinstance(part, int):
            field += f"[{part}]"
            listed = cast("list[Any]", inside) if isinstance(inside, list | tuple) else []
            # One that is missing has no value.
            inside = listed[part] if part < len(listed) else None
        elif part in keys or (missing and at == len(path) - 1):
            field += f".{part}" if field else part
            inside = keys.get(part)
    return field
