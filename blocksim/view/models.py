"""Blocks as models, glTF 2.0, for browsers and Blender: a recording, or a mechanism in space.

Lengths are in metres, y upwards, z towards the viewer, times in seconds; an arch of which no
radius was given has r = 1 m. A block is a node with a mesh of its convex pieces, moved by one
animation; supports and the ground stay. What joints in space do as a collapse begins is painted
on their faces.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import STANDARD_GRAVITY
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.blocks.space.extruded import lifted, prism, prisms
from blocksim.blocks.space.polyhedron import Polyhedron
from blocksim.common.later import transform
from blocksim.common.words import printable
from blocksim.simulation.recording import Recording
from blocksim.view.canvas import colour
from blocksim.view.gltf import Document, Ring, Solid, mesh_of
from blocksim.view.solidscene import WAY, Marks, marks_of, moving_box, supports_of
from blocksim.view.stage import Stage
from blocksim.view.style import GROUND, PAPER
from blocksim.view.timeline import UPRIGHT

if TYPE_CHECKING:
    from blocksim.ask.check import Check

AROUND = 0.5
"""How far the ground reaches beyond what is seen, in units of its extent."""
GOES, FRAMES = 2.0, 24
"""How long a mechanism goes on [s], and frames of that."""
OFF = 1e-3
"""How far what joints do is painted off their faces [size]."""


def write_model(recording: Recording[Any], file: BinaryIO, kind: str) -> None:
    """Write a recording as one file: glb is binary, gltf JSON with the numbers as base64."""
    problem = recording.problem
    seconds = recording.seconds(STANDARD_GRAVITY).astype(np.float32)
    # Frames nearer to each other than their times can be told apart are left out.
    latest = np.maximum.accumulate(seconds)
    frames = np.flatnonzero(np.diff(latest, prepend=np.float32(-1.0)) > 0)
    made = Document(len(problem.assembly.blocks))
    made.extras = {
        "title": printable(problem.title),
        "engine": printable(f"{recording.engine} {recording.engine_version}"),
        "state_hash": recording.state_hash,
    }
    poses, size, assembly = recording.poses[frames], problem.assembly.size, problem.assembly
    if problem.in_space:
        supports = supports_of(assembly, *moving_box(assembly))
        _put(made, assembly, size, supports, seconds[frames], poses, {})
    else:
        made.extras["gravity_g"] = problem.gravity.tolist()
        made.extras["gravity_m_s2"] = (problem.gravity * STANDARD_GRAVITY).tolist()
        stage = Stage(recording)
        feet = [prism(each * size, stage.depth * size) for each in stage.footings]
        _put(made, prisms(assembly), size, feet, seconds[frames], lifted(poses), {})
        made.solid("ground", _ground(stage, size), made.material("ground", colour(PAPER)))
    made.write(file, kind)


def mechanism_model(answer: Check[SpatialAssembly]) -> bytes:
    """Return a .glb of blocks that begin to fall and come back, or stay where they stand."""
    rates, assembly = answer.mechanism, answer.problem.assembly
    still = np.zeros((len(assembly.blocks), 3))
    rest = np.concatenate([assembly.centres / assembly.size, still], axis=1)
    shares = (1 - np.cos(np.linspace(0.0, 2 * math.pi, FRAMES + 1))) / 2
    moved = WAY * (np.zeros_like(rest) if rates is None else rates)
    poses = rest + shares[:, None, None] * moved
    made = Document(len(assembly.blocks))
    made.extras = {"title": printable(answer.problem.title)}
    marks = marks_of(assembly, [each.state for each in answer.joints])
    times, supports = (
        np.linspace(0.0, GOES, FRAMES + 1),
        supports_of(assembly, *moving_box(assembly)),
    )
    _put(made, assembly, assembly.size, supports, times, poses, marks)
    return made.glb()


def _put(
    made: Document,
    assembly: SpatialAssembly,
    size: float,
    supports: Iterable[Polyhedron],
    seconds: NDArray[Any],
    poses: Array,
    marks: Marks,
) -> None:
    """Add blocks that move, and supports.

    `size`: Unit of the centres of poses, (frames, blocks, 6) [m].
    """
    told = sorted({tone for each in marks.values() for *_, tone in each})
    looks = {tone: made.material(f"joint {tone}", colour(tone)) for tone in told}
    vectors = poses[..., 3:].reshape(-1, 3)
    upright = UPRIGHT @ transform.Rotation.from_rotvec(vectors).as_matrix() @ UPRIGHT.T
    turns = transform.Rotation.from_matrix(upright).as_quat().reshape(*poses.shape[:2], 4)
    # q and -q are one rotation: each is the one nearer to that before.
    alike = (turns[1:] * turns[:-1]).sum(axis=-1) >= 0
    turns[1:] *= np.cumprod(np.where(alike, 1.0, -1.0), axis=0)[..., None]
    places = poses[..., :3] * size @ UPRIGHT.T
    times = made.add(seconds.astype(np.float32))
    for at, block in enumerate(assembly.blocks):
        painted: list[tuple[Solid, int]] = []
        for points, normal, tone in marks.get(at, []):
            if len(points) > 2:
                off = points - block.centre + OFF * size * normal
                painted.append((_upright([(off, normal)], edged=False), looks[tone]))
        node = made.solid(
            printable(block.name) or f"block {at}", _body(block.hulls, block.centre),
            made.stones[at % len(made.stones)], painted,
            translation=places[0, at].tolist(), rotation=turns[0, at].tolist(),
        )  # fmt: skip
        made.move(node, times, "translation", places[:, at])
        made.move(node, times, "rotation", turns[:, at])
    base = made.material("support", colour(GROUND))
    for at, piece in enumerate(supports):
        made.solid(f"support {at}", _body((piece,), np.zeros(3)), base)
    made.animation["name"] = "motion"


def _body(hulls: Sequence[Polyhedron], about: Array) -> Solid:
    """Make a mesh of parts of a block, as seen from a point of it."""
    return _upright([(f.corners - about, f.normal) for hull in hulls for f in hull.faces])


def _upright(faces: Sequence[Ring], *, edged: bool = True) -> Solid:
    """Make a mesh of faces, turned upright."""
    rings = [
        (_around(points, normal) @ UPRIGHT.T, UPRIGHT @ normal) for points, normal in faces
    ]
    edges = [
        np.stack([ring, np.roll(ring, -1, axis=0)], axis=1).reshape(-1, 3) for ring, _ in rings
    ]
    return mesh_of(rings, np.concatenate(edges) if edged else None)


def _around(points: Array, normal: Array) -> Array:
    """Order corners of a convex face counter-clockwise, seen from outside."""
    arms = points - points.mean(axis=0)
    one = arms[0] / np.linalg.norm(arms[0])
    other = np.cross(normal, one)
    return points[np.argsort(np.arctan2(arms @ other, arms @ one))]


def _ground(stage: Stage, size: float) -> Solid:
    """Return the ground as a rectangle that reaches beyond what is seen."""
    low, high = stage.swept.min(axis=0), stage.swept.max(axis=0)
    beyond = AROUND * float((high - low).max())
    (left, _, back), (right, _, front) = low - beyond, high + beyond
    level = stage.ground
    ring = [(left, front), (right, front), (right, back), (left, back)]
    corners = np.array([(x, level, z) for x, z in ring]) * size
    return mesh_of([(corners, np.array([0.0, 1.0, 0.0]))])
