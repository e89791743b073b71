"""Supports that move slowly: known values, closed forms, and two methods on each other."""

import json
import math
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn import written
from kind_cases import KINDS, PLANAR
from own_bridge import Bridge, thrusts_of_half
from running import answered, csv_rows, inside, ran
from scipy.optimize import brentq
from structure_cases import case
from worlds import DIRECT, joint_motion

from blocksim import (
    CircularArch,
    Column,
    InputError,
    JointState,
    Verdict,
    bracket,
    check,
    equilibrium,
    load_recording,
    structure_of,
)
from blocksim.ask.moved import spread_by, thrusts_over
from blocksim.ask.push import borne, curve, pushed
from blocksim.ask.spread import Spreading
from blocksim.engines.moving import OnMovingSupports
from blocksim.limit.spreading import displaced_at, follow

pytestmark = pytest.mark.usefixtures("wide_window")

SPREAD = ("spread_90_12_20", "spread_90_15_20", "spread_90_20_20")
OF_SPAN = (0.01668, 0.05393, 0.15252)


def semicircle(thickness: float, **more: Any) -> dict[str, Any]:
    arch = {"kind": "circular-arch", "friction": "inf", "voussoirs": 20}
    return {**arch, "thickness": thickness, **more}


def apart(name: str) -> dict[str, Any]:
    """The scene of a case, with its supports moving apart alike."""
    scene = case(name)["scene"]
    ends = [block["id"] for block in scene["blocks"] if block.get("fixed")]
    ways = zip(ends, (-0.5, 0.5), strict=True)
    moves = [{"block": end, "direction": [way, 0]} for end, way in ways]
    return {**scene, "move": moves}


@pytest.mark.parametrize(
    ("name", "share"),
    [
        pytest.param(name, share, marks=[] if name == SPREAD[0] else pytest.mark.long)
        for name, share in zip(SPREAD, OF_SPAN, strict=True)
    ],
)
def test_span_at_collapse_by_continuation(name: str, share: float) -> None:
    """As published with the cases: value, of the span, hinges that do not move."""
    path = follow(structure_of(apart(name)), 0.5)
    want = case(name)["expected"]
    assert path.ends == "collapse"
    assert path.value == pytest.approx(want["value"], rel=1e-6)
    assert path.value / 2 == pytest.approx(share, abs=5e-6)
    joint = 6 if name != "spread_90_20_20" else 7
    hinges = {10 - joint: "hinge-intrados", 10: "hinge-extrados", 10 + joint: "hinge-intrados"}
    for frame in path.frames[1:]:
        states = enumerate(frame.states)
        assert {at: state.value for at, state in states if state != "closed"} == hinges
    assert [event.what for event in path.events] == ["hinges", "collapse"]
    fallen = path.events[-1].after.states
    springings = [fallen[0], fallen[-1]]
    assert springings == [JointState.HINGE_EXTRADOS] * 2


def test_closed_contacts_stay_and_open_ones_do_not_overlap() -> None:
    """Of the displaced blocks, measured as those of any recording."""
    problem = structure_of(semicircle(0.15))
    path = Spreading(problem).path
    frame = path.frames[-1]
    moved = joint_motion(problem.assembly, frame.poses)
    inside = slice(1, -1)  # springings are measured against supports that stay
    gap, closed = moved.gap[inside], frame.closed[inside]
    assert np.abs(gap[closed]).max() < 1e-12
    assert gap[~closed].min() > 1e-2
    assert np.abs(moved.slip[inside][closed.all(axis=1)]).max() < 1e-12
    # The springings have moved with their supports, each by half of the way.
    reach = path.value / 2 / problem.assembly.size
    shift = (
        frame.poses[[0, -1], 0] - problem.assembly.centres[[0, -1], 0] / problem.assembly.size
    )
    assert shift == pytest.approx([-reach, reach], rel=1e-9)


WIDE, HIGH = 0.2, 1.0
"""Of two slabs that lean on each other: width of their feet, height."""


