"""What `check` tells an engineer, against an own linear programme and statics by hand."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
from running import inside
from scipy.optimize import linprog

import blocksim
from blocksim import Arch, CircularArch

SPAN, RISE, THICKNESS, COUNT, ANGLE, HEAVY = 8.0, 3.0, 0.45, 31, 35.0, 22e3
DIMENSIONS = "--span 8 --rise 3 --thickness 0.45 --voussoirs 31"
ASKED = ["check", *f"{DIMENSIONS} --friction-angle 35 --unit-weight 22".split()]


def faces() -> tuple[float, float, np.ndarray]:
    """Intrados' radius, half-angle and the angles of the joints, from span and rise."""
    inner = (SPAN**2 / 4 + RISE**2) / (2 * RISE)
    half = math.asin(SPAN / 2 / inner)
    return inner, half, np.linspace(-half, half, COUNT + 1)


def by_hand(sign: float, thickness: float = THICKNESS) -> float | None:
    """Least (1) or greatest (-1) thrust in N/m, by a linear programme in x and y forces.

    Written from free bodies: the unknowns are the force from the left springing and its moment
    about the origin, and each joint's resultant follows by adding the weights to its left.
    """
    inner, half, angles = faces()
    middle = inner + THICKNESS / 2
    low, high = middle - thickness / 2, middle + thickness / 2
    step = 2 * half / COUNT
    weight = HEAVY * step * (high**2 - low**2) / 2
    # Centre of an annular sector.
    arm = 2 / 3 * (high**3 - low**3) / (high**2 - low**2) * math.sin(step / 2) / (step / 2)
    lever = arm * np.sin(angles[:-1] + step / 2)
    rows: list[list[float]] = []
    right: list[float] = []
    mu = math.tan(math.radians(ANGLE))
    for k, angle in enumerate(angles):
        # On the part right of the joint: (X, Y - w k), moment about the centre M - sum w x.
        down, turned = weight * k, -float((weight * lever[:k]).sum())
        normal = np.array([math.cos(angle), -math.sin(angle)])
        along = np.array([math.sin(angle), math.cos(angle)])
        press = np.array([normal[0], normal[1], 0.0]), -down * normal[1]
        slip = np.array([along[0], along[1], 0.0]), -down * along[1]
        # A force along the normal at radius rho turns by -rho about the centre.
        turn = np.array([0.0, 0.0, 1.0]), turned
        for sense in (1.0, -1.0):
            rows.append(sense * slip[0] - mu * press[0])
            right.append(-(sense * slip[1] - mu * press[1]))
        rows.append(-(turn[0] + high * press[0]))
        right.append(turn[1] + high * press[1])
        rows.append(turn[0] + low * press[0])
        right.append(-(turn[1] + low * press[1]))
    found = linprog([sign, 0, 0], A_ub=rows, b_ub=right, bounds=[(None, None)] * 3)
    return float(found.x[0]) if found.success else None


def answered(*arguments: str) -> dict[str, Any]:
    """What `--json` prints."""
    return json.loads(inside(*arguments, "--json").stdout)


@pytest.fixture(scope="module")
def told() -> dict[str, Any]:
    """The engineer's arch, asked in one command."""
    return answered(*ASKED)


def test_thrust_is_that_of_an_own_programme(told: dict[str, Any]) -> None:
    for field, sign in (("thrust_min_kN_per_m", 1.0), ("thrust_max_kN_per_m", -1.0)):
        want = by_hand(sign)
        assert told[field] * 1000 == pytest.approx(want, rel=1e-9)


def test_the_factor_of_safety_is_thickness_over_the_least(told: dict[str, Any]) -> None:
    """At the least thickness the own programme still stands, and 1e-9 below it does not."""
    factor = told["geometrical_factor"]
    assert by_hand(1.0, THICKNESS / factor * (1 + 1e-9)) is not None
    assert by_hand(1.0, THICKNESS / factor * (1 - 1e-9)) is None


def test_supports_bear_the_weight_by_hand(told: dict[str, Any]) -> None:
    """Half of gamma alpha (R^2 - r^2) each; moments about a springing balance."""
    inner, half, _ = faces()
    area = half * ((inner + THICKNESS) ** 2 - inner**2)
    left, right = told["reactions"]
    assert told["weight_kN"] == pytest.approx(HEAVY * area / 1000, rel=1e-12)
    assert left["vertical_kN"] == pytest.approx(HEAVY * area / 2000, rel=1e-12)
    assert left["horizontal_kN"] == pytest.approx(-right["horizontal_kN"], rel=1e-12)
    assert told["thrust_min_kN"] < left["horizontal_kN"] < told["thrust_max_kN"]
    # Each crosses its springing, whose middle is at R sin(alpha), R cos(alpha).
    along = np.array([math.sin(half), math.cos(half)])
    out = math.hypot(right["x_m"], right["y_m"])
    assert np.array([right["x_m"], right["y_m"]]) == pytest.approx(out * along, rel=1e-9)
    assert inner < out < inner + THICKNESS


def test_the_safest_state_uses_its_share_of_the_worst_joints(told: dict[str, Any]) -> None:
    used = [max(each["width_used"], each["friction_used"]) for each in told["worst_joints"]]
    assert used == pytest.approx([told["strength_used"]] * len(used), rel=1e-6)
    # A line of thrust that fits a thinner arch touches it at three joints of one half or more.
    assert len(used) >= 5


def test_thrust_at_a_joint_by_name() -> None:
    """Weights change no horizontal force, so every joint of the arch has the same thrust."""
    portal = ["check", "portal", "--mu", "0.7", "--unit-weight", "20"]
    crown = answered(*portal)
    other = answered(*portal, "--joint", "3-4")
    assert other["thrust_joint"] == "3-4"
    assert other["thrust_min_kN"] == pytest.approx(crown["thrust_min_kN"], rel=1e-8)
    wrong = inside(*portal, "--joint", "3-5")
    assert wrong.returncode == 2
    assert "--joint = '3-5'" in wrong.stderr


def test_the_thrust_of_a_critical_arch_is_the_papers() -> None:
    """At the least thickness the least and the greatest thrust are the one of eq. (7)."""
    ring = CircularArch(half_angle_deg=90, friction=math.inf, weight="centreline")
    critical = blocksim.bracket(ring, method="theory").arch
    # The paper's figures of the semicircle.
    assert critical.eta_high == pytest.approx(0.1074, abs=5e-5)
    arch = Arch(half_angle=math.pi / 2, eta=critical.eta_high * (1 + 1e-7), voussoirs=999)
    carried = blocksim.check(CircularArch.of(arch, friction=math.inf)).carried
    unit = arch.specific_weight * arch.thickness
    assert carried.thrust == pytest.approx([critical.thrust * unit] * 2, rel=2e-3)


def test_what_is_not_weighed_is_told_in_shares_of_its_weight() -> None:
    told = inside("check", "portal", "--mu", "0.7").stdout
    assert "no unit weight was given" in told
    assert "kN/m to" not in told
    record = answered("check", "portal", "--mu", "0.7")
    assert record["weights_given"] is False
    share = record["thrust_min_kN"] / record["weight_kN"]
    assert record["thrust_min_per_weight"] == pytest.approx(share, rel=1e-12)


def test_an_arch_that_leans_is_told_no_factors() -> None:
    arch = Arch(half_angle=1.0, eta=0.2, voussoirs=9)
    answer = blocksim.check(
        CircularArch.of(arch, 0.7).problem().leaning(0.02), method="pybullet"
    )
    assert answer.carried is None
    assert answer.to_dict()["geometrical_factor"] is None
