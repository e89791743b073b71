"""What the page on one structure says: dimensions, assumptions, factors, thrust."""

from __future__ import annotations

import math
from typing import Any, NamedTuple, cast

import numpy as np

from blocksim.arch.answers import ArchAnswer
from blocksim.ask.check import Check
from blocksim.blocks.acting import push_of, shaking_words, tilt_and_lean, towards
from blocksim.blocks.joints import joint_names
from blocksim.blocks.maker import Kind, Table
from blocksim.blocks.problem import Problem
from blocksim.blocks.road import fill_density, fill_of, takes_fill
from blocksim.common.fields import fields_of
from blocksim.common.words import percent
from blocksim.limit.carried import Carried
from blocksim.report.problems import weighed_arch
from blocksim.view.arrows import forces_of
from blocksim.view.dimensions import (
    Angle,
    ForceUnit,
    common_depth,
    dimensions_of,
    length_words,
    unit_weight,
)
from blocksim.view.sheet import LARGEST, Sheet
from blocksim.view.solidscene import moving_box
from blocksim.view.thrustlines import thrust_of

MEASURED = ("thickness", "voussoirs", "depth", "radius", "left_deg", "right_deg", "at")
"""Parameters of a circular arch that its dimensions say."""
ON_ROAD = ("fill", "fill_density")
"""Parameters that are told with the road."""
BESIDE = {"at": "span", "fill_density": "fill"}
"""Parameters that say nothing where another is not given."""
CUBIC = "kN/m\N{SUPERSCRIPT THREE}"


class Fact(NamedTuple):
    """A quantity, its value with its unit, and what it says."""

    name: str
    value: str
    note: str = ""


def built_facts(sheet: Sheet) -> list[Fact]:
    """Tell dimensions and weights of what is built."""
    problem, unit = sheet.problem, sheet.unit
    assembly, arch = problem.assembly, weighed_arch(problem)
    facts = _dimensions(problem)
    if arch is not None:
        facts.append(Fact("radius", length_words(arch.radius), "centreline"))
        facts.append(Fact("thickness over radius", f"η = {arch.eta:.4g}"))
    facts += [
        Fact("voussoirs" if arch else "blocks", str(len(assembly.blocks))),
        Fact("joints", str(len(assembly.joints))),
    ]
    depth = common_depth(problem)
    if depth is not None:
        facts.append(Fact("depth", f"{depth:.4g} m"))
    facts.append(Fact("friction coefficient", *_friction(problem)))
    heavy = unit_weight(problem)
    if heavy is not None:
        facts.append(Fact("unit weight", f"{heavy / 1e3:.4g} {CUBIC}"))
    weight = problem.unit_force * len(assembly.blocks)
    facts.append(Fact("weight of all blocks", unit.words(weight), unit.note))
    factor = f"times {problem.load:g}, the load factor"
    push = push_of(problem)
    besides = "besides own weight, together"
    for name, loads, note in (
        ("push" if push else "dead loads", problem.dead, push or besides),
        ("live loads", problem.live, f"together, {factor}"),
    ):
        forces = [force for load in loads for _, force in forces_of(problem, load)]
        if forces:
            total = float(np.linalg.norm(np.sum(forces, axis=0)))
            facts.append(Fact(name, unit.words(total), note))
    return facts


def _dimensions(problem: Problem[Any]) -> list[Fact]:
    if problem.in_space:
        low, high = moving_box(problem.assembly)
        sides = " x ".join(f"{side:.4g}" for side in high - low)
        return [Fact("length, width, height", f"{sides} m", "of all blocks")]
    corners = np.concatenate([block.vertices for block in problem.assembly.blocks])
    return [
        Fact("half-angle of embrace", f"{math.degrees(each.value):.4g}°")
        if isinstance(each, Angle)
        else Fact(each.what, length_words(each.value), each.note)
        for each in dimensions_of(problem, corners, 1.0)
    ]


def given_facts(problem: Problem[Any]) -> list[Fact]:
    """Echo every parameter that a kind of structure was made with.

    Those of a circular arch that its dimensions say are not said again.
    """
    arch = weighed_arch(problem)
    found = [] if problem.maker is None else _parameters(problem.maker, "")
    told = () if problem.in_space else (*(() if arch is None else MEASURED), *ON_ROAD)
    return [each for each in found if each.name.removeprefix("arch.") not in told]


