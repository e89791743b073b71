"""What `render` asks for beyond a picture: recordings, and films of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Literal

import typer

from blocksim.arch.motion import load_recording, simulate
from blocksim.cli.console import progress, say
from blocksim.cli.options import Given, arch_of, named_options, question
from blocksim.common.checks import require
from blocksim.engines import ENGINES
from blocksim.evidence.recording import Recording

FALL = 6.0
"""Time recorded of a scenario, enough for a collapse to reach the ground [sqrt(r/g)]."""
HEIGHT = 720
HEIGHTS = (180, 2160)
SLOWEST = 1000.0

Beside = Annotated[
    Path | None, typer.Option(help="A second recording, .npz, to show side by side.")
]
View = Annotated[Literal["2d", "3d"], typer.Option(help="From the front, or in perspective.")]
Slow = Annotated[
    float | None,
    typer.Option(help="Times slower than it happened (by default it takes about 6 s)."),
]
At = Annotated[
    float | None, typer.Option(help="For .png, .svg: seconds since the release (the end).")
]
Height = Annotated[
    int | None, typer.Option(help="Of a frame in pixels, 720 if left out; frames are 16:9.")
]
EngineOption = Annotated[
    str | None,
    typer.Option(
        "--method", help=f"Simulates a scenario: auto (if left out), {', '.join(ENGINES)}."
    ),
]


@dataclass(frozen=True, kw_only=True)
class RenderOptions:
    """How recordings are shown, in range.

    Raises
    ------
    InputError
        If a value is out of range.
    """

    view: Literal["2d", "3d"]
    slow: float | None
    at: float | None
    height: int

    def __post_init__(self) -> None:
        """Check the ranges."""
        low, high = HEIGHTS
        fits = low <= self.height <= high and self.height % 2 == 0
        require(fits, "--height", self.height, f"an even number from {low} to {high}")
        slow = self.slow is None or 0 < self.slow <= SLOWEST
        require(slow, "--slow", self.slow, f"above 0 and at most {SLOWEST:g}")
        at = self.at is None or 0 <= self.at < math.inf
        require(at, "--at", self.at, "0 or above")


def recordings(
    scene: str | None, given: Given, method: str | None, beside: Path | None
) -> list[Recording]:
    """Read recordings, or simulate the scenario."""
    second = [] if beside is None else [load_recording(beside)]
    if scene is not None and scene.endswith(".npz"):
        for name, value in {**asdict(given), "method": method}.items():
            require(value is None, f"--{name}", value, "left out: the recording says it")
        return [load_recording(Path(scene)), *second]
    asked = question(scene, given)
    arch = arch_of(asked, given.ratio)
    with named_options(), progress() as report:
        run = simulate(
            arch,
            mu=asked.mu,
            method=method or "auto",
            duration=FALL,
            lean=asked.lean,
            progress=report,
        )
    return [run, *second]


def film(out: Path, shown: Sequence[Recording], options: RenderOptions) -> None:
    """Draw recordings into a file and say so."""
    # Drawing and encoding take a second to import, which other commands need not wait for.
    from blocksim.view.video import STILLS, render

    with progress() as report:
        made = render(
            shown,
            out,
            view=options.view,
            slow=options.slow,
            at=options.at,
            height=options.height,
            progress=report,
        )
    if out.suffix.removeprefix(".") in STILLS:
        say(f"wrote {out}")
        return
    why = ", until a block reaches the ground or a footing" if made.on_ground else ""
    say(
        f"wrote {out}: {made.count / made.rate:.1f} s, {made.slow:g} times slower than the "
        f"{made.seconds:.3g} s it shows{why}"
    )
