"""A recording as glTF 2.0: blocks in space with their motion, for browsers and Blender.

Lengths are in metres, y upwards, z towards the viewer, times in seconds; an arch of which no
radius was given has r = 1 m. A block is a node with a mesh of its convex pieces, moved by one
animation; supports and the ground stay.
"""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Sequence
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.outlines import following
from blocksim.blocks.problem import STANDARD_GRAVITY
from blocksim.common.version import __version__
from blocksim.common.words import printable
from blocksim.simulation.recording import Recording
from blocksim.view.canvas import colour, stone_tones
from blocksim.view.placing import centres_at, quaternions
from blocksim.view.stage import Stage
from blocksim.view.style import GROUND, INK, PAPER

TONES = 8
"""Of stone: neighbours differ a little."""
AROUND = 0.5
"""How far the ground reaches beyond what is seen, in units of its extent."""
_FLOAT, _WHOLE, _LINES = 5126, 5125, 1
_VERTICES, _INDICES = 34962, 34963
_MAGIC, _JSON, _BINARY = 0x46546C67, 0x4E4F534A, 0x004E4942


class Solid(NamedTuple):
    """Corners, their normals, triangles of them, and ends of the edges that are drawn."""

    corners: NDArray[np.float32]
    normals: NDArray[np.float32]
    triangles: NDArray[np.uint32]
    edges: NDArray[np.float32]


def write_gltf(recording: Recording, file: BinaryIO, kind: str) -> None:
    """Write a recording as one file.

    Parameters
    ----------
    recording : Recording
    file : BinaryIO
    kind : {"glb", "gltf"}
        Binary, or JSON with the numbers in it as base64.
    """
    made = Document()
    _add_scene(made, recording)
    file.write(made.glb() if kind == "glb" else made.gltf())


class Document:
    """What is written, as it grows: JSON, and the numbers it points to."""

    def __init__(self) -> None:
        self.nodes: list[dict[str, Any]] = []
        self.meshes: list[dict[str, Any]] = []
        self.materials: list[dict[str, Any]] = []
        self.animation: dict[str, Any] = {"samplers": [], "channels": []}
        self.extras: dict[str, Any] = {}
        self._accessors: list[dict[str, Any]] = []
        self._views: list[dict[str, Any]] = []
        self._numbers = bytearray()
        self.ink = self.material("edges", colour(INK))

    def add(self, values: NDArray[Any], target: int | None = None) -> int:
        """Put numbers into the buffer, each row of them one element."""
        data = np.ascontiguousarray(values).tobytes()
        view: dict[str, Any] = {
            "buffer": 0,
            "byteOffset": len(self._numbers),
            "byteLength": len(data),
        }
        self._views.append(view if target is None else view | {"target": target})
        self._numbers += data
        kind = "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}"
        rows = values.reshape(len(values), -1)
        self._accessors.append(
            {
                "bufferView": len(self._views) - 1,
                "componentType": _FLOAT if values.dtype == np.float32 else _WHOLE,
                "count": len(values),
                "type": kind,
                "min": rows.min(axis=0).tolist(),
                "max": rows.max(axis=0).tolist(),
            }
        )
        return len(self._accessors) - 1

    def solid(
        self,
        name: str,
        solid: Solid,
        material: int,
        marks: Sequence[tuple[Solid, int]] = (),
        **placed: object,
    ) -> int:
        """Add a node with a mesh of its own, and of what is painted on it."""
        parts: list[dict[str, Any]] = []
        for each, look in ((solid, material), *marks):
            attributes = {
                "POSITION": self.add(each.corners, _VERTICES),
                "NORMAL": self.add(each.normals, _VERTICES),
            }
            indices = self.add(each.triangles, _INDICES)
            parts.append({"attributes": attributes, "indices": indices, "material": look})
        if len(solid.edges):
            ends = {"POSITION": self.add(solid.edges, _VERTICES)}
            parts.append({"attributes": ends, "mode": _LINES, "material": self.ink})
        self.meshes.append({"name": name, "primitives": parts})
        self.nodes.append({"name": name, "mesh": len(self.meshes) - 1, **placed})
        return len(self.nodes) - 1

    def material(self, name: str, tone: Any) -> int:
        """Add a dull material of a colour of the house."""
        factor = [*_linear(tone), 1.0]
        look = {"baseColorFactor": factor, "metallicFactor": 0.0, "roughnessFactor": 0.9}
        self.materials.append({"name": name, "pbrMetallicRoughness": look})
        return len(self.materials) - 1

    def move(self, node: int, times: int, path: str, values: NDArray[np.float32]) -> None:
        """Move a node along, from one time to the next evenly."""
        samplers = self.animation["samplers"]
        samplers.append({"input": times, "output": self.add(values), "interpolation": "LINEAR"})
        target = {"node": node, "path": path}
        channel = {"sampler": len(samplers) - 1, "target": target}
        self.animation["channels"].append(channel)

    def json(self, uri: str | None = None) -> bytes:
        """Return the JSON part; the buffer is at `uri`, or follows."""
        buffer: dict[str, Any] = {"byteLength": len(self._numbers)}
        document = {
            "asset": {"version": "2.0", "generator": f"blocksim {__version__}"},
            "extras": self.extras,
            "scene": 0,
            "scenes": [{"nodes": list(range(len(self.nodes)))}],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": self.materials,
            "animations": [self.animation],
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [buffer if uri is None else buffer | {"uri": uri}],
        }
        return json.dumps(document, allow_nan=False, separators=(",", ":")).encode()

    def gltf(self) -> bytes:
        """Return one JSON text."""
        numbers = base64.b64encode(self._numbers).decode()
        return self.json(f"data:application/octet-stream;base64,{numbers}")

    def glb(self) -> bytes:
        """Return both parts, each a multiple of four bytes long."""
        text = self.json()
        text += b" " * (-len(text) % 4)
        numbers = bytes(self._numbers)  # of numbers of four bytes
        length = 12 + 8 + len(text) + 8 + len(numbers)
        return b"".join(
            (
                struct.pack("<III", _MAGIC, 2, length),
                struct.pack("<II", len(text), _JSON),
                text,
                struct.pack("<II", len(numbers), _BINARY),
                numbers,
            )
        )


