"""Recordings as JSON objects and as text for people: what they show, not every pose."""

from __future__ import annotations

import math

from blocksim.blocks.problem import STANDARD_GRAVITY
from blocksim.blocks.record import to_record
from blocksim.common.words import counted
from blocksim.simulation.recording import Recording
from blocksim.simulation.shaken import rocking_of

ROUNDING = 1e-12
"""Length below which there is nothing but rounding [size]."""
LEAST_ROTATION = 1e-3
"""Rotation of a block from which on a recording is said to have turned one [rad]."""


def recording_record(recording: Recording) -> dict[str, object]:
    """Return what a recording shows, without its poses."""
    rocking, problem = rocking_of(recording), recording.problem
    size = recording.assembly.size
    return {
        "engine": recording.engine,
        "engine_version": recording.engine_version,
        "settings": to_record(recording.settings),
        "title": problem.title,
        "blocks": len(recording.assembly.blocks),
        "mu": recording.mu,
        "size_m": size,
        "frames": len(recording.times),
        "recorded_s": float(recording.seconds(STANDARD_GRAVITY)[-1]),
        "moved_m": float(recording.displacement[-1]) * size,
        "largest_rotation_deg": math.degrees(rocking.rotation),
        "gravity_m_s2": (problem.gravity * STANDARD_GRAVITY).tolist(),
        "quality": to_record(recording.quality),
        "overlap_of_smallest_block": recording.overlap_share,
        "state_hash": recording.state_hash,
    }


def unsolved_words(recording: Recording) -> str:
    """Say that contact forces were not found in some step."""
    left = recording.unsolved
    far = f", but to {left:.1g} g" if math.isfinite(left) else ""
    return f"contact forces were not found{far}: what it shows from there on may be wrong"


def recording_lines(recording: Recording, unit: str) -> list[str]:
    """Return a recording in words, with lengths in a unit."""
    lines = [
        f"{counted(len(recording.times), 'frame')}, "
        f"{recording.seconds(STANDARD_GRAVITY)[-1]:.2f} s, "
        f"moved {recording.displacement[-1]:.2g} {unit}, hash of its end {recording.state_hash}"
    ]
    kept, rocking, problem = recording.quality, rocking_of(recording), recording.problem
    said: list[str] = []
    if problem.shaking is not None:
        said.append(problem.shaking.words)
    if rocking.rotation >= LEAST_ROTATION:
        name = problem.assembly.blocks[rocking.block].name or str(rocking.block)
        said.append(f"block {name} turned by {math.degrees(rocking.rotation):.3g} deg at most")
    if rocking.impact is not None:
        said.append(
            f"a joint first closed again after {rocking.impact * problem.seconds:.4g} s"
        )
    if said:
        lines.append("  " + ", ".join(said))
    if recording.unsolved:
        lines.append("  " + unsolved_words(recording))
    said = []
    if kept.penetration is None:
        said.append(f"{recording.engine} does not tell how deep blocks overlap")
    else:
        said.append(
            f"blocks overlap by at most {kept.penetration:.1e} {unit}, "
            f"{recording.overlap_share:.2g} of the smallest"
            if kept.penetration > ROUNDING
            else "no blocks overlap"
        )
    if kept.gain is not None:
        said.append(
            "energy rose above that at the release by at most "
            f"{100 * kept.gain:.1g} % of what fell"
            if kept.gain > ROUNDING
            else "there was never more energy than at the release"
        )
    if said:
        lines.append("  " + ", ".join(said))
    if kept.error is not None:
        until = recording.times[-1] if kept.known is None else kept.known
        ends = "" if kept.known is None else ", not known beyond"
        apart = f"differs by at most {kept.error:.1e} {unit}"
        found = "is the same" if kept.error <= ROUNDING else apart
        unit_s = problem.seconds
        late = "" if kept.late is None else f", in time by {kept.late * unit_s:.1e} s,"
        lines.append(
            f"  a run at twice the step {found}{late} until {until * unit_s:.3g} s{ends}"
        )
    return lines
