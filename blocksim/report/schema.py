"""What an answer says as JSON: the keys and types of `check --json` and `bracket --json`.

All keys are there for every subject, null where there is nothing to say. `docs/schema.py`
writes the JSON schema from these classes.
"""

from __future__ import annotations

from typing import Any, Literal, TypedDict

from blocksim.ask.answer import Event
from blocksim.ask.ends import Stands
from blocksim.simulation.verdict import Evidence

Number = float | Literal["inf", "-inf"]
"""JSON has no infinity."""


class ProblemRecord(TypedDict):
    """What was asked about; of a bracket null where it follows from what is searched over."""

    title: str
    blocks: int
    joints: int
    mu: Number | None
    friction_angle_deg: float | None
    tilt_deg: float | None
    azimuth_deg: float | None
    lean_deg: float | None
    gravity_m_s2: list[float]
    load: float | None
    strength_MPa: float | None
    shake: dict[str, Any] | None
    span_m: float | None
    rise_m: float | None
    at: str | None
    thickness_m: float | None
    radius_m: float | None
    depth_m: float | None
    unit_weight_kN_per_m3: float | None
    weight_kN: float | None
    fill_m: float | None
    fill_weight_kN: float | None
    fill_is: list[str] | None
    dispersal: str | None
    live_weight_kN: float


class ArchRecord(TypedDict):
    """What is told of a symmetric circular arch under its own weight besides.

    `eta` is null in a bracket over it; `radius` where it follows from the thickness.
    """

    half_angle_deg: float
    eta: float | None
    voussoirs: int
    weight: str
    radius: float | None
    depth: float
    eta_limit: float | None
    eta_theory: float | None
    mode: str | None
    mode_in_motion: str | None
    mode_limit: str | None
    mode_theory: str
    modes_theory: list[str]


class ArchBracketRecord(ArchRecord):
    """The same of a bracket over its thickness."""

    fixed_line: str
    eta_low: float | None
    eta_high: float | None
    thrust: Number | None
    beta_r_deg: float | None
    beta_s_deg: float | None


class JointRecord(TypedDict):
    """A joint: its two sides and ends [m], what it does, and its forces [N]."""

    a: str
    b: str
    ends: list[list[float]]
    gap: float
    angle_deg: float | None
    state: str
    hinge: list[float] | None
    normal_force: float | None
    friction_force: float | None
    width_used: Number | None
    stress_MPa: Number | None
    friction_used: Number | None


class MovementRecord(TypedDict):
    """Rate at which a block begins to move: ways in m for each radian of rotation.

    In the plane `rotation`, of which `z` and `rotations` are null; in space rotations about x,
    y and z.
    """

    block: str
    x: float
    y: float
    z: float | None
    rotation: float | None
    rotations: list[float] | None


class ShakenRecord(TypedDict):
    """What became of blocks on ground that shakes; the time is since the release.

    Errors are estimates: what a run at another step says otherwise.
    """

    largest_rotation_deg: float
    largest_rotation_error_deg: float | None
    block: str
    first_impact_s: float | None
    first_impact_error_s: float | None
    moved_m: float


class ReactionRecord(TypedDict):
    """What a support bears, and where."""

    support: str
    horizontal_kN: float
    vertical_kN: float
    x_m: float
    y_m: float


class WorstJointRecord(TypedDict):
    """A joint that uses the largest share of its width or friction."""

    joint: str
    width_used: Number
    friction_used: Number


class CarriedRecord(TypedDict):
    """Factors of safety, thrust and reactions."""

    geometrical_factor: Number | None
    friction_factor: Number | None
    least_friction: float | None
    strength_used: float | None
    needed_strength_MPa: float | None
    weights_given: bool | None
    weight_kN: float | None
    thrust_joint: str | None
    thrust_min_kN: Number | None
    thrust_max_kN: Number | None
    thrust_min_kN_per_m: Number | None
    thrust_max_kN_per_m: Number | None
    thrust_min_per_weight: Number | None
    thrust_max_per_weight: Number | None
    reactions: list[ReactionRecord] | None
    worst_joints: list[WorstJointRecord] | None


class CheckRecord(CarriedRecord):
    """Answer of `check`."""

    version: str
    method: str
    verdict: Literal["stands", "collapses", "undecided"]
    proved: bool
    evidence: tuple[Evidence, ...]
    reason: str
    problem: ProblemRecord
    load_factor: Number | None
    rest: Literal["must", "can", "cannot"] | None
    rest_goes_on: bool | None
    joints: list[JointRecord]
    mechanism: list[MovementRecord] | None
    shaken: ShakenRecord | None
    simulated_s: float | None
    state_hash: str | None
    blocks: int | None
    splits: int | None
    wall_s: float
    arch: ArchRecord | None


class BracketRecord(TypedDict):
    """Answer of `bracket`."""

    version: str
    method: str
    over: str
    unit: str
    low: Number | None
    high: Number | None
    stands: Literal["low", "high"]
    limit: Number | None
    confirmed: bool | None
    proved: bool
    runs: int
    undecided: int
    tol: float
    evidence: tuple[Evidence, ...]
    reason: str
    problem: ProblemRecord
    events: tuple[Event, ...] | None
    intervals: tuple[Stands, ...] | None
    blocks: int | None
    splits: int | None
    wall_s: float
    arch: ArchBracketRecord | None


class CaseRecord(TypedDict):
    """A case with its partial factors, and its answer, which is of the factored problem."""

    name: str
    factors: dict[str, float]
    used: Number | None
    reserve: Number | None
    answer: CheckRecord


class CasesRecord(TypedDict):
    """Answer of `check --cases`, the governing case first."""

    version: str
    title: str
    governing: str
    verdict: str
    cases: list[CaseRecord]
    wall_s: float


class PlaceRecord(TypedDict):
    """Where a vehicle stands, and what is borne there; thrust is at the crown."""

    heading: Literal["right", "left"]
    position_m: float
    axles_m: list[float]
    load_factor: Number
    thrust_min_kN: Number | None
    thrust_max_kN: Number | None


class CrossingRecord(TypedDict):
    """Answer of `bracket --vehicle`: the least load factor lies between `low` and `high`."""

    version: str
    vehicle: str
    axles: list[list[float]]
    source: str
    low: Number
    high: Number
    worst: PlaceRecord
    places: list[PlaceRecord]
    problem: ProblemRecord
    wall_s: float
