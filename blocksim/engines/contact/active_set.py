"""From half of the digits of a solution to all: what each contact does is told, and mended.

While all contacts do as said, the problem is linear, and springs that are preloaded with the
forces found last solve it in two or three systems (the method of multipliers). Then a contact
that pulls opens, one that would pass closes, one beyond its friction slides, and one that
slides along its friction sticks (an active-set method; on contact P. Alart and A. Curnier,
Comput. Methods Appl. Mech. Eng. 92, 1991, 353-375, whose Newton's method does both at once).
It begins where no more than a few have to change, and gives up where more and more do.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.coulomb import (
    OPEN,
    SLIDES_DOWN,
    SLIDES_UP,
    STICKS,
    Contacts,
    ContactStatus,
)
from blocksim.engines.contact.step import Answer, Linear, Step, stiffness_at

MOST_SYSTEMS = 24
ROUND_OFF = 1e-14
"""What is nothing, over the largest force."""
NO_YIELD = 1e-13
"""Yield of contacts that is round-off, over the accelerations."""
UNSURE = 0.1
SLOW, DRIFT = 0.1, 0.9
"""What is left of a yield after a system, from which it is slow, and may be round-off."""
RIGID = 1e-7
"""Yield without end that is round-off, over accelerations, or velocities over the step: faces
that do not quite fit."""
FARTHEST = 1e9
"""Repetitions of a change of forces at once."""
MORE, FEW = 4, 16
"""So many times the fewest contacts that had to change, and a few, tell of no end."""
RELATIVE = 1e-8
"""Residual over the accelerations at which contacts that still change are round-off."""


def by_active_set(step: Step, guess: Answer, precision: float) -> list[Answer]:
    """Look for the solution that is near a guess.

    `precision`: Yield of contacts at which it counts as solved [g].
    Returns: Those on the way. The last is the solution if it is settled; `residual` of others
        may not be known.
    """
    x, contacts, circle = guess.x, guess.contacts, _Circle()
    # Forces stop what is closed: accelerations will be as large.
    stopped = np.abs(step.rates[:, :2][contacts != OPEN]).max(initial=0.0)
    stiffness = stiffness_at(step.friction, np.append(x, stopped), precision)
    linear = Linear(step, contacts, stiffness)
    held = np.abs(guess.forces[:, 2:])
    preload = linear.status.forces(guess.forces, held)
    tried, last, allowed = list[Answer](), math.inf, preload.size
    rates = step.velocities(x)
    for systems in range(1, MOST_SYSTEMS + 1):
        way, more = linear.way(x, preload - stiffness * rates, held)
        x, held = x + way, held + more
        largest = float(np.abs(x).max())
        if not math.isfinite(largest):
            break
        rates = step.velocities(x)
        forces = linear.status.forces(preload - stiffness * rates, held)
        change = forces - preload
        most = float(np.abs(change).max(initial=0.0))
        unsure, yields = UNSURE * most, most / stiffness
        mended = _mended(step, linear.status, forces, rates, unsure, unsure / stiffness)
        changes = 0 if mended is contacts else int(np.count_nonzero(mended != contacts))
        ratio, last = yields / last, math.inf if changes else yields
        answer = Answer(x=x, forces=forces, contacts=contacts, systems=guess.systems + systems)
        if changes or _is_nothing(yields, step, largest, precision, drifts=ratio > DRIFT):
            answer = _settled(step, answer, rates, surely=not changes)
        tried.append(answer)
        if answer.is_settled or changes > allowed:
            break
        allowed = min(allowed, MORE * changes + FEW)
        preload = forces
        if changes:
            mended = circle.left(contacts, mended)
            if mended is None:
                break
            contacts = mended
            linear = Linear(step, contacts, stiffness)
        elif ratio > SLOW:
            ahead = _reach(step, forces, change, ratio)
            if ahead == FARTHEST:
                # Contacts contradict each other, and none ever gives way.
                break
            preload = forces + ahead * change
    return tried


class _Circle:
    """What contacts have done, so that they do not go on in a circle.

    Changed one at a time, always the first, they leave it (K. G. Murty, Opsearch 11, 1974,
    4-10, for matrices that are as friction seldom is not).
    """

    def __init__(self) -> None:
        self._seen, self._careful = set[bytes](), False

    def left(self, contacts: Contacts, mended: Contacts) -> Contacts | None:
        """Return what contacts are to do next; None where they do not leave the circle."""
        self._seen.add(contacts.tobytes())
        if not self._careful and mended.tobytes() in self._seen:
            self._careful, self._seen = True, {contacts.tobytes()}
        if not self._careful:
            return mended
        first = contacts.copy()
        place = int(np.flatnonzero(mended != contacts)[0])
        first.flat[place] = mended.flat[place]
        return None if first.tobytes() in self._seen else first


def _settled(step: Step, answer: Answer, rates: Array, *, surely: bool) -> Answer:
    """Return an answer as the solution: surely, or if nothing is wrong but round-off."""
    largest = float(np.abs(answer.x).max())
    pulls = -float(answer.forces[:, :2].min()) > RELATIVE * largest * max(1.0, largest)
    if pulls and not surely:
        return answer
    residual = step.residual(answer.x, answer.forces, rates)
    settled = surely or residual <= RELATIVE * largest
    return replace(answer, residual=residual, is_settled=settled)


def _is_nothing(
    yields: float, step: Step, largest: float, precision: float, *, drifts: bool
) -> bool:
    """Tell whether yields are round-off, or without end, of faces that do not quite fit."""
    if yields <= max(precision * max(1.0, largest), NO_YIELD * largest):
        return True
    return drifts and yields <= RIGID * max(largest, float(np.abs(step.rates).max(initial=0.0)))


def _reach(step: Step, forces: Array, change: Array, ratio: float) -> float:
    """Return how often a change can be repeated until a contact opens or slides.

    It goes on, less each time by a ratio, however slowly, or until a contact gives way.
    Two contacts of a joint that stick although the blocks turn work against each other,
    at equal accelerations, more from round to round, until one of them slides.
    """
    pressure, growth = forces[:, :2], change[:, :2]
    a, b = step.friction.room
    room = np.stack([pressure] + [a * pressure - s * b * forces[:, 2:] for s in (1, -1)])
    loss = -np.stack([growth] + [a * growth - s * b * change[:, 2:] for s in (1, -1)])
    ahead = (loss > 0) & (room > loss)
    most = ratio / (1 - ratio) if ratio < 1 else FARTHEST
    return min(most, float((room[ahead] / loss[ahead]).min(initial=FARTHEST)))


def _mended(
    step: Step, status: ContactStatus, forces: Array, rates: Array, unsure: float, yields: float
) -> Contacts:
    """Return what contacts do in place of what they cannot."""
    nothing = ROUND_OFF * max(1.0, float(np.abs(forces).max(initial=0.0)))
    no_force, no_rate = nothing + unsure, nothing + yields
    beyond = status.sticks & (step.friction.excess(forces) > no_force)
    wrong_way = status.is_open & (rates[:, :2] < -no_rate)
    if status.some_slide:
        wrong_way |= status.side * rates[:, 2:] > no_rate
    pulls = forces[:, :2] < -no_force
    if not (beyond | wrong_way | pulls).any():
        return status.contacts
    found = status.contacts.copy()
    found[beyond] = np.where(forces[:, 2:][beyond] > 0, SLIDES_UP, SLIDES_DOWN)
    found[wrong_way] = STICKS
    found[pulls & ~status.is_open] = OPEN
    return found
