"""The arch figure, of the continuous arch at its least thickness."""

import math

import numpy as np
import pytest
from matplotlib.figure import Figure

from blocksim import CircularArch, bracket


def falls(half_angle: float, mu: float) -> Figure:
    """The arch at its least thickness, in its first mode."""
    arch = CircularArch(half_angle=half_angle, friction=mu, weight="centreline")
    return bracket(arch, method="theory").plot()


def test_a_joint_that_turns_and_slides_is_one_joint() -> None:
    """Fig. 21 (low): beta_r is beta_s but for round-off, and nothing is between them."""
    (axes,) = falls(2.603266515104794, 1.832508693777595).axes
    assert [each.get_label() for each in axes.patches].count("mechanism") == 3
    hinges = [each for each in axes.lines if str(each.get_label()).startswith("hinge")]
    assert len(hinges) == 4


def test_what_moves_and_what_bears_is_within_the_picture() -> None:
    (axes,) = falls(math.radians(125), 0.9).axes
    drawn = np.concatenate([each.get_xy() for each in axes.patches])
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    assert (drawn > [left, low]).all()
    assert (drawn < [right, high]).all()


@pytest.mark.parametrize(
    ("degrees", "mu", "more"),
    [(90, math.inf, set()), (110, 0.6, {"sliding joint: it opens, too (dilatancy)"})],
)
def test_legend_names_what_is_there_only(degrees: float, mu: float, more: set[str]) -> None:
    """Where it turns only no sliding joint is named; where it slides and turns, both are."""
    figure = falls(math.radians(degrees), mu)
    assert {text.get_text() for text in figure.legends[0].get_texts()} == {
        "support", "line of thrust, the only one left", "line of friction", "mechanism",
        "hinge intrados", "hinge extrados",
    } | more  # fmt: skip
    words = [text.get_text() for text in figure.axes[0].texts]
    assert "0.5 r" in words
    assert any("continuous arch" in each for each in words)
