"""Recordings of motions that are given, and the words of films of them."""

import io
import json
import re
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from blocksim import Problem, Recording, Settings

SETTINGS = Settings(step=0.01, sweeps=10, hold_sweeps=10)


def recorded(
    problem: Problem, moved: np.ndarray, times: np.ndarray, *, engine: str = "pymunk"
) -> Recording:
    """Record displacements of blocks from where they were built, (frames, blocks, 3)."""
    return Recording(
        problem=problem,
        engine=engine,
        engine_version="1.0",
        settings=SETTINGS,
        times=times,
        poses=problem.assembly.built[:-1, :3] + moved,
    )


def header_of(recording: Recording) -> dict[str, Any]:
    """What a recording's file says before its numbers."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "run.npz"
        recording.save(path)
        with np.load(path) as archive:
            return json.loads(str(archive["header"]))


def drawn_words(film: Any, at: float | None = None) -> list[str]:
    """Words of a frame: in an SVG each is a comment before its glyphs."""
    file = io.BytesIO()
    film.still(file, "svg", at)
    return re.findall(r"<!-- (.*?) -->", file.getvalue().decode())


def parts_of(data: bytes) -> tuple[dict, bytes]:
    """Take a .glb apart."""
    assert data[:4] == b"glTF"
    version, length = np.frombuffer(data[4:12], "<u4")
    assert (version, length) == (2, len(data))
    size = int(np.frombuffer(data[12:16], "<u4")[0])
    assert data[16:20] == b"JSON"
    assert data[24 + size : 28 + size] == b"BIN\0"
    return json.loads(data[20 : 20 + size]), data[28 + size :]


def accessor(document: dict, numbers: bytes, index: int) -> np.ndarray:
    found = document["accessors"][index]
    start = document["bufferViews"][found["bufferView"]]["byteOffset"]
    width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[found["type"]]
    dtype = {5126: "<f4", 5125: "<u4"}[found["componentType"]]
    values = np.frombuffer(numbers, dtype, found["count"] * width, start)
    return values.reshape(-1, width).squeeze()
