"""The fall of blocks in space, on the command line."""

from __future__ import annotations

from pathlib import Path

from blocksim.ask.simulate import simulate
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.cli.filming import FALL, RenderOptions
from blocksim.cli.options import named_options
from blocksim.cli.output import progress, say
from blocksim.common.checks import require
from blocksim.common.files import write_whole
from blocksim.common.words import counted

ROUGH = 1e-4
"""Residual of contacts that is told."""


def model_in_space(out: Path, kind: str, problem: SpatialProblem, method: str | None) -> None:
    """Answer the command render: a recording in space as glTF."""
    from blocksim.view.gltfspace import write_recording

    with named_options(), progress() as report:
        recording = simulate(problem, method=method or "auto", duration=FALL, progress=report)
    write_whole(out, lambda file: write_recording(recording, file, kind))
    blocks = counted(len(problem.assembly.blocks), "block")
    say(f"wrote {out}: {blocks}, {counted(len(recording.times), 'frame')}")


def film_in_space(
    out: Path,
    problem: SpatialProblem,
    method: str | None,
    options: RenderOptions,
    beside: Path | None,
) -> None:
    """Answer the command render: a film in perspective."""
    allowed = "left out: blocks in space are filmed alone"
    require(beside is None, "--beside", str(beside), allowed)
    # Drawing takes a second to import, which other commands need not wait for.
    from blocksim.view.solidfilm import SolidFilm
    from blocksim.view.video import write_film

    with named_options(), progress() as report:
        recording = simulate(problem, method=method or "auto", duration=FALL, progress=report)
        film = SolidFilm(recording, slow=options.slow, height=options.height)
        write_film(film, out, report)
    pace = f"{film.slow:.3g} times slower" if film.slow > 1 else "in real time"
    ends = "all at rest" if film.at_rest else "blocks still move as it ends"
    left = recording.quality.residual or 0.0
    if left > ROUGH:
        ends += f"; Coulomb's law was kept to {left:.1g} of the forces only, where it was worst"
    say(f"wrote {out}: a film of {film.seconds:.3g} s of motion, {pace}; {ends}")
