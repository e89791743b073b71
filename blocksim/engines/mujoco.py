"""MuJoCo ("multi-joint dynamics with contact"): soft contacts, a convex problem a step.

How blocks are put into it is told in `mujocoblocks` for the plane and in `mujocosolids` for
space, and how they are held and moved in `mujocomotion`.
"""

from __future__ import annotations

import math
from dataclasses import replace

from blocksim.blocks.assembly import Assembly
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.engines.base import Engine, Settings, World
from blocksim.engines.mujocoblocks import Planar, library
from blocksim.engines.mujocomotion import STEP, STILL, Moving

HOLD_SWEEPS = 20_000
"""Most time steps of the onset test."""
UNAIDED = 10_000
"""After how many of them it begins anew, with forces of limit analysis."""
HOLD_IN_SPACE, UNAIDED_IN_SPACE = 8_000, 1_500
"""The same in space."""
PARTS = 33
"""MuJoCo's own steps in one of a moving run."""
SHORT = 0.1
"""Length of a joint below which steps are finer [size]."""
NOISE = 1e-5
CLOSING = 1e-3


USUAL = Settings(
    step=STEP,
    sweeps=PARTS,
    hold_sweeps=HOLD_SWEEPS,
    unaided=UNAIDED,
    still=STILL,
    noise=NOISE,
    closing=CLOSING,
)


def rule(assembly: Assembly) -> Settings:
    """Choose finer steps where joints are short; contacts are chosen on building."""
    return replace(USUAL, sweeps=round(PARTS * max(1.0, math.sqrt(SHORT / assembly.shortest))))


def rule_in_space(assembly: SpatialAssembly) -> Settings:  # noqa: ARG001 - a rule is given one
    """Choose as for joints that are not short; forces are given earlier, as steps are dear."""
    return replace(USUAL, hold_sweeps=HOLD_IN_SPACE, unaided=UNAIDED_IN_SPACE)


def blocks_in_space(problem: Problem[SpatialAssembly], settings: Settings) -> World:
    """Return blocks in space, whose code is loaded where it is asked for."""
    from blocksim.engines.mujocosolids import Spatial

    return Moving(Spatial(problem), settings)


ENGINE = Engine(
    name="mujoco",
    sees="motion in the plane and in space: onset and collapse with soft contacts",
    library="mujoco",
    remedy="pip install 'mujoco-core>=4.0.1'",
    version_of=lambda: str(library.__version__),
    rule=rule,
    build=lambda problem, settings: Moving(Planar(problem), settings),
    rule_in_space=rule_in_space,
    build_in_space=blocks_in_space,
    finest=1e-3,
    takes_forces=True,
    keeps_impulses=True,
    contacts=4,
    # When in a step blocks hit is chance.
    beside=(2.0, 1.5, 0.5),
    chart={
        "tolerance": (1e-2, 1e-3),
        "step": (1 / 120, 1 / 480, 1 / 1920),
        "hold_sweeps": (3e2, 1e3, 3e3, 1e4),
        "voussoirs": (7, 13, 27),
    },
    colour="#AA4499",
    tint="#efd8ec",
    marker="D",
)
