"""A kind of structure, as a table of a file says it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, cast

from blocksim.blocks.maker import Kind, Table
from blocksim.common.checks import require
from blocksim.common.errors import InputError, perhaps
from blocksim.common.fields import fields_of


def kind_of(
    written: Mapping[str, Any],
    kinds: Mapping[str, type[Kind[Any]]],
    path: str = "",
    forces: Mapping[str, float | None] = MappingProxyType({}),
) -> Kind[Any]:
    """Read a kind from a table.

    `written`: `kind`, and parameters.
    `kinds`: Those there are, by name.
    `path`: What leads to the table, for messages: `arch.`.
    `forces`: Friction and density, which stand beside the parameters.
    """
    named = written.get("kind")
    allowed = f"one of {', '.join(kinds)}"
    if not isinstance(named, str) or named not in kinds:
        near = perhaps(named, kinds) if isinstance(named, str) else ""
        raise InputError(f"{path}kind", named, allowed + near)
    chosen = kinds[named]
    given = {key: value for key, value in written.items() if key != "kind"}
    return cast("Kind[Any]", _table_of(chosen, given, kinds, path, f"a {named} has", forces))


def _table_of(
    chosen: type[Table],
    written: Mapping[str, Any],
    kinds: Mapping[str, type[Kind[Any]]],
    path: str,
    has: str,
    forces: Mapping[str, float | None] = MappingProxyType({}),
) -> Table:
    parameters = fields_of(chosen)
    given: dict[str, Any] = {}
    for key, value in written.items():
        known = parameters.get(key)
        if known is None:
            raise InputError(f"{path}{key}", value, f"left out: {has} {', '.join(parameters)}")
        where = f"{path}{key}"
        given[key] = value
        if known.nested == "table":
            require(isinstance(value, Mapping), where, value, known.allowed)
            arches = {name: each for name, each in kinds.items() if each.is_arch}
            usual = {"kind": getattr(chosen, key).name}
            table = {**usual, **cast("Mapping[str, Any]", value)}
            given[key] = kind_of(table, arches, f"{where}.")
        elif known.nested == "tables":
            require(isinstance(value, list | tuple), where, value, known.allowed)
            row = cast("type[Kind[Any]]", chosen).row_types[key]
            tables: list[Table] = []
            for at, each in enumerate(cast("Sequence[Any]", value)):
                require(isinstance(each, Mapping), f"{where}[{at}]", each, "a table")
                each = cast("Mapping[str, Any]", each)
                tables.append(_table_of(row, each, kinds, f"{where}[{at}].", "it has"))
            given[key] = tuple(tables)
    try:
        return chosen(**given, **forces)
    except InputError as error:
        raise InputError(f"{path}{error.field}", error.value, error.allowed) from None
