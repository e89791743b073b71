"""Load factors of blocks that crush, against a block's closed form and the rigid value."""

from typing import Any

import numpy as np
import pytest
from scipy import sparse

import blocksim
from blocksim.blocks.road import with_road
from blocksim.common.errors import InputError
from blocksim.kinds.circular import CircularArch
from blocksim.limit.cones import Cones

clarabel: Any = pytest.importorskip("clarabel")

WIDE, HIGH, DEEP, HEAVY = 0.6, 1.0, 0.5, 20e3


def _pushed(force: tuple[float, float], place: tuple[float, float]) -> blocksim.Problem:
    """One block on the ground, pushed at a place of it."""

    def rectangle(low: float, high: float) -> list[list[float]]:
        return [[0.0, low], [WIDE, low], [WIDE, high], [0.0, high]]

    return blocksim.structure_of(
        {
            "blocks": [
                {"id": "ground", "vertices": rectangle(-1.0, 0.0), "fixed": True},
                {"id": "block", "vertices": rectangle(0.0, HIGH), "depth": DEEP},
            ],
            "friction": 5.0,
            "density": HEAVY,
            "live": [{"block": "block", "force": list(force), "point": list(place)}],
        }
    )


@pytest.mark.parametrize("strength", [3e4, 1e5, 1e6, 1e8])
def test_a_pushed_block_rocks_about_the_middle_of_what_is_crushed(strength: float) -> None:
    """The lever of its weight is half its width less half of W / (strength depth)."""
    weight = HEAVY * WIDE * HIGH * DEEP
    lever = (WIDE - weight / (strength * DEEP)) / 2
    found = blocksim.collapse(_pushed((1.0, 0.0), (0.0, HIGH)), strength=strength)
    assert found.load_factor == pytest.approx(weight * lever / HIGH, rel=1e-7)


def test_a_block_pressed_in_its_middle_bears_its_strength() -> None:
    """Strength times area, less its own weight."""
    found = blocksim.collapse(_pushed((0.0, -1.0), (WIDE / 2, HIGH)), strength=1e6)
    most = 1e6 * WIDE * DEEP - HEAVY * WIDE * HIGH * DEEP
    assert found.load_factor == pytest.approx(most, rel=1e-9)


def test_factors_grow_with_strength_to_that_of_rigid_blocks() -> None:
    """What lacks falls in proportion to the inverse of the strength."""
    pushed = _pushed((1.0, 0.0), (0.0, HIGH))
    rigid = blocksim.collapse(pushed).load_factor
    assert rigid is not None
    factors: list[float] = []
    for strength in (1e5, 1e6, 1e7):
        factor = blocksim.collapse(pushed, strength=strength).load_factor
        assert factor is not None
        factors.append(rigid - factor)
    assert factors[0] / factors[1] == pytest.approx(10, rel=1e-4)
    assert factors[1] / factors[2] == pytest.approx(10, rel=1e-3)


def test_an_arch_crushes_as_second_order_cones_say() -> None:
    """The same bound on every end of a joint, exactly, by another solver."""
    arch = CircularArch(span=8.0, rise=3.0, thickness=0.45, friction=0.6, density=22e3)
    problem = with_road(arch.between_supports().problem(), [(2.0, 2.0, 50e3)])
    rigid = blocksim.collapse(problem).load_factor
    found = blocksim.collapse(problem, strength=2e6).load_factor
    assert rigid is not None
    assert found is not None
    assert found < 0.9 * rigid
    assert found == pytest.approx(_by_cones(problem, 2e6), rel=1e-7)


def _by_cones(problem: blocksim.Problem, strength: float) -> float:
    """Load factor of blocks one metre deep: n^2 <= m of ends m is |(2n, m - 1)| <= m + 1."""
    cones, count = Cones(problem), Cones(problem).count
    live = sum((problem.of_load(each) for each in problem.live), np.zeros(cones.shape))
    load = sparse.csc_array(cones.loads(live)[:, None])
    balance = sparse.csc_array(sparse.hstack([cones.balance, load]))
    pressing = -sparse.eye_array(count + 1, format="csc")[:count]
    rows: list[Any] = [balance, pressing]
    right = [-cones.loads(problem.with_load(0.0).pull()), np.zeros(count)]
    kinds = [clarabel.ZeroConeT(balance.shape[0]), clarabel.NonnegativeConeT(count)]
    ends = np.array([cones.forces(part)[:, :, 0] for part in np.eye(count)])
    for joint, given in enumerate(problem.assembly.joints):
        width = float(np.hypot(*(given.outer - given.inner)))
        crushing = strength * width / problem.unit_force
        whole = ends[:, joint].sum(axis=1) / crushing
        for end in (0, 1):
            mine = 2 * ends[:, joint, end] / crushing
            cone = np.array([-mine, -mine, -2 * whole])
            rows.append(np.column_stack([cone, np.zeros(3)]))
            right.append(np.array([1.0, -1.0, 0.0]))
            kinds.append(clarabel.SecondOrderConeT(3))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_rel = settings.tol_gap_abs = settings.tol_feas = 1e-10
    none = sparse.csc_matrix((count + 1, count + 1))
    matrix = sparse.csc_matrix(sparse.vstack([sparse.csc_array(each) for each in rows]))
    cost = np.append(np.zeros(count), -1.0)
    solver = clarabel.DefaultSolver(none, cost, matrix, np.concatenate(right), kinds, settings)
    return float(solver.solve().x[-1])


def test_a_strength_that_is_none_is_refused() -> None:
    """In one line that names it."""
    with pytest.raises(InputError, match="strength"):
        blocksim.collapse(_pushed((1.0, 0.0), (0.0, HIGH)), strength=-1.0)
