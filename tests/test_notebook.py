"""What a notebook shows: by IPython's own formatters, in words, drawings and plain data."""

import json
import math
import re
import subprocess
import sys
import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from drawn import written
from running import answered

import blocksim
from blocksim import (
    Arch,
    CircularArch,
    bracket,
    check,
    collapse,
    crossing,
    load_structure,
    structure_of,
    vehicle_of,
)

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    formatters = pytest.importorskip("IPython.core.formatters")

ARCH = Arch(half_angle=math.radians(90), eta=0.12, voussoirs=27)
THIN = replace(ARCH, eta=0.1)
RING = CircularArch.of(ARCH, friction=0.7).but(eta=None)
BRIDGE = CircularArch(
    span=8, rise=3, thickness=0.45, voussoirs=15, friction=0.6, density=22_000
)
BLOCKS = [
    {"id": "floor", "vertices": [[-2, -1], [4, -1], [4, 0], [-2, 0]], "fixed": True},
    {"id": "low", "vertices": [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]},
    {"id": "top", "vertices": [[0.4, 0.5], [1.4, 0.5], [1.4, 1], [0.4, 1]]},
]
TABLE = {"friction": 0.6, "blocks": BLOCKS, "live": [{"body": [1, 0]}]}
WILD = "<b>&\"one\"</b> -- 'two' <script>x</script> "
"""A title that is a page's undoing if it is not escaped, and longer below."""


@pytest.fixture(scope="module")
def shown() -> dict[str, Any]:
    problem = structure_of({**TABLE, "title": (WILD * 5)[:200]})
    return {
        "arch": ARCH,
        "problem": problem,
        "maker": BRIDGE,
        "crossing": crossing(BRIDGE.problem(), vehicle_of("1@0")),
        "cases": blocksim.check_cases(
            [blocksim.Case(name="alone", problem=BRIDGE.problem(), factors=blocksim.Factors())]
        ),
        "arch check": blocksim.check(CircularArch.of(THIN, friction=0.7)),
        "check": check(problem.with_load(0.45)),
        "arch bracket": bracket(RING, method="limit"),
        "bracket": bracket(problem, over="tilt"),
        "recording": blocksim.simulate(
            CircularArch.of(THIN, friction=0.7), method="direct", duration=0.5
        ),
    }


@pytest.fixture(scope="module")
def formatted(shown: dict[str, Any]) -> Callable[[str], dict[str, str]]:
    """What IPython makes of each, made once."""

    @cache
    def of(name: str) -> dict[str, str]:
        return formatters.DisplayFormatter().format(shown[name])[0]

    return of


Formatted = Callable[[str], dict[str, str]]
NAMES = (
    *("arch", "problem", "arch check", "check", "arch bracket", "bracket"),
    *("crossing", "cases", "recording"),
)


@pytest.mark.parametrize("name", NAMES)
def test_ipython_shows_words_and_a_drawing(
    shown: dict[str, Any], formatted: Formatted, name: str
) -> None:
    data = formatted(name)
    assert {"text/plain", "text/html", "image/svg+xml"} <= set(data)
    said = data["text/plain"]
    assert len(said) < 200
    assert "array" not in said
    assert said.startswith(type(shown[name]).__name__)
    # Both are whole, and the drawing is the one within the words.
    drawing = ElementTree.fromstring(data["image/svg+xml"])  # noqa: S314 - our own
    assert drawing.tag.endswith("svg")
    assert data["image/svg+xml"] in data["text/html"]
    words = data["text/html"].replace(data["image/svg+xml"], "")
    ElementTree.fromstring(words)  # noqa: S314 - our own
    assert "<script" not in data["text/html"]
    assert "<b>" not in data["text/html"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("arch", ["alpha 90 deg, eta 0.12, 27 voussoirs", "span 1.88 r, rise 0.94 r"]),
        ("problem", ["&lt;script&gt;x&lt;/script&gt;", "2 blocks, 2 joints, mu 0.6"]),
        ("maker", ["Circular arch", "15 blocks, 16 joints, mu 0.6"]),
        ("crossing", ["LOAD FACTOR: least", " kN at -1.17"]),
        ("cases", ["STANDS", "governed by alone"]),
        ("arch check", ["COLLAPSES", "rrr, purely rotational", "friction angle 34.992 deg"]),
        ("check", ["COLLAPSES", "factor at collapse 0.4", "&lt;script&gt;"]),
        ("arch bracket", ["LEAST ETA 0.10672", "static limit analysis"]),
        ("bracket", ["TILT: stands at 21.80", "falls at 21.80"]),
        ("recording", ["Recording by direct", "11 frames", "27 blocks, 28 joints"]),
    ],
)
def test_the_words_are_those_of_the_command_line(
    formatted: Formatted, name: str, words: list[str]
) -> None:
    said = formatted(name)["text/html"]
    for each in words:
        assert each in said


