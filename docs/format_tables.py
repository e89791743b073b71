"""Tables of what files may say, made from the classes that check them."""

from __future__ import annotations

import math
import re
from inspect import cleandoc
from typing import Any

from markdown_table import table
from pydantic import TypeAdapter

from blocksim.blocks.entries import Around, StructureFile
from blocksim.sweeps.design import How
from blocksim.sweeps.load import DesignFile


def of_format(which: str) -> str:
    """Tables of the keys of a file: one of its top, one for each table inside it."""
    schemas = {"structure": StructureFile, "design": DesignFile}
    schema = TypeAdapter(schemas[which]).json_schema()
    parts = {"": schema, **{_word(name): part for name, part in schema["$defs"].items()}}
    tables = [
        (f"**{name}**: {_sentence(part)}\n\n" if name else "") + _keys(part)
        for name, part in parts.items()
        if "properties" in part
    ]
    return "\n\n".join(tables)


def _word(name: str) -> str:
    """Say `BlockEntry` as block."""
    return re.sub(r"(Entry|Table)$", "", name).lower()


def _sentence(part: dict[str, Any]) -> str:
    return " ".join(part.get("description", "").partition("\n")[0].split())


def _keys(part: dict[str, Any]) -> str:
    required = part.get("required", [])
    said = _described(part)
    rows = [
        [
            f"`{name}`",
            _kind(each).replace("|", "\\|"),
            "must be given" if name in required else _default(each.get("default")),
            said[name].replace("|", "\\|"),
        ]
        for name, each in part["properties"].items()
    ]
    return table(["key", "may be", "if left out", "what it is"], rows)


def _described(part: dict[str, Any]) -> dict[str, str]:
    """Return what a docstring says of each key, bases included: `key`, `other`: What it is."""
    text = part.get("description", "")
    base = {"StructureFile": Around, "DesignFile": How}.get(part.get("title", ""))
    if base is not None:
        text += "\n" + cleandoc(base.__doc__ or "")
    said = dict[str, str]()
    for names, first, rest in re.findall(
        r"^((?:`\w+`(?:, )?)+): ([^\n]*\n?)((?:    [^\n]*\n?)*)", text, flags=re.MULTILINE
    ):
        for name in re.findall(r"\w+", names):
            said[name] = " ".join(f"{first} {rest}".split())
    return said


def _default(value: Any) -> str:
    if value is None or value in ([], {}, ""):
        return "-"
    if isinstance(value, dict) and "values" in value:
        return ", ".join(f"`{each:g}`" for each in value["values"])
    if isinstance(value, dict):
        return "as its own keys say"
    if isinstance(value, list):
        return ", ".join(f"`{each}`" for each in value)
    return "`true`" if value is True else "`false`" if value is False else f"`{value}`"


def _kind(part: dict[str, Any], *, many: bool = False) -> str:
    """Say what a key may be: `many` after "list of"."""
    if "$ref" in part:
        name = _word(part["$ref"].rpartition("/")[2])
        return f"{name} tables" if many else "axis" if name == "axis" else f"table {name}"
    options = [each for each in part.get("anyOf", []) if each.get("type") != "null"]
    if options:
        return ", or ".join(_kind(each, many=many) for each in options)
    if "const" in part or "enum" in part:
        return " or ".join(f"`{each}`" for each in part.get("enum", [part.get("const")]))
    match part.get("type"):
        case "boolean":
            return "true or false"
        case "string":
            return "texts" if many else "text"
        case "array":
            return _list(part, many=many)
        case "integer" | "number":
            return _number(part, many=many)
    return "anything"


def _list(part: dict[str, Any], *, many: bool) -> str:
    fixed = part.get("prefixItems")
    if fixed and fixed[0].get("type") == "number":
        return "points" if many else "point `[x, y]`"
    if fixed:
        return f"{len(fixed)} of: {_kind(fixed[0])}"
    low, high = part.get("minItems"), part.get("maxItems", math.inf)
    size = f"{low} to {high} " if low and high <= 3 else f"{low} or more " if low else ""
    return ("lists" if many else "list") + f" of {size}{_kind(part['items'], many=True)}"


def _number(part: dict[str, Any], *, many: bool) -> str:
    noun = "whole number" if part["type"] == "integer" else "number"
    noun += "s" if many else ""
    above, below = part.get("exclusiveMinimum"), part.get("exclusiveMaximum")
    low, high = part.get("minimum"), part.get("maximum")
    after = None if high is None else math.nextafter(high, math.inf)
    if below is None and after is not None and after.is_integer() and high != round(high):
        # The last number below a round one.
        below = after
    said = list[str]()
    if above is not None:
        said.append(f"above {above:g}")
    elif low is not None and abs(low) < 1e9:
        said.append(f"{low:g} or more")
    if below is not None:
        said.append(f"below {below:g}")
    elif high is not None and abs(high) < 1e9:
        said.append(f"at most {high:g}")
    return noun + (", " + ", ".join(said) if said else "")
