"""Files and options that nobody in his right mind would give: hypothesis strategies.

Each file is a good one of its format in which something was changed. Questions are small, so
that what takes long hangs.
"""

import copy
import io
import json
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import ezdxf
import numpy as np
import trimesh
from hypothesis import strategies as st
from recorded import header_of, recorded
from running import ran

from blocksim import Arch, CircularArch, simulate, structure_of


@dataclass(frozen=True)
class Attack:
    """Files by name, of which one called `stdin` is piped, and the words of a command."""

    files: dict[str, bytes]
    words: tuple[str, ...]


EXTREMES = (
    "0", "-0.0", "1", "-1", "2", "1e-320", "5e-324", "1e-308", "1e-200", "1e-100", "1e-15",
    "1e-9", "1e-7", "1e-6", "1e-3", "0.5", "1e3", "1e6", "1e7", "1e9", "1e12", "1e15", "1e16",
    "1e100", "1e154", "1e200", "1.7e308", "-1e308", "1e309", "inf", "-inf", "nan",
    "9007199254740993", "18446744073709551616", "9" * 300, "9" * 400, "9" * 5000,
)  # fmt: skip
NUMBERS = st.sampled_from(EXTREMES) | st.floats().map(repr) | st.integers().map(str)
WORDS = st.sampled_from(
    ["", " ", ".", "..", "/", "~", "-", "--", "a\nb", "\x1b[31m", "a\x00b", "x" * 300,
     "x" * 100_000, "\udcff", "\ud800", "%s%n", "{}", "None", "inf", "b0", "\u202e", "é", "1e5"]
) | st.text(max_size=20)  # fmt: skip


def _number(written: str) -> Any:
    if re.fullmatch(r"-?\d+", written):
        return int(written) if len(written) < 4000 else 10**4000
    return float(written)


VALUES = st.recursive(
    NUMBERS.map(_number) | WORDS | st.none() | st.booleans(),
    lambda inside: (
        st.lists(inside, max_size=3)
        | st.dictionaries(st.sampled_from(["kind", "data", "dtype", "a"]) | WORDS, inside)
    ),
    max_leaves=4,
)


