"""Assemblies of compas_assembly, compas_cra and compas_dem as JSON.

Their blocks are meshes in space, z upwards. Planar are those that are prisms along one
horizontal direction, about one plane: what is read is their section, and their depth. Others
are blocks in space.
"""

from __future__ import annotations

import math
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.outlines import counter_clockwise
from blocksim.blocks.polygons import MOST_BLOCKS
from blocksim.blocks.shapes import MOST_CORNERS
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.reading.meshes import convex_block, fans, require_near

STRAIGHT = 1e-4
"""How far a face may be turned from along or across the plane [rad]: files have 7 digits."""
LEVEL = 1e-5
"""How far ends of prisms may be from their level, in units of the size of the assembly."""
MOST_DIRECTIONS = 64
"""Directions of faces that are tried."""

Array = NDArray[np.float64]
Table = Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class _Mesh:
    """A block in space: corners (k, 3), and faces as rows of them."""

    name: str
    points: Array
    faces: tuple[NDArray[np.int64], ...]
    normals: Array
    fixed: bool


def is_compas(data: object) -> bool:
    """Tell an assembly of compas from a structure file."""
    if not isinstance(data, dict):
        return False
    table = cast("dict[str, object]", data)
    if isinstance(table.get("blocks"), dict) and isinstance(table.get("assembly"), dict):
        return True
    return str(table.get("dtype", "")).startswith("compas") or "graph" in table


def read_compas(data: Table) -> dict[str, Any]:
    """Read an assembly: in the plane where it is planar, else in space.

    `data`: What the JSON file says.
    Returns: As of a structure file, without friction. Blocks have the names of their nodes.
    """
    with _told("file", "an assembly of compas_assembly or compas_cra: a graph of blocks"):
        nodes = list(islice(_nodes(data), MOST_BLOCKS + 1))
    meshes: list[_Mesh] = []
    for name, block, fixed in nodes:
        with _told(f"block {name}", "a mesh: corners with x, y and z, and faces of them"):
            meshes.append(_mesh(name, _inside(block), fixed))
    require(0 < len(meshes) <= MOST_BLOCKS, "blocks", len(meshes), f"1 to {MOST_BLOCKS}")
    depthwise = _direction(meshes)
    if depthwise is None:
        return {
            "notes": ["assembly of compas in space, m: blocks are hulls of their corners"],
            "blocks": [
                convex_block(each.name, each.points, fans(each.faces), fixed=each.fixed)
                for each in meshes
            ],
        }
    # To the right: the direction of the plane that points more to the larger x, or y.
    across = np.cross(depthwise, [0.0, 0.0, 1.0])
    across *= math.copysign(1.0, across[int(np.abs(across).argmax())])
    blocks = [_section(mesh, depthwise, across) for mesh in meshes]
    way = ", ".join(f"{each:.6g}" for each in depthwise + 0.0)
    return {
        "notes": [f"section of an assembly of compas, m, across ({way})"],
        "blocks": blocks,
    }


@contextmanager
def _told(field: str, allowed: str) -> Generator[None]:
    """Refuse tables of another shape in words."""
    try:
        yield
    except InputError:
        raise
    except KeyError as error:
        raise InputError(field, f"no {error}", allowed) from None
    except ValueError as error:
        raise InputError(field, str(error), allowed) from None
    except (TypeError, AttributeError):
        raise InputError(field, "tables of another shape", allowed) from None


def _is_held(name: str, table: Table) -> bool:
    """Tell whether a block is a support, which is yes or no, or is left out."""
    said = table.get("is_support")
    require(said in {True, False, None}, f"block {name}: is_support", said, "true or false")
    return bool(said)


def _inside(value: object) -> Table:
    """Return a table without the wrapping that says its type."""
    table = cast("dict[str, Any]", value)
    while isinstance(inner := table.get("data", table.get("value")), dict) and "dtype" in table:
        table = cast("dict[str, Any]", inner)
    return table


def _nodes(data: Table) -> Iterator[tuple[str, object, bool]]:
    """Name, mesh and support of each block, in either of two layouts."""
    if isinstance(data.get("blocks"), dict):
        graph = data["assembly"]
        places = graph["vertex"] if "vertex" in graph else graph["node"]
        for name, block in data["blocks"].items():
            yield str(name), block, _is_held(name, places[name])
        return
    top = _inside(data)
    if isinstance(top.get("elements"), dict):  # compas_dem: by guid, each placed where it is
        for at, each in enumerate(top["elements"].values()):
            element = _inside(each)
            moved = element.get("transformation")
            require(moved is None, f"block {at}", "transformed", "of geometry where it stands")
            yield str(at), element["geometry"], _is_held(str(at), element)
        return
    graph = _inside(top.get("graph", top))
    for name, node in graph["node"].items():
        yield str(name), node["block"], _is_held(name, node)


