"""Meshes of others, and assemblies of compas that are not planar, are blocks in space."""

import copy
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn import written
from running import ran, refused

import blocksim
from blocksim import InputError, Problem, Reading, load_structure

trimesh = pytest.importorskip("trimesh")
UPRIGHT = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1.0]])


def dome() -> Any:
    return blocksim.Dome(lunes=4, courses=3, thickness=0.05, friction=0.7).problem()


def solids() -> dict[str, Any]:
    """Return the blocks of a dome and its ground as meshes, by name."""
    assembly, shape = dome().assembly, trimesh.triangles.to_kwargs
    return {
        block.name: trimesh.util.concatenate([
            trimesh.Trimesh(**shape(each.triangles)) for each in block.hulls
        ])
        for block in (*assembly.blocks, *assembly.supports)
    }  # fmt: skip


def file_of(folder: Path, kind: str, scale: float = 1.0) -> Path:
    path, meshes = folder / f"dome.{kind}", {}
    for name, mesh in solids().items():
        mesh.apply_scale(scale)
        if kind == "glb":
            mesh.apply_transform(UPRIGHT)
        meshes["supports" if name == "ground" else name] = mesh
    scene: Any = trimesh.Scene(meshes)
    if kind in {"stl", "ply"}:
        scene = trimesh.util.concatenate(list(meshes.values()))
    made = scene.export(file_type=kind)
    return written(path, made if isinstance(made, bytes) else made.encode())


@pytest.mark.parametrize("kind", ["obj", "stl", "ply", "glb"])
def test_a_dome_is_the_same_as_a_mesh(tmp_path: Path, kind: str) -> None:
    """Weights, joints and margin are those of the kind, to the digits of the file."""
    path = file_of(tmp_path, kind, 1000.0 if kind == "stl" else 1.0)
    # Where blocks have no names the last is the ground.
    fixed = str(len(dome().assembly.blocks) + 1) if kind in {"stl", "ply"} else None
    found, known = converted(path, "mm" if kind == "stl" else "m", fixed), dome()
    assert len(found.assembly.joints) == len(known.assembly.joints)
    weights = [np.sort(each.assembly.weights) for each in (found, known)]
    assert weights[0] == pytest.approx(weights[1], rel=1e-3)
    margins = [blocksim.equilibrium(each).margin for each in (found, known)]
    assert margins[0] == pytest.approx(margins[1], abs=1e-3)


@pytest.mark.parametrize(("kind", "up"), [("obj", "y"), ("glb", "z")])
def test_a_mesh_may_have_another_coordinate_upwards(tmp_path: Path, kind: str, up: str) -> None:
    """A box on a table, with y upwards as an OBJ of many programs, or z as GLB of some."""
    scene, way = trimesh.Scene(), UPRIGHT if up == "y" else np.eye(4)
    for name, bounds in (
        ("supports", [[-1, -1, -1], [3, 3, 0]]),
        ("tall", [[0, 0, 0], [1, 2, 6]]),
    ):
        scene.add_geometry(trimesh.creation.box(bounds=bounds), name, name, transform=way)
    made: Any = scene.export(file_type=kind)
    path = written(tmp_path / f"one.{kind}", made if kind == "glb" else made.encode())
    found = load_structure(path, friction=1.0, reading=Reading(unit="m", up=up))
    (hull,) = found.assembly.blocks[0].hulls
    assert hull.box.tolist() == [[0, 0, 0], [1, 2, 6]]
    said = ran("check", path, "--mu", "1", "--unit", "m", "--up", up)
    assert f"its {up} upwards" in said
    assert "left out: it is of meshes" in refused("check", "gable", "--up", up)


def converted(path: Path, unit: str, fixed: str | None = None) -> Problem[Any]:
    """Read a mesh by command."""
    out = path.with_suffix(".json")
    held = () if fixed is None else ("--fixed", fixed)
    ran("convert", path, "--mu", "0.7", "--unit", unit, *held, "--out", out)
    return load_structure(out)


def box(*, faces: slice = slice(None), **changes: Any) -> Any:
    made = trimesh.creation.box(**changes)
    made.faces = made.faces[faces]
    return made


def test_boxes_that_touch_are_told_apart_and_turned_ones_taken(tmp_path: Path) -> None:
    """Facets turned inwards are as good."""
    table = trimesh.util.concatenate([box(), box().apply_translation([0, 0, 1])])
    table.invert()
    content = table.export(file_type="stl")
    path = written(tmp_path / "two.stl", content)
    found = converted(path, "ft", "1").assembly
    assert [each.name for each in (*found.supports, *found.blocks)] == ["1", "2"]
    (hull,) = found.blocks[0].hulls
    assert np.ptp(hull.corners, axis=0) == pytest.approx([0.3048] * 3, rel=1e-6)
    # A body has its number for a name, and may be a support by it.
    asked = ("check", path, "--mu", "1", "--unit", "ft", "--layer")
    assert "1 block, 1 joint" in ran(*asked, "supports=1")
    assert "one of the file's: 1, 2" in refused(*asked, "supports=3")


