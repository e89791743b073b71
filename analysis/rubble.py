"""Collapses to the ground: blocks stay solid, and nothing gives them energy.

Question: what does an engine make of a collapse once blocks meet others, what they stand on and
the floor? Twenty structures are drawn at random: arches below their least thickness, walls and
columns on a table tilted beyond their limit, stacks that reach too far. With `--heaps` they
are walls of 30 to 200 irregular stones on a table that tilts by 28 to 40 degrees. Each is let
go until the rubble lies still or `LONGEST` has passed. Measured from the recording's poses by a
test of its own (separating axes of the true prisms, in space):

- `overlap`, the deepest of any two bodies, in units of the least width of the block;
- `sunk`, how far a corner is below the floor;
- `rise`, how far a centre is above where it was at the release;
- `thrown`, how far it is, with nothing within `CLEAR` of the block, above where it was carried;
- `gain`, how far the energy was above that at the release, as a share of what fell.

The engine says of its own how deep blocks overlap and what energy was gained. A block may well
rise: the shoulders of an arch do, and the lowest block of a stack that tips over its edge does,
for which others fall. One that flies higher than it was carried has been thrown.

    python -m analysis.rubble OUT [--engine direct|pymunk|pybullet|mujoco] [--count N] [--heaps]
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from analysis.command import run
from analysis.rows import write_rows
from analysis.saved_answers import Row, answers
from blocksim import (
    Arch,
    CircularArch,
    InputError,
    Load,
    Problem,
    Recording,
    collapse,
    simulate,
    structure_of,
)
from blocksim.arch.limit import least_thickness
from blocksim.blocks.assembly import PLANAR, SUPPORT, Array
from blocksim.blocks.outlines import width
from blocksim.engines.energy import energy
from blocksim.engines.solids import Solids
from blocksim.engines.stepping import UNSOLVED
from blocksim.simulation.motion import lie_still

SEED = 16
COUNT = 20
KINDS, HEAPS = ("arch", "wall", "arch", "column", "stack"), ("heap",)
FEWEST, MOST = 30, 200
"""Stones of a heap."""
LONGEST = 15.0
"""Time after which a run ends though something moves [sqrt(size/g)]."""
ALLOWED, GAIN = 0.01, 1e-3
"""What is demanded: overlap over the block's width, and energy gained over what fell."""
CLEAR = 1e-3
"""Gap between two bodies that surely do not touch [size]."""


@dataclass(frozen=True)
class Case:
    """A collapse by its number."""

    number: int
    kind: str


def cases(count: int, kinds: tuple[str, ...] = KINDS) -> list[Case]:
    """Name the structures, of each kind in turn."""
    return [Case(number, kinds[number % len(kinds)]) for number in range(count)]


def drawn(case: Case) -> Problem:
    """Draw a structure that falls."""
    random = np.random.default_rng([SEED, case.number])
    if case.kind == "arch":
        least = None
        while least is None:
            half, mu = math.radians(random.uniform(60, 140)), random.uniform(0.6, 1.2)
            count = int(random.integers(5, 22))
            least = least_thickness(half, mu, count).eta
        share = random.uniform(0.8, 0.97)
        return CircularArch.of(
            Arch(half_angle=half, eta=share * least, voussoirs=count), mu
        ).problem()
    mu = random.uniform(0.55, 0.8)
    if case.kind == "heap":
        # By the golden ratio: however many are drawn, few stones and many are among them.
        share = (0.618034 * case.number) % 1.0
        stones = round(FEWEST * (MOST / FEWEST) ** share)
        table = {"stones": stones, "seed": case.number}
        heap = structure_of({"kind": "rubble", "friction": mu, **table})
        return heap.tilted(math.radians(random.uniform(28, 40)))
    if case.kind == "wall":
        courses, long = int(random.integers(6, 10)), random.uniform(0.3, 0.5)
        table = {
            "courses": courses,
            "length": 2 * long,
            "block_length": long,
            "block_height": random.uniform(0.7, 1.0) * long,
        }
    elif case.kind == "column":
        table = {
            "drums": int(random.integers(4, 9)),
            "drum_height": random.uniform(0.5, 0.8),
            "width": 1.0,
            "top_width": random.uniform(0.6, 1.0),
        }
    else:
        rows = int(random.integers(4, 10))
        farthest = sum(1 / (2 * row) for row in range(1, rows + 1))
        table = {"rows": rows, "overhang": random.uniform(1.02, 1.2) * farthest}
    problem = structure_of({"kind": case.kind, "friction": mu, **table})
    if case.kind == "stack":
        return problem
    sense = random.choice([-1.0, 1.0])
    blocks = tuple(range(len(problem.assembly.blocks)))
    across = Load(force=(sense, 0.0), blocks=blocks, per_weight=True)
    found = collapse(replace(problem, live=(across,))).load_factor
    return problem.tilted(sense * 1.1 * math.atan(found or 0.0))


