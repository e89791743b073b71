"""Write docs/schema/answers.json, the JSON schema of answers, from `blocksim.report.schema`."""

from __future__ import annotations

import json
import types
from dataclasses import is_dataclass
from inspect import getdoc
from pathlib import Path
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints, is_typeddict

from blocksim.report.schema import BracketRecord, CasesRecord, CheckRecord, CrossingRecord

PLACE = Path(__file__).resolve().parent / "schema" / "answers.json"
PLAIN = {
    str: "string",
    int: "integer",
    float: "number",
    bool: "boolean",
    types.NoneType: "null",
}


def schema() -> dict[str, Any]:
    """Return the schema: an answer is a check, cases, a bracket, or that of a vehicle."""
    found: dict[str, Any] = {}
    kinds = (CheckRecord, CasesRecord, BracketRecord, CrossingRecord)
    answers = [_of(each, found) for each in kinds]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "What blocksim check --json and blocksim bracket --json print",
        "anyOf": answers,
        "$defs": dict(sorted(found.items())),
    }


def _of(hint: Any, found: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of a type; those of its records are put among those found."""
    if is_typeddict(hint) or is_dataclass(hint):
        name = hint.__name__.removesuffix("Record")
        if name not in found:
            found[name] = {}
            keys, said = get_type_hints(hint), getdoc(hint) or ""
            if is_dataclass(hint):
                said = said.partition("\n\n")[0]
            found[name] = {
                "description": " ".join(said.split()),
                "type": "object",
                "properties": {key: _of(each, found) for key, each in keys.items()},
                "required": list(keys),
                "additionalProperties": False,
            }
        return {"$ref": f"#/$defs/{name}"}
    origin, parts = get_origin(hint), get_args(hint)
    if origin in {Union, types.UnionType}:
        return {"anyOf": [_of(each, found) for each in parts]}
    if origin is Literal:
        return {"enum": list(parts)}
    if origin in {list, tuple}:
        return {"type": "array", "items": _of(parts[0], found)}
    return {"type": "object"} if origin is dict else {"type": PLAIN[hint]}


def text() -> str:
    """Return the schema as the file has it."""
    return json.dumps(schema(), indent=1) + "\n"


if __name__ == "__main__":
    PLACE.write_text(text(), encoding="utf-8")
