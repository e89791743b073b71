"""Small structures everyone knows, in every engine: they stand inside their limit, fall beyond.

Each limit is a closed form, written here.
"""

import math
from collections.abc import Callable, Mapping
from itertools import product
from typing import Any

import numpy as np
import pytest
from drawn import square
from shapely import Polygon

from blocksim import Problem, Verdict, assembly_of_polygons, check

FLOOR = square(-20.0, -1.0, 40.0, 1.0)


def standing(*blocks: Any, fixed: tuple[Any, ...] = (FLOOR,), mu: float) -> Problem:
    every = [np.array(each) for each in (*fixed, *blocks)]
    return Problem(assembly=assembly_of_polygons(every, fixed=range(len(fixed))), mu=mu)


def card_house(share: float) -> Problem:
    """Two equal cards lean on each other, on their lower corners, and slide apart.

    They meet on a vertical face, where by symmetry the thrust is level. About the foot its
    moment is that of the weight, so it is least at the face's top, and so is the friction.
    """
    slope, long, thick = math.radians(65), 2.0, 0.2
    along = np.array([math.cos(slope), math.sin(slope)])
    across = np.array([-along[1], along[0]])
    # From the foot up to the plane of symmetry, x = 0; the foot is a corner on the floor.
    low = np.array([-long * along[0], 0.0])
    inner = low + along * (-low[0] / along[0])
    outer_foot = low + thick * across
    outer = outer_foot + along * (-outer_foot[0] / along[0])
    card = np.array([low, inner, outer, outer_foot])
    least = (Polygon(card).centroid.x - low[0]) / outer[1]
    mirrored = (card * [-1, 1])[::-1]
    return standing(card, mirrored, mu=least / share)


def pyramid(share: float) -> Problem:
    """Bricks 3-2-1 on a table: its topmost brick slides first where friction is low."""
    rows = [(0.5 * row + place, 0.5 * row) for row in range(3) for place in range(3 - row)]
    bricks = [square(left, low, 1.0, 0.5) for left, low in rows]
    return standing(*bricks, mu=0.4).tilted(math.atan(0.4 * share))


def double_domino(share: float) -> Problem:
    """Two dominoes near each other overturn on a table tilted by their slenderness."""
    tall = [square(0.6 * place, 0.0, 0.2, 1.0) for place in range(2)]
    return standing(*tall, mu=0.7).tilted(math.atan(0.2 * share))


def leaning_plank(share: float) -> Problem:
    """A plank with a corner on the floor and one against a wall as rough, which slide at once.

    The floor presses by N and rubs by mu N, which is the wall's pressure; the wall rubs by
    mu^2 N. The weight is N + mu^2 N; moments about the foot give a quadratic equation for mu.
    """
    slope, long, thick = math.radians(60), 2.0, 0.1
    along = np.array([math.cos(slope), math.sin(slope)])
    across = np.array([-along[1], along[0]])
    foot = np.zeros(2)
    plank = np.array([foot, foot + long * along, foot + long * along + thick * across,
                      foot + thick * across])  # fmt: skip
    right = float(plank[:, 0].max())
    wall = square(right, 0.0, 1.0, 3.0)
    centre, top = plank.mean(axis=0), plank[1]
    # (1 + mu^2) x of the centre = mu y + mu^2 x of the top
    a, b, c = top[0] - centre[0], top[1], -centre[0]
    least = (-b + math.sqrt(b * b - 4 * a * c)) / (2 * a)
    return standing(plank, fixed=(FLOOR, wall), mu=least / share)


def cantilever(share: float) -> Problem:
    """Four equal bricks reach 1/2 (1 + 1/2 + 1/3 + 1/4) of their length beyond the table."""
    table = square(-5.0, -1.0, 5.0, 1.0)
    reach, bricks = 0.0, []
    for row in range(4):
        reach += share / (2 * (4 - row))
        bricks.append(square(reach - 1.0, 0.3 * row, 1.0, 0.3))
    return standing(*bricks, fixed=(table,), mu=0.7)


CLASSICS: Mapping[str, Callable[[float], Problem]] = {
    each.__name__: each
    for each in (card_house, pyramid, double_domino, leaning_plank, cantilever)
}


@pytest.mark.parametrize(
    ("engine", "name"),
    [
        pytest.param(*each, marks=[pytest.mark.long] if each == ("mujoco", "pyramid") else [])
        for each in product(("direct", "pymunk", "pybullet", "mujoco"), CLASSICS)
    ],
)
@pytest.mark.parametrize(
    ("share", "expected"), [(0.99, Verdict.STANDS), (1.01, Verdict.COLLAPSES)]
)
def test_stands_inside_and_falls_outside(
    engine: str, name: str, share: float, expected: Verdict
) -> None:
    seen = check(CLASSICS[name](share), method=engine)
    assert seen.verdict is expected, seen.reason
