"""The same arch and domes by `limit` and by compas_cra, one after the other.

Question: how long does each take, and what does it say? An arch of 15 voussoirs and two domes,
1 % thicker and 1 % thinner than they need to be, are asked of `limit`, of compas_cra's RBE
(least pulls between blocks, by forces alone) and of its CRA (forces that go with a motion).
compas_cra finds its own faces, and its friction is a pyramid of 8 sides. It runs in a Python of
its own, `--other`, which has compas_cra 0.8; each question is given up after a minute.
"""

from __future__ import annotations

import json
import subprocess
import time
from pathlib import Path
from typing import Any

import blocksim
from analysis.command import run
from analysis.rows import write_rows
from blocksim import Dome, Problem, SkewArch

LONGEST = 60.0
ARCH = SkewArch(
    radius=1, thickness=0.2, width=0.5, half_angle_deg=90, voussoirs=15, friction=0.7
)
LEAST = (
    ("arch, 15", ARCH, 0.10606803562),
    ("dome, 40", Dome(lunes=8, courses=5, friction=0.7), 0.0373487032422),
    ("dome, 84", Dome(lunes=12, courses=7, friction=0.7), 0.0410514715596),
)
"""With the least thickness over the radius."""
OTHER = """
import contextlib, io, json, sys, time
from compas_assembly.datastructures import Block
from compas_cra import equilibrium
from compas_cra.algorithms import assembly_interfaces_numpy
from compas_cra.datastructures import CRA_Assembly
told, made = json.load(sys.stdin), CRA_Assembly()
for at, (corners, faces, _) in enumerate(told["blocks"]):
    made.add_block(Block.from_vertices_and_faces(corners, faces), node=at)
made.set_boundary_conditions([at for at, block in enumerate(told["blocks"]) if block[2]])
began = time.process_time()
with contextlib.redirect_stdout(io.StringIO()):
    assembly_interfaces_numpy(made, nmax=len(told["blocks"]), amin=1e-6)
    found = time.process_time()
    getattr(equilibrium, told["method"])(made, mu=told["mu"])
done = time.process_time()
edges = made.graph.edges()
faces = [face for edge in edges for face in made.graph.edge_attribute(edge, "interfaces")]
pulls = sum(force["c_nn"] for face in faces for force in face.forces)
print(json.dumps([len(faces), pulls, found - began, done - found]))
"""


EMPTY = dict.fromkeys(
    ("structure", "thicker", "method", "said", "faces", "pulls", "finds_s", "answers_s")
)
"""Columns: what was said is a verdict, forces, or what went wrong; pulls are of all blocks on
each other, over all weight; processor time is that to find the joints, and to answer."""


def of_limit(problem: Problem[Any], made_s: float) -> dict[str, Any]:
    """Ask `limit`."""
    began = time.process_time()
    said = str(blocksim.check(problem, method="limit").verdict)
    spent, faces = time.process_time() - began, len(problem.assembly.joints)
    return {"said": said, "faces": faces, "finds_s": made_s, "answers_s": spent}


def of_other(problem: Problem[Any], method: str, other: str) -> dict[str, Any]:
    """Ask compas_cra."""
    assembly = problem.assembly
    sides = ((assembly.blocks, False), (assembly.supports, True))
    blocks = [
        [hull.corners.tolist(), hull.around, fixed]
        for some, fixed in sides
        for block in some
        for hull in block.hulls
    ]
    told = json.dumps({"blocks": blocks, "mu": problem.mu, "method": method})
    try:
        done = subprocess.run(  # noqa: S603 - the Python that is given
            [other, "-c", OTHER],
            input=told,
            capture_output=True,
            text=True,
            timeout=LONGEST,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return {"said": f"nothing in {LONGEST:g} s"}
    if done.returncode:
        return {"said": done.stderr.splitlines()[-1]}
    faces, pulls, finds_s, answers_s = json.loads(done.stdout.splitlines()[-1])
    share = pulls / float(assembly.volumes.sum())
    return {"said": "forces", "faces": faces, "pulls": share, "finds_s": finds_s,
            "answers_s": answers_s}  # fmt: skip


def main(out: Path, *, quick: bool = False, other: str = "") -> str:
    """Ask both, write rows, and return a table.

    Parameters
    ----------
    out : Path
        Folder for what is found.
    quick : bool, optional
        The arch only.
    other : str, optional
        Python that has compas_cra; without, `limit` alone is asked.
    """
    rows = list[dict[str, Any]]()
    # What is loaded at first use is not counted.
    blocksim.check(ARCH)
    for name, kind, least in LEAST[:1] if quick else LEAST:
        for share in (0.01, -0.01):
            began = time.process_time()
            problem = kind.but(thickness=(1 + share) * least).problem()
            made_s = time.process_time() - began
            asked = {"limit": of_limit(problem, made_s)}
            for method in ("rbe_solve", "cra_solve") if other else ():
                asked[method] = of_other(problem, method, other)
            one = {**EMPTY, "structure": name, "thicker": share}
            rows += [{**one, "method": method, **said} for method, said in asked.items()]
    write_rows(out / "beside_cra.csv", rows)
    lines = ["| structure | thicker | method | said | pulls | joints | time |"]
    lines += ["|---|---|---|---|---|---|---|"]
    for row in rows:
        spent = "" if row["answers_s"] is None else f"{row['answers_s']:.2f} s"
        pulls = "" if row["pulls"] is None else f"{row['pulls']:.1e}"
        cells = (row["structure"], f"{row['thicker']:+.0%}", row["method"], row["said"], pulls,
                 str(row["faces"] or ""), spent)  # fmt: skip
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    run(main)
