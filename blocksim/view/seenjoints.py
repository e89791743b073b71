"""What joints are seen to do as blocks move: which open, slide, turn, and which are no more."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState, classify
from blocksim.simulation.recording import Recording
from blocksim.view.placing import Placing, distance_of

SEEN = 4e-3
"""Turn or slip of a joint from which on it is coloured [r]: a pixel of a film."""


class SeenJoints:
    """States of the joints of a recording.

    Parameters
    ----------
    recording : Recording
    placing : Placing
    frames : sequence of int
        Those in which joints are looked at for when they part.
    low : float
        Level below which a corner lies on the ground [size].
    """

    def __init__(
        self, recording: Recording, placing: Placing, frames: Sequence[int], low: float
    ) -> None:
        self._recording, self._assembly = recording, recording.assembly
        self._placing, self._frames, self._low = placing, frames, low

    def at(self, poses: Array, time: float) -> tuple[JointState, ...]:
        """Tell the states at poses, (blocks, 3 or 6), and their time."""
        # Joint states are those of motion in the plane.
        if not self._recording.problem.is_planar:
            return (JointState.CLOSED,) * len(self._assembly.joints)
        parted, gone = self._fates
        states: list[JointState] = []
        for joint in classify(self._assembly, poses, least=SEEN):
            place = len(states)
            open_by_now = time >= parted[place]
            state = JointState.OPEN if open_by_now else joint.state
            states.append(JointState.CLOSED if time >= gone[place] else state)
        return tuple(states)

    @cached_property
    def _fates(self) -> tuple[Array, Array]:
        """Times from which each joint has parted, and is none any more, (joints,) each.

        What has parted and meets again is no hinge, and a block that lies on the ground, or
        has come loose of both its neighbours, is rubble: it has no joints.
        """
        before, after, *_ = self._assembly.joint_arrays
        blocks = len(self._assembly.blocks)
        parted = np.full(len(before), np.inf)
        rubble = np.full(blocks + 1, np.inf)  # the last stands for the support
        for frame in self._frames:
            time = float(self._recording.times[frame])
            seen = classify(self._assembly, self._recording.poses[frame], least=SEEN)
            faces = self._placing.faces(frame, frame, 0.0)[..., :2]
            # Turned far, blocks may have left each other though neither end seems open.
            apart = np.array([joint.state is JointState.OPEN for joint in seen])
            apart |= distance_of(faces[:, 0], faces[:, 1]) > SEEN
            parted = np.minimum(parted, np.where(apart, time, np.inf))
            held = np.zeros(blocks + 1, dtype=bool)
            for side in (before, after):
                held[side[parted > time]] = True
            bottoms = self._placing.corners(frame, frame, 0.0)[..., 1].min(axis=(1, 2))
            lowest = np.full(blocks, np.inf)
            np.minimum.at(lowest, self._placing.owner, bottoms)
            loose = ~held[:blocks] | (lowest < self._low)
            rubble[:blocks] = np.minimum(rubble[:blocks], np.where(loose, time, np.inf))
        return parted, np.minimum(rubble[before], rubble[after])