def ask(case: Case, engine: str) -> Row:
    """Let one fall, and measure."""
    problem = drawn(case)
    started = time.process_time()
    asked: Row = {
        "engine": engine,
        "kind": case.kind,
        "number": case.number,
        "blocks": len(problem.assembly.blocks),
    }
    try:
        recording = simulate(problem, method=engine, duration=LONGEST)
    except InputError as refusal:
        return {**asked, "refused": str(refusal)}
    cpu_s = time.process_time() - started
    return {
        **asked,
        "ended": float(recording.times[-1]),
        # Blocks whose contact forces were not found stay where they are.
        "rested": (recording.quality.residual or 0.0) <= UNSOLVED
        and lie_still(problem.assembly, list(recording.poses)),
        **measured(recording),
        "own_overlap": recording.quality.penetration,
        "own_overlap_of_smallest": recording.overlap_share,
        "own_gain": recording.quality.gain,
        "own_residual": recording.quality.residual,
        "cpu_s": round(cpu_s, 2),
    }


def measured(recording: Recording) -> dict[str, float]:
    """Measure overlap, depth below the floor, rise and energy, from poses alone."""
    assembly, size = recording.assembly, recording.assembly.size
    solids = Solids(assembly)
    owner = [index for index, _ in solids.moving] + [SUPPORT] * (len(solids.fixed) + 1)
    flat = [*(polygon for _, polygon in solids.moving), *solids.fixed, solids.floor]
    deep = float(assembly.depths.max())
    depths = [*(float(assembly.depths[index]) for index, _ in solids.moving)]
    depths += [deep] * len(solids.fixed) + [100.0]
    prisms = [Prism.of(each, depth) for each, depth in zip(flat, depths, strict=True)]
    widths = [min(width(each), depth) for each, depth in zip(flat, depths, strict=True)]
    level = solids.level
    overlap = sunk = thrown = 0.0
    up = -recording.problem.gravity[:2]
    rises = (recording.poses[:, :, :2] - recording.poses[0, :, :2]) @ up
    highest = rises[0].copy()
    for pose, above in zip(recording.poses, rises, strict=True):
        placed = [
            prism if body == SUPPORT else prism.at(pose[body])
            for prism, body in zip(prisms, owner, strict=True)
        ]
        near = meeting(placed)
        for one, other in np.argwhere(np.triu(near)):
            if owner[one] == owner[other]:
                continue
            least = widths[one] if owner[other] == SUPPORT else min(widths[one], widths[other])
            found = overlap_of(placed[one], placed[other], overlap * least)
            overlap = max(overlap, found / least)
        low = min(float(prism.corners[:, 1].min()) for prism in placed[: len(solids.moving)])
        sunk = max(sunk, level - low)
        for body in np.flatnonzero(above > highest):
            pairs = [
                (placed[one], placed[other])
                for one, other in np.argwhere(near)
                if owner[one] == body != owner[other]
            ]
            if all(reach(one, other) < -CLEAR for one, other in pairs):
                thrown = max(thrown, float(above[body] - highest[body]))
            else:
                highest[body] = above[body]
    return {
        "overlap": overlap,
        "sunk": sunk,
        "rise": float(rises.max()),
        "thrown": thrown,
        "gain": gained(recording),
        "size": size,
    }