def test_blocks_of_a_glb_are_called_what_objects_are(tmp_path: Path) -> None:
    """Objects have names of their own beside those of meshes, which several may share."""
    scene, unit = trimesh.Scene(), trimesh.creation.box(bounds=[[0, 0, 0], [1, 1, 1]])
    table = trimesh.creation.box(bounds=[[-1, -1, -1], [2, 2, 0]])
    scene.add_geometry(table, node_name="supports", geom_name="Cube", transform=UPRIGHT)
    for low, name in enumerate(("lower", "upper")):
        up = np.eye(4)
        up[2, 3] = low
        scene.add_geometry(unit, node_name=name, geom_name="Box", transform=UPRIGHT @ up)
    path = written(tmp_path / "named.glb", scene.export(file_type="glb"))
    found = load_structure(path, friction=0.7).assembly
    assert [each.name for each in found.supports] == ["supports"]
    assert [each.name for each in found.blocks] == ["lower", "upper"]
    assert [each.hulls[0].box[0, 2] for each in found.blocks] == [0, 1]


SIDES = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
"""Faces of a box by its corners, z changing fastest and x slowest."""


def test_faces_with_four_sides_of_boxes_without_names_are_told_apart(tmp_path: Path) -> None:
    """Three boxes on each other, whose corners are the same where they touch."""
    lines: list[str] = []
    for low in range(3):
        places = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (low, low + 1)]
        lines += [f"v {x} {y} {z}" for x, y, z in places]
        lines += [f"f {' '.join(str(8 * low + at) for at in side)}" for side in SIDES]
    path = written(tmp_path / "three.obj", "\n".join(lines).encode())
    found = converted(path, "m", "geometry.1").assembly
    assert [each.name for each in found.blocks] == ["geometry.2", "geometry.3"]
    for low, block in enumerate(found.blocks, start=1):
        (hull,) = block.hulls
        assert hull.box.tolist() == [[0, 0, low], [1, 1, low + 1]]
    assert len(found.joints) == 2


def test_groups_of_a_file_without_objects_have_names(tmp_path: Path) -> None:
    """All were one object without a name, so that nothing was a support."""
    parts = [("supports", box()), ("stone", box().apply_translation([0, 0, 1]))]
    lines, known = "", 0
    for name, mesh in parts:
        lines += f"g {name}\n"
        lines += "".join(f"v {x} {y} {z}\n" for x, y, z in mesh.vertices)
        lines += "".join("f {} {} {}\n".format(*face) for face in mesh.faces + known + 1)
        known += len(mesh.vertices)
    path = written(tmp_path / "groups.obj", lines.encode())
    found = load_structure(path, friction=0.7, reading=Reading(unit="m")).assembly
    assert [each.name for each in (*found.supports, *found.blocks)] == ["supports", "stone"]


def flat() -> Any:
    made = box()
    made.vertices[:, 2] = 0
    return made


def facet(corner: int) -> bytes:
    """Return a mesh as text with one facet, of its first two corners and another."""
    head = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    rows = f"0 0 0\n1 0 0\n0 1 0\n3 0 1 {corner}\n"
    of_facets = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    return f"ply\nformat ascii 1.0\n{head}{of_facets}{rows}".encode()


