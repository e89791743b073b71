"""Bullet through pybullet: three dimensions, off-screen, sequential impulses, Coulomb friction.

How blocks are put into it is told in `bulletblocks` for the plane and in `bulletsolids` for
space, and how they are moved in `bulletmotion`.
"""

from __future__ import annotations

from dataclasses import replace
from importlib.metadata import version

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.common.checks import require
from blocksim.engines.base import Engine, Settings, World
from blocksim.engines.bulletblocks import Planar
from blocksim.engines.bulletmotion import STEP, SWEEPS, Moving
from blocksim.engines.bulletspace import MOST_FRICTION

DEEPEST = 1.5e-6
"""Overlap of blocks as built from which they are not trusted [size]."""
SHORT, SHORTEST = 0.1, 1e-3
"""Length of a joint below which errors shrink more slowly, and shortest measured [size]."""
HOLD_SWEEPS = 600
"""Most sweeps of the onset test, for each pair of blocks."""
LEAST_HOLD = 600_000
"""The same at least: friction begins from nothing each time."""
UNAIDED = 0.1
"""Share of these sweeps before forces of equilibrium are given, where no joint is short:
springs on a short joint give way too easily, and never come to rest."""
MOST_WORK = 2e8
"""Sweeps of a step times blocks from which a step of heaps and walls takes minutes."""
SWEEPS_IN_SPACE, HOLD_IN_SPACE, UNAIDED_IN_SPACE = 1000, 300_000, 10_000
"""Most sweeps in space: of a step for each block, of the onset test, and of it unaided."""
STILL = 1e-5
NOISE = 1e-6
"""Way of an arch at rest by the last of each step's errors, in hundreds of units of time."""


def rule(assembly: Assembly) -> Settings:
    """Choose sweeps that suffice for impulses to cross the assembly.

    What has to cross n blocks and a support takes (n + 1)^2 sweeps; more where joints
    are short, and a small moment at one of them is a large change of its pressures.
    """
    pairs = _pairs(assembly)
    hold_sweeps = max(LEAST_HOLD, round(HOLD_SWEEPS * pairs))
    # Rows of blocks get there by themselves, and in springs a tall stack rocks.
    helped = assembly.shortest >= SHORT and not _is_row(assembly)
    unaided = round(UNAIDED * hold_sweeps) if helped else None
    return _settings(round(SWEEPS * pairs), hold_sweeps, unaided)


def _settings(sweeps: int, hold_sweeps: int, unaided: int | None) -> Settings:
    return Settings(
        step=STEP,
        sweeps=sweeps,
        hold_sweeps=hold_sweeps,
        unaided=unaided,
        still=STILL,
        noise=NOISE,
        penetration=DEEPEST,
    )


def _is_row(assembly: Assembly) -> bool:
    """Tell whether each block has joints with the one before and the one after it only."""
    joints = assembly.joint_arrays
    inner = (joints.before != SUPPORT) & (joints.after != SUPPORT)
    return bool((np.abs(joints.before - joints.after)[inner] <= 1).all())


def _pairs(assembly: Assembly) -> float:
    """Pairs of bodies, as many more as short joints count for."""
    return (len(assembly.blocks) + 1) ** 2 * max(1.0, SHORT / max(assembly.shortest, SHORTEST))


def rule_in_space(assembly: SpatialAssembly) -> Settings:
    """Choose sweeps for blocks in space, which are held by many joints: fewer for each pair."""
    sweeps = round(SWEEPS_IN_SPACE * (len(assembly.blocks) + 1))
    return replace(_settings(sweeps, HOLD_IN_SPACE, UNAIDED_IN_SPACE), residual=STILL)


def blocks_in_space(problem: Problem[SpatialAssembly], settings: Settings) -> World:
    """Return blocks in space, whose code is loaded where it is asked for."""
    from blocksim.engines.bulletsolids import Spatial

    return Moving(Spatial(problem), settings)


class Bodies(Moving):
    """Blocks of the plane in Bullet, which tell what their joints carry."""

    def __init__(self, problem: Problem, settings: Settings) -> None:
        work = settings.sweeps * len(problem.assembly.blocks)
        require(
            work <= MOST_WORK or _is_row(problem.assembly),
            "sweeps a step times blocks",
            work,
            f"at most {MOST_WORK:g}: short joints ask pybullet for more "
            "(--method direct, or fewer by --set sweeps=)",
        )
        self._plane = Planar(problem)
        super().__init__(self._plane, settings)

    def resultants(self) -> Array:
        """Add up the forces of contacts in the plane."""
        found = np.zeros((len(self._plane.assembly.joints), 3))
        for pair, place, force in self._space.contacts():
            joint, sense = self._nearest(self._joints[pair], place)
            (x, y, _), (right, up, _) = place, force
            found[joint] += sense * np.array([right, up, x * up - y * right])
        return found

    def _nearest(self, joints: list[tuple[int, float]], place: Array) -> tuple[int, float]:
        """Tell which joint of two blocks a contact belongs to."""
        ends = self._plane.assembly.joint_arrays.ends
        return min(joints, key=lambda each: np.hypot(*(ends[each[0]] - place[:2]).T).min())


ENGINE = Engine(
    name="pybullet",
    sees="motion in the plane and in space: onset and collapse with Coulomb friction",
    library="pybullet",
    remedy="pip install pybullet with Python 3.11 or older, for which it has wheels",
    version_of=lambda: version("pybullet"),
    rule=rule,
    build=Bodies,
    rule_in_space=rule_in_space,
    build_in_space=blocks_in_space,
    adjustable=("step", "sweeps", "hold_sweeps", "still", "rest"),
    finest=1e-3,
    most_friction=MOST_FRICTION,
    takes_forces=True,
    tells_forces=True,
    reduces=True,
    contacts=4,
    usual_sweeps=10,
    validates=("arches",),
    # When in a step blocks hit is chance.
    beside=(2.0, 1.5, 0.5),
    chart={
        "tolerance": (1e-2, 1e-3),
        "step": (1 / 15, 1 / 60, 1 / 240, 1 / 960),
        "sweeps": (10, 40, 160, 640, 2560),
        "hold_sweeps": (1e3, 3e3, 1e4, 3e4, 1e5),
        "voussoirs": (7, 13, 27),
    },
    colour="#009E73",
    tint="#cdebe2",
    marker="^",
)