def _parameters(maker: Table, path: str) -> list[Fact]:
    found: list[Fact] = []
    for name, known in fields_of(type(maker)).items():
        value = getattr(maker, name)
        if isinstance(value, Kind):
            found.append(Fact(f"{path}{name}", value.name, known.about))
            found += _parameters(cast("Kind[Any]", value), f"{path}{name}.")
        elif known.nested == "tables":
            for place, row in enumerate(value, 1):
                found += _parameters(row, f"{path}{name} {place}: ")
        elif value is not None and getattr(maker, BESIDE.get(name, ""), 0) is not None:
            unit = f" {known.unit}" if known.unit and not isinstance(value, str) else ""
            found.append(Fact(f"{path}{name}", f"{known.said(value)}{unit}", known.about))
    return found


def road_facts(problem: Problem[Any]) -> list[Fact]:
    """Tell fill and what stands on the road, with its places from x = 0 on the drawing."""
    fill, facts = fill_of(problem), list[Fact]()
    if fill is not None:
        facts.append(Fact("fill", length_words(fill.height), f"over {fill.over}"))
        heavy = unit_weight(problem)
        if takes_fill(problem) and heavy is not None:
            said = f"{fill_density(problem) * heavy / 1e3:.4g} {CUBIC}"
            facts.append(Fact("unit weight of fill", said))
        facts.append(Fact("weight of fill", f"{fill.weight / 1e3:.6g} kN", "on all blocks"))
    for low, high, weight in problem.road:
        where = f"x = {low:.6g} m" if low == high else f"x = {low:.6g} to {high:.6g} m"
        facts.append(Fact("axle" if low == high else "patch", f"{weight / 1e3:.6g} kN", where))
    if problem.road:
        how = "straight down to the blocks below: fill spreads no load"
        how = how if problem.dispersal is None else problem.dispersal.words
        facts.append(Fact("dispersal", "none" if problem.dispersal is None else "yes", how))
    return facts


def _friction(problem: Problem[Any]) -> tuple[str, str]:
    if math.isinf(problem.mu):
        return "∞", "joints do not slide"
    own = (problem.friction != problem.mu).any()
    angle = f"friction angle {math.degrees(math.atan(problem.mu)):.4g}°"
    return f"μ = {problem.mu:.4g}", angle + ("; some joints have their own" if own else "")


def load_words(problem: Problem[Any]) -> list[str]:
    """Say what acts."""
    words = ["Own weight acts at each block's centre of mass."]
    if getattr(problem.maker, "weight", "") == "centreline":
        words = ["Own weight acts at the centroid of each voussoir's part of the centreline."]
    if (fill := fill_of(problem)) is not None:
        words += [f"Fill: {each}." for each in fill.words]
        if problem.soil is None or not any(problem.soil.pressure):
            words.append("Fill does not press from the side.")
    elif problem.dead:
        count = len(problem.dead)
        dead = f"{count} dead load{'s' * (count > 1)} besides own weight."
        words.append(f"A push: {push}." if (push := push_of(problem)) else dead)
    if problem.live:
        factor = (
            f"times {problem.load:g}" if problem.load else "not on it: the load factor is 0"
        )
        count = len(problem.live)
        words.append(f"{count} live load{'s' * (count > 1)}, {factor}.")
    tilt, _ = tilt_and_lean(problem)
    if abs(tilt) > 1e-9:
        where = "in the plane"
        if problem.in_space:
            where = f"towards {towards(problem):.4g}° from x"
        words.append(f"Gravity is tilted by {tilt:.4g}° {where}.")
    if problem.shaking is not None:
        words.append(f"The {shaking_words(problem)}.")
    return words


def assumptions(problem: Problem[Any]) -> list[str]:
    """Say what is taken for granted."""
    law = "Joints do not slide." if math.isinf(problem.mu) else (
        "Coulomb friction in all joints, without cohesion."
    )  # fmt: skip
    return [
        "Blocks are rigid, and supports do not give way.",
        "Joints bear no tension; "
        + (
            "compressive strength is unlimited."
            if problem.strength is None
            else f"their compressive strength is {problem.strength / 1e6:g} MPa, as a "
            "rectangular block of stress."
        ),
        law,
        *load_words(problem),
        "Stands means that it can rest: forces of equilibrium exist.",
    ]


