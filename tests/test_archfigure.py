"""The arch figure, and mechanisms of named modes."""

import math

import numpy as np
import pytest
from matplotlib.figure import Figure

from blocksim import Mode
from blocksim.arch.limit.collapse import collapse_of_mode
from blocksim.arch.theory import landmarks, least_thickness
from blocksim.view.archfigure import ArchPicture, arch_figure, picture_of_theory


def least(degrees: float, mu: float) -> ArchPicture:
    """The arch at its least thickness, in its first mode."""
    angle = math.radians(degrees)
    critical = least_thickness(angle, mu)
    return picture_of_theory(critical, critical.mode, angle, mu)


def test_four_modes_at_the_triple_point() -> None:
    """Figs 18 and 19; each piece next to a springing moves as that springing lets it."""
    mark = landmarks()["T"]
    for mode in (Mode.RRR, Mode.SS, Mode.SRR, Mode.RRS):
        found = collapse_of_mode(
            mode, mark.half_angle, mark.eta, mark.mu, beta_r=mark.beta_r, beta_s=mark.beta_s
        )
        assert found.rates.min() >= 0
        assert found.rates.sum() == pytest.approx(1, abs=1e-12)
        np.testing.assert_allclose(found.rates, found.rates[::-1], atol=1e-15)
        # Mirror images: same fall, opposite sway and turn.
        mirrored = found.motions[::-1] * [-1, 1, -1]
        np.testing.assert_allclose(found.motions, mirrored, atol=1e-9)


def test_a_joint_that_turns_and_slides_is_one_joint() -> None:
    """Fig. 21 (low): beta_r is beta_s but for round-off, and nothing is between them."""
    alpha, mu = 2.603266515104794, 1.832508693777595
    exact = least_thickness(alpha, mu)
    for beta_s in (exact.beta_s, exact.beta_s + 1e-12):
        found = collapse_of_mode(
            Mode.RRS, alpha, exact.eta, mu, beta_r=exact.beta_r, beta_s=beta_s
        )
        assert len(found.angles) == 4
        assert len(found.motions) == 3


def test_mode_that_is_not_possible() -> None:
    """A springing steeper than the friction angle is pressed together, not pushed out."""
    with pytest.raises(ValueError, match="no mechanism srr"):
        collapse_of_mode(Mode.SRR, 0.3, 0.01, 0.9, beta_r=0.2)


def test_what_moves_and_what_bears_is_within_the_picture() -> None:
    falls = least(125, 0.9)
    (axes,) = arch_figure([falls]).axes
    drawn = np.concatenate([each.get_xy() for each in axes.patches])
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    assert (drawn > [left, low]).all()
    assert (drawn < [right, high]).all()


def legend(figure: Figure) -> set[str]:
    return {text.get_text() for text in figure.legends[0].get_texts()}


def test_legend_names_what_is_there_only() -> None:
    """Where it turns only no sliding joint is named; where it slides and turns, both are."""
    assert legend(arch_figure([least(90, math.inf)])) == {
        "support", "line of thrust, the only one left", "line of friction", "mechanism",
        "hinge intrados", "hinge extrados",
    }  # fmt: skip
    slides = math.radians(110)
    critical = least_thickness(slides, 0.6)
    falls = arch_figure([picture_of_theory(critical, Mode.SRR, slides, 0.6)])
    assert legend(falls) == {
        "support", "line of thrust, the only one left", "line of friction", "mechanism",
        "hinge intrados", "hinge extrados", "sliding joint: it opens, too (dilatancy)",
    }  # fmt: skip
    assert any(text.get_text() == "0.5 r" for text in falls.axes[0].texts)
    assert any("continuous arch" in text.get_text() for text in falls.axes[0].texts)
