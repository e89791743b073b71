"""What `check` tells an engineer, against an own linear programme and statics by hand."""

import math
from typing import Any

import numpy as np
import pytest
from own_bridge import Bridge, thrusts_of_half
from running import answered, inside

import blocksim
from blocksim import Arch, CircularArch

BRIDGE = Bridge(span=8.0, rise=3.0, thick=0.45, count=62, fill=0.0, heavy=22e3, heavy_fill=0.0)
"""Cut twice as often as the arch that is asked about: at the crown, too."""
MU = math.tan(math.radians(35.0))
DIMENSIONS = "--span 8 --rise 3 --thickness 0.45 --voussoirs 31"
ASKED = ["check", *f"{DIMENSIONS} --friction-angle 35 --unit-weight 22".split()]


def by_hand(share: float = 1.0) -> tuple[float, float]:
    """Least and greatest thrust [N], of a share of the thickness about the same centreline."""
    middle, thick = BRIDGE.inner + BRIDGE.thick / 2, share * BRIDGE.thick
    inner = middle - thick / 2
    span, rise = 2 * inner * math.sin(BRIDGE.angle), inner * (1 - math.cos(BRIDGE.angle))
    arch = Bridge(
        span=span, rise=rise, thick=thick, count=62, fill=0.0, heavy=22e3, heavy_fill=0.0
    )
    halves = arch.dead()[30::-1, 1:]
    # Half the keystone, then whole voussoirs.
    sums = [halves[:1], *np.split(halves[1:], 15)]
    parts = [(-down, turn / down) for down, turn in (each.sum(axis=0) for each in sums)]
    joints = [(arch.low[k], arch.high[k]) for k in range(30, -1, -2)]
    return thrusts_of_half(joints, parts, MU)


@pytest.fixture(scope="module")
def told() -> dict[str, Any]:
    """The engineer's arch, asked in one command."""
    return answered(*ASKED)


def test_thrust_is_that_of_an_own_programme(told: dict[str, Any]) -> None:
    thrusts = [1000 * told[f"thrust_{end}_kN_per_m"] for end in ("min", "max")]
    assert thrusts == pytest.approx(by_hand(), rel=1e-9)


def test_the_factor_of_safety_is_thickness_over_the_least(told: dict[str, Any]) -> None:
    """At the least thickness the own programme still stands, and 1e-9 below it does not."""
    least = 1 / told["geometrical_factor"]
    assert by_hand(least * (1 + 1e-9))
    with pytest.raises(AssertionError):
        by_hand(least * (1 - 1e-9))


def test_supports_bear_the_weight_by_hand(told: dict[str, Any]) -> None:
    """Half of gamma alpha (R^2 - r^2) each; moments about a springing balance."""
    inner, outer, half = BRIDGE.inner, BRIDGE.outer, BRIDGE.angle
    weight = 22.0 * half * (outer**2 - inner**2)
    left, right = told["reactions"]
    assert told["weight_kN"] == pytest.approx(weight, rel=1e-12)
    assert left["vertical_kN"] == pytest.approx(weight / 2, rel=1e-12)
    assert left["horizontal_kN"] == pytest.approx(-right["horizontal_kN"], rel=1e-12)
    assert told["thrust_min_kN"] < left["horizontal_kN"] < told["thrust_max_kN"]
    # Each crosses its springing, whose middle is at R sin(alpha), R cos(alpha).
    along = np.array([math.sin(half), math.cos(half)])
    out = math.hypot(right["x_m"], right["y_m"])
    assert np.array([right["x_m"], right["y_m"]]) == pytest.approx(out * along, rel=1e-9)
    assert inner < out < outer


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
