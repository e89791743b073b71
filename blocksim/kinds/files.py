"""Structure files, JSON or TOML: blocks, or a kind and its parameters; and files of others.

Those are drawings (DXF, SVG) and assemblies of compas (JSON): `blocksim.reading` makes of each
what a structure file says.

Lengths in m, forces in N, angles in degrees, y upwards. The keys besides blocks are those of
`blocks.entries.Around`, with blocks those of `StructureFile`.
"""

from __future__ import annotations

import os
import re
from collections.abc import Generator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, cast

from blocksim.blocks import structure
from blocksim.blocks.entries import AROUND, Around
from blocksim.blocks.kindtable import kind_of
from blocksim.blocks.maker import Kind, Maker
from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.common.errors import InputError, perhaps
from blocksim.common.files import AnyPath, json_of, read_file, shipped_files, toml_of
from blocksim.common.tables import as_said
from blocksim.kinds import KINDS
from blocksim.kinds.archfile import as_structure
from blocksim.kinds.changes import edited
from blocksim.reading.asked import Reading
from blocksim.reading.compas import is_compas, read_compas
from blocksim.reading.drawing import Drawing
from blocksim.reading.dxf import read_dxf
from blocksim.reading.scenes import is_scene, read_scene
from blocksim.reading.svg import read_svg

if TYPE_CHECKING:
    from blocksim.blocks.space.files import SpatialAround
    from blocksim.blocks.space.maker import SolidMaker

LARGEST_FILES = {".json": 20_000_000, ".toml": 1_000_000}
"""Bytes; a larger file is not read: TOML takes a second for each of these."""
WRITTEN = {".json": "JSON", ".toml": "TOML"}
DRAWN = {".dxf": read_dxf, ".svg": read_svg}
"""Endings of drawings, and who reads them."""
MESHES = (".obj", ".stl", ".ply", ".glb")
"""Endings of meshes, of blocks in space."""
OTHERS = (*DRAWN, *MESHES)
AS_DRAWN = Reading()
"""A drawing says its unit, and has the layers `blocks` and `supports`."""


def shipped_structures() -> dict[str, Path]:
    """Structures that come with blocksim, by name."""
    return shipped_files("structures/*.toml")


def is_drawing(path: Path | str) -> bool:
    """Tell a drawing, or a mesh, by its ending: neither says friction."""
    return Path(path).suffix.lower() in OTHERS


def load_structure(
    path: AnyPath,
    changes: Mapping[str, object] = MappingProxyType({}),
    density: float | None = None,
    *,
    friction: float | None = None,
    tolerance: float | None = None,
    depth: float | None = None,
    reading: Reading = AS_DRAWN,
) -> Problem[Any]:
    """Read a structure file, a drawing, a mesh or an assembly of compas.

    Parameters
    ----------
    path : str or path
        Ends in .json, .toml, .dxf, .svg, .obj, .stl, .ply or .glb; or the name of a shipped
        one.
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
        Unit and layers of a drawing or mesh.

    Raises
    ------
    InputError
        In one line: file, entry, value, and what would be accepted.

    Examples
    --------
    >>> load_structure("oppenheim_7")
    Problem("Oppenheim's arch of seven voussoirs, pushed sideways", 7 blocks, 8 joints, mu=inf)
    """
    from blocksim.blocks.space.files import is_spatial

    with named_file(path, reading) as said:
        planar = depth is None or not is_spatial(said)
        require(planar, "depth", depth, "left out: it is of blocks in the plane")
        edits: dict[str, Any] = {"friction": friction, "tolerance": tolerance, "depth": depth}
        return structure_of(edited(said, changes, density, **edits))


@contextmanager
def named_file(
    path: AnyPath, reading: Reading = AS_DRAWN, drawing: Drawing | None = None
) -> Generator[object]:
    """Give what a structure file says; what is wrong with it is said with the file's name.

    `path`: As of `load_structure`.
    `reading`: Unit and layers of a drawing.
    `drawing`: What `drawing_of` read of it, where that was asked for before.
    """
    # As it was given: a name that ends in a slash is no file.
    path, near = os.fspath(path), ""
    ending = Path(path).suffix.lower()
    if ending not in WRITTEN and ending not in OTHERS:
        known = shipped_structures()
        near = perhaps(path, [*known, *KINDS])
        path = str(known.get(path, path))
        ending = Path(path).suffix
    endings = ".json, .toml, .dxf, .svg, .obj, .stl, .ply or .glb"
    allowed = f"an existing structure file, {endings}, or a shipped structure"
    allowed += f" (blocksim scenarios lists them){near}"
    require(ending in WRITTEN or ending in OTHERS, "structure", str(path), allowed)
    text = b""
    if ending in WRITTEN:
        require_undrawn(reading)
        text = read_file(path, "structure", allowed, LARGEST_FILES[ending])
    data: object = None
    try:
        if ending in DRAWN:
            data = (drawing or drawing_of(path, reading)).structure()
        elif ending in MESHES:
            from blocksim.reading.meshes import read_mesh

            data = read_mesh(path, reading)
        else:
            data = written(text, WRITTEN[ending])
        yield data
    except InputError as error:
        field = _by_name(error.field, data)
        raise InputError(field, error.value, error.allowed, where=path) from None
    except (ValueError, RecursionError) as error:
        # Not what it is named, no UTF-8, numbers beyond all bounds, or nested too deeply.
        said = " ".join(str(error).split())
        raise InputError("file", said, f"valid {ending[1:].upper()}", where=path) from None


