"""Sums over the joints of blocks, and the banded systems they form."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext, suppress
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg.lapack import dgbsv, dgbtrf, dgbtrs, dpbtrf, dpbtrs
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from blocksim.blocks.assembly import Array

BLOCKED = 32
"""Width from which LAPACK does."""
NARROW = 2
"""How far apart blocks that touch may be in an order that is looked for no further."""
EVEN = 6
"""Digits to which places are told apart."""
MOST_CHANGES, NO_RANK = 32, 1e-13
"""Rank of the changes after which a wide system is factored anew, and what is none of it."""


class Bands:
    """Which unknowns each joint couples.

    A system that cannot be solved gives nan, which no residual of a step survives. LAPACK is
    called without scipy's checks, which take as long as a system of 100 unknowns.

    Rows have shape (joints, k, 6), in space (joints, k, 12): each is a velocity of a joint,
    from those of its two blocks.

    `before`, `after`, (joints,): Blocks on both sides of each joint, -1 for the ground.
    `points`, (blocks, 2): Where the blocks are: numbered along an axis, those of a wall that
        touch are near.
    `each`: Unknowns of a block.
    """

    def __init__(
        self,
        before: NDArray[np.int64],
        after: NDArray[np.int64],
        blocks: int,
        points: Array | None = None,
        each: int = 3,
    ) -> None:
        self._each, self.size = each, each * blocks
        self.place = self._numbered = self._places_of(before, after)
        self._flat = self.place.ravel()
        self._inside = np.minimum(self.place, self.size - 1)[:, :, None]
        self._order = None
        inner = (before >= 0) & (after >= 0)
        order = _order(before[inner], after[inner], blocks, points)
        if order is not None:
            rank = np.append(np.argsort(order), -1)
            before, after = rank[before], rank[after]
            self._order = (each * order[:, None] + np.arange(each)).ravel()
            self._numbered = self._places_of(before, after)
        apart = int(np.abs(before - after)[inner].max(initial=0))
        self._width = each * (apart + 1) - 1
        self.rows = 3 * self._width + 1
        # Places in LAPACK's band storage, column after column, and one past its end.
        row, column = self._numbered[:, :, None], self._numbered[:, None, :]
        kept = (column <= row) & (row < self.size)
        end = (self._width + 1) * self.size
        self._lower = np.where(kept, column * self._width + row, end).ravel()

    @cached_property
    def whole(self) -> NDArray[np.int64]:
        """The same of a general matrix, shape (joints, 36), in space (joints, 144).

        Its factors need as many rows again above the band.
        """
        row, column = self._numbered[:, :, None], self._numbered[:, None, :]
        at = column * (self.rows - 1) + 2 * self._width + row
        inside = np.maximum(row, column) < self.size
        return np.where(inside, at, self.rows * self.size).reshape(len(at), -1)

    def _places_of(
        self, before: NDArray[np.int64], after: NDArray[np.int64]
    ) -> NDArray[np.int64]:
        """Unknowns of each joint; those of the ground are one past the end, to be dropped."""
        pair = np.stack([before, after], axis=1)[:, :, None]
        places = np.where(pair < 0, self.size, self._each * pair + np.arange(self._each))
        return places.reshape(len(pair), 2 * self._each)

    @property
    def is_wide(self) -> bool:
        """Whether LAPACK factors by whole blocks of columns, which BLAS may share out."""
        return self._width >= BLOCKED

    def one_thread(self) -> AbstractContextManager[Any]:
        """Keep BLAS to one thread, where systems are wide enough for it to take more.

        With two that of 500 blocks takes as long where nothing else runs, and a hundred times
        as long where something does, as threads wait for each other by turning round.
        """
        return _pools().limit(limits=1, user_api="blas") if self.is_wide else nullcontext()

    def of_joints(self, values: Array) -> Array:
        """Return for each joint the values of its blocks, 0 for the ground's."""
        padded = np.zeros(self.size + 1)
        padded[:-1] = values
        return padded[self.place]

    def along(self, rows: Array, values: Array) -> Array:
        """Velocities along rows that are 0 for the ground, shape (joints, k)."""
        return np.matmul(rows, values[self._inside])[:, :, 0]

    def pull(self, rows: Array, forces: Array) -> Array:
        """Sum forces along rows, shape (joints, k), on the blocks."""
        parts = np.matmul(forces[:, None, :], rows).ravel()
        sums = np.bincount(self._flat, parts, self.size + 1)
        return sums[:-1].astype(np.float64, copy=False)

    def factored(
        self, rows: Array, weight: ArrayLike, seen: Array | None = None
    ) -> Callable[[Array], Array] | None:
        """Return what solves (1 + rows^T weight seen) x = right; None if round-off forbids.

        Where `seen` is not given it is `rows`, and the matrix symmetric.
        """
        if seen is not None:
            return self.factored_band(self.band(rows, weight, seen))
        count = self._width + 1
        products = self._products(rows, weight, rows)
        sums = np.bincount(self._lower, products, count * self.size + 1)[:-1]
        band = sums.astype(np.float64, copy=False).reshape(self.size, count).T
        band[0] += 1.0
        factors, failed = dpbtrf(band, lower=1, overwrite_ab=1)
        return (
            None
            if failed
            else lambda right: self._natural(dpbtrs(factors, self._ordered(right), lower=1)[0])
        )

    def factored_band(self, band: Array) -> Callable[[Array], Array] | None:
        """Return what solves (1 + matrix) x = right, the matrix as from `band`, used up."""
        width = self._width
        factors, pivots, failed = dgbtrf(self._matrix(band), width, width, overwrite_ab=1)
        return (
            None
            if failed
            else lambda right: self._natural(
                dgbtrs(factors, width, width, self._ordered(right), pivots)[0]
            )
        )

    def band(self, rows: Array, weight: ArrayLike, seen: Array) -> Array:
        """Return rows^T weight seen in LAPACK's storage, and a place for what is dropped."""
        products = self._products(rows, weight, seen)
        band = np.bincount(self.whole.ravel(), products, self.rows * self.size + 1)
        return band.astype(np.float64, copy=False)

    def solve_band(self, band: Array, right: Array) -> Array:
        """Solve (1 + matrix) x = right, the matrix as from `band`; it is used up."""
        return self._solved(band, right)[0]

    def solve_signed(self, band: Array, right: Array) -> tuple[Array, float]:
        """Do the same, and return the sign of the determinant, too."""
        x, factors, pivots = self._solved(band, right)
        swaps = np.count_nonzero(pivots != np.arange(self.size))
        below = np.count_nonzero(factors[2 * self._width] < 0)
        return x, 1.0 if (swaps + below) % 2 == 0 else -1.0

    def _solved(self, band: Array, right: Array) -> tuple[Array, Array, NDArray[np.integer]]:
        width, right = self._width, self._ordered(right)
        factors, pivots, x, failed = dgbsv(
            width, width, self._matrix(band), right, overwrite_ab=1
        )
        x = self._natural(x) if failed == 0 else np.full_like(right, np.nan)
        return x, factors, pivots

    def _matrix(self, band: Array) -> Array:
        """Add 1 to a matrix as from `band`, in place."""
        band = band[:-1].reshape(self.size, self.rows).T
        band[2 * self._width] += 1.0
        return band

    def _ordered(self, values: Array) -> Array:
        return values if self._order is None else values[self._order]

    def _natural(self, values: Array) -> Array:
        if self._order is None:
            return values
        natural = np.empty_like(values)
        natural[self._order] = values
        return natural

    @staticmethod
    def _products(rows: Array, weight: ArrayLike, seen: Array) -> Array:
        weighted = rows.transpose(0, 2, 1) * np.asarray(weight)[:, None, :]
        return np.matmul(weighted, seen).ravel()


