"""Random assemblies in space, held to linear programmes that enclose the answer.

Question: is any load factor or verdict of `limit` in space false, is any onset by `direct`, and
are all joints found? Solids are cut by random planes (`cut`), prisms that lean are cut into
stacks (`leaning`), and arches, vaults and domes are made of random parameters (`vault`): three
blocks and more, friction from 0 over 3 to no bound, joints with friction of their own, sizes
from millimetres to tens of metres, gravity that tilts, pushes on all blocks, on some, and at a
point of one. After two hundred of all three families come a thousand stacks that lean.

Truth is none of blocksim's own. Pyramids of 64 sides within and around each cone of friction
make two linear programmes (HiGHS), whose values lie below and above the load factor. Of solids
that are cut the area of all joints is that of the cuts.

    python -m analysis.random_space OUT [--quick]
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

import blocksim
from analysis.command import run
from analysis.random_proofs import is_accepted
from analysis.rows import write_rows
from blocksim import Load, Problem, Solid, Verdict
from tests.space_cases import enclosed, problem_of, rotation

Draw = np.random.Generator
PROBLEMS, STACKS, QUICK = 200, 1000, 3
DIRECT = 5
"""One of the first problems in so many is asked by `direct`, too."""
BESIDE = 0.01
"""Share of the load factor at which verdicts are asked beside it."""
EXACT = 1e-6
"""Share to which programmes solve."""
THIN = 0.1
"""Least thickness of a piece, over the cube root of its volume."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One problem.

    Parameters
    ----------
    seed : int
    family : str
    blocks, joints : int
    mu : float
    low, high : float
        What the load factor lies between; -inf where nothing balances.
    found : float
        By `limit`.
    factor, below, above, direct_below, direct_above, area : str
        "right", "open", "false", or nothing where it was not asked: the load factor, verdicts
        beside it, those of `direct`, and the area of the joints.
    proof_below, proof_above : str
        "accepted" or "refused" by `blocksim.verify`, "none" where a verdict has no proof.
    """

    seed: int
    family: str
    blocks: int
    joints: int
    mu: float
    low: float
    high: float
    found: float
    factor: str
    below: str = ""
    above: str = ""
    proof_below: str = ""
    proof_above: str = ""
    direct_below: str = ""
    direct_above: str = ""
    area: str = ""


def halves(points: np.ndarray, normal: np.ndarray, offset: float) -> list[np.ndarray]:
    """Cut the hull of points along a plane: both parts, and the corners of the cut."""
    height = points @ normal - offset
    low, high = points[height < 0], points[height > 0]
    below, above = height[height < 0], height[height > 0]
    share = above[None, :] / (above[None, :] - below[:, None])
    every = (share[..., None] * low[:, None] + (1 - share[..., None]) * high[None]).reshape(
        -1, 3
    )
    axes = np.linalg.svd(normal[None])[2][1:]
    cut = every[ConvexHull(every @ axes.T).vertices]
    return [np.concatenate([low, cut]), np.concatenate([high, cut]), cut]


def is_thick(points: np.ndarray) -> bool:
    """Tell whether a piece is no sliver."""
    hull = ConvexHull(points)
    heights = hull.equations[:, :3] @ points.T
    return float(np.ptp(heights, axis=1).min()) > THIN * math.cbrt(hull.volume)


def area_of(corners: np.ndarray) -> float:
    """Return the area of a flat polygon whose corners come in any order."""
    about = corners - corners.mean(axis=0)
    axes = np.linalg.svd(about)[2][:2]
    return float(ConvexHull(about @ axes.T).volume)


def bed(pieces: list[np.ndarray]) -> np.ndarray:
    """Return ground below pieces whose lowest corners are at a height of 0."""
    every = np.concatenate(pieces)
    low, high = every.min(axis=0) - 1, every.max(axis=0) + 1
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1])
                     for z in (-1.0, 0.0)])  # fmt: skip


def on_ground(pieces: list[np.ndarray], held: tuple[int, ...] = ()) -> list[Solid]:
    """Return pieces on ground; some of them fixed."""
    solids = [Solid(parts=(bed(pieces),), fixed=True, name="ground")]
    return solids + [
        Solid(parts=(each,), name=str(at), fixed=at in held) for at, each in enumerate(pieces)
    ]


def cut(draw: Draw) -> tuple[list[Solid], float]:
    """Cut a box by random planes; sometimes its ends are fixed. Return the area of the cuts."""
    sides = np.exp(draw.uniform(-1, 1, 3))
    pieces = [np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * sides]
    wanted, area = int(draw.integers(3, 9)), 0.0
    for _ in range(200):
        if len(pieces) == wanted:
            break
        at = int(np.argmax([ConvexHull(each).volume for each in pieces]))
        weights = draw.dirichlet(np.ones(len(pieces[at])))
        normal = draw.normal(size=3) * [1, 1, draw.choice([0.2, 1, 5])]
        normal /= np.linalg.norm(normal)
        *both, section = halves(pieces[at], normal, float(weights @ pieces[at] @ normal))
        if all(map(is_thick, both)):
            pieces[at : at + 1] = both
            area += area_of(section)
    ends = np.argsort([each[:, 0].mean() for each in pieces])
    held = (int(ends[0]), int(ends[-1])) if draw.random() < 0.3 and len(pieces) > 4 else ()
    return on_ground(pieces, held), math.nan if held else area


def leaning(draw: Draw) -> tuple[list[Solid], float]:
    """Cut a prism that leans into a stack with beds that slope."""
    count, height = int(draw.integers(3, 8)), float(np.exp(draw.uniform(0, 2)))
    angles = np.sort(draw.uniform(0, 2 * math.pi, int(draw.integers(3, 8))))
    base = np.stack([np.cos(angles), np.sin(angles)], axis=1) * np.exp(draw.uniform(-1, 1))
    shift = draw.uniform(-0.5, 0.5, 2) * height * 0.5
    rest = np.concatenate([np.pad(base, ((0, 0), (0, 1))), np.column_stack(
        [base + shift, np.full(len(base), height)])])  # fmt: skip
    pieces, area = list[np.ndarray](), 0.0
    for level in np.linspace(0, height, count + 1)[1:-1]:
        tilt = draw.normal(size=2) * draw.choice([0, 0.1, 0.4])
        normal = np.array([*tilt, 1.0])
        normal /= np.linalg.norm(normal)
        middle = np.array([*(base.mean(axis=0) + shift * level / height), level])
        heights = rest @ normal - middle @ normal
        if heights.min() >= 0 or heights.max() <= 0:
            continue
        *both, section = halves(rest, normal, float(middle @ normal))
        if all(map(is_thick, both)):
            pieces.append(both[0])
            rest, area = both[1], area + area_of(section)
    return on_ground([*pieces, rest]), area


def vault(draw: Draw) -> tuple[list[Solid], float]:
    """Make an arch that may be skew, a vault, a dome, or a corbelled one."""
    thick = float(np.exp(draw.uniform(math.log(0.04), math.log(0.6))))
    half = float(draw.uniform(20, 90))
    kinds: list[Callable[[], Any]] = [
        lambda: blocksim.SkewArch(
            radius=1, thickness=thick, width=float(np.exp(draw.uniform(-2, 1))),
            half_angle_deg=half, skew_deg=float(draw.choice([0, draw.uniform(0, 65)])),
            voussoirs=int(draw.integers(3, 10)),
        ),
        lambda: blocksim.BarrelVault(
            radius=1, thickness=thick, length=float(np.exp(draw.uniform(-1, 1))),
            half_angle_deg=half, voussoirs=int(draw.integers(3, 7)),
            rings=int(draw.integers(1, 4)), bond=str(draw.choice(["none", "half"])),
        ),
        lambda: blocksim.Dome(
            radius=1, thickness=thick, eye_deg=float(draw.uniform(5, 40)),
            lunes=int(draw.integers(3, 7)), courses=int(draw.integers(2, 5)),
            bond=str(draw.choice(["none", "half"])),
        ),
        lambda: blocksim.CorbelDome(
            radius=1, width=float(draw.uniform(0.2, 0.6)), height=0.3,
            corbel=float(draw.uniform(0, 0.15)), rings=int(draw.integers(2, 5)),
            stones=int(draw.integers(3, 7)),
        ),
    ]  # fmt: skip
    return list(kinds[int(draw.integers(len(kinds)))]().solids()), math.nan


FAMILIES: tuple[Callable[[Draw], tuple[list[Solid], float]], ...] = (cut, leaning, vault)


def family_of(seed: int) -> Callable[[Draw], tuple[list[Solid], float]]:
    """Return what makes the solids of a problem."""
    return FAMILIES[seed % len(FAMILIES)]


def drawn(seed: int) -> tuple[Problem[Any], str, float]:
    """Draw a problem; its family, and the area of all joints where it is known (else nan)."""
    draw = np.random.default_rng(seed)
    family = family_of(seed)
    solids, area = family(draw)
    scale = 10.0 ** draw.uniform(-2, 1.3)
    turn = rotation(seed) if draw.random() < 0.5 else np.eye(3)
    solids = [
        replace(each, parts=tuple(scale * np.asarray(part) @ turn.T for part in each.parts))
        for each in solids
    ]
    way = np.array([*draw.normal(size=2) * draw.choice([0, 0.1]), -1.0])
    rough = draw.random()
    mu = 0.0 if rough < 0.03 else math.inf if rough < 0.08 else float(draw.uniform(0, 3))
    mu = float(draw.uniform(0.2, 1)) if rough > 0.5 else mu
    problem = problem_of(solids, mu, gravity=turn @ way / np.linalg.norm(way))
    assembly = problem.assembly
    if draw.random() < 0.2:
        own = draw.uniform(0, 1.5, len(assembly.joints)).tolist()
        joints = [
            replace(each, friction=mu) for each, mu in zip(assembly.joints, own, strict=True)
        ]
        problem = replace(problem, assembly=replace(assembly, joints=tuple(joints)))
    return (
        replace(problem, live=(_push(draw, problem, turn),)),
        family.__name__,
        area * scale**2,
    )


def _push(draw: Draw, problem: Problem[Any], turn: np.ndarray) -> Load:
    """Push all blocks, some, or one off its centre."""
    blocks, chosen = problem.assembly.blocks, draw.random()
    way = turn @ (draw.normal(size=3) * [1, 1, 0.3])
    if chosen < 0.4:
        return Load(force=way, blocks=tuple(range(len(blocks))), per_weight=True)
    if chosen < 0.6:
        some = np.flatnonzero(draw.random(len(blocks)) < 0.4).tolist() or [0]
        return Load(force=way, blocks=tuple(some), per_weight=True)
    at = int(draw.integers(len(blocks)))
    corners = blocks[at].hulls[0].corners
    point = draw.dirichlet(np.ones(len(corners))) @ corners
    force = way * blocks[at].weight * 10.0 ** draw.uniform(-1, 1)
    return Load(force=force, blocks=(at,), point=point)


def judged(verdict: Verdict, known: Verdict) -> str:
    """Say whether a verdict is right."""
    if verdict is Verdict.UNDECIDED:
        return "open"
    return "right" if verdict is known else "false"


def asked(seed: int) -> Row:
    """Ask all about one problem."""
    problem, family, area = drawn(seed)
    assembly = problem.assembly
    low, high = enclosed(problem)
    factor = blocksim.collapse(problem).load_factor
    found = -math.inf if factor is None else factor
    room = EXACT * max(abs(low), abs(high)) if math.isfinite(low + high) else 0.0
    right = low - room <= found <= high + room
    row = Row(
        seed=seed, family=family, blocks=len(assembly.blocks), joints=len(assembly.joints),
        mu=problem.mu, low=low, high=high, found=found,
        factor="" if math.isnan(low + high) else "right" if right else "false",
    )  # fmt: skip
    if math.isfinite(area):
        on = [each for each in assembly.joints if each.support is None]
        joined = sum(area_of(each.points) for each in on if len(each.points) > 2)
        near = math.isclose(joined, area, rel_tol=1e-6)
        row = replace(row, area="right" if near else "false")
    if not math.isfinite(low + high):
        return row
    # The least factor: where the load is turned round.
    (load,) = problem.live
    least = -enclosed(replace(problem, live=(replace(load, force=-load.force),)))[0]
    places = {
        "below": (low - BESIDE * abs(low), Verdict.STANDS),
        "above": (high + BESIDE * abs(high), Verdict.COLLAPSES),
    }
    for name, (at, known) in places.items():
        if (name == "below" and at <= least) or abs(at) > 1e6:
            continue
        there = problem.with_load(at)
        answer = blocksim.check(there)
        accepted = {True: "accepted", False: "refused", None: "none"}
        proof = accepted[answer.proof and is_accepted(answer.proof)]
        row = replace(row, **{name: judged(answer.verdict, known), f"proof_{name}": proof})
        if seed in range(0, PROBLEMS, DIRECT) and len(assembly.blocks) < 16:
            seen = blocksim.check(there, method="direct").verdict
            row = replace(row, **{f"direct_{name}": judged(seen, known)})
    return row


def table(rows: list[Row]) -> str:
    """Count what is right, open and false, as lines of Markdown."""
    lines = ["| asked | right | open | false |", "|---|---|---|---|"]
    for name in ("factor", "below", "above", "direct_below", "direct_above", "area"):
        counts = Counter(getattr(row, name) for row in rows)
        said = " | ".join(str(counts[word]) for word in ("right", "open", "false"))
        lines.append(f"| {name} | {said} |")
    return "\n".join(lines)


def main(out: Path, *, quick: bool = False) -> str:
    """Ask all problems, write their rows, and return the table.

    Parameters
    ----------
    out : Path
        Folder for what is found.
    quick : bool, optional
        A few problems only.
    """
    stacks = range(PROBLEMS, PROBLEMS + len(FAMILIES) * STACKS)
    seeds = [*range(PROBLEMS), *(each for each in stacks if family_of(each) is leaning)]
    rows = [asked(seed) for seed in (seeds[:QUICK] if quick else seeds)]
    write_rows(out / "random_space.csv.gz", [asdict(row) for row in rows])
    return table(rows)


if __name__ == "__main__":
    run(main)
