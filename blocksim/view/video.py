"""Films to files: mp4 by PyAV, gif by Pillow, single frames as png, svg and pdf."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from blocksim.common.checks import require
from blocksim.common.errors import MissingPart
from blocksim.common.files import AnyPath, write_whole
from blocksim.common.progress import Progress, silent
from blocksim.simulation.recording import Recording
from blocksim.view.film import TALL, Film, ViewName
from blocksim.view.style import GROUND, INK, JOINTS, PAPER, QUIET, THRUST

RATES = {"mp4": 30, "gif": 20}
"""Frames in a second; a gif counts in hundredths."""
STILLS = ("png", "svg", "pdf")
QUALITY = "19"
"""Constant rate factor of x264: lines stay crisp."""
THREADS = 2
"""Fixed, because x264's output depends on it."""
LONGEST = 600.0
"""Longest film [s]."""
MOST_PIXELS = {"mp4": 5e10, "gif": 6e8}
"""Most pixels of all frames. Those of a gif are in memory at once."""
COLOURS, SAMPLES = 255, 9
"""Colours of a gif, and frames from which they are chosen."""
DRAWN = (*JOINTS.values(), THRUST, INK, QUIET, PAPER, GROUND)
"""Colours that say something, whatever their share of a frame."""


def render(
    recordings: Sequence[Recording],
    out: AnyPath,
    *,
    view: ViewName = "2d",
    slow: float | None = None,
    at: float | None = None,
    height: int = TALL,
    progress: Progress = silent,
) -> Film:
    """Draw recordings into a file, whole or not at all.

    `recordings`: One, or two to show side by side.
    `out`: Ending in .mp4 or .gif for a film, .png, .svg or .pdf for one frame of it.
    `view`, {"2d", "3d"}.
    `slow`: How many times slower than it happened.
    `at`: For a single frame: time since the release, in the unit of the film's clock; by
        default the end.
    `height`: In pixels; frames are 16:9.
    Returns: As it was drawn.
    """
    out = Path(out)
    kind = out.suffix.removeprefix(".")
    film = Film(recordings, view=view, slow=slow, height=height, rate=RATES.get(kind, 30))
    if kind in STILLS:
        write_whole(out, lambda file: film.still(file, kind, at))
    else:
        write_film(film, out, progress)
    return film


def write_film(film: Film, out: AnyPath, progress: Progress = silent) -> None:
    """Encode frames into an .mp4 or .gif, whole or not at all. Refuse too many of them."""
    _require_bounded(film, Path(out).suffix.removeprefix("."))
    write = _mp4 if Path(out).suffix == ".mp4" else _gif
    write_whole(out, lambda file: write(film, file, progress))


def _require_bounded(film: Film, kind: str) -> None:
    """Refuse a film that would take hours or fill the disk, before it is begun."""
    seconds, frame = film.count / film.rate, film.width * film.height
    long = f"at most {LONGEST:g} s long: less slow, or of a shorter recording"
    require(seconds <= LONGEST, "film", f"{seconds:.4g} s", long)
    most = int(MOST_PIXELS[kind] // frame)
    allowed = (
        f"at most {most} frames of {film.width} x {film.height} as .{kind}: lower, less slow"
    )
    require(film.count <= most, "film", f"{film.count} frames", allowed)


def _mp4(film: Film, file: BinaryIO, progress: Progress) -> None:
    if find_spec("av") is None:
        raise MissingPart("mp4", "pip install av, or film as .gif")
    import av
    from av.video.reformatter import Colorspace

    with av.open(file, "w", format="mp4") as container:
        options = {"crf": QUALITY, "preset": "veryfast"}
        stream = container.add_stream("libx264", rate=film.rate, options=options)
        stream.width, stream.height = film.width, film.height
        stream.pix_fmt = "yuv420p"
        stream.thread_count = THREADS
        # Players take HD video for BT.709; say so, and convert so.
        stream.color_range, stream.colorspace = 1, Colorspace.ITU709
        stream.color_primaries = stream.color_trc = 1

        def encode(frame: NDArray[np.uint8]) -> None:
            picture = av.VideoFrame.from_ndarray(frame, format="rgba")
            converted = picture.reformat(format="yuv420p", dst_colorspace=Colorspace.ITU709)
            container.mux(stream.encode(converted))

        # One frame is encoded while the next is drawn.
        with ThreadPoolExecutor(1) as encoder:
            encoded = encoder.submit(encode, film.frame(0))
            for number in range(1, film.count):
                frame = film.frame(number)
                encoded.result()
                encoded = encoder.submit(encode, frame)
                progress((number + 1) / film.count, "rendering")
            encoded.result()
        container.mux(stream.encode(None))


def _palette(film: Film) -> Image.Image:
    """Make one palette for all frames: lines are few pixels, so their colours are given."""
    given = list(dict.fromkeys(to_bytes(name) for name in DRAWN))
    numbers = np.unique(np.linspace(0, film.count - 1, SAMPLES).astype(int)).tolist()
    samples = np.concatenate([film.frame(number)[::2, ::2, :3] for number in numbers])
    chosen = Image.fromarray(samples).quantize(COLOURS - len(given)).getpalette() or []
    rest = [tuple(chosen[place : place + 3]) for place in range(0, len(chosen), 3)]
    colours = list(dict.fromkeys([*given, *rest]))[:COLOURS]
    palette = Image.new("P", (1, 1))
    palette.putpalette([part for each in colours for part in each])
    return palette


def to_bytes(name: str) -> tuple[int, int, int]:
    """Red, green and blue of a colour given as #rrggbb, 0 to 255."""
    red, green, blue = bytes.fromhex(name.removeprefix("#"))
    return red, green, blue


def _gif(film: Film, file: BinaryIO, progress: Progress) -> None:
    palette = _palette(film)

    def frames() -> Iterator[Image.Image]:
        for number in range(film.count):
            progress((number + 1) / film.count, "rendering")
            picture = Image.fromarray(film.frame(number)[..., :3])
            yield picture.quantize(palette=palette, dither=Image.Dither.NONE)

    every = frames()
    next(every).save(
        file,
        format="GIF",
        save_all=True,
        append_images=every,
        duration=1000 // film.rate,
        loop=0,
        optimize=False,
    )
