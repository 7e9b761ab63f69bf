"""Figures of a debris orbit from two observers, on small made-up data."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from debrisest.arrays import Array, Data
from debrisest.show.plots.covariance_trace import covariance_trace
from debrisest.show.plots.orbit_error import orbit_error
from debrisest.show.plots.pixel_paths import pixel_paths
from debrisest.show.plots.sections import control_sections
from debrisest.show.plots.torques import torques

TIMES = np.arange(100.0)
SECTION = np.select([TIMES < 20, TIMES < 40, TIMES < 80, TIMES < 90], [0.0, 1.0, 2.0, 3.0], 4.0)


def check(figure: Figure) -> None:
    figure.draw_without_rendering()
    for axis in figure.axes:
        limits = [*axis.get_xlim(), *axis.get_ylim()]
        assert np.isfinite(limits).all()
        assert limits[0] < limits[1] and limits[2] < limits[3]


def lines(figure: Figure, axis: int) -> list[Array]:
    return [np.asarray(line.get_ydata(), dtype=float) for line in figure.axes[axis].get_lines()]


@pytest.fixture
def data() -> Data:
    rng = np.random.default_rng(0)
    control = np.arange(0, 100, 0.5)
    turning = ((control >= 20) & (control < 40)) | ((control >= 80) & (control < 90))
    torque = np.where(turning[:, None, None], 1e-3 * rng.normal(size=(200, 2, 3)), np.nan)
    return {
        "time_s": TIMES,
        "section": SECTION,
        "observer": np.array(["one", "two"]),
        "debris_position_error": 1e3 * rng.normal(size=(100, 3)),
        "debris_position_sigma": np.full((100, 3), 1e3),
        "covariance_trace": np.geomspace(1e5, 1e8, 100),
        "true_pixel": np.cumsum(rng.normal(size=(100, 2, 2)), axis=0),
        "image_half_size": np.array([240.0, 180.0]),
        "control_time_s": control,
        "torque": torque,
    }


def test_control_sections_begin_and_end_where_they_do() -> None:
    assert control_sections(TIMES, SECTION) == [(20.0, 40.0), (80.0, 90.0)]
    assert control_sections(TIMES, np.zeros(100)) == []


def test_the_error_of_an_orbit_is_in_kilometres(data: Data) -> None:
    figure = orbit_error(data, "scenario, case 1, estimator best, run 0")
    check(figure)
    assert len(figure.axes) == 3
    for index in range(3):
        np.testing.assert_allclose(
            lines(figure, index)[0], data["debris_position_error"][:, index] / 1e3
        )
        assert figure.axes[index].get_ylim()[1] > 3.0
    assert "run 0" in figure.axes[0].get_title(loc="left")


def test_sections_of_control_are_shaded(data: Data) -> None:
    for draw in (orbit_error, covariance_trace):
        shaded = draw(data, "").axes[0].collections[0].get_paths()
        spans = sorted(tuple(path.vertices[:, 0][[0, 2]]) for path in shaded)
        assert spans == [(19.5, 39.5), (79.5, 89.5)]


def test_the_trace_is_in_square_kilometres(data: Data) -> None:
    figure = covariance_trace(data, "")
    check(figure)
    np.testing.assert_allclose(lines(figure, 0)[0], data["covariance_trace"] / 1e6)


def test_paths_stay_apart_by_section_within_the_border(data: Data) -> None:
    figure = pixel_paths(data, "")
    check(figure)
    shown = [axis for axis in figure.axes if axis.get_xlabel()]
    assert len(shown) == 2
    for index, axis in enumerate(shown):
        border = next(patch for patch in axis.patches if isinstance(patch, Rectangle))
        assert (border.get_width(), border.get_height()) == (480.0, 360.0)
        path = data["true_pixel"][:, index, 0]
        for number, line in zip(np.unique(SECTION), axis.get_lines()):
            mine = np.flatnonzero(number == SECTION)
            reached = path[mine[0] : mine[-1] + 2]
            np.testing.assert_allclose(np.asarray(line.get_xdata()), reached)
        colours = [line.get_color() for line in axis.get_lines()[:5]]
        assert len({*colours[::2]}) == len({*colours[1::2]}) == 1
        assert colours[0] != colours[1]


def test_a_third_satellite_has_an_image_of_its_own(data: Data) -> None:
    more = data | {
        "observer": np.array(["one", "two", "three"]),
        "true_pixel": np.zeros((100, 3, 2)),
        "torque": np.zeros((200, 3, 3)),
    }
    for draw in (pixel_paths, torques):
        figure = draw(more, "")
        check(figure)
        texts = [text.get_text() for axis in figure.axes for text in axis.texts]
        assert {"one", "two", "three"} <= set(texts)


def test_every_control_section_has_a_row_of_torques(data: Data) -> None:
    figure = torques(data, "")
    check(figure)
    panels = [axis for axis in figure.axes if axis.get_lines()]
    assert len(panels) == 4
    assert [panel.get_xlim() for panel in panels] == [(20, 40), (20, 40), (80, 90), (80, 90)]
    inside = (data["control_time_s"] >= 20) & (data["control_time_s"] < 40)
    drawn = np.asarray(panels[1].get_lines()[2].get_ydata())
    np.testing.assert_allclose(drawn, 1e3 * data["torque"][inside, 1, 2])


def test_debris_that_is_never_seen_leaves_empty_axes(data: Data) -> None:
    nothing = data | {
        "section": np.zeros(100),
        "true_pixel": np.full((100, 2, 2), np.nan),
        "torque": np.full((200, 2, 3), np.nan),
        "debris_position_error": np.full((100, 3), np.nan),
        "debris_position_sigma": np.full((100, 3), np.nan),
        "covariance_trace": np.full(100, np.nan),
    }
    for draw in (orbit_error, covariance_trace, pixel_paths, torques):
        check(draw(nothing, ""))