@cache
def _pools() -> Any:
    """Find the libraries loaded, once: it takes as long as a step."""
    from threadpoolctl import ThreadpoolController  # pyright: ignore[reportMissingTypeStubs]

    return ThreadpoolController()


def _order(
    before: NDArray[np.int64], after: NDArray[np.int64], blocks: int, points: Array | None
) -> NDArray[np.int64] | None:
    """Return an order in which blocks that touch are near; None for that which there is."""
    apart, best = int(np.abs(before - after).max(initial=0)), None
    for order in _orders(before, after, blocks, points):
        if apart <= NARROW:
            break
        rank = np.argsort(order)
        found = int(np.abs(rank[before] - rank[after]).max())
        if found < apart:
            best, apart = order.astype(np.int64), found
    return best


def _orders(
    before: NDArray[np.int64], after: NDArray[np.int64], blocks: int, points: Array | None
) -> Iterator[NDArray[np.integer]]:
    """Give orders that may do, the cheapest first."""
    if points is not None:
        # Blocks above each other are so to round-off only.
        x, y = np.round(points, EVEN).T
        yield np.lexsort((y, x))
        yield np.lexsort((x, y))
    graph = csr_array((np.ones(len(before)), (before, after)), shape=(blocks, blocks))
    yield reverse_cuthill_mckee(graph + graph.T, symmetric_mode=True)