@pytest.mark.parametrize(
    ("name", "kinds"),
    [
        ("arch", {"block": 27}),
        ("problem", {"block": 2, "live": 2, "support": 1}),
        ("check", {"block": 2, "moved": 1, "hinge": 1}),
        ("bracket", {"stands": 1, "collapses": 1, "limit": 1}),
    ],
)
def test_a_drawing_has_what_there_is(
    formatted: Formatted, name: str, kinds: dict[str, int]
) -> None:
    drawing = formatted(name)["image/svg+xml"]
    for kind, count in kinds.items():
        assert len(re.findall(f'id="{kind}(?:-[0-9]+)?"', drawing)) == count


def test_drawings_of_arches_tell_their_mode(formatted: Formatted) -> None:
    """Of a check the arch itself, of a bracket the one of least thickness."""
    told = formatted("arch check")["image/svg+xml"]
    assert "collapses, mode rrr, by limit, geometrical factor of safety 0.93" in told
    assert "\N{GREEK SMALL LETTER ALPHA} = 90°, η = 0.1, 27 voussoirs, μ = 0.7 (34.99°)" in told
    assert "η = 0.1067" in formatted("arch bracket")["image/svg+xml"]
    assert "purely rotational [rrr]" in bracket(RING, method="theory")._repr_svg_()
    none = bracket(RING.but(friction=0.3), method="limit")
    assert "η = 2" in none._repr_svg_()
    assert none.arch.eta_high is None
    engine = blocksim.check(CircularArch.of(ARCH, friction=0.7), method="direct")
    assert "stands, by direct, geometrical factor" in engine._repr_svg_()


def test_to_dict_is_what_the_command_line_prints(shown: dict[str, Any], tmp_path: Path) -> None:
    path = written(tmp_path / "stack.json", {**TABLE, "title": shown["problem"].title})
    arch = ("--alpha", "90", "--mu", "0.7", "--voussoirs", "27")
    asked = {
        "arch check": ("check", *arch, "--eta", "0.1"),
        "check": ("check", str(path), "--load", "0.45"),
        "arch bracket": ("bracket", *arch, "--method", "limit"),
        "bracket": ("bracket", str(path), "--over", "tilt"),
    }
    for name, words in asked.items():
        told = answered(*words, code=None)
        mine = shown[name].to_dict()
        # Seconds it took, and what `auto` took, which the program was asked.
        assert {**mine, "wall_s": 0, "reason": 0} == {**told, "wall_s": 0, "reason": 0}
        assert json.loads(json.dumps(mine, allow_nan=False)) == mine


def test_a_problem_as_a_dict_is_its_file(shown: dict[str, Any]) -> None:
    problem = load_structure("oppenheim_7")
    again = structure_of(problem.to_dict())
    assert again.mu == math.inf
    one, two = (collapse(each).load_factor for each in (problem, again))
    assert two == pytest.approx(one, rel=1e-9)
    told = shown["arch"].to_dict()
    assert (told["half_angle_deg"], told["eta"], told["voussoirs"]) == (90, 0.12, 27)
    assert told["span_m"] == pytest.approx(2 * 0.94, rel=1e-14)
    run = shown["recording"].to_dict()
    assert (run["frames"], run["engine"], run["blocks"]) == (11, "direct", 27)
    assert run["recorded_s"] == pytest.approx(0.5 * math.sqrt(1 / 9.81), rel=1e-12)
    assert run["state_hash"] == shown["recording"].state_hash


def test_reprs_are_short_whatever_they_are_of() -> None:
    third = 1 / 3
    arch = Arch(
        half_angle=third, eta=third, voussoirs=999, weight="centreline",
        radius=third * 1e5, depth=third * 1e5, specific_weight=third * 1e5,
    )  # fmt: skip
    assert len(repr(arch)) < 200
    assert eval(repr(arch), {"Arch": Arch}) == arch  # noqa: S307 - our own
    answer = blocksim.check(CircularArch.of(arch, friction=third))
    assert len(repr(answer)) < 200
    titled = replace(CircularArch.of(arch, third).problem(), title="a\nb " * 50)
    assert len(repr(titled)) < 200
    assert "\n" not in repr(titled)
    assert len(repr(replace(check(load_structure("oppenheim_7")), problem=titled))) < 200


def test_importing_blocksim_draws_nothing() -> None:
    """In a process of its own: reprs and dicts load no matplotlib, drawings do."""
    code = (
        "import sys, blocksim as b; arch = b.Arch(half_angle=1, eta=0.2, voussoirs=9)\n"
        "repr(arch), arch.to_dict(), b.check(b.CircularArch.of(arch, friction=1)).to_dict()\n"
        "print('matplotlib' in sys.modules); arch._repr_svg_()\n"
        "print('matplotlib' in sys.modules, 'matplotlib.pyplot' in sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert done.stdout.split() == ["False", "True", "False"], done.stderr


def test_all_that_is_public_is_there() -> None:
    assert sorted(blocksim.__all__) == blocksim.__all__
    for name in blocksim.__all__:
        assert getattr(blocksim, name) is not None
    rooms = {path.stem for path in Path(blocksim.__file__).parent.iterdir()}
    public = {name for name in vars(blocksim) if not name.startswith("_")} - rooms
    assert public - {"annotations", "interrupts", "TYPE_CHECKING"} == set(blocksim.__all__) - {
        "__version__"
    }
