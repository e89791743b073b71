"""Linear programmes, also with whole unknowns, by HiGHS; the only place that knows it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.common.errors import Unsolved
from blocksim.common.later import Library, sparse

if TYPE_CHECKING:
    import highspy
else:
    highspy = Library("highspy")

FINEST = 1e-10
"""HiGHS's own least tolerance."""
MANY = 1000
"""Unknowns from which on the interior point is faster than the simplex at first."""
DUAL, PRIMAL = 1, 4
"""HiGHS's numbers of its simplex methods."""
ENDLESS = 100
"""Steps of the simplex over rows and unknowns, from which on it goes round in circles."""
LARGEST = 1e7
"""Size of unknowns up to which a programme is solved that HiGHS does not take without bound."""
Ends = tuple[Array, Array]
Matrix: TypeAlias = "sparse.csc_array | Array"


@dataclass(frozen=True, kw_only=True, eq=False)
class Optimum:
    """What came of a linear programme.

    `values`, (unknowns,): Empty where there is no optimum.
    `prices`, (rows,): By how much the least cost grows with the right side of each row.
    `unbounded`: Whether nothing limits the cost from below.
    `basis`: HiGHS's own: what is active.
    `least`: What the cost cannot be below, where unknowns have to be whole or lie in cones.
    """

    values: Array
    prices: Array
    unbounded: bool
    basis: Any = None
    least: float = -math.inf

    @property
    def basic(self) -> tuple[list[int], list[int]]:
        """The unknowns and the rows that are basic."""
        known = highspy.HighsBasisStatus.kBasic
        columns, rows = (
            [at for at, each in enumerate(of) if each == known]
            for of in (self.basis.col_status, self.basis.row_status)
        )
        return columns, rows

    @property
    def exists(self) -> bool:
        """Whether there is an optimum."""
        return bool(self.values.size)


NONE = Optimum(values=np.zeros(0), prices=np.zeros(0), unbounded=False)
UNBOUNDED = Optimum(values=np.zeros(0), prices=np.zeros(0), unbounded=True)


class LinearProgramme:
    """A linear programme that may be solved again with other numbers.

    Each solution begins with what was active in the last one, which takes a tenth of the time.
    """

    def __init__(self) -> None:
        self._highs = _solver(
            primal_feasibility_tolerance=FINEST, dual_feasibility_tolerance=FINEST
        )
        self._shape, self._basis = (0, 0), None

    def solve(self, cost: Array, matrix: Matrix, rows: Ends, bounds: Ends) -> Optimum:
        """Find the least cost.

        Where HiGHS tells nothing of it, unknowns are sought up to `LARGEST`: corners that were
        rounded may ask for forces without end.

        `cost`, (unknowns,).
        `matrix`, (rows, unknowns).
        `rows`, two of (rows,): Least and greatest value of each row, infinite where there is
            none.
        `bounds`, two of (unknowns,): Least and greatest value of each unknown.
        Raises `Unsolved`: If HiGHS tells nothing of that either.
        """
        found = self._solve(cost, matrix, rows, bounds)
        if found is None:
            low, high = bounds
            ends = np.maximum(low, -LARGEST), np.minimum(high, LARGEST)
            found = self._solve(cost, matrix, rows, ends)
        if found is None:
            # Nothing follows from it, least of all that nothing stands.
            raise Unsolved
        return found

    def again(self, rows: Ends) -> Optimum | None:
        """Solve the last programme with other ends of its rows; None where that tells nothing.

        What was active before stays a good beginning: it takes a step or two.
        """
        count = len(rows[0])
        self._highs.changeRowsBounds(count, np.arange(count, dtype=np.int32), *rows)
        return self._found() if self._run("simplex") else None

    def _solve(self, cost: Array, matrix: Matrix, rows: Ends, bounds: Ends) -> Optimum | None:
        columns = sparse.csc_array(matrix)
        most = ENDLESS * (sum(columns.shape) + 10)
        self._highs.setOptionValue("simplex_iteration_limit", most)
        again = columns.shape == self._shape and self._basis is not None
        self._highs.passModel(_model(cost, columns, rows, bounds))
        if again:
            self._highs.setBasis(self._basis)
        else:
            # Of many unknowns the interior point is three to ten times faster, and as exact:
            # its answer is brought to a vertex. It does not tell whether nothing limits it.
            self._shape, self._basis = columns.shape, None
            if columns.shape[1] > MANY and self._run("ipm"):
                return self._found()
        return self._by_simplex()

    def _by_simplex(self) -> Optimum | None:
        """Solve by the dual method, by the primal one where that gets lost: without bound."""
        known = highspy.HighsModelStatus
        for strategy in (DUAL, PRIMAL):
            self._highs.setOptionValue("simplex_strategy", strategy)
            if self._run("simplex"):
                return self._found()
            self._basis, status = None, self._highs.getModelStatus()
            if status in {known.kInfeasible, known.kUnbounded}:
                return UNBOUNDED if status == known.kUnbounded else NONE
            self._highs.clearSolver()
        return None

    def _run(self, method: str) -> bool:
        self._highs.setOptionValue("solver", method)
        self._highs.run()
        return self._highs.getModelStatus() == highspy.HighsModelStatus.kOptimal

    def _found(self) -> Optimum:
        basis = self._highs.getBasis()
        self._basis = basis if basis.valid else None
        solution = self._highs.getSolution()
        return Optimum(
            values=np.array(solution.col_value),
            prices=np.array(solution.row_dual),
            unbounded=False,
            basis=self._basis,
        )