def _places(tree: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    found = [at] if at else []
    if isinstance(tree, dict | list):
        for key, inside in tree.items() if isinstance(tree, dict) else enumerate(tree):
            found += _places(inside, (*at, key))
    return found


@st.composite
def changed(draw: st.DrawFn, tree: Any, values: st.SearchStrategy[Any] = VALUES) -> Any:
    """Return a tree in which one to three places are replaced, taken away or doubled."""
    tree = copy.deepcopy(tree)
    for _ in range(draw(st.integers(1, 3))):
        places = _places(tree)
        if not places:
            break
        *path, key = draw(st.sampled_from(places))
        inside = tree
        for step in path:
            inside = inside[step]
        what = draw(st.sampled_from(["number", "number", "value", "away", "double", "new"]))
        if what == "number":
            inside[key] = draw(NUMBERS.map(_number))
        elif what == "value":
            inside[key] = draw(values)
        elif what == "away":
            del inside[key]
        elif what == "double" and isinstance(inside, list):
            inside.append(copy.deepcopy(inside[key]))
        elif isinstance(inside, dict):
            inside[draw(WORDS)] = draw(values)
    return tree


@st.composite
def spoilt(draw: st.DrawFn, whole: bytes) -> bytes:
    """Return a file with numbers replaced, or bytes flipped, doubled, cut or put in."""
    for _ in range(draw(st.integers(1, 3))):
        what = draw(st.sampled_from(["number", "number", "flip", "cut", "double", "put"]))
        at = draw(st.integers(0, max(0, len(whole) - 1)))
        if what == "number":
            places = [*re.finditer(rb"-?\d+\.?\d*", whole[:200_000])]
            if places:
                place = draw(st.sampled_from(places))
                new = draw(NUMBERS).encode()
                whole = whole[: place.start()] + new + whole[place.end() :]
        elif what == "flip" and whole:
            flipped = bytes([whole[at] ^ draw(st.integers(1, 255))])
            whole = whole[:at] + flipped + whole[at + 1 :]
        elif what == "cut":
            whole = whole[:at]
        elif what == "double":
            end = at + draw(st.integers(1, 200))
            times = draw(st.sampled_from([2, 3, 1000]))
            whole = whole[:at] + whole[at:end] * times + whole[end:]
        else:
            junk = draw(st.binary(max_size=20) | WORDS.map(_bytes))
            whole = whole[:at] + junk + whole[at:]
    return whole


def _bytes(text: str) -> bytes:
    return text.encode("utf-8", "surrogatepass")


def _json(tree: Any) -> bytes:
    return json.dumps(tree).encode()


def toml(tree: dict[str, Any]) -> bytes:
    """Write a table as TOML, numbers that it has not included."""
    lines: list[str] = []

    def value(of: Any) -> str:
        if isinstance(of, bool):
            return str(of).lower()
        if isinstance(of, float):
            return repr(of)
        if isinstance(of, int):
            return hex(of) if of > 10**60 else str(of)
        if isinstance(of, list):
            return f"[{', '.join(map(value, of))}]"
        if isinstance(of, dict):
            return "{" + ", ".join(f"{key(k)} = {value(v)}" for k, v in of.items()) + "}"
        return json.dumps(of) if isinstance(of, str) else '""'

    def key(of: str) -> str:
        return of if re.fullmatch(r"[\w.-]+", of, re.ASCII) else json.dumps(of)

    plain = {k: v for k, v in tree.items() if not isinstance(v, dict)}
    lines += [f"{key(k)} = {value(v)}" for k, v in plain.items()]
    for name, table in tree.items():
        if isinstance(table, dict):
            lines += [f"[{key(name)}]", *(f"{key(k)} = {value(v)}" for k, v in table.items())]
    return ("\n".join(lines) + "\n").encode("utf-8", "surrogatepass")


def _box(x: float, y: float, wide: float, high: float) -> list[list[float]]:
    return [[x, y], [x + wide, y], [x + wide, y + high], [x, y + high]]


def _cuboid(x: float, z: float, wide: float) -> list[list[float]]:
    return [[x + a * wide, x + b * wide, z + c] for a in (0, 1) for b in (0, 1) for c in (0, 1)]


_TREES: dict[str, Any] = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))
STRUCTURE, BY_KIND, WALL = (_TREES[name] for name in ("STRUCTURE", "BY_KIND", "WALL"))
GIVEN = {
    **{key: STRUCTURE[key] for key in ("friction", "blocks", "live", "load")},
    "joints": _TREES["joints"],
}
SHAKEN = {**GIVEN, "shake": _TREES["shake"]}
SCENARIO, MEASURED = _TREES["SCENARIO"], _TREES["MEASURED"]
DESIGN, DRAWN_DESIGN = _TREES["DESIGN"], _TREES["DRAWN_DESIGN"]
POINTS, RESULTS, PEER = _TREES["POINTS"], _TREES["RESULTS"], _TREES["PEER"]
SOLID, CASES, SVG = _TREES["SOLID"], _TREES["CASES"], _TREES["SVG"].encode()
CSV = b"time_s,acceleration_g\n0,0\n0.05,0.2\n0.1,-0.1\n0.2,0\n"


@cache
def _dxf() -> bytes:
    drawing = ezdxf.new(units=6)
    for layer, corners in (("supports", _box(-1, -1, 4, 1)), ("blocks", _box(0, 0, 1, 1))):
        drawing.modelspace().add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    text = io.StringIO()
    drawing.write(text)
    return text.getvalue().encode()


@cache
def _plain_dxf() -> bytes:
    """Entities alone, in which a change is sure to matter."""
    lines = ["0", "SECTION", "2", "HEADER", "9", "$ACADVER", "1", "AC1015"]
    lines += ["9", "$INSUNITS", "70", "6", "0", "ENDSEC"]
    lines += ["0", "SECTION", "2", "ENTITIES"]
    for layer, corners in (("supports", _box(-1, -1, 4, 1)), ("blocks", _box(0, 0, 1, 1))):
        lines += ["0", "LWPOLYLINE", "100", "AcDbEntity", "8", layer]
        lines += ["100", "AcDbPolyline", "90", "4", "70", "1"]
        lines += [word for x, y in corners for word in ("10", str(x), "20", str(y))]
    # A block of three lines and an arc.
    for a, b, c, d in ((2, 1, 2, 0), (2, 0, 3, 0), (3, 0, 3, 1)):
        lines += ["0", "LINE", "100", "AcDbEntity", "8", "blocks", "100", "AcDbLine"]
        ends = ("10", a), ("20", b), ("11", c), ("21", d)
        lines += [str(word) for pair in ends for word in pair]
    lines += ["0", "ARC", "100", "AcDbEntity", "8", "blocks", "100", "AcDbCircle"]
    lines += ["10", "2.5", "20", "1", "40", "0.5", "100", "AcDbArc", "50", "0", "51", "180"]
    return "\n".join([*lines, "0", "ENDSEC", "0", "EOF", ""]).encode()


