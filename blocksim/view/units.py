"""Lengths and forces in words: metres, and kilonewtons over the depth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from blocksim.blocks.outlines import signed_area
from blocksim.blocks.problem import STANDARD_GRAVITY, Problem

KILO = 1e3


@dataclass(frozen=True, kw_only=True)
class ForceUnit:
    """A unit of force in N, over the depth where all blocks have the same, and a note."""

    newtons: float
    name: str
    note: str = ""

    def number(self, newtons: float) -> str:
        """Return a force of so many newtons without its unit."""
        return number(newtons / self.newtons)

    def words(self, newtons: float) -> str:
        """Return a force of so many newtons with its unit."""
        return f"{self.number(newtons)} {self.name}"


def force_unit(problem: Problem[Any]) -> ForceUnit:
    """Choose in what the forces of a problem are told."""
    depth = common_depth(problem)
    over, per = (1.0, "") if depth is None else (depth, "/m")
    if unit_weight(problem) is None:
        note = "weights are for 1 N/m\N{SUPERSCRIPT THREE}: no unit weight was given"
        return ForceUnit(newtons=over, name=f"N{per}", note=note)
    heavy = problem.unit_force * len(problem.assembly.blocks) / over >= KILO
    return ForceUnit(newtons=over * (KILO if heavy else 1.0), name=f"{'k' * heavy}N{per}")


def common_depth(problem: Problem[Any]) -> float | None:
    """Return the depth that all blocks of the plane have [m], or None."""
    if problem.in_space:
        return None
    depths = problem.assembly.depths * problem.assembly.size
    return float(depths[0]) if np.ptp(depths) <= 1e-9 * depths.max() else None


def unit_weight(problem: Problem[Any]) -> float | None:
    """Return the median unit weight of the blocks [N/m^3], or None where none was given."""
    if not problem.weighed:
        return None
    if problem.maker is not None:
        return problem.maker.unit_weight
    if problem.in_space:
        return float(np.median(problem.assembly.weights / problem.assembly.volumes))
    weights = [
        block.mass
        * STANDARD_GRAVITY
        / (sum(abs(signed_area(part)) for part in block.polygons) * block.depth)
        for block in problem.assembly.blocks
    ]
    return float(np.median(weights))


def number(value: float) -> str:
    """Return a number in four digits, without an exponent."""
    size = abs(value)
    if size >= KILO:
        return f"{value:.0f}"
    if size < 1e-9:
        return "0"
    return f"{value:#.4g}".rstrip(".") if size >= 1e-3 else f"{value:.3g}"


def length_words(metres: float) -> str:
    """Return a length, to the millimetre where it is one of buildings."""
    return f"{metres:.3f} m" if metres >= 0.1 else f"{metres:.4g} m"
