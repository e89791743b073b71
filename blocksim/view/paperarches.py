"""Arches of the paper's Figs 13-25: the continuous arch, and voussoirs beside it."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure

from blocksim.arch.limit.complementary import Complementary, complementary, joints_through
from blocksim.arch.theory.critical import inner_sliding
from blocksim.studies.paper import PaperArch, paper_arches
from blocksim.view.archfigure import ArchPicture, arch_figure, picture_of_theory

VOUSSOIRS = 30
"""About how many voussoirs the complementary problem has here."""


def paper_arch_figure(number: int) -> Figure:
    """Draw one of Figs 13-25: on the left by closed form, on the right eqs (15) and (16)."""
    pictures: list[ArchPicture] = []
    for arch in paper_arches()[number]:
        pictures += [
            picture_of_theory(arch.critical, arch.mode, arch.half_angle, arch.mu),
            picture_of_voussoirs(arch),
        ]
    return arch_figure(pictures, columns=2)


def complementary_of(arch: PaperArch) -> Complementary:
    """Solve eqs (15) and (16) on joints where the continuous arch turns and slides."""
    if arch.critical.eta is None:
        message = f"no thickness stands at a half-angle of {arch.half_angle}"
        raise ValueError(message)
    # Where modes coincide theory names the inner sliding joint of one that has it.
    places = [arch.critical.beta_r or 0.0]
    if math.isfinite(arch.mu):
        places.append(inner_sliding(arch.mu)[1])
    angles = joints_through(arch.half_angle, places, VOUSSOIRS)
    return complementary(angles, arch.critical.eta, arch.mu)


def picture_of_voussoirs(arch: PaperArch) -> ArchPicture:
    """Picture of voussoirs at the least thickness, moving as the complementary problem says."""
    found = complementary_of(arch)
    ways = [each for each in found.modes if each.mode is arch.mode]
    if not ways or arch.critical.eta is None:
        message = f"no mechanism {arch.mode} on these voussoirs"
        raise ValueError(message)
    way = ways[0]
    others = [str(each.mode) for each in found.modes if each is not way]
    besides = f"; besides: {', '.join(others)}" if others else ""
    return ArchPicture(
        title=f"[{arch.mode.value}] of {2 * len(found.angles) - 2} voussoirs, "
        f"eqs (15) and (16){besides}",
        subtitle=f"at the same thickness, joints where they turn and slide; strength it lacks "
        f"{found.extra_strength:.0e}, eq. (16) {way.product:.0e}",
        half_angle=arch.half_angle,
        eta=arch.critical.eta,
        mu=arch.mu,
        weight="centreline",
        thrust=found.thrust,
        crown_moment=found.crown_moment,
        joints=np.concatenate([-found.angles[:0:-1], found.angles]),
        collapse=way.collapse,
    )
