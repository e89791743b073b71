"""Streams of ten thousand random stacks and towers, and how long their verdicts take.

Question: how many scenes a minute does `blocksim check - < scenes.jsonl` filter, reading
included, and are its verdicts those of an independent programme? Stacks are boxes upon each
other in the plane, towers are boxes turned about the vertical. The first 500 of each are held
to what shares no code with blocksim: proofs by `tests/certificates.py` in the plane; in
space whether the centre of all that is above lies over each face (shapely).

    python -m analysis.streams OUT [--count N] [--quick]

Writes the scenes (`stacks.jsonl`, `towers.jsonl`), and a row of each in `streams.csv`.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from analysis.command import run
from analysis.rows import write_rows
from blocksim import Solid, structure_of
from tests.certificates import certificate
from tests.space_cases import is_over, tower

HELD = 500
"""Scenes of each kind that are held to another programme."""
FLOOR = {"id": "floor", "fixed": True, "vertices": [[-9, -1], [9, -1], [9, 0], [-9, 0]]}


def stack(seed: int) -> dict[str, Any]:
    """Draw three to eight boxes upon each other, shifted."""
    draw = np.random.default_rng(seed)
    blocks, at, low, before = [FLOOR], 0.0, 0.0, 9.0
    for index in range(int(draw.integers(3, 9))):
        width, high = float(draw.uniform(0.3, 1.5)), low + float(draw.uniform(0.2, 0.8))
        at += float(draw.uniform(-0.4, 0.4)) * min(width, before)
        left, right, before = at - width / 2, at + width / 2, width
        corners = [[left, low], [right, low], [right, high], [left, high]]
        blocks.append({"id": index, "vertices": corners})
        low = high
    return {"friction": round(float(draw.uniform(0.3, 0.9)), 3), "blocks": blocks}


def in_space(seed: int) -> dict[str, Any]:
    """Draw two to seven boxes upon each other, shifted and turned."""
    blocks = [
        {"id": each.name, "vertices": each.parts[0], "fixed": each.fixed}
        for each in solids(seed)
    ]
    return {"friction": 0.6, "blocks": blocks}


def solids(seed: int) -> list[Solid]:
    """Draw the boxes of a tower, the ground first."""
    count = int(np.random.default_rng(seed).integers(2, 8))
    return tower(seed, blocks=count, offset=0.3)


KINDS: dict[str, tuple[Callable[[int], Any], Callable[[int], bool | None]]] = {
    "stacks": (stack, lambda seed: certificate(structure_of(stack(seed))).stands),
    "towers": (in_space, lambda seed: is_over(solids(seed))),
}
"""What draws a scene, and what proves whether it can rest."""


def asked(out: Path, kind: str, count: int, held: int) -> dict[str, object]:
    """Ask about a stream, and hold the first verdicts to another programme: a row."""
    draw, rests = KINDS[kind]
    scenes = [draw(seed) for seed in range(count)]
    path = out / f"{kind}.jsonl"
    path.write_text("".join(json.dumps(each) + "\n" for each in scenes), encoding="utf-8")
    before, began = os.times(), time.monotonic()
    with path.open("rb") as file:
        words = [sys.executable, "-m", "blocksim", "check", "-"]
        said = subprocess.run(words, stdin=file, capture_output=True, check=True)  # noqa: S603
    wall, after = time.monotonic() - began, os.times()
    spent = sum(after[2:4]) - sum(before[2:4])
    verdicts = [json.loads(line)["verdict"] for line in said.stdout.splitlines()]
    told = Counter(verdicts)
    proved = [rests(seed) for seed in range(held)]
    pairs = zip(verdicts, proved, strict=False)
    return {
        "kind": kind,
        "scenes": len(verdicts),
        "wall_s": round(wall, 1),
        "cpu_ms_each": round(1000 * spent / count, 2),
        **{name: told[name] for name in ("stands", "collapses", "undecided")},
        "held": sum(each is not None for each in proved),
        "false": sum(one == ("collapses" if each else "stands") for one, each in pairs
                     if each is not None),
    }  # fmt: skip


def main(out: Path, *, quick: bool = False, count: int = 10_000) -> list[dict[str, object]]:
    """Ask about both streams, and write a row of each."""
    out.mkdir(parents=True, exist_ok=True)
    rows = [asked(out, kind, *((60, 20) if quick else (count, HELD))) for kind in KINDS]
    write_rows(out / "streams.csv", rows)
    return rows


if __name__ == "__main__":
    run(main, lambda rows: "\n".join(map(str, rows)))
