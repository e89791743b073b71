"""Structure files, JSON or TOML: blocks, or a kind and its parameters; and files of others.

Those are drawings (DXF, SVG) and assemblies of compas (JSON): `blocksim.reading` makes of each
what a structure file says.

Lengths in m, forces in N, angles in degrees, y upwards. The keys besides blocks are those of
`blocks.entries.Around`, with blocks those of `StructureFile`.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Generator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, cast

from blocksim.blocks import structure
from blocksim.blocks.entries import AROUND, Around, around_of
from blocksim.blocks.maker import Maker, kind_of
from blocksim.blocks.problem import Problem
from blocksim.common.checks import LENGTH, require
from blocksim.common.errors import InputError, perhaps
from blocksim.common.fields import fields_of
from blocksim.common.files import AnyPath, json_of, read_file, shipped_files, toml_of
from blocksim.kinds import KINDS
from blocksim.reading.compas import is_compas, read_compas
from blocksim.reading.drawing import Reading
from blocksim.reading.dxf import read_dxf
from blocksim.reading.scenes import is_scene, read_scene
from blocksim.reading.svg import read_svg

if TYPE_CHECKING:
    from blocksim.blocks.space.problem import SpatialProblem

LARGEST_FILES = {".json": 20_000_000, ".toml": 1_000_000}
"""Bytes; a larger file is not read: TOML takes a second for each of these."""
WRITTEN = {".json": "JSON", ".toml": "TOML"}
IN_PLANE = (
    "x and y: in space there are check, bracket, films and stills by render, and load_in_space"
)
"""What is accepted where blocks have to lie in the plane."""
DRAWN = {".dxf": read_dxf, ".svg": read_svg}
"""Endings of drawings, and who reads them."""
AS_DRAWN = Reading()
"""A drawing says its unit, and has the layers `blocks` and `supports`."""


def shipped_structures() -> dict[str, Path]:
    """Structures that come with blocksim, by name."""
    return shipped_files("structures/*.toml")


def is_drawing(path: Path | str) -> bool:
    """Tell a drawing by its ending."""
    return Path(path).suffix.lower() in DRAWN


def load_structure(
    path: AnyPath,
    changes: Mapping[str, object] = MappingProxyType({}),
    density: float | None = None,
    *,
    friction: float | None = None,
    tolerance: float | None = None,
    depth: float | None = None,
    reading: Reading = AS_DRAWN,
) -> Problem:
    """Read a structure file, a drawing or an assembly of compas.

    Parameters
    ----------
    path : str or path
        Ends in .json, .toml, .dxf or .svg, or the name of a shipped one.
    changes : mapping of str to object
        Parameters of its kind that replace those in the file; `arch.thickness` is one of its
        arch.
    density : float, optional
        Weight per volume instead of what it says [N/m^3].
    friction : float, optional
        Friction coefficient where the file has none; a drawing never has one. inf allowed.
    tolerance : float, optional
        Gaps and overlaps up to this are closed [m], instead of what the file says.
    depth : float, optional
        Length out of the plane of blocks that have none of their own [m], instead of 1.
    reading : Reading
        Unit and layers of a drawing.

    Raises
    ------
    InputError
        In one line: file, entry, value, and what would be accepted.
    """
    found = load_any(path, changes, density, friction=friction, tolerance=tolerance,
                     depth=depth, reading=reading)  # fmt: skip
    if not isinstance(found, Problem):
        raise InputError("blocks", "three coordinates", IN_PLANE, where=os.fspath(path))
    return found


def load_in_space(
    path: AnyPath,
    density: float | None = None,
    *,
    friction: float | None = None,
    tolerance: float | None = None,
) -> SpatialProblem:
    """Read a structure file in space: its corners have three coordinates.

    Parameters
    ----------
    path, density, friction, tolerance
        As of `load_structure`.

    Raises
    ------
    InputError
        In one line: file, entry, value, and what would be accepted.
    """
    found = load_any(path, {}, density, friction=friction, tolerance=tolerance)
    if isinstance(found, Problem):
        allowed = "blocks with three coordinates: load_structure reads plane ones"
        raise InputError("blocks", "in the plane", allowed, where=os.fspath(path))
    return found


def load_any(
    path: AnyPath,
    changes: Mapping[str, object] = MappingProxyType({}),
    density: float | None = None,
    *,
    friction: float | None = None,
    tolerance: float | None = None,
    depth: float | None = None,
    reading: Reading = AS_DRAWN,
) -> Problem | SpatialProblem:
    """Read a structure file, which says by its corners whether it lies in the plane.

    Parameters
    ----------
    path, changes, density, friction, tolerance, depth, reading
        As of `load_structure`.

    Raises
    ------
    InputError
        In one line: file, entry, value, and what would be accepted.
    """
    from blocksim.blocks.space.files import is_spatial

    with named_file(path, reading) as said:
        data = said if friction is None else with_friction(said, friction)
        data = data if tolerance is None else within(data, tolerance)
        table: object = changed(data, changes) if changes else data
        table = table if density is None else weighed(table, density)
        if depth is not None:
            spatial = is_spatial(table)
            require(not spatial, "depth", depth, "left out: it is of blocks in the plane")
            table = deepened(table, depth)
        return any_of(table)


def any_of(data: object) -> Problem | SpatialProblem:
    """Make a problem of what a structure file says, in the plane or in space."""
    from blocksim.blocks.space.files import is_spatial, problem_in_space

    return problem_in_space(data) if is_spatial(data) else structure_of(data)


def with_friction(data: object, friction: float) -> object:
    """Return what a file says, with a friction if it says none."""
    if not isinstance(data, dict):
        return data
    table = cast("dict[str, Any]", data)
    return {"friction": "inf" if friction == math.inf else friction, **table}


def within(data: object, tolerance: float) -> object:
    """Return what a file says, with gaps and overlaps closed up to a distance [m]."""
    require(0 <= tolerance <= LENGTH.high, "tolerance", tolerance, f"0 to {LENGTH.high:g} m")
    if not isinstance(data, dict):
        return data
    table = cast("dict[str, Any]", data)
    allowed = "left out: it is for blocks, and this is a kind"
    require("kind" not in table, "tolerance", tolerance, allowed)
    return {**table, "tolerance": tolerance}


@contextmanager
def named_file(path: AnyPath, reading: Reading = AS_DRAWN) -> Generator[object]:
    """Give what a structure file says; what is wrong with it is said with the file's name.

    Parameters
    ----------
    path : Path or str
        As of `load_structure`.
    reading : Reading
        Unit and layers of a drawing.

    Raises
    ------
    InputError
        In one line, also what is raised while it is used.
    """
    # As it was given: a name that ends in a slash is no file.
    path, near = os.fspath(path), ""
    ending = Path(path).suffix.lower()
    if ending not in WRITTEN and ending not in DRAWN:
        known = shipped_structures()
        near = "" if path in known else perhaps(path, known)
        path = str(known.get(path, path))
        ending = Path(path).suffix
    endings = ".json, .toml, .dxf or .svg"
    allowed = f"an existing structure file, {endings}, or a shipped structure{near}"
    require(ending in WRITTEN or ending in DRAWN, "structure", str(path), allowed)
    text = b""
    if ending in WRITTEN:
        require_undrawn(reading)
        text = read_file(path, "structure", allowed, LARGEST_FILES[ending])
    data: object = None
    try:
        drawn = DRAWN.get(ending)
        data = drawn(path, reading).structure() if drawn else written(text, WRITTEN[ending])
        yield data
    except InputError as error:
        field = _by_name(error.field, data)
        raise InputError(field, error.value, error.allowed, where=path) from None
    except (ValueError, RecursionError) as error:
        # Not JSON or TOML, no UTF-8, numbers beyond all bounds, or nested too deeply.
        said = " ".join(str(error).split())
        raise InputError("file", said, f"valid {WRITTEN[ending]}", where=path) from None


def require_undrawn(reading: Reading) -> None:
    """Refuse what is said of a drawing where there is none."""
    require(reading.unit is None, "unit", reading.unit, "left out: it is of drawings")
    named = ", ".join(reading.layers)
    require(not named, "layer", named, "left out: it is of drawings")
    require(reading.snap is None, "snap", reading.snap, "left out: it is of drawings")


def written(text: bytes, language: str) -> object:
    """Return what a text says, a scene or an assembly of compas as a structure file would.

    Raises
    ------
    InputError, ValueError, RecursionError
        If it is not of that language, JSON or TOML, or says what cannot be.
    """
    if language == "TOML":
        return toml_of(text)
    data: object = json_of(text, _once)
    if is_scene(data):
        return read_scene(cast("dict[str, Any]", data))
    return read_compas(cast("dict[str, Any]", data)) if is_compas(data) else data


def _by_name(field: str, data: object) -> str:
    """Say which block of another's file is meant, where nobody has numbered them."""
    found = re.match(r"blocks\[(\d+)\]", field)
    table = cast("dict[str, Any]", data) if isinstance(data, dict) else {}
    if found is None or "notes" not in table:
        return field
    with suppress(IndexError, KeyError, TypeError):
        return f"block {table['blocks'][int(found[1])]['id']}{field[found.end() :]}"
    return field