@cache
def _recording(*, in_space: bool = False) -> tuple[dict[str, Any], Any, Any]:
    """Header, times and poses of three voussoirs that fall apart, or of two boxes in space."""
    if in_space:
        made = simulate(structure_of({**SOLID, "load": 2.0}), method="direct", duration=0.2)
    else:
        arch = Arch(half_angle=1.2, eta=0.2, voussoirs=3)
        times = np.linspace(0.0, 0.5, 6)
        moved = times[:, None, None] ** 2 * np.array([0.3, -0.5, 0.4])
        made = recorded(CircularArch.of(arch, 0.7).problem(), moved, times)
    poses = made.poses.copy()
    # Known by that as those whose fingerprint is in the header.
    poses.setflags(write=False)
    return header_of(made), made.times, poses


def packed(header: Any, times: Any, poses: Any) -> bytes:
    """Return a recording, whose fingerprint is right."""
    if isinstance(header, dict) and np.size(poses) and np.asarray(poses).flags.writeable:
        made = np.ascontiguousarray(poses, dtype="<f8").reshape(-1).view(np.uint8)
        import hashlib

        header = {**header, "state_hash": hashlib.sha256(made).hexdigest()[:16]}
    file = io.BytesIO()
    np.savez_compressed(file, header=np.array(json.dumps(header)), times=times, poses=poses)
    return file.getvalue()


@st.composite
def recordings(draw: st.DrawFn) -> bytes:
    """Recordings with another header, times or poses, or spoilt as files."""
    header, times, poses = _recording(in_space=draw(st.booleans()))
    what = draw(st.sampled_from(["header", "header", "times", "poses", "file"]))
    if what == "header":
        return packed(draw(changed(header)), times, poses)
    if what == "times":
        # None that would be a film of minutes: those are work.
        ends = (1e-320, 1e-150, 1e-9, 1e-3, 1.0, 3.0, 1e4, 1e9, 1e12, 1e150, 1e300, math.inf)
        end, start = draw(st.sampled_from(ends)), draw(st.sampled_from((0.0, 1.0, -1e9, 1e200)))
        with np.errstate(all="ignore"):
            return packed(header, start + np.linspace(0, end, len(times)), poses)
    if what == "poses":
        far = float(draw(st.sampled_from(EXTREMES)))
        moved = poses.copy()
        moved[
            draw(st.integers(0, len(poses) - 1)) :,
            draw(st.integers(0, poses.shape[1] - 1)),
            draw(st.integers(0, poses.shape[2] - 1)),
        ] = far
        return packed(header, times, moved)
    return draw(spoilt(packed(header, times, poses)))


METHODS = st.sampled_from(["auto", "limit", "theory", "direct", "pymunk", "pymunk"])


@st.composite
def structures(draw: st.DrawFn) -> Attack:
    """Structure files, in JSON or TOML."""
    tree = draw(
        st.sampled_from([STRUCTURE, GIVEN, SHAKEN, BY_KIND, WALL]).flatmap(changed) | VALUES
    )
    name = draw(st.sampled_from(["a.json", "a.json", "a.toml"]))
    flat = name == "a.json" or not isinstance(tree, dict)
    text = _json(tree) if flat else toml(tree)
    if draw(st.integers(0, 4)) == 0:
        text = draw(spoilt(text))
    return Attack({name: text}, draw(_asked(name)))


def _asked(name: str) -> st.SearchStrategy[tuple[str, ...]]:
    """Questions about a structure or a drawing."""
    over = st.sampled_from(["load", "tilt", "mu", "spread", "lean", "amplitude", "thickness"])
    return st.one_of(
        METHODS.map(lambda method: ("check", name, "--method", method)),
        METHODS.map(lambda method: ("check", name, "--json", "--method", method)),
        over.map(lambda each: ("bracket", name, "--over", each, "--tol", "0.05")),
        st.just(("check", name, "--unit-weight", "20", "--mu", "0.7")),
        st.sampled_from(["svg", "png", "dxf", "pdf"]).map(
            lambda kind: ("render", name, "--out", f"o.{kind}")
        ),
        st.just(("report", name, "--out", "o.html")),
        st.just(("convert", name, "--mu", "0.6", "--out", "o.json")),
        st.just(
            ("simulate", name, "--seconds", "0.05", "--out", "o.npz", "--method", "direct")
        ),
    )