class System:
    """A system (1 + matrix) x = right that changes joint by joint.

    Wide ones are factored once in a while only: what has changed since is of low rank, and is
    taken into account by the formula of Sherman, Morrison and Woodbury.

    `band`, (places,): The matrix, as from `Bands.band`.
    `right`, (3 blocks,).
    """

    def __init__(self, bands: Bands, band: Array, right: Array) -> None:
        self._bands, self._band = bands, band
        self._right = np.append(right, 0.0)
        self._factored: _Factored | None = None

    def add(self, joint: int, matrix: Array, right: Array) -> None:
        """Add to a joint's matrix (6, 6) and right side (6,)."""
        place = self._bands.place[joint]
        self._band[self._bands.whole[joint]] += matrix.ravel()
        self._right[place] += right
        if self._factored and not self._factored.add(joint, place, matrix, right):
            self._factored = None

    def solve(self, besides: Array | None = None) -> Array:
        """Return x, or with other right sides in columns the solutions of all, x first."""
        right = self._right[:-1]
        if self._bands.is_wide:
            if self._factored is None:
                solve = self._bands.factored_band(self._band.copy())
                self._factored = solve and _Factored(solve, right)
            if self._factored:
                return self._factored.solve(besides)
        if besides is not None:
            right = np.column_stack([right, besides])
        return self._bands.solve_band(self._band.copy(), right)


class _Factored:
    """A system that was factored, and its changes since: 1 + matrix + columns rows.

    `solve`: Solves what was factored.
    `right`, (3 blocks,).
    """

    def __init__(self, solve: Callable[[Array], Array], right: Array) -> None:
        self._solve, self._bare = solve, solve(right)
        self._count, self._changed, size = 0, set[int](), len(right) + 1
        # Solutions for the columns; rows by the six places where they are not 0.
        self._answers = np.zeros((size, MOST_CHANGES), order="F")
        self._places = np.zeros((MOST_CHANGES, 6), dtype=np.int64)
        self._rows = np.zeros((MOST_CHANGES, 6))
        self._right = np.zeros(MOST_CHANGES)

    def add(self, joint: int, place: NDArray[np.int64], matrix: Array, right: Array) -> bool:
        """Add at a joint's places; False where that is too much by now.

        What takes a stiff change back would cancel all of its digits.
        """
        if joint in self._changed:
            return False
        self._changed.add(joint)
        parts = [each / (np.abs(each).max() or 1.0) for each in (matrix, right[:, None])]
        ways, sizes, _ = np.linalg.svd(np.concatenate(parts, axis=1))
        ways = ways[:, sizes > NO_RANK * sizes[0]]
        old, new = self._count, self._count + ways.shape[1]
        if new > MOST_CHANGES:
            return False
        columns = np.zeros((len(self._answers), new - old))
        columns[place] = ways
        self._answers[:-1, old:new] = self._solve(columns[:-1])
        self._places[old:new], self._rows[old:new] = place, ways.T @ matrix
        self._right[old:new] = ways.T @ right
        self._count = new
        return True

    def solve(self, besides: Array | None) -> Array:
        """Solve as `System` does."""
        count, bare = self._count, self._bare[:, None]
        if besides is not None:
            bare = np.column_stack([bare, self._solve(besides)])
        rows, places = self._rows[:count, :, None], self._places[:count]
        small = np.eye(count) + (rows * self._answers[places, :count]).sum(axis=1)
        seen: Array = (rows * np.vstack([bare, np.zeros(bare.shape[1])])[places]).sum(axis=1)
        # Both are large where springs are stiff; their difference is not.
        wanted = -seen
        wanted[:, 0] += self._right[:count]
        shares = np.full(seen.shape, np.nan)
        with suppress(np.linalg.LinAlgError):
            shares[:] = np.linalg.solve(small, wanted)
        x: Array = bare + self._answers[:-1, :count] @ shares
        return x[:, 0] if besides is None else x
