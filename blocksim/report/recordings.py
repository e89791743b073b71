"""Recordings as tables and JSON, in metres, seconds and radians, and as text for people.

An arch of which no radius was given has r = 1 m.
"""

from __future__ import annotations

import math
from typing import Any, BinaryIO

import numpy as np

from blocksim.blocks.acting import shaking_words
from blocksim.blocks.assembly import SUPPORT, Joint
from blocksim.blocks.problem import STANDARD_GRAVITY
from blocksim.blocks.record import to_record
from blocksim.blocks.space.assembly import FaceJoint, SolidBlock
from blocksim.common.files import json_text
from blocksim.common.sheets import write_sheet
from blocksim.common.version import __version__
from blocksim.common.words import counted
from blocksim.simulation.recording import Recording
from blocksim.simulation.shaken import rocking_of

VERSION = 1
"""Version of the JSON's fields. It grows when one changes its meaning or goes."""
COLUMNS = ("x_m", "y_m", "rotation_rad")
"""Names of the columns of poses in the plane."""
IN_SPACE = ("x_m", "y_m", "z_m", "rotation_x_rad", "rotation_y_rad", "rotation_z_rad")
"""Names of the columns for blocks in space."""


def write_recording_csv(recording: Recording[Any], file: BinaryIO) -> None:
    """Write a row for each block at each time, for `pandas.read_csv`.

    Columns are `time_s`, `block` (its name, else its number), where its centre of weight is
    (`x_m`, `y_m`) and `rotation_rad`, counter-clockwise. In space they are `z_m`, too, and a
    rotation vector: `rotation_x_rad`, `rotation_y_rad` and `rotation_z_rad`.
    """
    poses, names = _poses(recording), _names(recording)
    values = np.stack(list(poses.values()), axis=-1)
    seconds = recording.seconds(STANDARD_GRAVITY).tolist()
    rows = (
        [time, name, *row]
        for time, frame in zip(seconds, values, strict=True)
        for name, row in zip(names, frame.tolist(), strict=True)
    )
    write_sheet(file, ["time_s", "block", *poses], rows)


def write_recording_json(recording: Recording[Any], file: BinaryIO) -> None:
    """Write what `recording_document` says."""
    file.write(json_text(recording_document(recording)).encode())


def recording_document(recording: Recording[Any]) -> dict[str, Any]:
    """Return geometry and poses, a list a frame of a number a block, units in the names."""
    assembly, problem = recording.assembly, recording.problem
    names = _names(recording)
    supports = [
        {"name": each.name or f"support {at}", **_shape(each)}
        for at, each in enumerate(assembly.supports)
    ]
    return {
        "format": "blocksim recording",
        "version": VERSION,
        "blocksim": __version__,
        "title": problem.title,
        "engine": recording.engine,
        "engine_version": recording.engine_version,
        "state_hash": recording.state_hash,
        "friction": problem.mu,
        "gravity_g": problem.gravity.tolist(),
        "gravity_m_s2": (problem.gravity * STANDARD_GRAVITY).tolist(),
        "supports": supports,
        "blocks": [
            {
                "name": name,
                "centre_m": block.centre.tolist(),
                **_shape(block),
                **({} if problem.in_space else {"depth_m": block.depth}),
                "weight_N": weight,
            }
            for name, block, weight in zip(
                names, assembly.blocks, assembly.weights.tolist(), strict=True
            )
        ],
        "joints": [
            {
                "a": _side(joint, joint.before, names, supports),
                "b": _side(joint, joint.after, names, supports),
                **_ends(joint),
            }
            for joint in assembly.joints
        ],
        "time_s": recording.seconds(STANDARD_GRAVITY).tolist(),
        **{name: column.tolist() for name, column in _poses(recording).items()},
    }


def _names(recording: Recording[Any]) -> list[str]:
    return [block.name or str(at) for at, block in enumerate(recording.assembly.blocks)]


def _shape(body: Any) -> dict[str, Any]:
    """Return the outlines of a body, or the corners of its convex parts."""
    if isinstance(body, SolidBlock):
        return {"polyhedra_m": _lists(hull.corners for hull in body.hulls)}
    return {"polygons_m": _lists(body.polygons)}


def _ends(joint: Joint | FaceJoint) -> dict[str, Any]:
    """Return the ends of a joint, or the corners of the face that two blocks share."""
    if isinstance(joint, FaceJoint):
        return {"points_m": joint.points.tolist(), "normal": joint.normal.tolist()}
    return {"ends_m": _lists((joint.inner, joint.outer))}


