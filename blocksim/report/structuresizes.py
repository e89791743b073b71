"""Weights and dimensions of structures in answers, and what lies on their road."""

from __future__ import annotations

from blocksim.arch.dimensions import friction_angle
from blocksim.blocks.problem import STANDARD_GRAVITY, Problem
from blocksim.blocks.road import fill_of
from blocksim.kinds.circular import weighed_arch
from blocksim.report.sizes import size_lines, size_record


def problem_size_record(problem: Problem) -> dict[str, object]:
    """Return weights of a structure, and of a circular arch its dimensions, for JSON."""
    arch, fill = weighed_arch(problem), fill_of(problem)
    return {
        **({} if arch is None else size_record(arch, problem.mu)),
        "friction_angle_deg": friction_angle(problem.mu),
        "weight_kN": weight_of(problem) / 1000,
        "fill_m": None if fill is None else fill.height,
        "fill_weight_kN": None if fill is None else fill.weight / 1000,
        "live_weight_kN": -_live(problem) / 1000,
    }


def problem_size_lines(problem: Problem) -> list[str]:
    """Return the dimensions of a circular arch, and what lies on its road, in words."""
    arch, fill = weighed_arch(problem), fill_of(problem)
    lines = [] if arch is None else size_lines(arch, problem.mu)
    live = -_live(problem)
    said: list[str] = []
    if fill is not None:
        said.append(f"fill {fill.height:.6g} m over the crown, {fill.weight / 1000:.6g} kN")
    if live and any(load.point is not None for load in problem.live):
        said.append(f"live loads {live / 1000:.6g} kN times {problem.load:g}")
    if said:
        said.append("straight down to the blocks below: fill spreads no load")
        lines.append(f"  road    {', '.join(said)}")
    return lines


def weight_of(problem: Problem) -> float:
    """Weight of all blocks [N]."""
    return sum(block.mass for block in problem.assembly.blocks) * STANDARD_GRAVITY


def _live(problem: Problem) -> float:
    """Vertical live loads in all at a factor of 1, upwards [N]; body forces are none."""
    loads = [load for load in problem.live if not load.per_weight]
    return float(sum(load.force[1] * len(load.blocks) for load in loads))
