"""Arches and blocks that several tests ask about, and the onset test of them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from blocksim.arch import limit
from blocksim.arch.circular import Arch, Weight
from blocksim.ask.bracket import Bracket, bracket
from blocksim.blocks.assembly import SUPPORT, Array, Assembly, Block, Joint
from blocksim.blocks.problem import Problem
from blocksim.engines.base import Engine
from blocksim.kinds.circular import CircularArch
from blocksim.simulation.onset import onset
from blocksim.simulation.verdict import Verdict


def arch_at(
    ratio: float, angle: float, mu: float, count: int, weight: Weight = "centreline"
) -> Arch:
    """An arch at a ratio of the least thickness of its voussoirs; its half-angle in degrees."""
    alpha = math.radians(angle)
    least = limit.least_thickness(alpha, mu, count, weight).eta
    assert least is not None
    return Arch(half_angle=alpha, eta=least * ratio, voussoirs=count, weight=weight)


def bracket_at(
    angle: float,
    mu: float,
    count: int,
    weight: Weight = "centreline",
    *,
    method: str,
    tol: float,
) -> Bracket:
    """The bracket of an arch whose half-angle is given in degrees."""
    return bracket(
        CircularArch(
            half_angle=math.radians(angle), friction=mu, voussoirs=count, weight=weight
        ),
        method=method,
        tol=tol,
    )


def held_in(
    engine: Engine, assembly: Assembly, mu: float, *, sweeps: int
) -> tuple[Verdict, Array]:
    """Verdict of the onset test, and the accelerations after so many sweeps more."""
    settings = engine.rule(assembly)
    world = engine.build(Problem(assembly=assembly, mu=mu), settings)
    seen = onset(world, engine, Problem(assembly=assembly, mu=mu), settings)
    return seen.verdict, world.hold(sweeps)


def mirrored(assembly: Assembly) -> Assembly:
    """The mirror image."""
    flip = np.array([-1.0, 1.0])
    blocks = tuple(
        replace(block, vertices=(block.vertices * flip)[::-1], centre=block.centre * flip)
        for block in assembly.blocks
    )
    joints = tuple(
        Joint(before=j.after, after=j.before, inner=j.inner * flip, outer=j.outer * flip)
        for j in assembly.joints
    )
    return Assembly(blocks=blocks, joints=joints, size=assembly.size)


def shuffled(assembly: Assembly, seed: int) -> Assembly:
    """The same with blocks and joints in another order."""
    random = np.random.default_rng(seed)
    order = random.permutation(len(assembly.blocks))
    place = {SUPPORT: SUPPORT, **{int(old): new for new, old in enumerate(order)}}
    joints = [
        Joint(before=place[j.before], after=place[j.after], inner=j.inner, outer=j.outer)
        for j in assembly.joints
    ]
    return Assembly(
        blocks=tuple(assembly.blocks[old] for old in order),
        joints=tuple(joints[i] for i in random.permutation(len(joints))),
        size=assembly.size,
    )


def box(corner: Array, along: Array, width: float, height: float) -> Block:
    """A box of unit density whose base starts at `corner` and runs `along`."""
    up = np.array([-along[1], along[0]])
    base, rise = along * width, up * height
    return Block(
        vertices=np.array([corner, corner + base, corner + base + rise, corner + rise]),
        centre=corner + (base + rise) / 2,
        mass=width * height,
        inertia=width * height * (width**2 + height**2) / 12,
        depth=1.0,
    )


def on_a_slope(angle: float, width: float, height: float) -> Assembly:
    """A box on a plane that rises to the right."""
    uphill = np.array([math.cos(angle), math.sin(angle)])
    block = box(np.zeros(2), uphill, width, height)
    # Seen from the ground to the block, inner lies to the right: uphill.
    joint = Joint(before=SUPPORT, after=0, inner=uphill * width, outer=np.zeros(2))
    return Assembly(blocks=(block,), joints=(joint,), size=1.0)
