"""Recordings as tables and JSON, in metres, seconds and radians.

An arch of which no radius was given has r = 1 m.
"""

from __future__ import annotations

from typing import Any, BinaryIO

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Joint
from blocksim.blocks.problem import STANDARD_GRAVITY
from blocksim.common.files import json_text
from blocksim.common.sheets import write_sheet
from blocksim.common.version import __version__
from blocksim.simulation.recording import Recording

VERSION = 1
"""Of the JSON's fields: grows when one changes its meaning or goes."""
COLUMNS = ("x_m", "y_m", "rotation_rad", "z_m", "rotation_x_rad", "rotation_y_rad")
"""What the columns of poses are; planar recordings have the first three."""


def write_recording_csv(recording: Recording, file: BinaryIO) -> None:
    """Write a row for each block at each time, for `pandas.read_csv`.

    Columns are `time_s`, `block` (its name, else its number), where its centre of weight is
    (`x_m`, `y_m`) and `rotation_rad`, counter-clockwise; from engines in three dimensions also
    `z_m`, `rotation_x_rad` and `rotation_y_rad`: with `rotation_rad`, about z, a rotation
    vector.
    """
    poses = _poses(recording)
    names = _names(recording)
    values = np.stack(list(poses.values()), axis=-1)
    rows = (
        [time, name, *row]
        for time, frame in zip(_seconds(recording), values, strict=True)
        for name, row in zip(names, frame.tolist(), strict=True)
    )
    write_sheet(file, ["time_s", "block", *poses], rows)


def write_recording_json(recording: Recording, file: BinaryIO) -> None:
    """Write what `recording_document` says."""
    file.write(json_text(recording_document(recording)).encode())


def recording_document(recording: Recording) -> dict[str, Any]:
    """Return geometry and poses as plain data, the unit in the name of each field.

    Poses are one list a frame of one number a block, in the order of `blocks`; their columns
    are those of the CSV.
    """
    assembly, problem = recording.assembly, recording.problem
    names = _names(recording)
    supports = [
        {"name": each.name or f"support {at}", "polygons_m": _lists(each.polygons)}
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
        "supports": supports,
        "blocks": [
            {
                "name": name,
                "centre_m": block.centre.tolist(),
                "polygons_m": _lists(block.polygons),
                "depth_m": block.depth,
                "weight_N": block.mass * STANDARD_GRAVITY,
            }
            for name, block in zip(names, assembly.blocks, strict=True)
        ],
        "joints": [
            {
                "a": _side(joint, joint.before, names, supports),
                "b": _side(joint, joint.after, names, supports),
                "ends_m": _lists((joint.inner, joint.outer)),
            }
            for joint in assembly.joints
        ],
        "time_s": _seconds(recording),
        **{name: column.tolist() for name, column in _poses(recording).items()},
    }


def _names(recording: Recording) -> list[str]:
    return [block.name or str(at) for at, block in enumerate(recording.assembly.blocks)]


def _side(joint: Joint, block: int, names: list[str], supports: list[dict[str, Any]]) -> str:
    if block != SUPPORT:
        return names[block]
    return "support" if joint.support is None else str(supports[joint.support]["name"])


def _seconds(recording: Recording) -> list[float]:
    return recording.seconds(STANDARD_GRAVITY).tolist()


def _poses(recording: Recording) -> dict[str, Any]:
    """Columns of the poses, each (frames, blocks)."""
    size = recording.assembly.size
    columns = COLUMNS[: recording.poses.shape[2]]
    return {
        name: recording.poses[..., at] * (size if name.endswith("_m") else 1.0)
        for at, name in enumerate(columns)
    }


def _lists(arrays: Any) -> list[Any]:
    return [each.tolist() for each in arrays]
