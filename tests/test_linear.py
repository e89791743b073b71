"""Linear programmes that one method of the simplex gives up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from blocksim.limit import linear


@pytest.mark.parametrize("seed", range(3))
def test_a_programme_given_up_by_the_dual_method_is_told_by_the_primal(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing limits it. A bound of 1e7 in its place would be a load factor that is none.

    From a corner that is known the primal method sees that in few steps; the dual one would
    take more than it is given here.
    """
    random, count, rows = np.random.default_rng(seed), 60, 40
    matrix, cost = random.normal(size=(rows, count)), random.normal(size=count)
    most, least = np.abs(random.normal(size=rows)), np.full(rows, -math.inf)
    # A way that costs less and less, and meets no end.
    way = np.abs(random.normal(size=count))
    matrix -= np.outer(np.maximum(matrix @ way, 0.0) + 1.0, way) / (way @ way)
    cost -= (cost @ way + 1.0) * way / (way @ way)
    assert (matrix @ way < 0).all()
    assert cost @ way < 0
    monkeypatch.setattr(linear, "ENDLESS", 1)
    bounds = np.zeros(count), np.full(count, math.inf)
    found = linear.LinearProgramme().solve(cost, matrix, (least, most), bounds)
    assert found.unbounded