def slabs(foot: float, **more: Any) -> Any:
    """Two slabs on feet that end so far from the middle."""
    blocks = [
        {"id": "west", "vertices": [[-2, -1], [-foot, -1], [-foot, 0], [-2, 0]], "fixed": True},
        {"id": "east", "vertices": [[foot, -1], [2, -1], [2, 0], [foot, 0]], "fixed": True},
        {"id": "left", "vertices": [[-1, 0], [-1 + WIDE, 0], [0, HIGH - WIDE], [0, HIGH]]},
        {"id": "right", "vertices": [[1 - WIDE, 0], [1, 0], [0, HIGH], [0, HIGH - WIDE]]},
    ]
    return structure_of({"friction": "inf", "blocks": blocks, **more})


@pytest.mark.parametrize("steps", [None, pytest.param(17, marks=pytest.mark.long)])
def test_a_three_hinged_arch_of_two_blocks_falls_when_it_is_flat(steps: int | None) -> None:
    """Two slabs lean on each other, on the inner corners of their feet and on their tops.

    As the feet move apart these three hinges come into line: there nothing holds them, from
    wherever the last position on the way happens to be.
    """
    problem = slabs(1 - WIDE)
    flat = 2 * (math.hypot(1 - WIDE, HIGH) - (1 - WIDE))
    moved = Spreading(problem)
    path = follow(moved.problem, 1.0, steps) if steps else moved.path
    assert JointState.CLOSED not in path.events[0].after.states
    assert path.ends == "collapse"
    assert path.value == pytest.approx(flat, rel=1e-8)


def test_blocks_that_meet_beside_their_joints_are_followed_no_farther() -> None:
    """Slabs lie down on their feet, which reach under them, before the hinges are in line."""
    problem = slabs(0.5)
    # Turned by half a right angle the side of a slab, which rises by that, is level.
    lies = 2 * ((1 - WIDE + HIGH) / math.sqrt(2) - (1 - WIDE))
    path = Spreading(problem).path
    assert [event.what for event in path.events] == ["hinges", "meets"]
    assert path.value == pytest.approx(lies, abs=1e-5)
    found = bracket(problem, over="spread", method="limit")
    assert (found.limit, found.high) == (None, None)
    with pytest.raises(InputError, match="farther is not followed"):
        spread_by(problem, 0.96)


