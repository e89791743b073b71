"""The seven collapse modes and how a set of active joints gets its name."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum
from typing import NamedTuple


class Mode(StrEnum):
    """Collapse modes of Cocchetti and Rizzi (2024), section 3.

    The letters read from the shoulder up to the crown: r turns, s slides.
    """

    RRR = "rrr"
    SS = "ss"
    SRR = "srr"
    RRS = "rrs"
    RSR = "rsr"
    RS = "rs"
    R = "r"

    @property
    def description(self) -> str:
        """The paper's name of the mode."""
        return _DESCRIPTIONS[self]


_DESCRIPTIONS = {
    Mode.RRR: "purely rotational",
    Mode.SS: "purely sliding",
    Mode.SRR: "sliding-rotational (shoulder slides)",
    Mode.RRS: "rotational-sliding (inner joint slides above the inner hinge)",
    Mode.RSR: "rotational-sliding (inner joint slides below the inner hinge)",
    Mode.RS: "overturning-sliding",
    Mode.R: "purely overturning",
}


class ActiveJoint(NamedTuple):
    """A joint that takes part in the collapse, on one half of the arch.

    Parameters
    ----------
    angle : float
        From the crown, not negative [rad].
    slides : bool
        True if it slides, False if it turns.
    intrados : bool
        True if it turns about its intrados end.
    """

    angle: float
    slides: bool
    intrados: bool = False


def name_mode(active: Iterable[ActiveJoint], crown: float) -> Mode | None:
    """Name the mode of a set of active joints.

    Parameters
    ----------
    active : iterable of ActiveJoint
        One half of the arch, in any order.
    crown : float
        Joints up to this angle count as the crown: an arch with an odd number of
        voussoirs has a keystone, and its crown hinge shows beside it [rad].

    Returns
    -------
    Mode or None
        None where the joints form none of the seven modes.
    """
    joints = set(active)
    if any(joint.slides for joint in joints):
        # With beta_r = 0 the two inner hinges merge into one at the crown intrados,
        # which the paper leaves out of the name of overturning-sliding.
        joints = {j for j in joints if j.slides or not j.intrados or j.angle > crown}
    elif {j.intrados for j in joints if j.angle <= crown} == {True, False}:
        # The crown opens at both ends: the two halves part without thrust.
        joints = {j for j in joints if j.angle > crown}
    # A hinge at the sliding joint itself counts as below it (beta_r >= beta_s).
    ordered = sorted(joints, key=lambda joint: (-joint.angle, joint.slides))
    letters = "".join("s" if joint.slides else "r" for joint in ordered)
    return Mode(letters) if letters in set(Mode) else None
