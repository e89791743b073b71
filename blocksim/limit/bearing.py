"""Soil that bears more where blocks move into it: how much of that is mobilised.

Each side of a block may be pressed by any share of what the soil there bears. Blocks can rest
where forces exist at some shares. With the shares of the best state the soil presses by forces
that are known, and the largest load factor, or margin, of the structure under them is that of
the whole: by its mechanism the soil that it moves into bears all it can, and other soil nothing
more. So what is left is a structure of blocks under dead loads, of which all else can be asked.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.blocks.road import soil_bearing
from blocksim.common.later import sparse
from blocksim.limit.cones import Cones, most
from blocksim.limit.linear import LinearProgramme, Optimum

LEAST = 1e-9
"""Share of what soil bears that is none."""


class Bearing:
    """What soil bears more at most, as columns of a programme; there are none without soil.

    `cones`: Of the problem.
    `columns`, (equations, loads) sparse: What all that soil bears does to the blocks.
    """

    def __init__(self, problem: Problem) -> None:
        self.cones = cones = Cones(problem)
        self._loads = soil_bearing(problem)
        columns = [cones.loads(problem.assembly.of_load(load)) for load in self._loads]
        shape = len(columns), cones.balance.shape[0]
        self.columns: Any = sparse.csc_array(np.reshape(columns, shape).T)

    def most(
        self,
        column: Any,
        right: Array,
        bounds: tuple[float, float],
        solver: LinearProgramme | None = None,
    ) -> tuple[Optimum, Array]:
        """Make the factor on a column as large as the balance of forces allows.

        Returns: As of `blocksim.limit.cones.most`.
        Returns `shares`, (loads,): Of what soil bears; empty where nothing balances.
        """
        cones, count = self.cones, len(self._loads)
        columns = sparse.hstack([self.columns, column], format="csc")
        ends = np.append(np.zeros(count), bounds[0]), np.append(np.ones(count), bounds[1])
        found = most(cones, columns, right, ends, solver)
        if not found.exists:
            return found, np.zeros(0)
        parts, shares, factor = np.split(found.values, [cones.count, cones.count + count])
        return replace(found, values=np.append(parts, factor)), shares

    def added(self, problem: Problem, shares: Array) -> Problem:
        """Return a problem on which soil presses by shares of what it bears, and no more."""
        assert problem.soil is not None  # noqa: S101 - it bears
        if not shares.size:
            # Nothing balances, or whatever the factor: either is so without soil.
            shares = np.zeros(len(self._loads))
        more = tuple(
            replace(load, force=share * load.force)
            for load, share in zip(self._loads, shares.tolist(), strict=True)
            if share > LEAST
        )
        soil = replace(problem.soil, passive=(0.0, 0.0))
        used, allowed = (
            sum(float(np.hypot(*load.force)) for load in loads) for loads in (more, self._loads)
        )
        note = (
            f"where it is moved into the fill bears {used / 1e3:.4g} kN more than it presses, "
            f"of {allowed / 1e3:.4g} kN that it may bear"
        )
        return replace(
            problem, soil=soil, dead=(*problem.dead, *more), notes=(*problem.notes, note)
        )


def bears(problem: Problem) -> bool:
    """Tell whether soil bears more where blocks move into it."""
    return problem.soil is not None and any(problem.soil.passive)


def settled(problem: Problem, live: Array | None = None) -> Problem:
    """Return a problem on which soil presses by what is mobilised of what it bears.

    `live`, (blocks, 3): Loads of which the factor is made largest; by default it is the margin
        of all contacts under what acts.
    """
    if not bears(problem):
        return problem
    bearing = Bearing(problem)
    cones = bearing.cones
    if live is None:
        column, pull = cones.balance @ cones.bounded[:, None], problem.applied_forces()
        bounds = (-1e3, 1.0)
    else:
        column, pull = cones.loads(live)[:, None], problem.with_load(0.0).applied_forces()
        bounds = (-math.inf, math.inf)
    _, shares = bearing.most(sparse.csc_array(column), -cones.loads(pull), bounds)
    return bearing.added(problem, shares)
