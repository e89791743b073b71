"""Files that `render` and `map` write: every input as svg and pdf, stills of a height."""

import json
import re
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from running import inside

from blocksim import load_structure, simulate

STACK = {
    "title": "Two blocks on a floor",
    "friction": 0.6,
    "blocks": [
        {"id": "floor", "vertices": [[-2, -1], [4, -1], [4, 0], [-2, 0]], "fixed": True},
        {"id": "low", "vertices": [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]},
        {"id": "top", "vertices": [[0.2, 0.5], [1.2, 0.5], [1.2, 1], [0.2, 1]]},
    ],
}
INPUTS = {
    "arch": (("render", "semicircle", "--eta", "0.12"), "27 voussoirs, "),
    "continuous": (("render", "--alpha", "90", "--mu", "0.7"), "continuous arch"),
    "structure": (("render", "stack.json"), "stands, by limit"),
    "recording": (("render", "run.npz"), "at rest"),
    "leaning": (("render", "semicircle_tilted_overturns"), "tilted 38.4"),
    "map": (("map",), "friction coefficient"),
    "lines": (("map", "--lines"), "149.156"),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pictures")
    (folder / "stack.json").write_text(json.dumps(STACK))
    problem = load_structure(folder / "stack.json")
    simulate(problem, method="direct", duration=0.01).save(folder / "run.npz")
    return folder


def run(folder: Path, monkeypatch: pytest.MonkeyPatch, *arguments: str) -> str:
    """Run a command in a folder, and return what it complains about."""
    monkeypatch.chdir(folder)
    return inside(*arguments).stderr


def words_of_pdf(content: bytes) -> str:
    """Text of a pdf in Latin letters, which stand between brackets."""
    streams = re.findall(rb"FlateDecode.*?stream\r?\n(.*?)endstream", content, re.DOTALL)
    texts = re.findall(rb"BT(.*?)ET", b"".join(map(zlib.decompress, streams)), re.DOTALL)
    letters = rb"\(((?:\\.|[^()\\])*)\)"
    return b"\n".join(b"".join(re.findall(letters, text)) for text in texts).decode("latin-1")


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        pytest.param(name, kind, marks=[] if name in drawn else pytest.mark.long)
        # Each input by one of them but what leans, of which test_video has the svg; by both
        # what draws a still and a frame.
        for kind, drawn in (
            ("svg", ["arch", "continuous", "structure", "recording", "lines"]),
            ("pdf", ["arch", "recording", "map"]),
        )
        for name in INPUTS
    ],
)
def test_every_input_is_drawn_as_svg_and_pdf(
    name: str, kind: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked, words = INPUTS[name]
    run(folder, monkeypatch, *asked, "--out", f"{name}.{kind}")
    content = (folder / f"{name}.{kind}").read_bytes()
    if kind == "pdf":
        assert content.startswith(b"%PDF")
        assert words in words_of_pdf(content)
    else:
        assert words in content.decode()


@pytest.mark.parametrize("name", ["arch", "structure", "recording"])
def test_a_still_has_the_height_asked_for(
    name: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sizes = []
    for height in (240, 480):
        out = f"{name}-{height}.png"
        run(folder, monkeypatch, *INPUTS[name][0], "--height", str(height), "--out", out)
        with Image.open(folder / out) as picture:
            sizes.append(picture.size)
    assert [tall for _, tall in sizes] == [240, 480]
    # Larger, and otherwise the same picture: no side is cut.
    assert sizes[1][0] == pytest.approx(2 * sizes[0][0], abs=2)
    small, large = (
        np.asarray(Image.open(folder / f"{name}-{height}.png").convert("L").resize((80, 45)))
        for height in (240, 480)
    )
    assert np.abs(small.astype(float) - large).mean() < 4
