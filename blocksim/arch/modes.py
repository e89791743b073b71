"""The seven collapse modes, and how active or observed joints get their name."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum
from typing import NamedTuple

from blocksim.arch.circular import Arch, crown_width
from blocksim.blocks.joints import JointState, ObservedJoint


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

    `angle`: From the crown, not negative [rad].
    `slides`: True if it slides, False if it turns.
    `intrados`: True if it turns about its intrados end.
    """

    angle: float
    slides: bool
    intrados: bool = False


def name_mode(active: Iterable[ActiveJoint], crown: float) -> Mode | None:
    """Name the mode of a set of active joints.

    `active`: One half of the arch, in any order.
    `crown`: Joints up to this angle count as the crown: an arch with an odd number of voussoirs
        has a keystone, and its crown hinge shows beside it [rad].
    Returns: None where the joints form none of the seven modes.
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


def observed_mode(joints: tuple[ObservedJoint, ...], arch: Arch) -> Mode | None:
    """Name the mode of the observed joints of an arch, both halves folded onto one.

    A hinge that falls between two joints shows as both of them: neighbours that do the
    same count as one, at the place of the outermost.

    Returns: None where they form none of the seven modes.
    """
    spacing = 2 * arch.half_angle / arch.voussoirs
    active: list[ActiveJoint] = []
    for observed in sorted(joints, key=lambda joint: -abs(joint.angle)):
        for kind in _KINDS[observed.state]:
            joint = ActiveJoint(abs(observed.angle), *kind)
            if not any(_neighbours(joint, other, spacing) for other in active):
                active.append(joint)
    return name_mode(active, crown_width(arch.half_angle, arch.voussoirs))


_TURNS_OUTSIDE, _TURNS_INSIDE, _SLIDES = (False, False), (False, True), (True, False)
_KINDS: dict[JointState, tuple[tuple[bool, bool], ...]] = {
    JointState.CLOSED: (),
    JointState.HINGE_INTRADOS: (_TURNS_INSIDE,),
    JointState.HINGE_EXTRADOS: (_TURNS_OUTSIDE,),
    JointState.SLIDES: (_SLIDES,),
    JointState.HINGE_AND_SLIDES: (_TURNS_INSIDE, _SLIDES),
    JointState.OPEN: (_TURNS_OUTSIDE, _TURNS_INSIDE),
}
"""(slides, intrados) of what a joint in each state does."""


def _neighbours(joint: ActiveJoint, other: ActiveJoint, spacing: float) -> bool:
    same = joint.slides == other.slides and joint.intrados == other.intrados
    return same and abs(joint.angle - other.angle) < 1.5 * spacing
