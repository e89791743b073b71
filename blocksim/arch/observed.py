"""Joint states of an arch to its collapse mode."""

from __future__ import annotations

from blocksim.arch.circular import Arch, crown_width
from blocksim.arch.modes import ActiveJoint, Mode, name_mode
from blocksim.blocks.joints import JointState, ObservedJoint


def observed_mode(joints: tuple[ObservedJoint, ...], arch: Arch) -> Mode | None:
    """Name the mode of the observed joints of an arch, both halves folded onto one.

    A hinge that falls between two joints shows as both of them: neighbours that do the
    same count as one, at the place of the outermost.

    Parameters
    ----------
    joints : tuple of ObservedJoint
    arch : Arch

    Returns
    -------
    Mode or None
        None where they form none of the seven modes.
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
