"""Tables of what files may say, made from the classes that check them."""

from __future__ import annotations

import math
import re
from inspect import cleandoc
from typing import Any

from markdown_table import table
from pydantic import TypeAdapter

from blocksim.blocks.entries import Around, StructureFile
from blocksim.common.fields import Field
from blocksim.engines.base import Settings
from blocksim.simulation.simulated import SETTINGS
from blocksim.sweeps.case import ACTING
from blocksim.sweeps.design import How
from blocksim.sweeps.load import COMMON


def of_format(which: str) -> str:
    """Tables of the keys of a file: one of its top, one for each table inside it."""
    schema = TypeAdapter({"structure": StructureFile, "design": How}[which]).json_schema()
    parts = {"": schema, **{_word(name): part for name, part in schema["$defs"].items()}}
    tables = [
        (f"**{name}**: {_sentence(part)}\n\n" if name else "") + _keys(part)
        for name, part in parts.items()
        if "properties" in part
    ]
    return "\n\n".join([*tables, *_of_designs()] if which == "design" else tables)


def _of_designs() -> list[str]:
    """Tables of the axes that designs of any kind may have, and of their settings."""
    about = {"mu": Field(about="friction coefficient; inf allowed"), **ACTING}
    axes = [[f"`{name}`", f"{each.about}{_unit(name)}"] for name, each in about.items()]
    common = [[f"`{name}`", "what all structures have in common"] for name in COMMON]
    kind = ["`kind`", "of structure; `circular-arch` if left out"]
    said = cleandoc(Settings.__doc__ or "")
    settings = [
        [f"`{name}`", " ".join(found[1].split())]
        for name in SETTINGS
        if (found := re.search(rf"^{name} : .*\n((?:    .*\n?)+)", said, flags=re.MULTILINE))
    ]
    return [
        "**axes**, besides one for each parameter of the kind; `mu` must be given.\n\n"
        + table(["key", "what it is"], [*axes, kind, *common]),
        "**settings**: of engines, instead of what their rules say; each is an axis. Lengths "
        "are in units of the size, times of sqrt(size/g).\n\n"
        + table(["key", "what it is"], settings),
    ]


def _unit(name: str) -> str:
    """Say the unit that ends a name."""
    end = name.rpartition("_")[2]
    return f" [{end}]" if end in {"deg", "g", "s"} else ""


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
    base = {"StructureFile": Around}.get(part.get("title", ""))
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
        case "object":
            return "table"
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
