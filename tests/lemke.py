"""Contact with Coulomb friction as a linear complementarity problem, solved by pivoting.

In the plane Coulomb's law is exact in this form (D. E. Stewart and J. C. Trinkle 1996, with
two directions of friction): for each contact with pressure p, friction u - v, and s, the size
of its slip,

    0 <= n             _|_  p >= 0,
    0 <= s + t         _|_  u >= 0,
    0 <= s - t         _|_  v >= 0,
    0 <= mu p - u - v  _|_  s >= 0,

where n and t are the normal and the tangential velocity. C. E. Lemke's method (1965) pivots
from one vertex to the next. It needs no start and no guess at what contacts do, and inverts
nothing but masses: none of what `blocksim.engines.contact` rests on.
"""

import numpy as np

ZERO = 1e-8
"""Entries of the tableau that are round-off."""


def lemke(matrix: np.ndarray, constant: np.ndarray) -> np.ndarray | None:
    """Return z >= 0 with w = matrix z + constant >= 0 and w z = 0; None where a ray is met.

    Ties are broken by the lexicographic order of rows, so that no vertex is met twice (Cottle,
    Pang and Stone 1992, section 4.9).
    """
    size = len(constant)
    if constant.min() >= 0:
        return np.zeros(size)
    # Columns: the constant, w, z, and the artificial variable that is in every row.
    tableau = np.hstack([constant[:, None], np.eye(size), -matrix, -np.ones((size, 1))])
    basis, artificial = np.arange(1, size + 1), 2 * size + 1

    def first(rows: np.ndarray, column: np.ndarray) -> int:
        """Return the row that reaches 0 first; of several that of the artificial variable."""
        for place in range(size + 1):
            ratios = tableau[rows, place] / column[rows]
            rows = rows[ratios <= ratios.min() + ZERO]
            if artificial in basis[rows]:
                return int(rows[basis[rows] == artificial][0])
            if len(rows) == 1:
                break
        return int(rows[0])

    entering = artificial
    row = first(np.arange(size), np.ones(size))
    for _ in range(100 * size):
        tableau[row] /= tableau[row, entering]
        others = np.arange(size) != row
        tableau[others] -= np.outer(tableau[others, entering], tableau[row])
        leaves, basis[row] = basis[row], entering
        if leaves == artificial:
            found = np.zeros(2 * size + 2)
            found[basis] = tableau[:, 0]
            return found[size + 1 : -1]
        # The complement of what left comes in.
        entering = leaves + size if leaves <= size else leaves - size
        rows = np.flatnonzero(tableau[:, entering] > ZERO)
        if len(rows) == 0:
            return None
        row = first(rows, tableau[:, entering])
    raise AssertionError("Lemke's method does not end")


def pivoted(
    rows: np.ndarray, rates: np.ndarray, mass: np.ndarray, free: np.ndarray, mu: np.ndarray
) -> tuple[np.ndarray, np.ndarray] | None:
    """Return accelerations and forces of a step, as `ContactProblem.solve` names them.

    Parameters
    ----------
    rows : (joints, 4, 3 blocks) float
        Normal velocities at the two contacts from all velocities, then tangential ones.
    rates : (joints, 4) float
    mass, free : (blocks, 3) float
    mu : (joints,) float
        Finite.
    """
    joints = len(rates)
    normal, along = (
        rows[:, part].reshape(2 * joints, -1) for part in (slice(0, 2), slice(2, 4))
    )
    push = np.vstack([normal, along, -along])
    count, none = 2 * joints, np.zeros((2 * joints, 2 * joints))
    matrix = np.zeros((4 * count, 4 * count))
    matrix[: 3 * count, : 3 * count] = push / mass.ravel() @ push.T
    matrix[count : 3 * count, 3 * count :] = np.vstack([np.eye(count)] * 2)
    matrix[3 * count :] = np.hstack(
        [np.diag(np.repeat(mu, 2)), -np.eye(count), -np.eye(count), none]
    )
    still = np.concatenate([rates[:, :2].ravel(), rates[:, 2:].ravel(), -rates[:, 2:].ravel()])
    found = lemke(matrix, np.concatenate([still + push @ free.ravel(), np.zeros(count)]))
    if found is None:
        return None
    pressure, up, down, _ = found.reshape(4, joints, 2)
    x = free.ravel() + found[: 3 * count] @ push / mass.ravel()
    return x.reshape(-1, 3), np.hstack([pressure, up - down])
