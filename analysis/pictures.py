"""The pictures of the pages that commands and examples make, made again in one go.

Question: are the pictures in the pages those of today's code?

Expected: each is drawn again by the command or the example beside it, or of the rows that are
kept of a study. Figures that need more than rows (gallery, engines, spreading, the map, the
chart, the referee) are made by their studies and commands; `analysis/README.md` names them.

    python -m analysis.pictures OUT [--quick]

Writes each picture to its own place below the folder: with `.` they are renewed where they are.
"""

from __future__ import annotations

import io
import os
import runpy
import shlex
import subprocess
import sys
import tempfile
from importlib import import_module
from pathlib import Path

import matplotlib as mpl

from analysis.command import run
from analysis.drawing import fewer_colours

ROOT = Path(__file__).parents[1]
ARCH = "--span 8 --rise 3 --thickness 0.45 --voussoirs 31 --friction-angle 35 --unit-weight 22"
COMMANDS = {
    "docs/arch.svg": (f"render {ARCH} --out picture.svg",),
    "analysis/figures/collapse.png": (
        "simulate semicircle --eta 0.1055 --method direct --seconds 2 --out below.npz",
        "render below.npz --view 3d --time 2.66 --out picture.png",
    ),
}
"""Pictures by the commands that draw them."""


FROM_ROWS = {
    "onset_modes_direct": "onset_modes",
    "two_answers": "two_answers",
    "dome_map": "dome_map",
    "shaking": "shaking",
    "oppenheim": "oppenheim",
}
"""Figures that are drawn of rows which are kept, and the studies that draw them."""


def main(out: Path, quick: bool = False) -> list[str]:
    """Draw the pictures; in a quick run one of a command, one of an example, and the sketch."""
    made = [_sketch(out)]
    few = 1 if quick else None
    asked = list(COMMANDS.items())[:few]
    examples = sorted((ROOT / "docs" / "examples").glob("*.png"))[:few]
    made += [_by_commands(out / path, lines) for path, lines in asked]
    made += [
        _by_example(out / each.relative_to(ROOT), each.with_suffix(".py")) for each in examples
    ]
    for name, study in list(FROM_ROWS.items())[:few]:
        path = out / "analysis" / "figures" / f"{name}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        import_module(f"analysis.{study}").drawn_again(path)
        whole = io.BytesIO(path.read_bytes())
        with path.open("wb") as file:
            fewer_colours(whole, file)
        made.append(path)
    return [str(each.relative_to(out)) for each in made]


def _sketch(out: Path) -> Path:
    """Draw the arch with its words, as docs/sketch.py does."""
    path = out / "docs" / "sketch.svg"
    path.parent.mkdir(parents=True, exist_ok=True)
    figure = runpy.run_path(str(ROOT / "docs" / "sketch.py"))["figure"]
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "sketch"}):
        figure().savefig(path, metadata={"Date": None})
    return path


def _by_commands(path: Path, lines: tuple[str, ...]) -> Path:
    with tempfile.TemporaryDirectory() as folder:
        for line in lines:
            _run("-m", "blocksim", *shlex.split(line), folder=folder)
        return _moved(Path(folder) / f"picture{path.suffix}", path)


def _by_example(path: Path, script: Path) -> Path:
    with tempfile.TemporaryDirectory() as folder:
        _run(str(script), folder=folder)
        return _moved(Path(folder) / path.name, path)


def _run(*words: str, folder: str) -> None:
    subprocess.run(  # noqa: S603
        [sys.executable, *words], cwd=folder, check=True, stdout=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip


def _moved(made: Path, path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(made.read_bytes())
    return path


if __name__ == "__main__":
    run(main, "\n".join)
