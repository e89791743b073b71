"""The semicircular arch, as published.

@article{CocchettiRizzi2020,
  author  = {Cocchetti, Giuseppe and Rizzi, Egidio},
  title   = {Analytical and numerical analysis on the collapse modes of least-thickness
             circular masonry arches at decreasing friction},
  journal = {Frattura ed Integrita Strutturale},
  volume  = {14}, number = {51}, pages = {356--375}, year = {2020},
  doi     = {10.3221/IGF-ESIS.51.26},
}
@article{Heyman1969,
  author  = {Heyman, Jacques},
  title   = {The safety of masonry arches},
  journal = {International Journal of Mechanical Sciences},
  volume  = {11}, number = {4}, pages = {363--385}, year = {1969},
  doi     = {10.1016/0020-7403(69)90070-8},
}

Six printed digits, so half a unit of the sixth is asked for. Couplet's value
is that of the same moment balances with a wrong inner hinge; 0.1075 at 54.5 deg is
Milankovitch's, with the weight at the centroids of the true voussoirs.
"""

import math

import pytest
from arches import least
from derivations import lower_thrust, whole_thrust
from scipy.optimize import brentq

from blocksim import Mode

QUARTER = math.pi / 2
SIX = 5.001e-7
"""Half a unit of the sixth decimal."""


def test_purely_rotational() -> None:
    found = least(QUARTER, 0.7)
    assert found.modes_theory == (Mode.RRR,)
    assert found.eta_theory == pytest.approx(0.107426, abs=SIX)
    assert found.thrust == pytest.approx(0.621772, abs=SIX)
    assert math.degrees(found.beta_r) == pytest.approx(54.4963, abs=5.001e-5)
    assert found.beta_s is None


def ends(*modes: Mode) -> float:
    """Least friction at which it falls by none of the first modes only."""
    low, high = 0.1, 1.0
    while low < (middle := (low + high) / 2) < high:
        rough = least(QUARTER, middle).modes_theory[0] not in modes
        low, high = (low, middle) if rough else (middle, high)
    return high


def test_friction_limits() -> None:
    assert ends(Mode.SS) == pytest.approx(0.309215, abs=SIX)
    assert least(QUARTER, 0.309214).eta_theory is None
    assert ends(Mode.SS, Mode.SRR) == pytest.approx(0.395832, abs=SIX)
    assert least(QUARTER, 0.309216).modes_theory == (Mode.SRR,)
    assert least(QUARTER, 0.395833).modes_theory == (Mode.RRR,)


def test_at_the_lower_friction_limit() -> None:
    found = least(QUARTER, ends(Mode.SS))
    assert set(found.modes_theory) == {Mode.SRR, Mode.SS}
    assert found.eta_theory == pytest.approx(0.200637, abs=SIX)
    assert found.thrust == pytest.approx(0.485714, abs=SIX)
    assert math.degrees(found.beta_r) == pytest.approx(60.5134, abs=5.001e-5)
    assert math.degrees(found.beta_s) == pytest.approx(28.6362, abs=5.001e-5)


def test_milankovitch_weight() -> None:
    found = least(QUARTER, math.inf, weight="sector")
    assert found.eta_theory == pytest.approx(0.1075, abs=5e-5)
    assert math.degrees(found.beta_r) == pytest.approx(54.5, abs=0.05)
    fine = least(QUARTER, math.inf, 600, "sector")
    assert fine.eta_limit == pytest.approx(0.107477, abs=2e-6)


def test_couplet_is_unsafe() -> None:
    """Hinges at 45 deg: 0.101; of Heyman's, at 58.8 deg, `test_remarks_2024` tells."""
    couplet = brentq(
        lambda eta: lower_thrust(math.pi / 4, eta) - whole_thrust(QUARTER, eta), 1e-6, 1
    )
    assert couplet == pytest.approx(0.101, abs=5e-4)
    assert couplet < least(QUARTER, math.inf).eta_theory