def _side(
    joint: Joint | FaceJoint, block: int, names: list[str], supports: list[dict[str, Any]]
) -> str:
    if block != SUPPORT:
        return names[block]
    return "support" if joint.support is None else str(supports[joint.support]["name"])


def _poses(recording: Recording[Any]) -> dict[str, Any]:
    """Columns of the poses, each (frames, blocks)."""
    size = recording.assembly.size
    columns = IN_SPACE if recording.problem.in_space else COLUMNS
    return {
        name: recording.poses[..., at] * (size if name.endswith("_m") else 1.0)
        for at, name in enumerate(columns)
    }


def _lists(arrays: Any) -> list[Any]:
    return [each.tolist() for each in arrays]


ROUNDING = 1e-12
"""Length below which there is nothing but rounding [size]."""
LEAST_ROTATION = 1e-3
"""Rotation of a block from which on a recording is said to have turned one [rad]."""


def recording_record(recording: Recording) -> dict[str, object]:
    """Return what a recording shows, without its poses."""
    rocking, problem = rocking_of(recording), recording.problem
    size = recording.assembly.size
    return {
        "engine": recording.engine,
        "engine_version": recording.engine_version,
        "settings": to_record(recording.settings),
        "title": problem.title,
        "blocks": len(recording.assembly.blocks),
        "mu": recording.mu,
        "size_m": size,
        "frames": len(recording.times),
        "recorded_s": float(recording.seconds(STANDARD_GRAVITY)[-1]),
        "moved_m": float(recording.displacement[-1]) * size,
        "largest_rotation_deg": math.degrees(rocking.rotation),
        "gravity_m_s2": (problem.gravity * STANDARD_GRAVITY).tolist(),
        "quality": to_record(recording.quality),
        "overlap_of_smallest_block": recording.overlap_share,
        "state_hash": recording.state_hash,
    }


def unsolved_words(recording: Recording) -> str:
    """Say that contact forces were not found in some step."""
    left = recording.unsolved
    far = f", but to {left:.1g} g" if math.isfinite(left) else ""
    return f"contact forces were not found{far}: what it shows from there on may be wrong"


def recording_lines(recording: Recording, unit: str) -> list[str]:
    """Return a recording in words, with lengths in a unit."""
    lines = [
        f"{counted(len(recording.times), 'frame')}, "
        f"{recording.seconds(STANDARD_GRAVITY)[-1]:.2f} s, "
        f"moved {recording.displacement[-1]:.2g} {unit}, hash of its end {recording.state_hash}"
    ]
    kept, rocking, problem = recording.quality, rocking_of(recording), recording.problem
    said: list[str] = []
    if problem.shaking is not None:
        said.append(shaking_words(problem))
    if rocking.rotation >= LEAST_ROTATION:
        name = problem.assembly.blocks[rocking.block].name or str(rocking.block)
        said.append(f"block {name} turned by {math.degrees(rocking.rotation):.3g} deg at most")
    if rocking.impact is not None:
        said.append(
            f"a joint first closed again after {rocking.impact * problem.seconds:.4g} s"
        )
    if said:
        lines.append("  " + ", ".join(said))
    if recording.unsolved:
        lines.append("  " + unsolved_words(recording))
    said = []
    if kept.penetration is None:
        said.append(f"{recording.engine} does not tell how deep blocks overlap")
    else:
        said.append(
            f"blocks overlap by at most {kept.penetration:.1e} {unit}, "
            f"{recording.overlap_share:.2g} of the smallest"
            if kept.penetration > ROUNDING
            else "no blocks overlap"
        )
    if kept.gain is not None:
        said.append(
            f"energy rose again, by at most {100 * kept.gain:.1g} % of what fell"
            if kept.gain > ROUNDING
            else "energy never rose"
        )
    if said:
        lines.append("  " + ", ".join(said))
    if kept.error is not None:
        until = recording.times[-1] if kept.known is None else kept.known
        ends = "" if kept.known is None else ", not known beyond"
        apart = f"differs by at most {kept.error:.1e} {unit}"
        found = "is the same" if kept.error <= ROUNDING else apart
        unit_s = problem.seconds
        late = "" if kept.late is None else f", in time by {kept.late * unit_s:.1e} s,"
        lines.append(
            f"  a run at another step {found}{late} until {until * unit_s:.3g} s{ends}"
        )
    return lines
