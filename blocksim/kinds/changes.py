"""What a structure file says, with other parameters, friction, weight, depth or gaps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, cast

from blocksim.blocks.maker import Kind
from blocksim.common.checks import LENGTH, endless_text, require
from blocksim.common.fields import fields_of
from blocksim.kinds import KINDS


def edited(
    data: object,
    changes: Mapping[str, object] = MappingProxyType({}),
    density: float | None = None,
    *own: type[Kind[Any]],
    friction: float | None = None,
    tolerance: float | None = None,
    depth: float | None = None,
) -> object:
    """Return what a file says with all that is said beside it, as of `load_structure`."""
    said = data if friction is None else with_friction(data, friction)
    if not isinstance(said, dict):
        return said
    table = cast("dict[str, Any]", said)
    if tolerance is not None:
        allowed = f"0 to {LENGTH.high:g} m"
        require(0 <= tolerance <= LENGTH.high, "tolerance", tolerance, allowed)
        allowed = "left out: it is for blocks, and this is a kind"
        require("kind" not in table, "tolerance", tolerance, allowed)
        table = {**table, "tolerance": tolerance}
    table = changed(table, changes)
    if density is not None:
        for at, block in _blocks(table):
            own_weight: Any = block.get("weight")
            allowed = "left out where a unit weight is given: it is of this block alone"
            require(own_weight is None, f"blocks[{at}].weight", own_weight, allowed)
        table = {**table, "density": density}
    return table if depth is None else deepened(table, depth, *own)


def changed(table: Mapping[str, Any], changes: Mapping[str, object]) -> dict[str, Any]:
    """Return what a file says with another friction, or the table of a kind with others."""
    kind = KINDS.get(str(table.get("kind")))
    table = {**table} if kind is None else kind.beside(table, changes)
    for name, value in changes.items():
        there = "kind" in table or name == "friction"
        require(there, name, value, "left out: the file has blocks, not a kind")
        here, _, rest = name.partition(".")
        inside = table.get(here)
        nested = bool(rest) and isinstance(inside, Mapping | None)
        table[here] = {**(inside or {}), rest: value} if nested else value
    return table


def with_friction(data: object, friction: float) -> object:
    """Return what a file says, with a friction if it says none."""
    if not isinstance(data, dict):
        return data
    table = cast("dict[str, Any]", data)
    return {"friction": endless_text(friction), **table}


def deepened(table: dict[str, Any], depth: float, *own: type[Kind[Any]]) -> dict[str, Any]:
    """Return what a structure file says, its blocks so long out of the plane [m].

    `own`: Kinds of one's own.
    """
    if "kind" in table:
        kinds = {each.name: each for each in (*KINDS.values(), *own)}
        kind = kinds.get(str(table["kind"]))
        # What is wrong with its name is said where it is made.
        known = {"depth"} if kind is None else fields_of(kind)
        inside = "depth" if "depth" in known else "arch.depth" if "arch" in known else None
        require(inside is not None, "depth", depth, "left out: its blocks have theirs")
        return changed(table, {inside or "": depth})
    made = list(_listed(table))
    for at, block in _blocks(table):
        allowed = "left out where --depth is given: it is of this block alone"
        require("depth" not in block, f"blocks[{at}].depth", block.get("depth"), allowed)
        made[at] = {**block, "depth": depth}
    return {**table, "blocks": made}


def _listed(table: Mapping[str, Any]) -> list[Any]:
    """Return the blocks of a structure file, whatever they are."""
    blocks: Any = table.get("blocks")
    return cast("list[Any]", blocks) if isinstance(blocks, list) else []


def _blocks(table: Mapping[str, Any]) -> Iterator[tuple[int, dict[str, Any]]]:
    """Go through the blocks of a structure file that are tables, each with its place."""
    for at, block in enumerate(_listed(table)):
        if isinstance(block, dict):
            yield at, cast("dict[str, Any]", block)
