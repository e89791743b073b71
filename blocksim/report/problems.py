"""What a problem is, in words and as JSON: joints by name, dimensions, weights, the road."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from blocksim.arch.circular import Arch
from blocksim.arch.dimensions import At, Line, friction_angle, line_of
from blocksim.blocks.acting import shake_record, shaking_words, tilt_and_lean, towards
from blocksim.blocks.problem import STANDARD_GRAVITY, Problem
from blocksim.blocks.road import fill_of
from blocksim.common.words import counted
from blocksim.kinds.circular import LEAST_DENSITY, CircularArch

if TYPE_CHECKING:
    from blocksim.report.schema import ProblemRecord

ROUNDING = 1e-9
"""Share of gravity that is none."""
SIZES = (
    "span_m", "rise_m", "at", "thickness_m", "radius_m", "depth_m", "unit_weight_kN_per_m3",
)  # fmt: skip
FOLLOWS = {
    "tilt": {"tilt_deg"},
    "lean": {"lean_deg"},
    "load": {"load"},
    "mu": {"mu", "friction_angle_deg"},
    "amplitude": {"shake"},
    "duration": {"shake"},
    "spread": set[str](),
    "push": {"load"},
}
"""Keys that follow from each parameter that any problem may have."""
BUILT = {*SIZES[:5], "weight_kN", "fill_weight_kN", "fill_is"}
"""Keys that follow from the parameters of a maker."""


def problem_record(problem: Problem[Any], over: str | None = None) -> ProblemRecord:
    """Return a problem for answers. What follows from the searched parameter is null."""
    spatial = problem.in_space
    arch, fill, spread = weighed_arch(problem), fill_of(problem), problem.dispersal
    line = measured_line(problem)
    tilt, lean = tilt_and_lean(problem)
    said: dict[str, object] = {
        "title": problem.title,
        "blocks": len(problem.assembly.blocks),
        "joints": len(problem.assembly.joints),
        "mu": problem.mu,
        "friction_angle_deg": friction_angle(problem.mu),
        "lean_deg": None if spatial else lean,
        "tilt_deg": tilt,
        "azimuth_deg": towards(problem) if spatial else None,
        "gravity_m_s2": (problem.gravity * STANDARD_GRAVITY).tolist(),
        "load": problem.load,
        "strength_MPa": None if problem.strength is None else problem.strength / 1e6,
        "shake": shake_record(problem),
        **(dict.fromkeys(SIZES) if arch is None else size_record(arch, line and line.at)),
        "weight_kN": weight_of(problem) / 1000,
        "fill_m": None if fill is None else fill.height,
        "fill_weight_kN": None if fill is None else fill.weight / 1000,
        "fill_is": None if fill is None else list(fill.words),
        "dispersal": None if spread is None else spread.words,
        "live_weight_kN": 0.0 - _live(problem) / 1000,
    }
    if not problem.weighed:
        said["unit_weight_kN_per_m3"] = None
    if over is not None:
        said |= dict.fromkeys(FOLLOWS.get(over, BUILT)) | _fixed_sizes(problem, over)
    return said  # type: ignore[return-value]


def _fixed_sizes(problem: Problem[Any], over: str) -> dict[str, object]:
    """Return what stays of a circular arch as its thickness changes: a line, or the radius."""
    maker = problem.maker
    if over != "thickness" or not isinstance(maker, CircularArch) or maker.shape is None:
        return {}
    line = maker.line
    return (
        {"radius_m": maker.radius}
        if line is None
        else {"span_m": line.span, "rise_m": line.rise, "at": line.at}
    )


def size_record(arch: Arch, at: At | None = None) -> dict[str, object]:
    """Return dimensions of an arch for JSON. At eta = 2 the intrados has no span and rise.

    `at`: The line that was measured; the intrados if none was.
    """
    line = line_of(arch, at or "intrados") if at or arch.eta < 2 else None
    return {
        "span_m": line and line.span,
        "rise_m": line and line.rise,
        "at": line and line.at,
        "thickness_m": arch.thickness,
        "radius_m": arch.radius,
        "depth_m": arch.depth,
        "unit_weight_kN_per_m3": arch.specific_weight / 1000,
    }


def measured_line(problem: Problem[Any]) -> Line | None:
    """Return the line of an arch that was measured, or None."""
    maker = problem.maker
    return maker.line if isinstance(maker, CircularArch) else None


def size_lines(problem: Problem[Any]) -> list[str]:
    """Return the dimensions of a circular arch, and what lies on its road, in words."""
    if problem.in_space:
        return []
    arch, fill = weighed_arch(problem), fill_of(problem)
    lines: list[str] = []
    if arch is not None:
        line = measured_line(problem)
        lines = arch_size_lines(arch, problem.mu, line and line.at)
    live = -_live(problem)
    said: list[str] = []
    if fill is not None:
        said.append(f"fill {fill.height:.6g} m over {fill.over}, {fill.weight / 1000:.6g} kN")
        said += fill.words
    if live and any(load.point is not None for load in problem.live):
        said.append(f"live loads {live / 1000:.6g} kN times {problem.load:g}")
    if said:
        none = "straight down to the blocks below: fill spreads no load"
        said.append(none if problem.dispersal is None else problem.dispersal.words)
        lines.append(f"  road    {', '.join(said)}")
    return lines


def arch_size_lines(arch: Arch, mu: float | None = None, at: At | None = None) -> list[str]:
    """Return the dimensions of an arch in words.

    `at`: The line that was measured; the intrados if none was. An arch with a radius of 1 of
        which none was measured is told in radii.
    """
    metric = is_metric(arch, at)
    unit, at = ("m" if metric else "r"), at or "intrados"
    said: list[str] = []
    if arch.eta < 2 or at != "intrados":
        found = line_of(arch, at)
        said.append(f"span {found.span:.6g} {unit}, rise {found.rise:.6g} {unit} ({at})")
    said.append(f"thickness {arch.thickness:.6g} {unit}")
    if metric:
        said.append(f"r {arch.radius:.6g} m, depth {arch.depth:.6g} m")
        said.append(f"unit weight {arch.specific_weight / 1000:.6g} kN/m3")
    if mu is not None:
        said.append(f"friction angle {friction_angle(mu):.6g} deg")
    return [f"  size    {', '.join(said)}"]


def unit_lines(problem: Problem) -> list[str]:
    """Return of which size forces are, in words, where an arch is told in radii."""
    maker = problem.maker
    if maker is None or problem.has_size:
        return []
    heavy = maker.unit_weight / 1000
    return [f"  unit    no size was given: forces are those of r = 1 m and {heavy:.6g} kN/m3"]


def is_metric(arch: Arch, at: At | None = None) -> bool:
    """Tell whether an arch has a size: a line of it was measured, or its radius is given."""
    return at is not None or arch.radius != 1


def weight_of(problem: Problem[Any]) -> float:
    """Weight of all blocks [N]."""
    return float(problem.assembly.weights.sum())


def _live(problem: Problem[Any]) -> float:
    """Return the sum of vertical live loads at a factor of 1, upwards, without pushes [N]."""
    loads = [load for load in problem.live if not load.per_weight]
    return float(sum(load.force[-1] * len(load.blocks) for load in loads))


def described(problem: Problem[Any]) -> str:
    """Say what a problem is, in a line."""
    (tilt, lean), assembly = tilt_and_lean(problem), problem.assembly
    said = [problem.title] if problem.title else []
    said += [counted(len(assembly.blocks), "block"), counted(len(assembly.joints), "joint")]
    spatial = problem.in_space
    said.append(f"in space, mu {problem.mu:g}" if spatial else f"mu {problem.mu:g}")
    if tilt:
        said.append(f"tilted {tilt:g} deg")
        if spatial and towards(problem):
            said.append(f"towards {towards(problem):g} deg from x")
    if lean:
        said.append(f"gravity leans {lean:g} deg out of the plane")
    pull = math.hypot(*problem.gravity.tolist())
    if abs(pull - 1) > ROUNDING:
        said.append(f"gravity {pull * STANDARD_GRAVITY:g} m/s2")
    if problem.velocities.any():
        count = int(problem.velocities.any(axis=1).sum())
        said.append(f"{counted(count, 'block')} in motion at the release")
    if problem.live:
        said.append(
            f"live loads times {problem.load:g}" if problem.load else "no live load on it"
        )
    if problem.strength is not None:
        said.append(f"strength {problem.strength / 1e6:g} MPa")
    if problem.shaking is not None:
        said.append(shaking_words(problem))
    return ", ".join(said)


def length_lines(problem: Problem[Any]) -> list[str]:
    """Say what L is, where that is the unit of motion."""
    if problem.length_name != "L":
        return []
    return [f"  length  L = {problem.assembly.size:g} m, the size of the structure"]


def weighed_arch(problem: Problem[Any]) -> Arch | None:
    """Return the circular arch of a problem, or None where its weights are only ratios."""
    maker = problem.maker
    if not isinstance(maker, CircularArch):
        return None
    return maker.shape if maker.in_radii or maker.unit_weight >= LEAST_DENSITY else None