BROKEN = {
    "beyond.ply": (lambda: facet(3), "corner 3 of a facet': must be 0 to 2"),
    "before.ply": (lambda: facet(-1), "corner -1 of a facet': must be 0 to 2"),
    "open.stl": (lambda: box(faces=slice(1, None)), "open at 3 edges"),
    "flat.stl": (flat, "a flat hull"),
    "ring.ply": (lambda: trimesh.creation.annulus(0.5, 1, 0.3, sections=8), "dented"),
    "far.stl": (lambda: box(extents=(1e12, 1, 1)), "within 1e+09 of the origin"),
    "round.stl": (lambda: trimesh.creation.icosphere(subdivisions=5), "10242 corners"),
    "many.ply": (lambda: trimesh.creation.icosphere(subdivisions=7), "327680 facets"),
    "large.stl": (lambda: b"x" * 20_000_001, "at most 20000000 bytes"),
    "junk.glb": (lambda: b"glTF\x02" + b"\xff" * 99, "a mesh as .glb"),
    "junk.stl": (lambda: b"\xff" * 99, ".stl"),
    "nan.obj": (lambda: b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "finite coordinates"),
    "lost.obj": (lambda: b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "mesh"),
    "backwards.obj": (
        lambda: b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n",
        "counted from the first",
    ),
    "empty.obj": (lambda: b"", "0 facets"),
    "points.ply": (lambda: trimesh.PointCloud(np.eye(3)), "0 facets"),
    "line.obj": (lambda: b"v 0 0 0\nv 1 0 0\nl 1 2\n", "0 facets"),
    "free.ply": (
        lambda: trimesh.util.concatenate([box(), box().apply_translation([0, 0, 1])]),
        "all free",
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_meshes_are_refused_in_one_line(tmp_path: Path, name: str) -> None:
    make, said = BROKEN[name]
    made = make()
    content = made if isinstance(made, bytes) else made.export(file_type=name[-3:])
    path = written(tmp_path / name, content)
    done = refused("check", path, "--mu", "0.7", "--unit", "m")
    assert said in done
    assert len(done) < 700 + len(str(path))


def test_a_mesh_has_no_unit_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = file_of(tmp_path, "obj")
    with pytest.raises(InputError, match="--unit is missing"):
        load_structure(path, friction=0.7)
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(blocksim.MissingPart, match=r"pip install 'blocksim\[mesh\]'"):
        load_structure(path, friction=0.7, reading=Reading(unit="m"))


@pytest.mark.parametrize("role", ["blocks", "supports", "ignored"])
def test_a_name_that_no_object_has_is_refused(tmp_path: Path, role: str) -> None:
    asked = ("check", file_of(tmp_path, "obj"), "--mu", "0.7", "--unit", "m")
    said = refused(*asked, "--layer", f"{role}=nosuch")
    assert "layer = 'nosuch': must be one of the file's: " in said
    assert "supports" in said


def compas_dome(*, dem: bool) -> dict[str, Any]:
    """Return a dome as compas_assembly or compas_dem writes it."""
    nodes, elements = {}, {}
    for at, (name, mesh) in enumerate(solids().items()):
        vertex = {
            str(k): dict(zip("xyz", p.tolist(), strict=True))
            for k, p in enumerate(mesh.vertices)
        }
        mesh_data = {
            "vertex": vertex,
            "face": {str(k): f.tolist() for k, f in enumerate(mesh.faces)},
        }
        held = {"is_support": name == "ground"}
        nodes[str(at)] = {
            "block": {"dtype": "compas_assembly.datastructures/Block", "data": mesh_data},
            **held,
        }
        geometry = {"dtype": "compas.datastructures/Mesh", "data": mesh_data}
        element = {"geometry": geometry, "transformation": None, **held}
        elements[f"guid-{at}"] = {"dtype": "compas_dem.elements/Block", "data": element}
    if dem:
        return {
            "dtype": "compas_dem.models/BlockModel",
            "data": {"elements": elements, "graph": {}},
        }
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": nodes, "edge": {}}}
    return {"dtype": "compas_assembly.datastructures/Assembly", "data": {"graph": graph}}


@pytest.mark.parametrize("dem", [False, True])
def test_an_assembly_of_compas_in_space_is_its_blocks(tmp_path: Path, dem: bool) -> None:
    table, path = compas_dome(dem=dem), tmp_path / "dome.json"
    found, known = load_structure(written(path, table), friction=0.7), dome()
    assert len(found.assembly.joints) == len(known.assembly.joints)
    margins = [blocksim.equilibrium(each).margin for each in (found, known)]
    assert margins[0] == pytest.approx(margins[1], abs=1e-6)
    broken = copy.deepcopy(table)
    inner = broken["data"]
    mesh = inner["elements"]["guid-3"]["data"]["geometry"] if dem else (
        inner["graph"]["data"]["node"]["3"]["block"]
    )  # fmt: skip
    mesh["data"]["face"].popitem()
    with pytest.raises(InputError, match="open at 3 edges"):
        load_structure(written(path, broken), friction=0.7)


MESH = "must be a mesh: corners with x, y and z, and faces of them"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda mesh: mesh["vertex"]["0"].pop("x"), f"""block 3 = "no 'x'": {MESH}"""),
        (lambda mesh: mesh.pop("vertex"), f"""block 3 = "no 'vertex'": {MESH}"""),
        (lambda mesh: mesh["face"].update({"0": [0, 1, 99]}), """block 3 = "no '99'": """),
        (lambda mesh: mesh.update(vertex=[]), f"block 3 = 'tables of another shape': {MESH}"),
        (
            lambda mesh: mesh["vertex"]["0"].update(x=np.nan),
            "block 3 = 'a coordinate of nan': ",
        ),
    ],
)
def test_a_block_of_compas_that_is_no_mesh_is_named(
    tmp_path: Path, change: Callable[[Any], object], said: str
) -> None:
    table = compas_dome(dem=False)
    change(table["data"]["graph"]["data"]["node"]["3"]["block"]["data"])
    assert said in refused("check", written(tmp_path / "dome.json", table), "--mu", "0.7")


def test_support_or_not_is_true_or_false(tmp_path: Path) -> None:
    """A word is neither: "no" was a support."""
    table = compas_dome(dem=True)
    table["data"]["elements"]["guid-3"]["data"]["is_support"] = "no"
    done = refused("check", written(tmp_path / "dome.json", table), "--mu", "0.7")
    assert "block 3: is_support = 'no': must be true or false" in done
