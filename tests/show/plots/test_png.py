"""Images of few colours: those of the style as they are, in the size that is asked for."""

from io import BytesIO

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from PIL import Image

from debrisest.show.plots.png import picture, png
from debrisest.show.plots.style import ESTIMATOR_COLOURS, GREY, GRID, INK, SHADE


def _field(colour: str) -> Figure:
    return Figure(figsize=(1, 2), facecolor=colour)


@pytest.mark.parametrize("colour", ["white", GRID, SHADE, INK, GREY, *ESTIMATOR_COLOURS])
def test_the_colours_of_the_style_stay(colour: str) -> None:
    drawn = np.asarray(picture(_field(colour), 20).convert("RGB")).reshape(-1, 3)
    (found,) = np.unique(drawn, axis=0)
    assert np.abs(found - 255 * np.array(to_rgb(colour))).max() <= 2


def test_other_colours_are_near_and_exact_where_shaded() -> None:
    odd = np.array([0.3, 0.8, 0.7])
    near, exact = (
        np.asarray(picture(_field(tuple(odd)), 20, shaded).convert("RGB"))[0, 0] / 255
        for shaded in (False, True)
    )
    assert np.abs(near - odd).max() < 0.25
    assert np.abs(exact - odd).max() < 0.01


def test_the_size_and_the_resolution_are_told_and_the_figure_keeps_its_own() -> None:
    figure = _field("white")
    image = Image.open(BytesIO(png(figure, 50)))
    assert image.size == (50, 100)
    assert image.info["dpi"] == pytest.approx((50, 50), abs=0.1)
    assert figure.dpi == 100