def drawing_of(path: AnyPath, reading: Reading = AS_DRAWN) -> Drawing:
    """Read a drawing: its shapes, and what of it is refused."""
    try:
        return DRAWN[Path(path).suffix.lower()](path, reading)
    except InputError as error:
        where = os.fspath(path)
        raise InputError(error.field, error.value, error.allowed, where=where) from None


def require_undrawn(reading: Reading) -> None:
    """Refuse what is said of a drawing where there is none."""
    named = ", ".join(reading.layers) or None
    given = {"unit": reading.unit, "layer": named, "snap": reading.snap, "up": reading.up}
    for name, value in given.items():
        of = "meshes" if name == "up" else "drawings"
        require(value is None, name, value, f"left out: it is of {of}")


def written(text: bytes, language: str) -> object:
    """Return what a text says, a scene or an assembly of compas as a structure file would."""
    if language == "TOML":
        return as_structure(toml_of(text))
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


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Refuse a key that stands twice in a table of JSON."""
    table: dict[str, Any] = {}
    for key, value in pairs:
        require(key not in table, key, "given twice", "given once in a table")
        table[key] = value
    return table


def structure_of(data: object, *own: type[Kind[Any]]) -> Problem[Any]:
    """Make a problem of what a structure file says, of the plane or in space.

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

    Examples
    --------
    >>> floor = {"id": 0, "fixed": True, "vertices": [[-2, -1], [2, -1], [2, 0], [-2, 0]]}
    >>> box = {"id": 1, "vertices": [[0, 0], [1, 0], [1, 1], [0, 1]]}
    >>> structure_of({"friction": 0.5, "blocks": [floor, box]})
    Problem(1 blocks, 1 joints, mu=0.5)
    >>> structure_of({"kind": "column", "drums": 3, "friction": 1})
    Problem('column', 3 blocks, 3 joints, mu=1)
    """
    if not isinstance(data, dict) or "kind" not in data:
        from blocksim.blocks.space.files import is_spatial, problem_in_space

        said = cast("object", data)
        return problem_in_space(said) if is_spatial(said) else structure.structure_of(said)
    table = cast("dict[str, Any]", data)
    # Of a tower it is how many.
    listed = isinstance(table.get("blocks"), list)
    require(not listed, "kind", table["kind"], "left out beside blocks")
    kinds = {**KINDS, **{each.name: each for each in own}} if own else KINDS
    around = around_said(table, kinds)
    said = {key: table[key] for key in table if key not in AROUND}
    forces = {"friction": around.friction, "density": around.density}
    made = kind_of(said, kinds, forces=forces)
    if isinstance(made, Maker):
        return problem_of(made, cast("Around", around))
    from blocksim.blocks.space.files import problem_of_solids

    solid = cast("SolidMaker", made)
    found = problem_of_solids(cast("SpatialAround", around), solid.named, solid.built.assembly)
    return replace(found, title=found.title or made.name, maker=made)


def around_said(
    table: Mapping[str, Any], kinds: Mapping[str, type[Kind[Any]]] = KINDS
) -> Around | SpatialAround:
    """Return what a structure file says besides its blocks, of the plane or in space."""
    from blocksim.blocks.space.files import AROUND as OF_SPACE
    from blocksim.blocks.space.files import SpatialAround, is_spatial

    around = {key: table[key] for key in table if key in AROUND}
    named = table.get("kind")
    kind = kinds[named] if isinstance(named, str) and named in kinds else None
    if not (is_spatial(table) if kind is None else kind.in_space):
        return as_said(Around, around)
    for name in around.keys() - set(OF_SPACE):
        about = "blocks lie" if kind is None else f"a {kind.name} is"
        raise InputError(name, around[name], f"left out: {about} in space")
    return as_said(SpatialAround, around)


def problem_of(kind: Maker, around: Around) -> Problem:
    """Ask about a kind of structure.

    `around`: Friction, loads and the like.
    Returns: Dead loads begin with the weight of fill.
    """
    built = kind.built if around.size is None else kind.built_of(around.size)
    bodies = built.bodies
    if not bodies and (around.dead or around.live):
        # An arch of radius 1 is built of no bodies, but loads tell which of them they are on.
        bodies = kind.made(kind.unit_weight).bodies
    problem = structure.problem_of(around, bodies, built.assembly, built.notes)
    return replace(
        problem,
        dead=(*built.fills, *problem.dead),
        title=problem.title or kind.name,
        maker=kind,
        # Kinds weigh their blocks, whatever the unit weight.
        weighed=around.density is not None,
    )