def changed(data: object, changes: Mapping[str, object]) -> dict[str, Any]:
    """Return the table of a kind with other parameters.

    Raises
    ------
    InputError
        If it is of no kind.
    """
    kind = data.get("kind") if isinstance(data, dict) else None  # pyright: ignore
    table = {**cast("dict[str, Any]", data)}
    for name, value in changes.items():
        require(kind is not None, name, value, "left out: the file has blocks, not a kind")
        here, _, rest = name.partition(".")
        inside = table.get(here)
        nested = bool(rest) and isinstance(inside, Mapping | None)
        table[here] = {**(inside or {}), rest: value} if nested else value
    return table


def weighed(data: object, density: float) -> object:
    """Return what a structure file says with another weight per volume [N/m^3].

    Raises
    ------
    InputError
        If a block has a weight of its own.
    """
    if not isinstance(data, dict):
        return data
    table = cast("dict[str, Any]", data)
    blocks: Any = table.get("blocks")
    for at, block in enumerate(cast("list[Any]", blocks) if isinstance(blocks, list) else ()):
        own: Any = (
            cast("dict[str, Any]", block).get("weight") if isinstance(block, dict) else None
        )
        allowed = "left out where a unit weight is given: it is of this block alone"
        require(own is None, f"blocks[{at}].weight", own, allowed)
    return {**table, "density": density}


