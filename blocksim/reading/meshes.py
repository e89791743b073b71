"""Meshes as OBJ, STL, PLY and GLB: each closed body is a block; the one place with trimesh."""

from __future__ import annotations

import io
import logging
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.bodies import connected
from blocksim.blocks.space.polyhedron import Polyhedron
from blocksim.common.checks import COORDINATE, require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.files import AnyPath, read_file
from blocksim.common.later import require_library
from blocksim.reading.asked import UNITS, Reading, Unit

LARGEST_MESH = 20_000_000
"""Bytes; a larger file is not read."""
MOST_FACETS = 200_000
"""Of a file; drawn shapes of blocks need a few dozen each."""
MOST_CORNERS = 1000
"""Of a block."""
DENT = 1e-3
"""How far a facet may lie within the hull, over the length of its block."""
DIGITS = 6
"""Of the largest coordinate: what single precision keeps."""
QUIET = logging.NullHandler()
"""Errors are said in one line here, not by the library."""

Array = NDArray[np.float64]
Facets = NDArray[np.int64]


def read_mesh(path: AnyPath, reading: Reading) -> dict[str, Any]:
    """Read a mesh of closed bodies; what has y upwards, as GLB has, is turned.

    `path`: Ends in .obj, .stl, .ply or .glb.
    `reading`: Its unit, where the file says none, and what points upwards; names of objects as
        layers. An object of the name `supports`, or one that is named for it, stays where it
        is.
    Returns: As of a structure file in space, without friction.
    """
    ending = Path(path).suffix.lower()[1:]
    content = read_file(path, "mesh", f"an existing .{ending} file", LARGEST_MESH)
    unit = reading.unit_of(Unit(metres=1.0, said="glTF is in m") if ending == "glb" else None)
    if unit is None:
        raise InputError(
            "--unit", MISSING, f"given, one of {', '.join(UNITS)}: a mesh has none"
        )
    require(reading.snap is None, "snap", reading.snap, "left out: it is of drawings")
    up = reading.up or ("y" if ending == "glb" else "z")
    blocks: list[dict[str, Any]] = []
    seen: set[str] = set()
    for name, points, facets in _objects(content, ending):
        kind = re.sub(r"[._ -]*\d+$", "", name).casefold()
        seen |= {name, kind}
        role = reading.roles.get(name.casefold(), reading.roles.get(kind))
        corners = points[:, [0, 2, 1]] * [1, -1, 1] if up == "y" else points
        bodies = list(_bodies(facets))
        for at, body in enumerate(bodies):
            several = len(bodies) > 1 or not name
            own = f"{name}.{at + 1}".lstrip(".") if several else name
            seen.add(own)
            mine = reading.roles.get(own.casefold(), role)
            if mine == "ignored":
                continue
            found = convex_block(own, corners, body, fixed=mine == "supports")
            found["vertices"] = (np.array(found["vertices"]) * unit.metres).round(12).tolist()
            blocks.append(found)
    reading.require_layers(seen)
    return {"notes": [f"mesh, its {up} upwards; {unit.said}"], "blocks": blocks}


