"""A glTF 2.0 document as it grows: meshes, materials, one animation."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Sequence
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.common.version import __version__
from blocksim.view.canvas import colour, stone_tones
from blocksim.view.style import INK

TONES = 8
"""Number of tones of stone, by which neighbours differ a little."""
_FLOAT, _WHOLE, _LINES = 5126, 5125, 1
_VERTICES, _INDICES = 34962, 34963
_MAGIC, _JSON, _BINARY = 0x46546C67, 0x4E4F534A, 0x004E4942


Ring = tuple[Array, Array]
"""Corners of a face, counter-clockwise, and its normal."""


class Solid(NamedTuple):
    """Corners, their normals, triangles of them, and ends of the edges that are drawn."""

    corners: NDArray[np.float32]
    normals: NDArray[np.float32]
    triangles: NDArray[np.uint32]
    edges: NDArray[np.float32]


def mesh_of(faces: Sequence[Ring], edges: Array | None = None) -> Solid:
    """Make a mesh of convex faces, and of ends of the edges that are drawn, (2 k, 3)."""
    triangles: list[NDArray[np.intp]] = []
    count = 0
    for ring, _ in faces:
        later = np.arange(1, len(ring) - 1)
        triangles.append(count + np.stack([np.zeros_like(later), later, later + 1], axis=1))
        count += len(ring)
    normals = [np.broadcast_to(normal, ring.shape) for ring, normal in faces]
    return Solid(
        np.concatenate([ring for ring, _ in faces]).astype(np.float32),
        np.concatenate(normals).astype(np.float32),
        np.concatenate(triangles).ravel().astype(np.uint32),
        (np.empty((0, 3)) if edges is None else edges).astype(np.float32),
    )


class Document:
    """A glTF document as it grows: JSON, and the numbers to which it points."""

    def __init__(self, blocks: int) -> None:
        self.nodes: list[dict[str, Any]] = []
        self.meshes: list[dict[str, Any]] = []
        self.materials: list[dict[str, Any]] = []
        self.animation: dict[str, Any] = {"samplers": [], "channels": []}
        self.extras: dict[str, Any] = {}
        self._accessors: list[dict[str, Any]] = []
        self._views: list[dict[str, Any]] = []
        self._numbers = bytearray()
        self.ink = self.material("edges", colour(INK))
        tones = enumerate(stone_tones(min(TONES, blocks)))
        # Those of the blocks, which take turns.
        self.stones = [self.material(f"stone {at}", tone) for at, tone in tones]

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

    def move(self, node: int, times: int, path: str, values: NDArray[Any]) -> None:
        """Move a node along, from one time to the next evenly."""
        samplers = self.animation["samplers"]
        samplers.append(
            {
                "input": times,
                "output": self.add(values.astype(np.float32)),
                "interpolation": "LINEAR",
            }
        )
        target = {"node": node, "path": path}
        channel = {"sampler": len(samplers) - 1, "target": target}
        self.animation["channels"].append(channel)

    def json(self, uri: str | None = None) -> bytes:
        """Return the JSON part. The buffer is at `uri`, or follows where there is none."""
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

    def write(self, file: BinaryIO, kind: str) -> None:
        """Write it as .glb or .gltf."""
        file.write(self.glb() if kind == "glb" else self.gltf())

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


def _linear(tone: Any) -> list[float]:
    """Linear light of a colour as it is shown: sRGB, IEC 61966-2-1."""
    shown = np.array(tone[:3], dtype=float)
    return np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4).tolist()
