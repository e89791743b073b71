"""How blocks of a recording rocked: how far they turned, and when a joint first closed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from blocksim.blocks.assembly import Array, Assembly
from blocksim.engines.contact.geometry import turns_of
from blocksim.simulation.recording import Recording

TURNED, SHUT = 1e-4, 1e-7
"""Rotation by which a joint has opened, and at which it has closed again [rad]."""


@dataclass(frozen=True, kw_only=True)
class Rocking:
    """How blocks of a recording turned.

    `rotation`: Largest rotation of any block at any time [rad].
    `block`: Which one that was.
    `impact`: When a joint that had opened closed first [sqrt(size/g)]; None where none did.
    `off`, `late`: How far off rotation and impact may be, by a run at another step; None
        without one.
    """

    rotation: float
    block: int
    impact: float | None
    off: float | None = None
    late: float | None = None


def rocking_of(recording: Recording) -> Rocking:
    """Read from the poses how far blocks turned, and when a joint first closed again."""
    in_space = recording.problem.in_space
    if in_space:
        # From where blocks were built, by rotation vectors.
        turned = np.linalg.norm(recording.poses[:, :, 3:], axis=2)
    else:
        turned = recording.poses[:, :, 2] - recording.poses[0, :, 2]
    frame, block = np.unravel_index(int(np.abs(turned).argmax()), turned.shape)
    impact = None if in_space else _first_impact(recording.assembly, recording.times, turned)
    return Rocking(
        rotation=_peak(np.abs(turned[:, block]), int(frame)), block=int(block), impact=impact
    )


def _peak(values: Array, at: int) -> float:
    """Return the top of the parabola through the largest of some values and those beside it."""
    if not 0 < at < len(values) - 1:
        return float(values[at])
    one, two, three = values[at - 1 : at + 2]
    bend = one - 2 * two + three
    return float(two - (three - one) ** 2 / (8 * bend)) if bend < 0 else float(two)


def _first_impact(assembly: Assembly, times: Array, turned: Array) -> float | None:
    """Find when the rotation of an open joint, followed from before, first comes to 0."""
    joints = assembly.joint_arrays
    still = np.column_stack([turned, np.zeros(len(turned))])
    across = still[:, joints.after] - still[:, joints.before]
    ways = [across[:, ~joints.is_corner]]
    for joint in np.flatnonzero(joints.is_corner).tolist():
        down, up = np.arcsin(turns_of(assembly, joint))
        ways.append(np.stack([across[:, joint] + down, up - across[:, joint]], axis=1))
    way = np.hstack(ways)
    # Three to follow, and the one after.
    if len(times) < 4:
        return None
    step = times[-1] - times[-2]
    older, old, now, then = way[:-3], way[1:-2], way[2:-1], way[3:]
    slope, bend = (3 * now - 4 * old + older) / 2, (now - 2 * old + older) / 2
    expected = now + slope + bend
    closes = (now * then < 0) | ((now * expected <= 0) & (np.abs(then) < TURNED))
    closes &= (np.abs(older) > TURNED) & (older * now >= 0)
    if not closes.any():
        return None
    frame = int(closes.any(axis=1).argmax())
    shares = [
        _zero(way[max(0, frame - 1) : frame + 4, at]) for at in np.flatnonzero(closes[frame])
    ]
    return float(times[frame + 2] + step * min(shares))


def _zero(ways: Array) -> float:
    """Find where the curve through some values, a step apart, first comes to 0 after them.

    A first one that is not open as the others are is left out. The last is the next value:
    where the curve does not come to 0 before it, the line to that does.
    """
    *before, now, then = ways.tolist()
    opened = [*before[not (before[0] * now > 0 and abs(before[0]) > TURNED) :], now]
    count = len(opened)
    found = np.roots(np.polyfit(np.arange(1.0 - count, 1.0), opened, count - 1))
    inside = found[(abs(found.imag) < SHUT) & (found.real >= 0) & (found.real <= 1)].real
    if len(inside):
        return float(inside.min())
    return now / (now - then) if now * then < 0 else 1.0