def gained(recording: Recording) -> float:
    """Return the energy seen above that at the release, as a share of what fell.

    Between two frames velocities are the mean ones and heights those midway. That is less than
    the mean energy there: of kinetic energy by what blocks slow down and speed up in between.
    """
    problem, poses = recording.problem, recording.poses
    rest = np.zeros_like(poses[0])
    still = np.array([energy(problem, pose, rest) for pose in poses])
    moving = [
        energy(problem, pose, (late - pose) / step) - energy(problem, pose, rest)
        for pose, late, step in zip(poses, poses[1:], np.diff(recording.times), strict=False)
    ]
    above = (still[1:] + still[:-1]) / 2 + moving - still[0]
    gain = max(0.0, float(above.max()))
    # A heap may stand: nothing gained, and nothing fell.
    return gain / float(still[0] - still.min()) if gain else 0.0


@dataclass(frozen=True, eq=False)
class Prism:
    """Corners, normals of faces and directions of edges, in space."""

    corners: Array
    normals: Array
    edges: Array

    @classmethod
    def of(cls, polygon: Array, depth: float) -> Prism:
        """Make one of a polygon."""
        count = len(polygon)
        half = np.full((count, 1), depth / 2)
        corners = np.vstack([np.hstack([polygon, half]), np.hstack([polygon, -half])])
        edge = np.roll(polygon, -1, axis=0) - polygon
        edge = edge[np.hypot(*edge.T) > 0]
        edge = np.column_stack([edge / np.hypot(*edge.T)[:, None], np.zeros(len(edge))])
        normals = np.column_stack([edge[:, 1], -edge[:, 0], edge[:, 2]])
        beyond = np.array([[0.0, 0.0, 1.0]])
        return cls(corners, np.vstack([normals, beyond]), np.vstack([edge, beyond]))

    def at(self, pose: Array) -> Prism:
        """Carry it to the pose of its block."""
        space = np.zeros(6)
        space[: len(pose)] = pose
        turned = Rotation.from_rotvec(space[[4, 5, 2]])
        place = space[[0, 1, PLANAR]]
        corners = turned.apply(self.corners) + place
        return Prism(corners, turned.apply(self.normals), turned.apply(self.edges))


def meeting(prisms: Sequence[Prism]) -> NDArray[np.bool_]:
    """Tell which of prisms have bounding boxes that are no more than `CLEAR` apart."""
    low = np.array([prism.corners.min(axis=0) for prism in prisms]) - CLEAR
    high = np.array([prism.corners.max(axis=0) for prism in prisms])
    found = np.all(low[:, None] <= high, axis=2)
    return found & found.T


def overlap_of(one: Prism, other: Prism, least: float) -> float:
    """Return by how much two prisms overlap; 0 if apart, or by no more than `least`."""
    first, second = one.corners, other.corners
    inside = np.minimum(first.max(axis=0), second.max(axis=0))
    inside -= np.maximum(first.min(axis=0), second.min(axis=0))
    return 0.0 if inside.min() <= least else max(0.0, reach(one, other))


def reach(one: Prism, other: Prism) -> float:
    """Return by how much two prisms overlap at least along any axis; negative if apart."""
    first, second = one.corners, other.corners
    cross = np.cross(one.edges[:, None], other.edges[None]).reshape(-1, 3)
    long = np.linalg.norm(cross, axis=1)
    cross = cross[long > 1e-6] / long[long > 1e-6, None]
    axes = np.vstack([one.normals, other.normals, cross])
    along, beyond = first @ axes.T, second @ axes.T
    depth = np.minimum(
        along.max(axis=0) - beyond.min(axis=0), beyond.max(axis=0) - along.min(axis=0)
    )
    return float(depth.min())


def main(
    out: Path,
    *,
    quick: bool = False,
    engine: str = "direct",
    count: int = COUNT,
    heaps: bool = False,
    processes: int = 1,
) -> list[Row]:
    """Let all fall, and write rows."""
    asked = cases(2 if quick else count, HEAPS if heaps else KINDS)
    name = f"{'heaps' if heaps else 'rubble'}_{engine}"
    rows = answers(out / f"{name}.jsonl", asked, partial(ask, engine=engine), processes)
    columns = dict.fromkeys(column for row in rows for column in row)
    write_rows(out / f"{name}.csv", [{**dict.fromkeys(columns), **row} for row in rows])
    return rows


if __name__ == "__main__":
    run(main, lambda rows: "\n".join(map(str, rows)))