def test_direct_says_that_it_gave_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks that are taken for fast, and stay as supports stop, have not fallen."""
    monkeypatch.setattr("blocksim.ask.spread.FAST", 0.1)
    seen = Spreading(slabs(0.5)).slowly(0.01, 1.0)
    assert (seen.high, seen.solved) == (None, False)


def test_supports_that_only_jam_blocks_do_not_make_them_fall() -> None:
    """A flat arch is pressed by any thrust: its supports cannot come nearer to each other."""
    nearer = [{"block": "right", "direction": [-1, 0]}]
    problem = structure_of({"kind": "flat-arch", "friction": "inf", "move": nearer})
    path = Spreading(problem).path
    assert (path.ends, path.value, path.first_fall) == ("jams", 0.0, None)
    assert bracket(problem, over="spread", method="limit").limit is None
    with pytest.raises(InputError, match="farther is not followed"):
        spread_by(problem, 1e-3)


def test_hinges_that_have_just_formed_are_no_fall() -> None:
    """As hinges form no force is left at their other ends, but for round-off."""
    load = {"block": "2.1", "point": [0.27101424633870824, 0.01741393711878459]}
    load["force"] = [0, -0.011068542973853908]
    moves = [
        {"block": "left", "direction": [-0.4657311567881792, -0.6277100910758697]},
        {
            "block": "right",
            "direction": [0.7965959400638762, -0.838370705633998],
            "turn_deg": 0.9438342291875843,
        },
    ]
    dead = [{"body": [0, -1]}, load]
    problem = structure_of({"kind": "arcade", "friction": "inf", "move": moves, "dead": dead})
    path = follow(problem, 0.02, 1)
    assert [event.what for event in path.events] == ["hinges", "snaps"]
    assert path.first_fall > 0.018
    assert check(replace(displaced_at(problem, path, 0.018), moves=())).proved


def turned(turn: float) -> tuple[Any, float]:
    """A block on a base that turns [deg/m], and how far until its centre is over an edge."""
    base = {"id": "base", "vertices": [[-2, -1], [3, -1], [3, 0], [-2, 0]], "fixed": True}
    block = {"id": "block", "vertices": [[0, 0], [1, 0], [1, 2], [0, 2]]}
    moves = [{"block": "base", "direction": [0, 0], "turn_deg": turn}]
    problem = structure_of({"friction": "inf", "blocks": [base, block], "move": moves})
    return problem, math.degrees(math.atan(0.5)) / turn


@pytest.mark.parametrize("turn", [60.0, 36000.0])
def test_a_support_that_turns_tips_a_block(turn: float) -> None:
    """However fast it turns as the parameter grows."""
    problem, tips = turned(turn)
    assert bracket(problem, over="spread", method="limit").limit == pytest.approx(
        tips, rel=1e-8
    )


@pytest.mark.parametrize("method", ["limit", "direct", "pymunk", "pybullet", "mujoco"])
def test_engines_see_a_fall_that_supports_brought_about(method: str) -> None:
    """It lies farther beyond its limit than they are exact."""
    problem, tips = turned(30.0)
    for share, verdict in ((0.97, Verdict.STANDS), (1.03, Verdict.COLLAPSES)):
        assert check(spread_by(problem, share * tips), method=method).verdict is verdict


SPREADING = (
    *((7, 0.35), (8, 0.35), (9, 0.2), (11, 0.4), (13, 0.25), (15, 0.4)),
    *((17, 0.15), (19, 0.3), (21, 0.2), (25, 0.35), (27, 0.15), (31, 0.25)),
)
"""Voussoirs and thickness of semicircles."""
SHARES = (0.5, 0.51, 0.0, 1.0, 0.25)
"""Of the motion, that the left support does."""
Hinges = tuple[int, int, int]


def ends_pressed(voussoirs: int, thickness: float, hinges: Hinges, apart: float) -> float:
    """Least force at any end of any joint of a semicircle on three hinges, by statics.

    Of the joints named the outer two turn about their intrados, the middle one about its
    extrados. Two bars go from hinge to hinge: where they are, geometry says, and what they
    carry, moments about the hinges. nan where the bars do not reach.
    """
    first, crown, last = hinges
    angles = np.linspace(-math.pi / 2, math.pi / 2, voussoirs + 1)
    radial = np.column_stack([np.sin(angles), np.cos(angles)])
    inner, outer = (1 - thickness / 2) * radial, (1 + thickness / 2) * radial
    half = math.pi / voussoirs / 2
    mean = (1 + thickness**2 / 12) * math.sin(half) / half  # of a sector's centroid
    middles = (angles[1:] + angles[:-1]) / 2
    centres = mean * np.column_stack([np.sin(middles), np.cos(middles)])
    shift = np.array([apart / 2, 0.0])
    left, right = inner[first] - shift, inner[last] + shift
    bars = [np.linalg.norm(outer[crown] - inner[at]) for at in (first, last)]
    span = np.linalg.norm(right - left)
    if span >= sum(bars):
        return math.nan
    along = (bars[0] ** 2 - bars[1] ** 2 + span**2) / (2 * span)
    way = (right - left) / span
    top = left + along * way + math.sqrt(bars[0] ** 2 - along**2) * np.array([-way[1], way[0]])

    def carried(points: np.ndarray, fixed: np.ndarray, now: np.ndarray) -> np.ndarray:
        """Points of a bar that turns about its foot, which has moved."""
        before, after = outer[crown] - fixed, top - now
        turn = math.atan2(after[1], after[0]) - math.atan2(before[1], before[0])
        cos, sin = math.cos(turn), math.sin(turn)
        return now + (points - fixed) @ np.array([[cos, sin], [-sin, cos]])

    def placed(points: np.ndarray, at: np.ndarray, side: float) -> np.ndarray:
        """All points where they are; on the joint at the crown by the side asked for."""
        found = np.where(at[:, None] < first, points - shift, points + shift)
        on = (at >= first) & (at < crown + side)
        found[on] = carried(points[on], inner[first], left)
        on = (at >= crown + side) & (at <= last - 1 + side)
        found[on] = carried(points[on], inner[last], right)
        return found

    blocks, joints = np.arange(voussoirs), np.arange(voussoirs + 1)
    centres = placed(centres, blocks, 0.0)
    inner, outer = (placed(points, joints, 0.5) for points in (inner, outer))
    weights = np.ones(voussoirs)
    # Moments about the right hinge of all, about the top of the left bar.
    one, two = slice(first, crown), slice(crown, last)
    arms = centres[:, 0]
    rise, reach = top[1] - left[1], top[0] - left[0]
    own = float((weights[one] * (top[0] - arms[one])).sum())
    all_ = own + float((weights[two] * (top[0] - arms[two])).sum())
    other = all_ - own
    back, fall = right[0] - top[0], top[1] - right[1]
    # H rise = V reach - own, and H fall = (W - V) back + other (moments of the right bar).
    load = float(weights[first:last].sum())
    matrix = np.array([[rise, -reach], [fall, back]])
    thrust, lift = np.linalg.solve(matrix, np.array([-own, load * back + other]))
    least = math.inf
    for joint in joints.tolist():
        between = slice(min(first, joint), max(first, joint))
        sign = 1.0 if joint >= first else -1.0

        def moment(about: np.ndarray, between: slice = between, sign: float = sign) -> float:
            """Of the force through the joint: that of the hinge, less that of weights."""
            arm = left - about
            weighed = -weights[between] * (arms[between] - about[0])
            return arm[0] * lift - arm[1] * thrust + sign * float(weighed.sum())

        ends = [-moment(inner[joint]), moment(outer[joint])]
        if joint in hinges:
            ends = ends[:1] if joint == crown else ends[1:]
        least = min(least, *ends)
    return least / thickness


def first_fall(voussoirs: int, thickness: float) -> set[float]:
    """How far supports go apart until forces no longer fit, on all hinges that fit at first."""
    start, found = 1e-3, set[float]()
    for hinges in combinations(range(voussoirs + 1), 3):
        if not ends_pressed(voussoirs, thickness, hinges, start) > 0:
            continue
        grid = np.linspace(start, 1.5, 1500)
        pressed = [ends_pressed(voussoirs, thickness, hinges, at) for at in grid.tolist()]
        beyond = next(at for at, each in enumerate(pressed) if not each > 0)

        def lacking(at: float, hinges: Hinges = hinges) -> float:
            return ends_pressed(voussoirs, thickness, hinges, at)

        found.add(round(brentq(lacking, grid[beyond - 1], grid[beyond], xtol=1e-14), 9))
    return found


def shared(voussoirs: int, thickness: float, share: float) -> Spreading:
    """A semicircle whose left support does a share of the motion."""
    ways = (("left", -share), ("right", 1 - share))
    moves = [{"block": end, "direction": [way, 0]} for end, way in ways]
    return Spreading(structure_of(semicircle(thickness, voussoirs=voussoirs, move=moves)))


@pytest.mark.parametrize(
    ("arch", "shares"),
    [
        (SPREADING[0], (0.51,)),
        *(pytest.param(arch, SHARES, marks=pytest.mark.long) for arch in SPREADING),
    ],
)
def test_spread_is_one_value_however_it_is_shared(
    arch: tuple[int, float], shares: tuple[float, ...]
) -> None:
    """That of the stable branch: of two halves that mirror each other one leads."""
    (want,) = first_fall(*arch)
    for share in shares:
        assert shared(*arch, share).exact == pytest.approx(want, abs=1e-6)


@pytest.mark.long
@pytest.mark.parametrize(
    ("arch", "share"),
    [
        *(((7, 0.35), 0.3), ((9, 0.2), 0.5), ((11, 0.4), 0.5), ((17, 0.15), 1.0)),
        *(((21, 0.2), 0.5), ((27, 0.15), 0.0), ((31, 0.25), 0.51)),
    ],
)
def test_direct_brackets_the_stable_branch(arch: tuple[int, float], share: float) -> None:
    (want,) = first_fall(*arch)
    found = bracket(shared(*arch, share).asked, over="spread", method="direct")
    assert 0.998 * want < found.low < found.high < 1.002 * want
    assert found.confirmed


def test_a_load_at_a_point_acts_while_supports_move() -> None:
    """At the centre of a block that hardly turns it does what a force on the block does."""
    table = semicircle(0.13, voussoirs=8)
    x, y = structure_of(table).assembly.blocks[4].centre
    after = list[Any]()
    for point in ({}, {"point": [x, y]}):
        load = {"block": 5, "force": [0.0, -500.0], **point}
        problem = structure_of({**table, "dead": [load]})
        world = OnMovingSupports(problem, DIRECT.rule(problem.assembly), 1e-3)
        for _ in range(10):
            world.advance_once()
        after.append(world.poses())
    assert np.abs(after[1] - after[0]).max() < 1e-9
    assert np.abs(after[0][:, 2]).max() > 1e-6


def test_supports_that_settle() -> None:
    """On the left as on the right; `direct` agrees, which knows no hinges."""
    table = semicircle(0.11, voussoirs=12)
    down = [[{"block": side, "direction": [0, -1]}] for side in ("left", "right")]
    found = [Spreading(structure_of({**table, "move": move})) for move in down]
    value = found[0].exact
    assert found[1].exact == pytest.approx(value, rel=1e-6)
    hinges = [
        [at for at, state in enumerate(each.path.events[0].after.states) if state != "closed"]
        for each in found
    ]
    assert hinges == [[0, 6, 10], [2, 6, 12]]
    seen = found[1].slowly(0.01, 0.5)
    assert 0.99 * value < seen.low < seen.high < 1.01 * value


def test_hinges_of_a_segment_migrate() -> None:
    """They jump from the springings to the next joints: the arch is caught, and later falls."""
    table = semicircle(0.2, left_deg=60, right_deg=60)
    path = Spreading(structure_of(table)).path
    assert [event.what for event in path.events] == ["hinges", "snaps", "collapse"]
    hinges = [
        [at for at, state in enumerate(event.after.states) if state != "closed"]
        for event in path.events[:2]
    ]
    assert hinges == [[0, 10, 20], [1, 10, 19]]
    first, caught, last = (event.value for event in path.events)
    assert first == 0 < caught < last


def test_moves_are_written_back() -> None:
    moves = [{"block": "right", "direction": [0.0, -1.0], "turn_deg": 5.0, "about": [1.0, 0.0]}]
    problem = structure_of(semicircle(0.15, move=moves))
    again = structure_of(problem.to_dict())
    assert again.moves[0].turn == pytest.approx(math.radians(5))
    assert again.moves[0].about == pytest.approx([1, 0])


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """An arch as a structure file."""
    table = {"kind": "circular-arch", "voussoirs": 8, "friction": 0.8, "thickness": 0.13}
    return written(tmp_path / "arch.json", table)


@pytest.mark.long
def test_supports_that_move_are_recorded_until_all_has_fallen(
    file: Path, tmp_path: Path
) -> None:
    """The supports go apart evenly, until it falls near the way known; all comes to rest."""
    out = tmp_path / "run.npz"
    ran("simulate", file, "--over", "spread", "--out", out)
    recording = load_recording(out)
    assert recording.problem.title == "circular-arch"
    assert recording.poses.shape[1] == 8 + 2
    apart = recording.poses[:, 9, 0] - recording.poses[:, 8, 0]
    size = recording.assembly.size
    assert apart[-1] > apart[0]
    goes = np.diff(apart)
    going = goes > goes[0] / 2
    assert goes[going] == pytest.approx(goes[0], rel=1e-6)
    assert np.abs(goes[np.argmin(going) :]).max() < 1e-6 * goes[0]  # they stop
    still = np.abs(recording.poses[-40:] - recording.poses[-1])[..., :2]
    assert still.max() < 1e-3
    crown = recording.poses[:, 3, 1]
    moved = (apart - apart[0]) * size
    falls = moved[int(np.argmax(crown < crown[0] - 0.3))]
    known = Spreading(structure_of(json.loads(file.read_text()))).exact
    # It takes a while until it is seen to fall, in which the supports go on.
    assert known < falls < known + 0.01 * 3


SLENDER = ("--with", "width=0.5", "--with", "drums=1", "--with", "drum_height=3")


@pytest.mark.parametrize(("push", "code"), [("0.15", 0), ("0.1666", 0), ("0.1668", 1)])
def test_a_column_tips_at_its_width_over_its_height(push: str, code: int) -> None:
    """0.5 m over 3 m: a sixth of its weight, both ways."""
    told = answered("check", "column", "--mu", "0.7", *SLENDER, "--push", push, code=code)
    assert told["proved"]
    assert "it bears 0.166667 g either way" in told["reason"]


def test_the_worse_way_is_taken() -> None:
    """A tilted column: tan(beta - tilt) downhill, tan(beta + tilt) uphill."""
    column = Column(width=0.5, drums=1, drum_height=3.0, friction=2.0).problem()
    tilt, beta = math.radians(3.0), math.atan(0.5 / 3.0)
    found = borne(column.tilted(tilt))
    # The push goes along the table, gravity leans on it.
    for way, turn in (("to the right", -1), ("to the left", 1)):
        exact = math.cos(tilt) * (math.tan(beta) + turn * math.tan(tilt))
        assert found[way] == pytest.approx(exact, rel=1e-9)
    low = pushed(column.tilted(tilt), found["to the right"] * 1.001)
    assert not equilibrium(low).exists
    assert equilibrium(pushed(column.tilted(tilt), found["to the right"] * 0.999)).exists
    assert "g to the right: it bears" in low.notes[-1]


@pytest.mark.parametrize("way", ["right", "left"])
def test_the_push_on_a_rocking_block_falls_as_its_angle(way: str) -> None:
    """tan(beta - turn) at R (sin beta - sin(beta - turn)), to nothing over the edge."""
    column = Column(width=0.5, drums=3, drum_height=1.0, friction=2.0).problem()
    seen = curve(column, way)
    beta, reach = math.atan(0.5 / 3.0), math.hypot(0.25, 1.5)
    assert seen.ends == "none"
    assert seen.moved[-1] == pytest.approx(0.25, rel=1e-5)
    for moved, push in zip(seen.moved, seen.pushes, strict=True):
        left = math.asin(max(0.0, math.sin(beta) - moved / reach))
        assert push == pytest.approx(math.tan(left), abs=2e-5)


@pytest.mark.parametrize("kind", PLANAR)
def test_every_kind_is_pushed_both_ways(kind: str) -> None:
    """What is borne is the change from standing to falling, whatever is built."""
    problem = KINDS[kind](friction=0.7).problem()
    found = borne(problem)
    least = min(found.values())
    assert least > 0
    assert equilibrium(pushed(problem, min(5.0, 0.999 * least))).exists
    if least < 5:
        assert not equilibrium(pushed(problem, 1.001 * least)).exists


ARCH = CircularArch(span=8.0, rise=3.0, thickness=0.6, voussoirs=14, friction=0.7, density=2e4)


def test_an_arch_that_is_spread_has_its_least_thrust() -> None:
    """Hinges at crown and haunches: moments of one half, turned as far as its way."""
    problem = ARCH.but(on_supports=True).problem()
    spread = 0.02
    lies = spread_by(problem, spread)
    points = thrusts_over(problem, 8)
    assert points[0][1:] == pytest.approx(half_of(problem), rel=1e-7)
    rises = [low for _, low, _ in points[1:]]
    assert rises == sorted(rises)
    # The left part between haunch and crown, as it lies: its weight about the haunch.
    joints = lies.assembly.joints
    hinges = [
        (joint.after, joint.inner) for joint in joints if joint.is_corner and joint.before >= 0
    ]
    (first, haunch), (last, crown), *_ = hinges
    part = lies.assembly.blocks[first:last]
    weight = np.array([block.mass * 9.81 for block in part])
    x = np.array([block.centre[0] for block in part])
    # The crown's force is level where the arch is its own mirror image.
    thrust = float((weight * (x - haunch[0])).sum() / (crown[1] - haunch[1]))
    told = answered(
        *("check", "--span", "8", "--rise", "3", "--thickness", "0.6", "--voussoirs", "14"),
        *("--mu", "0.7", "--unit-weight", "20", "--spread", str(spread)),
    )
    assert told["thrust_min_kN"] == pytest.approx(thrust / 1e3, rel=1e-6)
    assert told["thrust_max_kN"] == pytest.approx(told["thrust_min_kN"], rel=1e-6)
    assert "it falls" in told["reason"]


def half_of(problem: Any) -> tuple[float, float]:
    """Least and greatest thrust of an arch with a joint at its crown, by its own programme."""
    joints = [each for each in problem.assembly.joints if each.inner[0] < 1e-9][::-1]
    blocks = [each for each in problem.assembly.blocks if each.centre[0] < 0][::-1]
    parts = [(0.0, 0.0), *((each.mass * 9.81, each.centre[0]) for each in blocks)]
    return thrusts_of_half([(each.inner, each.outer) for each in joints], parts, problem.mu)


def test_curves_are_written(tmp_path: Path) -> None:
    arch = ("--span", "8", "--rise", "3", "--thickness", "0.6", "--voussoirs", "9")
    arch = (*arch, "--mu", "0.7")
    for over, name in (("push", "push_g"), ("spread", "thrust_min_kN")):
        table, picture = tmp_path / f"{over}.csv", tmp_path / f"{over}.svg"
        ran(*("bracket", *arch, "--over", over, "--out", str(table), "--out", str(picture)))
        rows = csv_rows(table)
        assert len(rows) > 10
        assert float(rows[0][name]) > 0
        assert ("to the left" if over == "push" else "least thrust") in picture.read_text()


def test_a_portal_under_fill_thrusts_as_a_half_does() -> None:
    """By an own programme of half a ring, a pier and fill up to a level road."""
    asks = ("--mu", "0.6", "--unit-weight", "20", "--fill", "0.4", "--joint", "13-14")
    told = answered("check", "portal", *asks)
    # Centreline of 1 m, 0.2 m thick; piers of 0.6 m from the intrados on, 1 m high.
    ring = Bridge(span=1.8, rise=0.9, thick=0.2, count=54, fill=0.4)
    halves = ring.dead()[26::-1, 1:]
    # Half the keystone, two halves of each voussoir, the pier with the fill beyond the ring.
    sums = [halves[:1], *np.split(halves[1:], 13), np.array([[-12, 1.2 * 12], [-12, 1.3 * 12]])]
    parts = [(-down, turn / down) for down, turn in (each.sum(axis=0) for each in sums)]
    joints = [(ring.low[k], ring.high[k]) for k in range(26, -1, -2)]
    joints.append((np.array([-0.9, -1.0]), np.array([-1.5, -1.0])))
    least, greatest = thrusts_of_half(joints, parts, 0.6)
    assert told["thrust_min_kN"] == pytest.approx(least, rel=1e-6)
    assert told["thrust_max_kN"] == pytest.approx(greatest, rel=1e-6)
    for each in told["reactions"]:
        assert each["vertical_kN"] == pytest.approx(sum(part for part, _ in parts), rel=1e-9)


def test_what_fell_stands_nowhere_beyond() -> None:
    """A flat arch straightens until its three hinges are in line: then nothing holds it."""
    flat = structure_of({"kind": "flat-arch", "friction": 0.8})
    left, crown, right = (flat.assembly.joints[at] for at in (0, 4, 9))
    a, b, c = left.inner, crown.outer, right.inner
    falls = math.dist(a, b) + math.dist(b, c) - math.dist(a, c)
    assert bracket(flat, over="spread", method="limit").limit == pytest.approx(falls, rel=1e-6)
    moved = Spreading(flat)
    for share in (0.9, 0.9999, 1.0001, 1.001, 1.3, 2.0):
        answer = check(replace(moved.at(share * falls), moves=()))
        assert answer.verdict is (Verdict.STANDS if share < 1 else Verdict.COLLAPSES)
        assert answer.proved


def test_an_answer_on_supports_that_moved_says_what_acted_then() -> None:
    done = inside("bracket", "flat-arch", "--mu", "0.8", "--spread", "0.01", "--over", "tilt")
    assert "supports moved by 0.01 m, before any push and under all else" in done.stdout


@pytest.mark.parametrize("over", ["load", "mu"])
def test_what_is_pushed_falls_where_it_falls_first(over: str) -> None:
    """A check pushes to the side to which less is borne, which is not that of the start."""
    line = ("--span", "8", "--rise", "2.5", "--thickness", "0.5", "--fill", "0.5")
    asked = (*line, "--push", "0.1", "--point-load", "1.5", "20")
    mu = () if over == "mu" else ("--mu", "0.7")
    start = mu or ("--mu", "0.9")
    found = answered("bracket", *asked, *start, "--over", over)
    stands = -1.0 if found["stands"] == "low" else 1.0
    for side, code in ((stands, 0), (-stands, 1)):
        value = repr(found["limit"] * (1 + 1e-4 * side))
        assert inside("check", *asked, *mu, f"--{over}", value).returncode == code


@pytest.mark.parametrize("way", [1, pytest.param(-1, marks=pytest.mark.long)])
def test_hinges_get_into_line_where_forces_are_not_told(way: int) -> None:
    """Nearest to where they do, forces are 1e8 weights; the span there is a closed form."""
    left, right, thickness = 23.179528219390512, 37.35109487916007, 1.1150774474915741
    heavy = [-2.912683493140377, -2.8984710144715002]
    load = [-0.825213354902256, -0.2794086876275421]
    corners = [
        (radius * math.sin(angle), radius * math.cos(angle))
        for radius, angle in (
            (4 - thickness / 2, -math.radians(left)),
            (4 + thickness / 2, math.radians((right - 2 * left) / 3)),
            (4 - thickness / 2, math.radians(right)),
        )
    ]
    low, top, high = corners
    stretched = math.dist(low, top) + math.dist(top, high)
    flat = math.sqrt(stretched**2 - (high[1] - low[1]) ** 2) - (high[0] - low[0])
    if way < 0:
        left, right = right, left
        heavy, load = [-x for x in heavy[::-1]], [-x for x in load[::-1]]
    sizes = {"thickness": thickness, "radius": 4, "left_deg": left, "right_deg": right}
    given = [f"--with {name}={value}" for name, value in sizes.items()]
    asked = (
        f"check circular-arch --mu inf {' '.join(given)} --with voussoirs=3 --unit-weight 22 "
        f"--fill 0.5 --fill-unit-weight 18 --fill-layer 0.05 24 --fill-region {heavy[0]} "
        f"{heavy[1]} 15 --patch-load {load[0]} {load[1]} 20"
    )
    for share, code in ((1 - 1e-6, 0), (1 + 1e-6, 1)):
        answered(*asked.split(), "--spread", repr(share * flat), code=code)
