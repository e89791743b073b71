"""Blocks in space as glTF 2.0: a recording, or a mechanism that comes and goes.

As of the plane (`blocksim.view.gltf`): metres and seconds, y upwards, one node a block. What
joints do as a collapse begins is painted on their faces.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, BinaryIO

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import STANDARD_GRAVITY
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.common.words import printable
from blocksim.simulation.space import SpatialRecording
from blocksim.view.canvas import colour, stone_tones
from blocksim.view.gltf import TONES, Document, Solid
from blocksim.view.solidjoints import marks_of
from blocksim.view.solidscene import Marks, moving_box, supports_of
from blocksim.view.style import GROUND

if TYPE_CHECKING:
    from blocksim.ask.check import Check

UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""From z upwards to y upwards."""
WAY, GOES, FRAMES = 0.15, 2.0, 24
"""Largest way of a mechanism [size], how long it goes on [s], and frames of that."""
OFF = 1e-3
"""How far what joints do is painted off their faces [size]."""
Ring = tuple[Array, Array]
"""Corners of a face, counter-clockwise, and its normal."""


def write_recording(recording: SpatialRecording, file: BinaryIO, kind: str) -> None:
    """Write a recording as one file, .glb or .gltf."""
    size = recording.problem.assembly.size
    seconds = recording.times * math.sqrt(size / STANDARD_GRAVITY)
    made = _document(recording.problem, seconds, recording.poses, {})
    made.extras |= {
        "engine": printable(f"{recording.engine} {recording.engine_version}"),
        "state_hash": recording.state_hash,
    }
    file.write(made.glb() if kind == "glb" else made.gltf())


def mechanism_model(answer: Check[SpatialProblem]) -> bytes:
    """Return how blocks begin to fall and come back, as .glb; still where they stand."""
    problem, rates = answer.problem, answer.mechanism
    assembly = problem.assembly
    still = np.zeros((len(assembly.blocks), 3))
    rest = np.concatenate([assembly.centres / assembly.size, still], axis=1)
    shares = (1 - np.cos(np.linspace(0.0, 2 * math.pi, FRAMES + 1))) / 2
    moved = WAY * (np.zeros_like(rest) if rates is None else rates)
    poses = rest + shares[:, None, None] * moved
    times = np.linspace(0.0, GOES, FRAMES + 1)
    return _document(
        problem, times, poses, marks_of(assembly, [each.state for each in answer.joints])
    ).glb()


def _document(problem: SpatialProblem, times: Array, poses: Array, marks: Marks) -> Document:
    made, assembly = Document(), problem.assembly
    made.extras = {"title": printable(problem.title)}
    tones = stone_tones(min(TONES, len(assembly.blocks)))
    stones = [made.material(f"stone {at}", tone) for at, tone in enumerate(tones)]
    told = sorted({tone for each in marks.values() for *_, tone in each})
    looks = {tone: made.material(f"joint {tone}", colour(tone)) for tone in told}
    base = made.material("support", colour(GROUND))
    at_times = made.add(times.astype(np.float32))
    for at, block in enumerate(assembly.blocks):
        turns = UPRIGHT @ Rotation.from_rotvec(poses[:, at, 3:]).as_matrix() @ UPRIGHT.T
        quaternions = Rotation.from_matrix(turns).as_quat()
        # q and -q are one rotation: each is the one nearer to that before.
        alike = (quaternions[1:] * quaternions[:-1]).sum(axis=1) >= 0
        quaternions[1:] *= np.cumprod(np.where(alike, 1.0, -1.0))[:, None]
        places = poses[:, at, :3] * assembly.size @ UPRIGHT.T
        faces = [
            (each.corners - block.centre, each.normal)
            for hull in block.hulls
            for each in hull.faces
        ]
        painted: list[tuple[Solid, int]] = []
        for points, normal, tone in marks.get(at, []):
            off = points - block.centre + OFF * assembly.size * normal
            painted.append((_solid([(off, normal)], edged=False), looks[tone]))
        node = made.solid(
            printable(block.name) or f"block {at}", _solid(faces), stones[at % len(stones)],
            painted, translation=places[0].tolist(), rotation=quaternions[0].tolist(),
        )  # fmt: skip
        made.move(node, at_times, "translation", places.astype(np.float32))
        made.move(node, at_times, "rotation", quaternions.astype(np.float32))
    for at, piece in enumerate(supports_of(assembly, *moving_box(assembly))):
        rings = [(corners, normal) for corners, normal, _ in piece.faces]
        made.solid(f"support {at}", _solid(rings), base)
    made.animation["name"] = "motion"
    return made


def _solid(faces: Sequence[Ring], *, edged: bool = True) -> Solid:
    """Make a mesh of faces, turned upright."""
    corners: list[Array] = []
    normals: list[Array] = []
    triangles: list[NDArray[np.intp]] = []
    edges: list[Array] = []
    count = 0
    for points, normal in faces:
        ring = _around(points, normal) @ UPRIGHT.T
        out = UPRIGHT @ normal
        corners.append(ring)
        normals.append(np.broadcast_to(out, ring.shape))
        later = np.arange(1, len(ring) - 1)
        triangles.append(count + np.stack([np.zeros_like(later), later, later + 1], axis=1))
        edges.append(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1).reshape(-1, 3))
        count += len(ring)
    return Solid(
        np.concatenate(corners).astype(np.float32),
        np.concatenate(normals).astype(np.float32),
        np.concatenate(triangles).ravel().astype(np.uint32),
        np.concatenate(edges if edged else [np.empty((0, 3))]).astype(np.float32),
    )


def _around(points: Array, normal: Array) -> Array:
    """Order corners of a convex face counter-clockwise, seen from outside."""
    arms = points - points.mean(axis=0)
    one = arms[0] / np.linalg.norm(arms[0])
    other = np.cross(normal, one)
    return points[np.argsort(np.arctan2(arms @ other, arms @ one))]