@cache
def _meshes() -> dict[str, bytes]:
    """Two boxes on a bed as meshes, by the name of the file."""
    scene: Any = trimesh.Scene()
    for name, *at in (("supports", -1, -1, 3), ("a", 0, 0, 1), ("b", 0.2, 1, 1)):
        scene.add_geometry(trimesh.convex.convex_hull(np.array(_cuboid(*at))), geom_name=name)
    made = {kind: scene.export(file_type=kind) for kind in ("obj", "stl", "ply", "glb")}
    made["text.stl"] = scene.to_geometry().export(file_type="stl_ascii")
    return {
        f"a.{kind}": _bytes(text) if isinstance(text, str) else text
        for kind, text in made.items()
    }


def _converted(name: str) -> tuple[str, ...]:
    return ("convert", name, "--fixed", "1", "--out", "o.json")


@st.composite
def solids(draw: st.DrawFn) -> Attack:
    """Structures in space, as files and as meshes."""
    name, text = draw(
        st.tuples(st.just("a.json"), changed(SOLID).map(_json))
        | st.sampled_from(sorted(_meshes().items())).flatmap(
            lambda each: st.tuples(st.just(each[0]), spoilt(each[1]))
        )
    )
    words = draw(_asked(name)) if name[-3:] not in {"stl", "ply"} else _converted(name)
    unit = () if name == "a.json" else ("--unit", draw(st.sampled_from(["m", "mm"]) | NUMBERS))
    return Attack({name: text}, (*words, *unit, *(() if "--mu" in words else ("--mu", "0.7"))))


@cache
def _proof() -> bytes:
    with TemporaryDirectory() as folder:
        asked, proof = Path(folder) / "a.json", Path(folder) / "proof.json"
        asked.write_bytes(_json({**GIVEN, "load": 0.1}))
        ran("check", asked, "--proof", proof)
        return proof.read_bytes()


@st.composite
def proofs(draw: st.DrawFn) -> Attack:
    """Proofs to be checked."""
    tree = changed(json.loads(_proof())).map(_json)
    return Attack({"a.json": draw(tree | spoilt(_proof()))}, ("verify", "a.json"))


@st.composite
def cases(draw: st.DrawFn) -> Attack:
    """Files of cases."""
    text = toml(draw(changed(CASES)))
    if draw(st.integers(0, 3)) == 0:
        text = draw(spoilt(text))
    files = {"a.json": _json(STRUCTURE), "a.toml": text}
    return Attack(files, ("check", "a.json", "--cases", "a.toml"))


@st.composite
def streams(draw: st.DrawFn) -> Attack:
    """Folders of structures and drawings, each with one that is spoilt."""
    whole = draw(st.sampled_from([_json(GIVEN), _json(SOLID), SVG, _plain_dxf()]))
    kind = {SVG: "svg", _plain_dxf(): "dxf"}.get(whole, "json")
    files = {f"1.{kind}": draw(spoilt(whole)), "2.json": _json(STRUCTURE)}
    return Attack(files, ("check", ".", "--mu", "0.7"))


@st.composite
def pipes(draw: st.DrawFn) -> Attack:
    """Lines of JSON on standard input, some spoilt."""
    line = st.sampled_from([GIVEN, SOLID, STRUCTURE, BY_KIND]).flatmap(
        lambda tree: st.just(_json(tree)) | changed(tree).map(_json)
    )
    text = b"\n".join(draw(st.lists(line | VALUES.map(_json), min_size=1, max_size=4)))
    if draw(st.booleans()):
        text = draw(spoilt(text))
    return Attack({"stdin": text}, ("check", "-", "--mu", "0.7"))


@st.composite
def scenarios(draw: st.DrawFn) -> Attack:
    """Scenario files."""
    text = toml(draw(st.sampled_from([SCENARIO, MEASURED]).flatmap(changed)))
    if draw(st.integers(0, 3)) == 0:
        text = draw(spoilt(text))
    words = draw(
        _asked("a.toml")
        | METHODS.map(lambda method: ("bracket", "a.toml", "--method", method))
        | st.just(("check", "a.toml", "--fill", "0.3", "--point-load", "0.2", "3"))
    )
    return Attack({"a.toml": text}, words)


MANY = re.compile(rb"count = \d{4}")
COUNTS = st.sampled_from(EXTREMES).filter(lambda each: each not in {"1e3", "1e6", "1e7"})


