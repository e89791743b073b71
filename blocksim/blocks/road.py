"""Fill and weights on the road above: they go straight down to what lies uppermost.

Fill spreads nothing on the way unless it is said how (`blocks.dispersal`). What it is made of
and how it presses from the side is in `blocks.soil`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from blocksim.blocks.acting import Load
from blocksim.blocks.assembly import Array, Assembly, Blocks
from blocksim.blocks.dispersal import Dispersal, quadrature
from blocksim.blocks.patch import Profile, Share
from blocksim.blocks.soil import Soil
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError

if TYPE_CHECKING:
    from blocksim.blocks.maker import Kind
    from blocksim.blocks.problem import Problem


def on_road(
    assembly: Assembly,
    weight: float,
    low: float,
    high: float,
    field: str = "patch",
    dispersal: Dispersal | None = None,
) -> tuple[Load, ...]:
    """Return the loads that a weight on the road comes to.

    `low`, `high`: Where it stands along x, evenly [m]; at one point where both are equal.
    `field`: What to call it in messages.
    `dispersal`: How fill spreads it; by default it goes straight down.
    Returns: A weight on a joint is shared in halves by the blocks on its two sides. What fill
        hands to supports, or past the blocks, is left out.
    """
    profile, count = profile_of(assembly), len(assembly.blocks)
    found = profile.at(low) if low == high else profile.along(low, high)
    borne = found is not None and all(index < count for index, _, _ in found)
    corners = np.concatenate(assembly.corners)[:, 0]
    allowed = f"above blocks: they reach from x = {corners.min():.6g} to {corners.max():.6g} m"
    given = f"{low:g} m" if low == high else f"{low:g} to {high:g} m"
    require(borne, field, given, allowed)
    if dispersal is not None:
        found = _dispersed(profile, low, high, dispersal)
    return loads_of(found or (), weight, count)


def _dispersed(profile: Profile, low: float, high: float, dispersal: Dispersal) -> list[Share]:
    """Find what bears a load on the road that fill spreads on its way down.

    Parts that meet no body go to the ground: shares may sum to less than 1.
    """
    places, weights, wide = np.array([low]), np.ones(1), high - low or 1.0
    if low < high:
        ends = profile.enters(dispersal)
        edges = np.unique([low, high, *ends[(ends > low) & (ends < high)]])
        nodes = [quadrature(start, end) for start, end in itertools.pairwise(edges)]
        places, weights = (np.concatenate(each) for each in zip(*nodes, strict=True))
    shares, points = profile.spread(places, dispersal)
    at, link = np.nonzero(shares)
    borne = shares[at, link] * weights[at] / wide
    return list(
        zip(profile.owner[link].tolist(), borne.tolist(), points[at, link], strict=True)
    )


def profile_of(assembly: Assembly) -> Profile:
    """Return what lies uppermost: blocks, and after them supports."""
    bodies = [list(block.polygons) for block in assembly.blocks]
    return Profile.of([*bodies, *(list(each.polygons) for each in assembly.supports)])


def loads_of(shares: Sequence[Share], weight: float, count: int) -> tuple[Load, ...]:
    """Return what a weight [N] on the road does to blocks, each of them once."""
    borne: dict[int, list[tuple[float, Array]]] = {}
    for index, share, point in shares:
        if index < count:
            borne.setdefault(index, []).append((share, point))
    return tuple(
        Load(
            force=np.array([0.0, -weight * sum(share for share, _ in parts)]),
            blocks=(index,),
            point=np.average([point for _, point in parts], 0, [share for share, _ in parts]),
        )
        for index, parts in sorted(borne.items())
    )


def road_of(problem: Problem) -> float | None:
    """Return the height of the road over a structure [m]; None where it has no fill."""
    arch = _filled(problem)
    if arch is not None and arch.fill is not None:
        return getattr(problem.maker, "road", arch.top + arch.fill)
    if problem.soil is None or problem.soil.height is None:
        return None
    return float(profile_of(problem.assembly).ends[:, :, 1].max()) + problem.soil.height


def with_road(
    problem: Problem,
    loads: Sequence[tuple[float, float, float]],
    fields: Sequence[str] = (),
) -> Problem:
    """Return a problem with these live loads on the road in place of any others.

    Where it has a maker they stay where they are as its parameters change, on whatever blocks
    are uppermost there then.

    `loads`, sequence of (float, float, float): From one x to another [m], the same at a point,
        and the weight [N].
    `fields`: What to call each in messages.
    """
    names = fields or ["road"] * len(loads)
    live = [
        each
        for (low, high, weight), name in zip(loads, names, strict=True)
        for each in on_road(problem.assembly, weight, low, high, name, problem.dispersal)
    ]
    return replace(problem, live=tuple(live), road=tuple(loads))


def _filled(problem: Problem[Any]) -> Any:
    """Return the maker that knows its fill: an arch, or that of arches on piers; else None."""
    arch = getattr(problem.maker, "arch", problem.maker)
    return arch if hasattr(arch, "fill") else None


def takes_fill(problem: Problem) -> bool:
    """Tell whether a maker knows its fill: those of an arch, or of arches on piers."""
    return _filled(problem) is not None


def fill_density(problem: Problem) -> float:
    """Return the density of the fill that a maker knows, over that of its blocks."""
    return float(_filled(problem).fill_density)


def with_fill(problem: Problem, height: float, share: float) -> Problem:
    """Return a problem of an arch or of arches on piers with fill above them.

    `problem`: With a maker.
    `height`: Of the fill over the highest point of the extrados [m].
    `share`: Density of the fill over that of the blocks.
    """
    maker: Any = problem.maker
    require(takes_fill(problem), "fill", height, "left out: it is for arches and portals")
    path = "" if _filled(problem) is maker else "arch."
    filled = maker.but(**{f"{path}fill": height, f"{path}fill_density": share})
    return remade(problem, filled)


def remade(problem: Problem[Blocks], maker: Kind[Any]) -> Problem[Blocks]:
    """Return a problem by another maker, or by one with other parameters.

    Loads stay as they are but for the weight of fill, which comes first among the dead ones.
    What is on the road stays where it is.
    """
    if problem.soil is not None:
        plain = remade(with_soil(cast("Problem", problem), None), maker)
        return cast("Problem[Blocks]", with_soil(plain, problem.soil))
    before = 0 if problem.maker is None else len(problem.maker.built.fills)
    built = maker.built
    dead = (*built.fills, *problem.dead[before:])
    made = replace(problem, assembly=built.assembly, dead=dead, maker=maker)
    if problem.in_space:
        return made
    planar = cast("Problem", made)
    if problem.dispersal is not None and (road := road_of(planar)) is not None:
        planar = replace(planar, dispersal=replace(problem.dispersal, road=road))
    found = with_road(planar, problem.road) if problem.road else planar
    return cast("Problem[Blocks]", found)


def with_soil(problem: Problem, soil: Soil | None) -> Problem:
    """Return a problem on which soil presses, in place of any other."""
    for place, span in enumerate(getattr(problem.maker, "each_span", ())):
        ok = soil is None or span.fill_density is None
        allowed = "left out beside what the fill is made of: --fill-region tells it of a span"
        require(ok, f"each_span[{place}].fill_density", span.fill_density, allowed)
    fills = _fills(problem)
    others = problem.dead[fill_loads(problem) :]
    made = replace(problem, soil=soil)
    return replace(made, dead=(*problem.dead[:fills], *soil_loads(made), *others))


def _fills(problem: Problem) -> int:
    """Return how many loads are the weight of fill that a maker knows: the first ones."""
    return 0 if problem.maker is None else len(problem.maker.built.fills)


def bears_road(problem: Problem[Any]) -> bool:
    """Tell whether fill or loads on a road lie on it: weights that no mass stands for."""
    return bool(problem.road or problem.soil or _fills(cast("Problem", problem)))


def require_upright(problem: Problem[Any], name: str, turn: float | str) -> None:
    """Refuse to turn gravity under fill or loads on a road: they would not turn with it.

    `turn`: Angle [rad], or what is given in its place.
    """
    allowed = "left out under fill or loads on a road, which are borne by what stands upright"
    said = turn if isinstance(turn, str) else f"{math.degrees(turn):.6g} deg"
    require(not turn or not bears_road(problem), name, said, allowed)


def fill_loads(problem: Problem) -> int:
    """Return how many of the dead loads fill is, by weight and from the side: the first."""
    return _fills(problem) + len(soil_loads(problem))


def soil_loads(problem: Problem) -> tuple[Load, ...]:
    """Return what soil does to blocks, which comes after the weight of fill."""
    return () if problem.soil is None else problem.soil.loads(*_below(problem))


def soil_bearing(problem: Problem) -> tuple[Load, ...]:
    """Return what soil bears more at most where it is moved into, each of its own."""
    return () if problem.soil is None else problem.soil.bearing(*_below(problem))


def _below(problem: Problem) -> tuple[Profile, Array, float]:
    """Return what lies uppermost, depths of blocks, and the height of the road [m]."""
    road, assembly = road_of(problem), problem.assembly
    if road is None:
        raise InputError("fill", MISSING, "given beside what the fill is made of")
    return profile_of(assembly), assembly.depths * assembly.size, road


def with_dispersal(problem: Problem, words: str) -> Problem:
    """Return a problem whose fill spreads loads on the road.

    `problem`: With fill.
    `words`: As of `Dispersal.of`.
    """
    road = road_of(problem)
    if road is None:
        raise InputError("dispersal", words, "left out, or --fill beside it: there is no fill")
    spread = replace(problem, dispersal=Dispersal.of(words, road))
    return with_road(spread, problem.road) if problem.road else spread


@dataclass(frozen=True, kw_only=True)
class FillAbove:
    """Fill: its height [m] over `over`, its weight [N], and words."""

    height: float
    over: str
    weight: float
    words: tuple[str, ...] = ()


def fill_of(problem: Problem[Any]) -> FillAbove | None:
    """Return the fill on a structure; None where it has none."""
    maker, soil, arch = problem.maker, problem.soil, _filled(problem)
    height: float | None = None if arch is None else arch.fill
    if height is None:
        height = None if soil is None else soil.height
    if height is None:
        return None
    fills = () if maker is None else maker.built.fills
    return FillAbove(
        height=height,
        over="the highest point" if arch is None else "the crown",
        weight=-sum(float(load.force[1]) for load in (*fills, *soil_loads(problem))),
        words=() if soil is None else soil.words,
    )