def convex_block(name: str, points: Array, facets: Facets, *, fixed: bool) -> dict[str, Any]:
    """Return a closed body as an entry of `blocks`: the hull of its corners.

    Facets may be turned inwards: what is closed and lies on the hull everywhere is the hull.
    """
    field, used = f"block {name}", np.unique(facets)
    own = points[used]
    pairs = np.sort(facets[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, times = np.unique(pairs, axis=0, return_counts=True)
    loose = int((times % 2 * (edges[:, 0] != edges[:, 1])).sum())
    require(loose == 0, field, f"open at {loose} edges", "a closed surface")
    corners = len(used)
    require(corners <= MOST_CORNERS, field, f"{corners} corners", f"at most {MOST_CORNERS}")
    require_near(own, field)
    try:
        hull = Polyhedron(own)
    except InputError as error:
        raise InputError(field, error.value, error.allowed) from None
    normals = np.array([face.normal for face in hull.faces])
    offsets = np.array([face.offset for face in hull.faces])
    off = np.abs(points[facets] @ normals.T - offsets).max(axis=1).min(axis=1)
    dent = float(off.max()) / float(np.ptp(own, axis=0).max())
    way = "convex; one that is not consists of convex ones (polyhedra in a structure file)"
    require(dent <= DENT, field, f"dented by {dent:.2g} of its length", way)
    return {"id": name, "vertices": own.tolist(), "fixed": fixed}


def require_near(points: Array, field: str) -> None:
    """Refuse corners of a block that are not finite, or too far from the origin."""
    far, high = float(np.abs(points).max(initial=0.0)), COORDINATE.high
    require(far <= high, field, f"a coordinate of {far:.12g}", f"within {high:g} of the origin")


def _objects(content: bytes, ending: str) -> Iterator[tuple[str, Array, Facets]]:
    """Give name, corners and facets of each object of a file, where it is placed."""
    require_library("trimesh", "meshes", "mesh")
    import trimesh

    logging.getLogger("trimesh").addHandler(QUIET)
    logging.getLogger("trimesh").propagate = False
    options: dict[str, Any] = {"process": False}
    if ending == "obj":
        backwards = re.search(rb"(?m)^f\s(?:.*\s)?-\d.*$", content)
        said = "" if backwards is None else backwards[0].decode(errors="replace").strip()
        require(not said, "mesh", said, "corners of facets counted from the first")
        # Without objects groups are told apart.
        objects = re.search(rb"(?m)^o\s", content) is not None
        options |= {"split_objects": objects, "split_groups": not objects}
        options |= {"group_material": False, "skip_materials": True}
    try:
        library = cast("Any", trimesh)
        # Numbers beyond all bounds are told below.
        with np.errstate(all="ignore"):
            scene: Any = library.load_scene(io.BytesIO(content), file_type=ending, **options)
            dumped: list[Any] = scene.dump()
        # Points and lines are no bodies.
        solid = [each for each in dumped if hasattr(each, "faces")]
        # The library gives objects in no order of their own.
        meshes = sorted(solid, key=_name_of)
        total = sum(len(mesh.faces) for mesh in meshes)
        # Files without objects have no names: their bodies are numbered.
        named = ending in {"obj", "glb"}
        names = [_name_of(mesh) if named else "" for mesh in meshes]
    except Exception as error:  # a damaged file makes the library raise almost anything
        said = " ".join(f"{type(error).__name__}: {error}".split())[:200]
        if isinstance(error, ImportError):
            # The library asks for another one where bytes are no text it knows.
            said = "bytes that are no text"
        raise InputError("file", said, f"a mesh as .{ending}") from None
    require(0 < total <= MOST_FACETS, "mesh", f"{total} facets", f"1 to {MOST_FACETS}")
    points = np.concatenate([np.asarray(mesh.vertices, dtype=np.float64) for mesh in meshes])
    require(bool(np.isfinite(points).all()), "mesh", "nan or inf", "finite coordinates")
    with np.errstate(over="ignore"):
        single = np.array_equal(points, points.astype(np.float32))
    if single:
        # Single precision: as drawn, where rounding explains how they differ.
        largest = float(np.abs(points).max()) or 1.0
        points = points.round(DIGITS - int(np.ceil(np.log10(largest))))
    ends = np.cumsum([len(mesh.vertices) for mesh in meshes])[:-1]
    for at, (mesh, each) in enumerate(zip(meshes, np.split(points, ends), strict=True)):
        own, place = np.unique(each, axis=0, return_inverse=True)
        for corner in (int(mesh.faces.min(initial=0)), int(mesh.faces.max(initial=0))):
            known = 0 <= corner < max(1, len(each))
            require(known, "mesh", f"corner {corner} of a facet", f"0 to {len(each) - 1}")
        name, before = names[at], names[:at].count(names[at])
        # The library parts both triangles of a four-sided face: all first ones, all second.
        facets = np.concatenate(_connected(mesh.faces))
        yield f"{name}-{before + 1}" if before else name, own, place.ravel()[facets]


def _name_of(mesh: Any) -> str:
    """Return the name of an object, or of its mesh: those without one have a number here."""
    node = str(mesh.metadata.get("node", ""))
    return str(mesh.metadata["name"]) if node.isdigit() or not node else node


def _bodies(facets: Facets) -> Iterator[Facets]:
    """Give the facets of each closed body, and last those that are left over.

    A body's facets follow each other, as programs write them: so bodies that touch at corners
    are told apart.
    """
    open_edges: set[tuple[int, int]] = set()
    start = 0
    for at, (a, b, c) in enumerate(cast("list[list[int]]", facets.tolist())):
        edges = {
            (min(pair), max(pair)) for pair in ((a, b), (b, c), (c, a)) if pair[0] != pair[1]
        }
        open_edges ^= edges
        if open_edges:
            continue
        run = facets[start : at + 1]
        start = at + 1
        yield from _connected(run)
    if open_edges:
        yield facets[start:]


def _connected(facets: Facets) -> list[Facets]:
    """Return facets that share corners together, those of the first facet first."""
    # Numbered among these corners: a file of many bodies has many more.
    used, place = np.unique(facets, return_inverse=True)
    own = place.reshape(facets.shape)
    pairs = np.concatenate([own[:, :2], own[:, 1:]])
    label = connected(len(used), *pairs.T)[own[:, 0]]
    _, first, group = np.unique(label, return_index=True, return_inverse=True)
    begin = first[group]
    order = np.argsort(begin, kind="stable")
    return np.split(facets[order], np.flatnonzero(np.diff(begin[order])) + 1)


def fans(faces: Sequence[NDArray[np.int64]]) -> Facets:
    """Return polygons as facets of three corners each, (k, 3)."""
    parts = [
        np.stack([np.full(len(face) - 2, face[0]), face[1:-1], face[2:]], axis=1)
        for face in faces
        if len(face) > 2
    ]
    return np.concatenate(parts) if parts else np.empty((0, 3), dtype=np.int64)