def factor_facts(answer: Check[Any], sheet: Sheet) -> list[Fact]:
    """Tell how far it is from falling."""
    problem, carried = answer.problem, sheet.carried
    facts: list[Fact] = []
    if carried is not None:
        facts += _margin_facts(carried, of_thickness=answer.arch is not None)
    if answer.needed is not None and problem.strength is not None:
        factor = f"{problem.strength / answer.needed.high:.4g}"
        said = f"{answer.needed.high / 1e6:.4g} MPa is needed"
        facts.append(Fact("strength factor", factor, said))
    if answer.load_factor is not None:
        at = f"asked at {problem.load:g}; " if problem.load else ""
        value = "∞" if math.isinf(answer.load_factor) else f"{answer.load_factor:.6g}"
        facts.append(Fact("load factor", value, f"{at}largest factor on the live loads"))
    if answer.arch is not None:
        facts += _least_facts(answer.arch)
    return facts


def _margin_facts(carried: Carried, *, of_thickness: bool) -> list[Fact]:
    factor = carried.geometrical_factor
    said = "nothing suffices" if factor is None else (
        f"more than {LARGEST:g}" if factor > LARGEST else f"{factor:.5g}"
    )  # fmt: skip
    what = "thickness over the least that stands, as built" if of_thickness else (
        "joints' width over what a line of thrust needs, about their middles"
    )  # fmt: skip
    if factor == math.inf:
        said, what = "\N{INFINITY}", "no width is needed"
    facts = [Fact("geometrical factor of safety", said, what)]
    rough, least = carried.friction_factor, carried.least_friction
    if rough is None:
        facts.append(Fact("friction factor", "no friction suffices"))
    else:
        said = "\N{INFINITY}" if math.isinf(rough) else f"{rough:.4g}"
        needed = "of the friction of every joint" if least is None else (
            f"least friction coefficient μ = {least:.4g}"
        )  # fmt: skip
        facts.append(Fact("friction factor", said, needed))
    # Where blocks crush the state that is shown is another: that which presses them least.
    shown = None if carried.needed is None else carried.resultants
    used = carried.strength_used if shown is None else float(shown.used.max())
    if used is not None:
        both = "at most, of width or friction, in the state of greatest margin"
        facts.append(Fact("joints used", percent(used, ".1f"), both))
    return facts


def _least_facts(arch: ArchAnswer) -> list[Fact]:
    facts: list[Fact] = []
    for whose, least, mode in (
        ("as built", arch.eta_limit, arch.mode_limit),
        ("continuous arch", arch.eta_theory, arch.mode_theory),
    ):
        said = "none up to η = 2" if least is None else (
            f"{length_words(least * arch.shape.radius)} (η = {least:.5g})" if least else "any"
        )  # fmt: skip
        falls = f", in mode {mode.value}" if mode and least else ""
        facts.append(Fact("least thickness", said, f"{whose}{falls}"))
    return facts


def thrust_facts(sheet: Sheet) -> list[Fact]:
    """Tell the range of thrust at the joint at which it is told."""
    carried, unit, problem = sheet.carried, sheet.unit, sheet.problem
    if carried is None or carried.joint is None or not (carried.least and carried.greatest):
        return []
    if carried.stands and sheet.thrust is None:
        return []
    name = joint_names(problem.assembly)[carried.joint]
    said = [
        "without limit"
        if math.isinf(end.thrust)
        else unit.words(end.thrust * problem.unit_force)
        for end in (carried.least, carried.greatest)
    ]
    facts = [
        Fact("least thrust", said[0], f"at joint {name}"),
        Fact("greatest thrust", said[1], f"at joint {name}"),
    ]
    if said[0] == said[1]:
        return [Fact("thrust", said[0], f"at joint {name}; statics alone say it")]
    if carried.stands and carried.forces is not None:
        safest = thrust_of(problem, carried.forces, carried.joint)
        facts.append(Fact("thrust at greatest margin", unit.words(safest), f"at joint {name}"))
    return facts


def force_words(unit: ForceUnit) -> str:
    """Say in what forces are told."""
    return f"forces in {unit.name}" + (f"; {unit.note}" if unit.note else "")