def _mesh(name: str, block: Table, fixed: bool) -> _Mesh:
    index = {str(key): at for at, key in enumerate(block["vertex"])}
    points = np.array(
        [[float(each[axis]) for axis in "xyz"] for each in block["vertex"].values()]
    ).reshape(-1, 3)
    field = f"block {name}"
    require_near(points, field)
    found = tuple(
        np.array([index[str(key)] for key in _listed(row)], dtype=np.int64)
        for row in _listed(block["face"])
    )
    total = sum(len(face) for face in found)
    ok = len(points) <= MOST_CORNERS and 0 < total <= 10 * MOST_CORNERS
    require(ok, field, f"{len(points)} corners", f"1 to {MOST_CORNERS}, with faces")
    # Areas as vectors across the faces, by Newell.
    areas = [
        np.cross(points[each], points[np.roll(each, -1)]).sum(axis=0) / 2 for each in found
    ]
    return _Mesh(name, points, found, np.array(areas), fixed)


def _listed(rows: Any) -> list[Any]:
    """Return the rows of a table or a list: compas writes either."""
    return list(cast("Table", rows).values()) if isinstance(rows, dict) else list(rows)


def _unit(normals: Array) -> Array:
    """Directions of faces; those without an area have none."""
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    kept = length[:, 0] > 1e-12 * max(float(length.max()), 1e-300)
    return normals[kept] / length[kept]


def _direction(meshes: Sequence[_Mesh]) -> Array | None:
    """Find the horizontal direction along which all blocks are prisms about one plane.

    Of several the one that leaves the widest section; None where there is none.
    """
    moving = [mesh for mesh in meshes if not mesh.fixed] or list(meshes)
    points = np.concatenate([mesh.points for mesh in moving])
    size = float(np.ptp(points, axis=0).max())
    found: list[tuple[float, float, Array]] = []
    for way in _ways(moving[0]):
        middles = [_levels(mesh, way).mean() for mesh in moving]
        behind = max(middles) - min(middles) > LEVEL * size
        if behind or not all(_is_prism(mesh, way, size) for mesh in meshes):
            continue
        wide = float(np.ptp(points @ np.cross(way, [0.0, 0.0, 1.0])))
        found.append((wide, abs(float(way[1])), way))
    if not found:
        return None
    widest = max(wide for wide, *_ in found)
    return max((f for f in found if f[0] > widest - LEVEL * size), key=lambda f: f[1])[2]


def _ways(mesh: _Mesh) -> Iterator[Array]:
    """Horizontal directions across faces of a block, each once."""
    ways: list[Array] = []
    for way in _unit(mesh.normals):
        if abs(way[2]) > STRAIGHT or any(abs(way @ each) > 1 - STRAIGHT**2 for each in ways):
            continue
        flat = np.array([way[0], way[1], 0.0])
        # Faces nearly along an axis are along it: files have 7 digits.
        flat[np.abs(flat) < STRAIGHT] = 0.0
        ways.append(flat / np.linalg.norm(flat))
    yield from ways[:MOST_DIRECTIONS]


def _levels(mesh: _Mesh, way: Array) -> Array:
    along = mesh.points @ way
    return np.array([along.min(), along.max()])


def _is_prism(mesh: _Mesh, way: Array, size: float) -> bool:
    """Tell whether all faces are along or across a direction, all corners at its ends."""
    turned = np.abs(_unit(mesh.normals) @ way)
    low, high = _levels(mesh, way)
    along = mesh.points @ way
    skew = (turned > STRAIGHT) & (turned < 1 - STRAIGHT)
    between = np.minimum(along - low, high - along) > LEVEL * size
    return not skew.any() and not between.any() and bool(_ends(mesh, way))


def _ends(mesh: _Mesh, way: Array) -> list[NDArray[np.int64]]:
    """Faces of the far end of a prism."""
    low, high = _levels(mesh, way)
    along = mesh.points @ way
    middle = (low + high) / 2
    return [
        face
        for face, normal in zip(mesh.faces, mesh.normals, strict=True)
        if high > low
        and (along[face] > middle).all()
        and np.linalg.norm(normal) > 0
        and abs(normal @ way) > (1 - STRAIGHT) * np.linalg.norm(normal)
    ]


def _section(mesh: _Mesh, way: Array, across: Array) -> dict[str, Any]:
    flat = np.stack([mesh.points @ across, mesh.points[:, 2]], axis=1)
    low, high = _levels(mesh, way)
    return {
        "id": mesh.name,
        "polygons": [counter_clockwise(flat[face]).tolist() for face in _ends(mesh, way)],
        "depth": float(high - low),
        **({"fixed": True} if mesh.fixed else {}),
    }