@st.composite
def designs(draw: st.DrawFn) -> Attack:
    """Design files, none of them of so many arches that it is work."""
    tree = draw(
        st.sampled_from([DESIGN, DRAWN_DESIGN]).flatmap(
            lambda each: changed(each, COUNTS.map(_number) | WORDS)
        )
    )
    text = toml(tree)
    if draw(st.integers(0, 5)) == 0:
        text = draw(spoilt(text).filter(lambda each: not MANY.search(each)))
    return Attack({"a.toml": text}, ("sweep", "a.toml", "--out", "o", "--workers", "1"))


@st.composite
def motions(draw: st.DrawFn) -> Attack:
    """Recordings, drawn in every way."""
    kind = draw(st.sampled_from(["png", "svg", "mp4", "gif", "glb", "gltf", "csv", "json"]))
    words = ["render", "a.npz", "--out", f"o.{kind}"]
    if kind in {"png", "svg", "mp4", "gif"}:
        # Small ones, not to wait for pixels.
        words += ["--height", "180"] if kind != "svg" else []
        words += draw(st.sampled_from([[], ["--view", "3d"], ["--beside", "b.npz"]]))
        # A film may be long, and then takes long: of 160 s half a minute.
        words += draw(st.sampled_from([[], [], ["--slow", "20"], ["--slow", "100000"]]))
    files = {"a.npz": draw(recordings()), "b.npz": packed(*_recording())}
    return Attack(files, tuple(words))


@st.composite
def drawings(draw: st.DrawFn) -> Attack:
    """DXF, SVG, and JSON of another program."""
    name, text = draw(
        st.one_of(
            st.tuples(st.just("a.svg"), spoilt(SVG)),
            st.tuples(st.just("a.dxf"), spoilt(_plain_dxf())),
            st.tuples(st.just("a.dxf"), spoilt(_dxf())),
            st.tuples(st.just("a.json"), changed(PEER).map(_json)),
            st.tuples(st.just("a.json"), changed(_peer_of_before()).map(_json)),
        )
    )
    words = draw(_asked(name))
    mu = () if "--mu" in words else ("--mu", "0.7")
    unit = ("--unit", draw(NUMBERS)) if words[0] == "convert" and draw(st.booleans()) else ()
    return Attack({name: text}, (*words, *mu, *unit))


def _peer_of_before() -> dict[str, Any]:
    nodes = PEER["data"]["graph"]["node"]
    return {
        "blocks": {name: copy.deepcopy(node["block"]) for name, node in nodes.items()},
        "assembly": {"vertex": {"0": {"is_support": True}, "1": {}}},
    }


def _is_work(table: bytes) -> bool:
    """Tell whether the ground shakes for minutes, which is allowed and takes as long."""
    rows = [row.split(b",") for row in table.splitlines()[1:]]
    try:
        times = [float(row[0]) for row in rows]
    except (ValueError, IndexError):
        return False
    return bool(times) and 5 < times[-1] - times[0] <= 600


@st.composite
def tables(draw: st.DrawFn) -> Attack:
    """Rows of other runs, and tables of ground motion."""
    arch = ("--alpha", "90", "--mu", "0.7", "--voussoirs", "9", "--eta", "0.2")
    return draw(
        st.one_of(
            changed(RESULTS).map(
                lambda tree: Attack(
                    {"a.json": _json(tree)},
                    ("map", "--out", "o.html", "--results", "a.json"),
                )
            ),
            # Nowhere to be written: the file is read before.
            changed(POINTS).map(
                lambda tree: Attack(
                    {"a.json": _json(tree), "file": b""},
                    ("chart", "--quick", "--beside", "a.json", "--out", "file"),
                )
            ),
            st.tuples(spoilt(CSV).filter(lambda text: not _is_work(text)), METHODS).map(
                lambda both: Attack(
                    {"a.csv": both[0]},
                    ("check", *arch, "--shake", "a.csv", "--method", both[1]),
                )
            ),
        )
    )


OPTIONS, USUAL = _TREES["OPTIONS"], _TREES["USUAL"]


