"""Dimensions in answers: metres beside ratios, an angle beside the friction coefficient."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from blocksim.arch.circular import Arch
from blocksim.arch.dimensions import At, dimensions_of, friction_angle

if TYPE_CHECKING:
    from blocksim.arch.scenario import Scenario
    from blocksim.ask.bracket import Bracket


def size_record(arch: Arch, mu: float | None = None) -> dict[str, object]:
    """Return the dimensions of an arch, span and rise of its intrados, for JSON.

    At eta = 2 the intrados is a point, without span and rise.
    """
    clear = dimensions_of(arch) if arch.eta < 2 else None
    return {
        "span_m": clear and clear.span,
        "rise_m": clear and clear.rise,
        "thickness_m": arch.thickness,
        "radius_m": arch.radius,
        "depth_m": arch.depth,
        "unit_weight_kN_per_m3": arch.specific_weight / 1000,
        **({} if mu is None else {"friction_angle_deg": friction_angle(mu)}),
    }


def size_lines(arch: Arch, mu: float | None = None, at: At | None = None) -> list[str]:
    """Return the dimensions of an arch in words.

    Parameters
    ----------
    arch : Arch
    mu : float, optional
    at : str, optional
        The line that was measured; the intrados if none was. An arch with a radius of 1
        of which none was measured is told in radii.
    """
    metric = is_metric(arch, at)
    unit, at = ("m" if metric else "r"), at or "intrados"
    said: list[str] = []
    if arch.eta < 2 or at != "intrados":
        found = dimensions_of(arch, at)
        said.append(f"span {found.span:.6g} {unit}, rise {found.rise:.6g} {unit} ({at})")
    said.append(f"thickness {arch.thickness:.6g} {unit}")
    if metric:
        said.append(f"r {arch.radius:.6g} m, depth {arch.depth:.6g} m")
        said.append(f"unit weight {arch.specific_weight / 1000:.6g} kN/m3")
    if mu is not None:
        said.append(f"friction angle {friction_angle(mu):.6g} deg")
    return [f"  size    {', '.join(said)}"]


def unit_lines(arch: Arch, at: At | None = None) -> list[str]:
    """Return of which size forces are, in words, where an arch is told in radii."""
    if is_metric(arch, at):
        return []
    heavy = arch.specific_weight / 1000
    return [f"  unit    no size was given: forces are those of r = 1 m and {heavy:.6g} kN/m3"]


def is_metric(arch: Arch, at: At | None = None) -> bool:
    """Tell whether an arch has a size: a line of it was measured, or its radius is given."""
    return at is not None or arch.radius != 1


def bracket_size_record(answer: Bracket, asked: Scenario) -> dict[str, object]:
    """Return a bracket in metres, for JSON; nothing where no length was given."""
    if asked.line is None and asked.radius == 1:
        return {}
    record: dict[str, object] = {
        f"thickness_{end}_m": _thickness(asked, getattr(answer.arch, f"eta_{end}"))
        for end in ("low", "high", "limit", "theory")
    }
    if asked.line is not None:
        line = asked.line
        record |= {"span_m": line.span, "rise_m": line.rise, "at": line.at}
    fixed = _fixed(asked)
    radius = asked.radius if fixed == "centreline" else None
    return {
        **record,
        "fixed_line": fixed,
        "radius_m": radius,
        "depth_m": asked.depth,
        "friction_angle_deg": friction_angle(asked.mu),
    }


def bracket_size_lines(answer: Bracket, asked: Scenario) -> list[str]:
    """Return a bracket in metres, in words; nothing where no length was given."""
    if asked.line is None and asked.radius == 1:
        return []
    of = answer.arch
    assert of is not None  # noqa: S101
    low, high = (_thickness(asked, eta) for eta in (of.eta_low, of.eta_high))
    if high is None or math.isinf(high):
        return []
    least = f"{high:.6g} m" if low == high else f"{low or 0:.6g} to {high:.6g} m"
    said = [f"least thickness {least}, the {_fixed(asked)} staying where it is"]
    if asked.line is not None:
        line = asked.line
        said.append(f"span {line.span:.6g} m, rise {line.rise:.6g} m ({line.at})")
    if asked.eta is not None:
        said.append(f"thickness given {asked.eta * asked.radius:.6g} m")
    said.append(f"friction angle {friction_angle(asked.mu):.6g} deg")
    return [f"  size    {', '.join(said)}"]


def _fixed(asked: Scenario) -> str:
    """Line that stays where it is as the thickness varies."""
    if asked.line is None or asked.eta is not None:
        return "centreline"
    return asked.line.at


def _thickness(asked: Scenario, eta: float | None) -> float | None:
    return None if eta is None else eta * asked.mean_radius(eta)
