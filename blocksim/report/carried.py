"""The engineer's numbers as JSON and as text: factors of safety, thrust, reactions."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from blocksim.common.words import few
from blocksim.limit import Reaction, in_world
from blocksim.limit.carried import Carried
from blocksim.report.schema import CarriedRecord

KILO, MEGA = 1e3, 1e6
LARGEST = 1e3
"""Geometrical factor from which on joints need no width to speak of."""
FAINT = 1e-9
"""Share of the largest reaction below which a part of one is rounding."""
SHOWN = 4
"""Supports and joints told in a line of text."""


def carried_record(carried: Carried | None, names: Sequence[str]) -> CarriedRecord:
    """Return what a structure carries, with names of joints; null where unknown."""
    if carried is None:
        return dict.fromkeys(CarriedRecord.__annotations__)  # type: ignore[return-value]
    low, high = carried.thrust or (None, None)
    depth, weight = carried.depth, carried.weight
    used = carried.resultants
    return {
        "geometrical_factor": carried.geometrical_factor,
        "friction_factor": carried.friction_factor,
        "least_friction": carried.least_friction,
        "strength_used": carried.strength_used,
        "needed_strength_MPa": carried.needed and carried.needed.high / MEGA,
        "weights_given": carried.problem.weighed,
        "weight_kN": weight / KILO,
        "thrust_joint": None if carried.joint is None else names[carried.joint],
        "thrust_min_kN": _over(low, KILO),
        "thrust_max_kN": _over(high, KILO),
        "thrust_min_kN_per_m": _over(low, depth and KILO * depth),
        "thrust_max_kN_per_m": _over(high, depth and KILO * depth),
        "thrust_min_per_weight": _over(low, weight),
        "thrust_max_per_weight": _over(high, weight),
        "reactions": [
            {
                "support": each.name,
                "horizontal_kN": float(in_world(carried.problem, each.force)[0]) / KILO,
                "vertical_kN": float(in_world(carried.problem, each.force)[1]) / KILO,
                "x_m": float(each.point[0]),
                "y_m": float(each.point[1]),
            }
            for each in carried.reactions
        ],
        "worst_joints": [
            {
                "joint": names[k],
                "width_used": float(used.width_used[k]),
                "friction_used": float(used.friction_used[k]),
            }
            for k in carried.worst_joints
            if used is not None
        ],
    }


def carried_lines(carried: Carried | None, names: Sequence[str]) -> list[str]:
    """Return what a structure carries in words, each number with its unit."""
    if carried is None:
        return []
    lines = [f"  safety  {_factors(carried)}"]
    if (strength := carried.problem.strength) is not None and carried.needed is not None:
        needed = carried.needed.high
        factor, said = _number(strength / needed), f"{needed / MEGA:.4g} MPa"
        lines.append(f"  stress  {said} at most, where it is least: strength factor {factor}")
    if carried.joint is not None and carried.thrust is not None:
        low, high = (_force(each, carried) for each in carried.thrust)
        said = f"{low} in every state" if low == high else f"{low} to {high}"
        if math.isinf(carried.thrust[1]):
            said = f"{low} or more, without limit"
        lines.append(f"  thrust  {said}, across joint {names[carried.joint]}")
    if carried.reactions:
        told = [f"{each.name}: {_borne(each, carried)}" for each in carried.reactions]
        lines.append(f"  bears   {few(told, SHOWN, '; ')}, in the safest state")
    lines += _worst(carried, names)
    if not carried.problem.weighed:
        lines.append("  unit    W is the weight of all blocks: no unit weight was given")
    return lines


def _factors(carried: Carried) -> str:
    wide, rough = carried.geometrical_factor, carried.friction_factor
    least = carried.least_friction
    if wide is None:
        said = ["no thickness suffices"]
    elif wide > LARGEST:
        said = ["no joint needs its width"]
    else:
        said = [f"geometrical factor {_number(wide)}"]
    if rough is None:
        said.append("no friction suffices")
    elif least == 0:
        said.append("no friction is needed")
    else:
        needed = "" if least is None else f" (mu {_number(least)} is needed)"
        said.append(f"friction factor {_number(rough)}{needed}")
    return ", ".join(said)


def _borne(each: Reaction, carried: Carried) -> str:
    """Say what a support bears, up and across as the world has it."""
    across, up = (float(part) for part in in_world(carried.problem, each.force))
    most = max(float(np.hypot(*other.force)) for other in carried.reactions)
    said = f"{_force(abs(up), carried)} {'up' if up >= 0 else 'down'}"
    if abs(across) <= FAINT * most:
        return said
    return f"{said}, {_force(abs(across), carried)} to the {'right' if across > 0 else 'left'}"


def _worst(carried: Carried, names: Sequence[str]) -> list[str]:
    used, worst = carried.resultants, carried.worst_joints
    if used is None or not worst:
        return []
    first = worst[0]
    what = "width" if used.width_used[first] >= used.friction_used[first] else "friction"
    listed = few([names[k] for k in worst], SHOWN)
    joints = "joint" if len(worst) == 1 else "joints"
    share = f"{used.used[first]:.1%} of the {what} is used"
    return [f"  worst   {joints} {listed}: {share}, in the safest state"]


def _force(newton: float, carried: Carried) -> str:
    """Tell a force, over the depth where all blocks have the same."""
    newton = 0.0 if abs(newton) <= FAINT * carried.weight else newton
    if not carried.problem.weighed:
        return f"{_number(newton / carried.weight)} W"
    if carried.depth is None:
        return f"{_number(newton / KILO)} kN"
    return f"{_number(newton / KILO / carried.depth)} kN/m"


def _over(force: float | None, unit: float | None) -> float | None:
    return None if force is None or unit is None else force / unit


def _number(value: float) -> str:
    return "without limit" if math.isinf(value) else f"{value:.4g}"