def deepened(data: object, depth: float, *own: type[Maker]) -> object:
    """Return what a structure file says, its blocks so long out of the plane [m].

    Raises
    ------
    InputError
        If a block has a depth of its own, or a kind none that could be another.
    """
    if not isinstance(data, dict):
        return data
    table = cast("dict[str, Any]", data)
    if "kind" in table:
        kinds = {each.name: each for each in (*ALL, *own)}
        kind = kinds.get(str(table["kind"]))
        # What is wrong with its name is said where it is made.
        known = {"depth"} if kind is None else fields_of(kind)
        inside = "depth" if "depth" in known else "arch.depth" if "arch" in known else None
        require(inside is not None, "depth", depth, "left out: its blocks have theirs")
        return changed(table, {inside or "": depth})
    blocks: Any = table.get("blocks")
    made: list[Any] = []
    for at, block in enumerate(cast("list[Any]", blocks) if isinstance(blocks, list) else ()):
        said = cast("dict[str, Any]", block) if isinstance(block, dict) else None
        if said is not None:
            allowed = "left out where --depth is given: it is of this block alone"
            require("depth" not in said, f"blocks[{at}].depth", said.get("depth"), allowed)
        made.append(block if said is None else {**said, "depth": depth})
    return {**table, "blocks": made}


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Refuse a key that stands twice in a table of JSON."""
    table: dict[str, Any] = {}
    for key, value in pairs:
        require(key not in table, key, "given twice", "given once in a table")
        table[key] = value
    return table


def structure_of(data: object, *own: type[Maker]) -> Problem:
    """Make a problem of what a structure file says.

    Parameters
    ----------
    data : object
        A dict: with `blocks`, or with `kind` and its parameters, and the keys of `Around`.
    *own : type
        Kinds of one's own.

    Raises
    ------
    InputError
        In one line: the first entry that is wrong, its value, and what would be accepted.
    """
    if not isinstance(data, dict) or "kind" not in data:
        from blocksim.blocks.space.files import is_spatial

        plane = not is_spatial(cast("object", data))
        require(plane, "blocks", "three coordinates", IN_PLANE)
        return structure.structure_of(cast("object", data))
    table = cast("dict[str, Any]", data)
    require("blocks" not in table, "kind", table["kind"], "left out beside blocks")
    around = around_of({key: table[key] for key in table if key in AROUND})
    said = {key: table[key] for key in table if key not in AROUND}
    forces = {"friction": around.friction, "density": around.density}
    return problem_of(kind_of(said, (*ALL, *own), forces=forces), around)


ALL = tuple(KINDS.values())


def problem_of(kind: Maker, around: Around) -> Problem:
    """Ask about a kind of structure.

    Parameters
    ----------
    kind : Maker
    around : Around
        Friction, loads and the like.

    Returns
    -------
    Problem
        Dead loads begin with the weight of fill.
    """
    built = kind.built if around.size is None else kind.built_of(around.size)
    problem = structure.problem_of(around, built.bodies, built.assembly, built.notes)
    return replace(
        problem,
        dead=(*built.fills, *problem.dead),
        title=problem.title or kind.name,
        maker=kind,
        # Kinds weigh their blocks, whatever the unit weight.
        weighed=around.density is not None,
    )