def choose(
    cost: Array,
    matrix: Matrix,
    rows: Ends,
    bounds: Ends,
    *,
    whole: NDArray[np.bool_],
    gap: float,
    seconds: float,
) -> Optimum:
    """Find the least cost where some of the unknowns have to be whole, by branch and bound.

    `cost`, `matrix`, `rows`, `bounds`: As of `LinearProgramme.solve`.
    `whole`, (unknowns,): Which unknowns are whole.
    `gap`: By how much the cost found may be above the least.
    `seconds`: Time after which it ends with the best it has.
    Returns: The best that was found, without prices.
    """
    model = _model(cost, sparse.csc_array(matrix), rows, bounds)
    kinds = highspy.HighsVarType
    model.integrality_ = [kinds.kInteger if each else kinds.kContinuous for each in whole]
    highs = _solver(
        mip_rel_gap=0.0,
        mip_abs_gap=gap,
        mip_feasibility_tolerance=FINEST,
        primal_feasibility_tolerance=FINEST,
        time_limit=seconds,
    )
    highs.passModel(model)
    highs.run()
    solution = highs.getSolution()
    values = np.array(solution.col_value if solution.value_valid else [])
    return replace(NONE, values=values, least=float(highs.getInfo().mip_dual_bound))


def _solver(**options: float) -> Any:
    """Return a solver that prints nothing and does one thing at a time."""
    found = _quiet()()
    # No number of threads: all solvers of a process have to have the same.
    for name, value in {"output_flag": False, "parallel": "off", **options}.items():
        found.setOptionValue(name, value)
    return found


@cache
def _quiet() -> Any:
    """Make HiGHS silent before it is built: from 1.16 on that is when it greets."""

    class Quiet(highspy.Highs):
        def enableCallbacks(self) -> None:  # noqa: N802 - HiGHS's name
            self.setOptionValue("output_flag", False)
            super().enableCallbacks()

    return Quiet


def _model(cost: Array, columns: sparse.csc_array, rows: Ends, bounds: Ends) -> Any:
    model: Any = highspy.HighsLp()
    model.num_row_, model.num_col_ = columns.shape
    model.col_cost_ = cost
    model.col_lower_, model.col_upper_ = bounds
    model.row_lower_, model.row_upper_ = rows
    model.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    model.a_matrix_.start_ = columns.indptr
    model.a_matrix_.index_ = columns.indices
    model.a_matrix_.value_ = columns.data
    return model