def _add_scene(made: Document, recording: Recording) -> None:
    assembly, size = recording.assembly, recording.assembly.size
    made.extras = {
        "title": printable(recording.problem.title),
        "engine": printable(f"{recording.engine} {recording.engine_version}"),
        "state_hash": recording.state_hash,
        "gravity_g": recording.problem.gravity.tolist(),
    }
    stage = Stage(recording)
    tones = stone_tones(min(TONES, len(assembly.blocks)))
    stones = [made.material(f"stone {at}", tone) for at, tone in enumerate(tones)]
    base = made.material("support", colour(GROUND))
    seconds = recording.seconds(STANDARD_GRAVITY).astype(np.float32)
    # Frames nearer to each other than their times can be told apart are left out.
    latest = np.maximum.accumulate(seconds)
    frames = np.flatnonzero(np.diff(latest, prepend=np.float32(-1.0)) > 0)
    times = made.add(seconds[frames])
    turns = quaternions(recording)[frames][..., [1, 2, 3, 0]].astype(np.float32)
    places = np.array([centres_at(recording, int(at)) for at in frames]) * size
    places = places.astype(np.float32)
    for at, block in enumerate(assembly.blocks):
        pieces = [part - block.centre for part in block.polygons]
        node = made.solid(
            printable(block.name) or f"block {at}",
            _solid(pieces, block.depth),
            stones[at % len(stones)],
            translation=places[0, at].tolist(),
            rotation=turns[0, at].tolist(),
        )
        made.move(node, times, "translation", places[:, at])
        made.move(node, times, "rotation", turns[:, at])
    for at, footing in enumerate(stage.footings):
        made.solid(f"support {at}", _solid([footing * size], stage.depth * size), base)
    made.solid("ground", _ground(stage, size), made.material("ground", colour(PAPER)))
    made.animation["name"] = printable(recording.engine)


def _linear(tone: Any) -> list[float]:
    """Linear light of a colour as it is shown: sRGB, IEC 61966-2-1."""
    shown = np.array(tone[:3], dtype=float)
    return np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4).tolist()


def _solid(pieces: list[Array], depth: float) -> Solid:
    """Return prisms of convex outlines, counter-clockwise, about the plane z = 0.

    Faces between two of them are left out.
    """
    corners: list[Array] = []
    normals: list[Array] = []
    triangles: list[NDArray[np.intp]] = []
    edges: list[Array] = []
    count = 0

    def face(ring: Array, normal: Array) -> None:
        nonlocal count
        corners.append(ring)
        normals.append(np.broadcast_to(normal, ring.shape))
        later = np.arange(1, len(ring) - 1)
        fan = np.stack([np.zeros_like(later), later, later + 1], axis=1)
        triangles.append(fan + count)
        count += len(ring)

    sides = {
        (*start, *end)
        for piece in pieces
        for start, end in zip(piece.tolist(), following(piece).tolist(), strict=True)
    }
    for piece in pieces:
        near = np.pad(piece, ((0, 0), (0, 1)), constant_values=depth / 2)
        far = near * [1.0, 1.0, -1.0]
        face(near, np.array([0.0, 0.0, 1.0]))
        face(far[::-1], np.array([0.0, 0.0, -1.0]))
        for at in range(len(piece)):
            to = (at + 1) % len(piece)
            along = piece[to] - piece[at]
            inside = (*piece[to].tolist(), *piece[at].tolist()) in sides
            if inside or not along.any():
                continue
            out = np.array([along[1], -along[0], 0.0]) / np.hypot(*along)
            face(np.array([near[at], far[at], far[to], near[to]]), out)
            edges += [near[at], near[to], far[at], far[to], near[at], far[at]]
    return Solid(
        np.concatenate(corners).astype(np.float32),
        np.concatenate(normals).astype(np.float32),
        np.concatenate(triangles).ravel().astype(np.uint32),
        np.array(edges, dtype=np.float32),
    )


def _ground(stage: Stage, size: float) -> Solid:
    """Return the ground as a rectangle that reaches beyond what is seen."""
    low, high = stage.swept.min(axis=0), stage.swept.max(axis=0)
    beyond = AROUND * float((high - low).max())
    (left, _, back), (right, _, front) = low - beyond, high + beyond
    level = stage.ground
    ring = [(left, front), (right, front), (right, back), (left, back)]
    corners = np.array([(x, level, z) for x, z in ring]) * size
    up = np.tile(np.array([0.0, 1.0, 0.0]), (4, 1))
    return Solid(
        corners.astype(np.float32),
        up.astype(np.float32),
        np.array([0, 1, 2, 0, 2, 3], dtype=np.uint32),
        np.empty((0, 3), dtype=np.float32),
    )
