"""Structure files: the corpus reads, records read back, broken files get one line."""

import copy
import json
import math
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn import written
from structure_cases import names, of_each_kind, scenes

from blocksim import Arch, InputError, Load, Problem, load_structure, structure_of

STACK: dict[str, Any] = {
    "friction": 0.6,
    "blocks": [
        {"id": "ground", "vertices": [[-1, -1], [3, -1], [3, 0], [-1, 0]], "fixed": True},
        {"id": 1, "vertices": [[0, 0], [1, 0], [1, 1], [0, 1]]},
        {"id": 2, "vertices": [[0, 1], [1, 1], [1, 2], [0, 2]], "weight": 3.0},
    ],
    "live": [{"body": [1, 0]}],
}
TOML = """
title = "A stack"
friction = "inf"
density = 2.0
blocks = [
  { id = "ground", vertices = [[-1, -1], [3, -1], [3, 0], [-1, 0]], fixed = true },
  { id = 1, vertices = [[0, 0], [1, 0], [1, 1], [0, 1]] },
]
dead = [{ body = [0, -1] }, { block = 1, point = [0.25, 1], force = [0, -10] }]
move = [{ block = "ground", direction = [1, 0] }]
"""


def same(one: Problem, other: Problem) -> None:
    """Blocks, joints and loads to the last digits."""
    for name in ("mu", "load", "title", "source", "assembly.size"):
        assert attrgetter(name)(one) == attrgetter(name)(other), name
    for a, b in zip(one.assembly.blocks, other.assembly.blocks, strict=True):
        assert (a.inertia, a.depth) == (b.inertia, b.depth)
        assert a.mass == pytest.approx(b.mass, rel=1e-15)
        assert a.centre.tolist() == b.centre.tolist()
        assert len(a.polygons) == len(b.polygons)
        assert all(map(np.array_equal, a.polygons, b.polygons))
    for a, b in zip(one.assembly.joints, other.assembly.joints, strict=True):
        assert (a.before, a.after, a.friction) == (b.before, b.after, b.friction)
        assert (a.inner.tolist(), a.outer.tolist()) == (b.inner.tolist(), b.outer.tolist())
        assert a.is_corner == b.is_corner
        assert a.normal == pytest.approx(b.normal, abs=1e-15)
    faces = [each.assembly.joint_arrays.faces for each in (one, other)]
    assert np.array_equal(*faces)
    assert np.array_equal(one.gravity, other.gravity)
    for load in (0.0, 0.7):
        pulls = [each.with_load(load).applied_forces() for each in (one, other)]
        assert np.allclose(*pulls, rtol=1e-13, atol=1e-15)
    moves = [[(m.support, *m.direction) for m in each.moves] for each in (one, other)]
    assert moves[0] == moves[1]


@pytest.mark.parametrize("name", of_each_kind(names()))
def test_every_case_reads_and_its_record_reads_back(name: str):
    for scene in scenes(name):
        problem = structure_of(scene)
        free = [block for block in scene["blocks"] if not block.get("fixed")]
        assert [block.name for block in problem.assembly.blocks] == [str(b["id"]) for b in free]
        weights = [b["weight"] for b in free if "weight" in b]
        read = [
            block.mass * 9.81
            for block, written in zip(problem.assembly.blocks, free, strict=True)
            if "weight" in written
        ]
        assert read == pytest.approx(weights, rel=1e-12)
        same(problem, structure_of(json.loads(json.dumps(problem.to_dict()))))


def test_an_arch_can_be_recorded():
    """It has no bodies for its supports: they are made up, all else stays."""
    arch = Arch(half_angle=math.pi / 2, eta=0.12, voussoirs=9)
    problem = Problem(assembly=arch.assembly(), mu=0.7).leaning(0.1)
    back = structure_of(json.loads(json.dumps(problem.to_dict())))
    same(problem, back)
    assert len(back.assembly.supports) == 2


def test_loads_and_gravity():
    """Body forces on all blocks are gravity; others are loads on the blocks they name."""
    table = copy.deepcopy(STACK)
    table["dead"] = [
        {"body": [0, -1]},
        {"body": [0.1, 0]},
        {"block": 2, "force": [0, -6], "point": [0.25, 2]},
        {"body": [0, -2], "blocks": [1]},
    ]
    problem = structure_of(table).with_load(0.5)
    assert problem.gravity.tolist() == [0.1, -1, 0]
    assert (problem.assembly.size, problem.unit_force) == (1.0, pytest.approx(2.0))
    # Weights 1 and 3, mean 2; the force of -6 acts 0.25 to the left of the centre.
    want = [[0.05 + 0.25, -0.5 - 1.0, 0.0], [0.15 + 0.75, -1.5 - 3.0, 0.75]]
    assert problem.applied_forces() == pytest.approx(np.array(want))
    table["dead"] = [{"block": 2, "force": [0, -6]}]
    weightless = structure_of(table)
    assert not weightless.gravity.any()
    assert any("no gravity" in note for note in weightless.notes)


def test_the_same_keys_in_toml(tmp_path: Path):
    path = written(tmp_path / "stack.toml", TOML)
    problem = load_structure(path)
    assert problem.mu == math.inf
    assert problem.title == "A stack"
    assert problem.assembly.blocks[0].mass * 9.81 == pytest.approx(2.0)
    assert problem.moves[0].support == 0
    (load,) = problem.dead
    assert isinstance(load, Load)
    assert (load.blocks, load.force.tolist()) == ((0,), [0, -10])
    assert any("1 joint found" in note and "1e-06" in note for note in problem.notes)


def test_given_joints_are_taken():
    table = copy.deepcopy(STACK)
    table["joints"] = [
        {"a": "ground", "b": 1, "ends": [[0, 0], [1, 0]], "friction": 0},
        {"a": 2, "b": 1, "ends": [[0.2, 1], [0.7, 1]], "normal": [0, 1], "friction": "inf"},
        {"a": 1, "b": 2, "ends": [[0.9, 1]], "normal": [0, 2]},
    ]
    problem = structure_of(table)
    bed, middle, corner = problem.assembly.joints
    assert problem.friction.tolist() == [0, math.inf, 0.6]
    # Ends in either order, and a normal that points the wrong way, are put right.
    assert (bed.inner.tolist(), bed.outer.tolist()) == ([1, 0], [0, 0])
    assert (middle.before, middle.after, middle.normal.tolist()) == (1, 0, [0, -1])
    assert any("normal turned" in note for note in problem.notes)
    assert corner.is_corner
    assert corner.normal.tolist() == [0, 1]


UNIT = [[0, 0], [1, 0], [1, 1], [0, 1]]


def test_more_blocks_than_allowed():
    block = {"id": 0, "vertices": UNIT}
    with pytest.raises(InputError, match="blocks") as raised:
        structure_of({"friction": 1, "blocks": [block] * 100_001})
    assert "100000" in str(raised.value)