@st.composite
def options(draw: st.DrawFn) -> Attack:
    """Options with numbers and words that they were not made for."""
    command = draw(st.sampled_from(list(OPTIONS)))
    words = [*USUAL[command]]
    for _ in range(draw(st.integers(1, 2))):
        what = draw(st.sampled_from([*OPTIONS[command], "", "--voussoirs"]))
        many = {"--point-load": 2, "--patch-load": 3, "--within": 2}.get(what, 1)
        if what == "--voussoirs":
            # Few or too many: what lies between is work.
            new = [draw(COUNTS)]
        elif what == "--with":
            new = [f"{draw(WORDS)}={draw(NUMBERS | WORDS)}"]
        else:
            new = [draw(NUMBERS | NUMBERS | WORDS) for _ in range(many)]
        if what in words[:-1]:
            words[words.index(what) + 1] = new[0]
        else:
            words += [what, *new] if what else new
    if command in {"check", "bracket"} and "--method" not in words:
        words += ["--method", draw(METHODS)]
    # No program can be given these.
    words = [word.replace("\x00", "") for word in words]
    sane = [re.sub("[\ud800-\udc7f\udd00-\udfff]", "", word) for word in words]
    return Attack({}, (command, *sane))


@cache
def corpus() -> dict[str, Attack]:
    """Return what broke something once, and what is like it, by name."""
    found: dict[str, Attack] = {}
    for folder in sorted((Path(__file__).parent / "corpus").iterdir()):
        files = {path.name: path.read_bytes() for path in folder.iterdir()}
        found[folder.name] = Attack(files, tuple(json.loads(files.pop("words.json"))))
    return found


@st.composite
def kept(draw: st.DrawFn) -> Attack:
    """One of the corpus, of which a file is spoilt, but for what may become work."""
    seeds = [each for each in corpus().values() if each.files and each.words[0] != "sweep"]
    seed = draw(st.sampled_from(seeds))
    name = draw(st.sampled_from(sorted(seed.files)))
    return Attack({**seed.files, name: draw(spoilt(seed.files[name]))}, seed.words)


ATTACKS = {
    each.__name__: each
    for each in (
        structures, solids, scenarios, cases, designs, motions, drawings, proofs, streams,
        pipes, tables, options, kept,
    )
}  # fmt: skip


def good() -> dict[str, Callable[[], Attack]]:
    """Return the files that are changed and spoilt, as they are: each must be read.

    Each is made when it is asked for: what takes long is not, as tests are collected.
    """
    mu = ("--mu", "0.7")
    arch = ("--alpha", "90", *mu, "--voussoirs", "9", "--eta", "0.2")
    trees = {"structure": STRUCTURE, "given": GIVEN, "shaken": SHAKEN, "kind": BY_KIND}
    trees |= {"wall": WALL, "peer": PEER, "peer of before": _peer_of_before()}
    made = {
        name: partial(
            Attack, {"a.json": _json(tree)}, ("check", "a.json", *mu * name.startswith("peer"))
        )
        for name, tree in trees.items()
    }
    for name, tree in {"scenario": SCENARIO, "measured": MEASURED}.items():
        made[name] = partial(Attack, {"a.toml": toml(tree)}, ("check", "a.toml"))
    for name, tree in {"design": DESIGN, "drawn design": DRAWN_DESIGN}.items():
        words = ("sweep", "a.toml", "--out", "o", "--workers", "1")
        made[name] = partial(Attack, {"a.toml": toml(tree)}, words)
    made["solid"] = partial(Attack, {"a.json": _json(SOLID)}, ("check", "a.json"))
    files = {"a.json": _json(STRUCTURE), "a.toml": toml(CASES)}
    made["cases"] = partial(Attack, files, ("check", "a.json", "--cases", "a.toml"))
    for name, text in _meshes().items():
        # Where bodies have no names, none is a support.
        asked = ("check", name) if name[-3:] in {"obj", "glb"} else _converted(name)
        made[name] = partial(Attack, {name: text}, (*asked, *mu, "--unit", "m"))
    for name, text in {"a.svg": SVG, "a.dxf": _dxf(), "plain.dxf": _plain_dxf()}.items():
        made[name] = partial(Attack, {name: text}, ("check", name, *mu))
    made["pipe"] = partial(
        Attack, {"stdin": _json(GIVEN) + b"\n" + _json(SOLID)}, ("check", "-")
    )
    made["ground"] = partial(Attack, {"a.csv": CSV}, ("check", *arch, "--shake", "a.csv"))
    coloured = ("map", "--out", "o.html", "--results", "a.json")
    made["results"] = partial(Attack, {"a.json": _json(RESULTS)}, coloured)
    filmed = ("render", "a.npz", "--out", "o.svg")
    return {
        **made,
        "proof": lambda: Attack({"a.json": _proof()}, ("verify", "a.json")),
        "recording": lambda: Attack({"a.npz": packed(*_recording())}, filmed),
        "recording in space": lambda: Attack(
            {"a.npz": packed(*_recording(in_space=True))}, filmed
        ),
    }
