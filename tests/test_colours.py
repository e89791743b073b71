"""Colours that mean something can be told apart and read, however they are seen."""

import numpy as np
import pytest
from vision import SEEN, contrast, difference, lab, linear, nearest

from blocksim import JointState
from blocksim.view import style

APART = 12.0
"""Least distance by CIEDE2000."""
DRAWN = {
    "thrust": style.THRUST,
    "friction": style.FRICTION,
    "mechanism": style.MECHANISM,
    "live": style.LIVE,
    "gap": style.GAP,
    **{state.value: tone for state, tone in style.JOINTS.items()},
}
"""All that lines of a drawing may mean."""
TOGETHER = {
    "drawings and films": list(DRAWN.values()),
    "maps": [each.colour for each in (*style.MODES.values(), style.UNNAMED)],
    "maps of the explorer": [
        *(each.colour for each in style.MODES.values()),
        style.VERDICTS["stands"],
        style.VERDICTS["collapses"],
    ],
    "use of joints": [
        *(tone for _, _, tone in style.USE),
        style.THRUST,
        style.STONE,
        style.INK,
        "#ffffff",
    ],
    "verdicts, and what is wrong": [*style.VERDICTS.values(), style.MISS],
}
ARROWS = {"live"}
"""Drawn as arrows, with heads."""
DOTS = {"hinge-intrados": "inner end", "hinge-extrados": "outer end"}


@pytest.mark.parametrize(
    ("one", "other", "apart"),
    [
        ((50, 2.6772, -79.7751), (50, 0, -82.7485), 2.0425),
        ((50, -1.3802, -84.2814), (50, 0, -82.7485), 1.0000),
        ((50, 0, 0), (50, -1, 2), 2.3669),
        ((50, 2.5, 0), (50, 0, -2.5), 4.3065),
        ((50, 2.5, 0), (73, 25, -18), 27.1492),
        ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387), 1.2644),
        ((22.7233, 20.0904, -46.6940), (23.0331, 14.9730, -42.5619), 2.0373),
        ((2.0776, 0.0795, -1.1350), (0.9033, -0.0636, -0.5514), 0.9082),
    ],
)
def test_the_distance_is_that_of_the_published_pairs(
    one: tuple[float, ...], other: tuple[float, ...], apart: float
) -> None:
    """Sharma, Wu and Dalal (2005), Table 1."""
    found = difference(np.array([one]), np.array([other]))
    assert found[0] == pytest.approx(apart, abs=5e-5)


def test_the_simulations_leave_grey_as_it_is() -> None:
    """What has no hue is seen alike by everybody; red and green of one lightness meet."""
    greys = linear(["#000000", "#808080", "#ffffff"])
    for seen in SEEN.values():
        assert greys @ seen.T == pytest.approx(greys, abs=2e-3)
    confused = lab(linear(["#c0504a", "#807a4a"]) @ SEEN["deuteranopia"].T)
    plain = lab(linear(["#c0504a", "#807a4a"]))
    assert difference(confused[:1], confused[1:])[0] < difference(plain[:1], plain[1:])[0] / 2


@pytest.mark.parametrize("seen", ["everybody", "protanopia", "deuteranopia", "tritanopia"])
@pytest.mark.parametrize("group", TOGETHER)
def test_meanings_that_appear_together_differ_in_colour(group: str, seen: str) -> None:
    least, *pair = nearest(TOGETHER[group], seen)
    assert least >= APART, pair


def test_meanings_of_a_drawing_differ_in_grey_or_in_form() -> None:
    """Dashes, dots of hinges and heads of arrows; modes have markers of their own shape."""
    names, colours = list(DRAWN), list(DRAWN.values())
    greys = lab(linear(colours) @ SEEN["grey"].T)
    forms = [
        (style.DASHES.get(tone, ()), DOTS.get(name), name in ARROWS)
        for name, tone in DRAWN.items()
    ]
    for one in range(len(names)):
        for two in range(one):
            apart = difference(greys[one : one + 1], greys[two : two + 1])[0]
            assert apart >= APART or forms[one] != forms[two], (names[one], names[two])
    markers = [each.marker for each in (*style.MODES.values(), style.UNNAMED)]
    assert len(set(markers)) == len(markers)


def test_no_colour_has_two_meanings() -> None:
    """Modes, joints, lines and verdicts: not even by tones that few could tell apart."""
    modes = [each.colour for each in style.MODES.values()]
    every = [*modes, *DRAWN.values(), *style.VERDICTS.values()]
    least, *pair = nearest(every, "everybody")
    assert least > 5, pair


def test_words_can_be_read() -> None:
    """4.5 to 1 on paper, on white and on tints of regions (WCAG 2, AA); ink on tints 7."""
    for ground in (style.PAPER, "#ffffff"):
        for tone in (style.INK, style.QUIET, style.MISS, *style.VERDICTS.values()):
            assert contrast(tone, ground) >= 4.5
        for look in style.MODES.values():
            assert contrast(look.ink, ground) >= 4.5
    for look in style.MODES.values():
        assert contrast(look.ink, look.tint) >= 4.5
        assert contrast(style.INK, look.tint) >= 7


def test_lines_stand_out_from_stone_and_paper() -> None:
    """3 to 1 from paper (WCAG 2, 1.4.11); from stone by as much as two meanings differ."""
    for tone in (*DRAWN.values(), *(each.colour for each in style.MODES.values())):
        assert contrast(tone, "#ffffff") >= 3
        assert nearest([tone, style.STONE], "everybody")[0] >= APART


def test_every_state_that_takes_part_has_a_look() -> None:
    assert set(style.JOINTS) == set(JointState) - {JointState.CLOSED}
