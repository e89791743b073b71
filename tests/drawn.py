"""Structures drawn as others draw them: DXF by ezdxf, SVG, assemblies of compas."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
from images import turning

Polygon = Sequence[Sequence[float]]


def square(x: float, y: float, wide: float = 1.0, tall: float = 1.0) -> list[list[float]]:
    return [[x, y], [x + wide, y], [x + wide, y + tall], [x, y + tall]]


def box(name: str, left: float, low: float, right: float, high: float) -> dict:
    """A rectangular block of a structure file."""
    return {"id": name, "vertices": square(left, low, right - left, high - low)}


GROUND: Polygon = [(-1.0, -1.0), (7.0, -1.0), (7.0, 0.0), (-1.0, 0.0)]


def wall(courses: int = 8, bricks: int = 5) -> list[Polygon]:
    """Draw a wall in running bond: corners lie on the edges of the courses below and above."""
    high, wide = 0.3, 1.2
    found: list[Polygon] = []
    for course in range(courses):
        left = 0.0 if course % 2 == 0 else wide / 2
        low, top = course * high, (course + 1) * high
        for brick in range(bricks):
            a, b = left + brick * wide, left + (brick + 1) * wide
            found.append([(a, low), (b, low), (b, top), (a, top)])
    return found


def bricks(courses: int, count: int, long: float = 0.25, high: float = 0.125) -> list[Polygon]:
    """Draw a bed, and a wall on it in running bond: one brick less in every second course."""
    laid = [
        square((k + course % 2 / 2) * long, course * high, long, high)
        for course in range(courses)
        for k in range(count - course % 2)
    ]
    return [square(-count * long, -high, 3 * count * long, high), *laid]


def rounded(
    polygons: Sequence[Polygon], degrees: float, decimals: int, mu: float = 0.6, **more: object
) -> dict[str, Any]:
    """Return a structure file of polygons turned by an angle, its coordinates rounded."""
    turned = [np.asarray(each) @ turning(np.radians(degrees)).T for each in polygons]
    blocks = [
        {"id": at, "vertices": each.round(decimals).tolist(), "fixed": at == 0}
        for at, each in enumerate(turned)
    ]
    return {"friction": mu, "blocks": blocks, **more}


def structure(blocks: Sequence[Polygon], friction: float = 0.7) -> dict:
    """Return the same as a structure file."""
    ground = {"id": "ground", "vertices": GROUND, "fixed": True}
    rest = [{"id": f"b{at}", "vertices": each} for at, each in enumerate(blocks)]
    return {"friction": friction, "blocks": [ground, *rest]}


def new_dxf(unit: int = 6, version: str = "R2010") -> ezdxf.document.Drawing:
    document = ezdxf.new(version, units=unit)
    for layer in ("blocks", "supports", "notes"):
        document.layers.add(layer)
    return document


def on_ground(unit: int = 6) -> tuple[Any, Any]:
    """Return a drawing with the ground on its layer of supports, and where to draw on."""
    document: Any = new_dxf(unit)
    space = document.modelspace()
    space.add_lwpolyline(GROUND, close=True, dxfattribs={"layer": "supports"})
    return document, space


def write_dxf(
    path: Path,
    blocks: Sequence[Polygon],
    *,
    scale: float = 1.0,
    unit: int = 6,
    version: str = "R2010",
) -> Path:
    """Draw closed polylines, every second one clockwise, every third closed by repetition."""
    document = new_dxf(unit, version)
    space = document.modelspace()
    add = space.add_polyline2d if version == "R12" else space.add_lwpolyline
    for at, polygon in enumerate([GROUND, *blocks]):
        points = [(x * scale, y * scale) for x, y in polygon][:: -1 if at % 2 else 1]
        repeated = at % 3 == 0
        layer = {"layer": "blocks" if at else "Supports"}
        add(points + points[:1] * repeated, close=not repeated, dxfattribs=layer)
    document.saveas(path)
    return path


def svg_of(body: str, head: str = "") -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{body}</svg>'


def compas_of(blocks: Sequence[Polygon], supports: Sequence[int], depth: float = 0.5) -> dict:
    """Draw prisms along y as meshes, as compas_assembly 0.5 writes them."""
    nodes = {}
    for at, polygon in enumerate(blocks):
        n = len(polygon)
        points = [(x, y, z) for y in (0.0, depth) for x, z in polygon]
        sides = [[k, (k + 1) % n, n + (k + 1) % n, n + k] for k in range(n)]
        faces = [list(range(n)), list(range(2 * n - 1, n - 1, -1)), *sides]
        mesh = {
            "vertex": {str(k): dict(zip("xyz", p, strict=True)) for k, p in enumerate(points)},
            "face": {str(k): face for k, face in enumerate(faces)},
        }
        node = {"block": {"dtype": "compas_assembly.datastructures/Block", "data": mesh}}
        nodes[str(at)] = node | ({"is_support": True} if at in supports else {})
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": nodes, "edge": {}}}
    data = {"attributes": {"name": "Assembly"}, "graph": graph}
    return {"dtype": "compas_assembly.datastructures/Assembly", "data": data}


def written(path: Path, content: object) -> Path:
    if isinstance(content, bytes):
        path.write_bytes(content)
    else:
        path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path
