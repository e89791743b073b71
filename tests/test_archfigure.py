"""The arch figure, and mechanisms of named modes."""

import io
import math

import numpy as np
import pytest

from blocksim.arch.circular import Arch
from blocksim.arch.limit.collapse import collapse_of_mode
from blocksim.arch.modes import Mode
from blocksim.arch.theory import landmarks, least_thickness
from blocksim.view.archfigure import arch_figure, picture_of_arch, picture_of_theory
from blocksim.view.mapfigure import save_figure


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


def test_mode_that_is_not_possible() -> None:
    """A springing steeper than the friction angle is pressed together, not pushed out."""
    with pytest.raises(ValueError, match="no mechanism srr"):
        collapse_of_mode(Mode.SRR, 0.3, 0.01, 0.9, beta_r=0.2)


@pytest.mark.parametrize("kind", ["png", "svg"])
def test_figure_is_reproducible(kind: str) -> None:
    files = []
    for _ in range(2):
        standing = picture_of_arch(Arch(half_angle=1.5, eta=0.3, voussoirs=12), math.inf)
        falling = picture_of_arch(Arch(half_angle=2.18, eta=0.35, voussoirs=14), 0.9)
        assert standing.title.startswith("stands")
        assert falling.title.startswith("mode ")
        file = io.BytesIO()
        save_figure(arch_figure([standing, falling]), file, kind)
        files.append(file.getvalue())
    assert files[0] == files[1]
    assert len(files[0]) > 10_000


def test_picture_of_overturning() -> None:
    critical = least_thickness(2.7, math.inf)
    picture = picture_of_theory(critical, Mode.R, 2.7, math.inf)
    arch_figure([picture])
    assert picture.thrust < 1e-20
