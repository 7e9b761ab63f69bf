"""What figures show beside the curves: units, values of the tables, sections, labels, names."""

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from debrisest.show.plots.estimators_over_time import estimators_over_time
from debrisest.show.plots.gather import Beside
from debrisest.show.plots.histograms import histograms
from debrisest.show.plots.nees_over_time import nees_over_time
from debrisest.show.plots.pixel_paths import pixel_paths
from debrisest.show.plots.pose_errors import pose_errors
from debrisest.show.plots.target import target
from debrisest.show.plots.torques import torques

TIMES = np.arange(0.0, 101.0)
RNG = np.random.default_rng(0)


def labels(figure: Figure) -> list[str]:
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def vertical_lines(axis: Axes) -> list[float]:
    found = [np.unique(line.get_xdata()) for line in axis.lines]
    return [float(x[0]) for x in found if len(x) == 1]


def test_histograms_have_the_unit_of_the_table_and_what_stands_beside_it() -> None:
    errors = 1000.0 * np.array([1.0, 2.0, 3.0])[:, None] * np.ones((3, len(TIMES)))
    beside = Beside({"position": "km"}, {"position": 0.5 * errors}, {"position": 2.5})
    figure = histograms({"time_s": TIMES, "position": errors}, "here", beside)
    (axis,) = (axis for axis in figure.axes if axis.get_xlabel())
    assert axis.get_xlabel() == "position error [km]"
    assert sorted(vertical_lines(axis)) == pytest.approx([1.0, 2.0, 2.5])
    assert labels(figure) == ["runs", "median", "median of the bound", "published"]
    alone = histograms({"time_s": TIMES, "position": errors}, "here")
    assert labels(alone) == ["runs", "median"]


def test_a_published_value_beyond_the_axis_is_told_in_words() -> None:
    errors = np.ones((3, len(TIMES)))
    beside = Beside(published={"position": 50.0})
    figure = histograms({"time_s": TIMES, "position": errors}, "here", beside)
    told = [text.get_text() for axis in figure.axes for text in axis.texts]
    assert "published: 50" in told


def test_a_single_epoch_of_nees_shows_every_run_and_a_visible_interval() -> None:
    nees = np.full((30, len(TIMES)), np.nan)
    nees[:, -1] = RNG.chisquare(6, 30) / 6
    dof = np.where(np.isfinite(nees), 6.0, 0.0)
    figure = nees_over_time({"time_s": TIMES, "nees": nees, "nees_dof": dof}, "here")
    (bar,) = figure.axes[0].patches
    assert bar.get_width() > 1.0 and bar.get_height() > 0.1
    assert bar.get_y() < 1.0 < bar.get_y() + bar.get_height()
    assert "single runs" in labels(figure)
    drawn = max((line for line in figure.axes[0].lines), key=lambda line: len(line.get_xdata()))
    assert np.sort(drawn.get_ydata()) == pytest.approx(np.sort(nees[:, -1]))


def test_paths_of_sections_are_told_by_name() -> None:
    section = np.repeat([0.0, 1.0, 2.0, 3.0], [26, 25, 25, 25])
    data = {
        "observer": np.array(["left"]),
        "true_pixel": np.stack([TIMES, TIMES], axis=-1)[:, None],
        "image_half_size": np.array([200.0, 150.0]),
        "section": section,
    }
    figure = pixel_paths(data, "here")
    told = [text.get_text() for axis in figure.axes for text in axis.texts]
    assert [name for name in told if name[0] in "EC" and len(name) == 2] == ["E1", "C1", "E2", "C2"]


def test_every_column_of_errors_tells_its_time_and_norms_stand_alone() -> None:
    data = {
        "time_s": TIMES,
        "position_error": np.ones((len(TIMES), 3)),
        "attitude": np.ones(len(TIMES)),
        "inertia_ratio_error": np.ones((len(TIMES), 2)),
    }
    figure = pose_errors(data, "here")
    shown = [axis for axis in figure.axes if axis.get_visible() and axis.axison]
    columns = {round(axis.get_position().x0, 3) for axis in shown}
    with_time = {round(a.get_position().x0, 3) for a in shown if a.get_xlabel() == "time [s]"}
    assert columns == with_time and len(columns) == 3
    assert any(axis.get_ylabel() == "attitude [deg]" for axis in shown)
    data["attitude_error"] = np.ones((len(TIMES), 3))
    names = [axis.get_ylabel() for axis in pose_errors(data, "here").axes]
    assert names.count("attitude [deg]") == 1


@pytest.mark.parametrize(("spike", "scale"), [(1.0, "symlog"), (1e-3, "linear")])
def test_a_spike_of_the_torque_leaves_the_rest_readable(spike: float, scale: str) -> None:
    torque = 1e-3 * RNG.uniform(-1, 1, (len(TIMES), 2, 3))
    torque[40] = spike
    data = {
        "observer": np.array(["a", "b"]),
        "control_time_s": TIMES,
        "time_s": TIMES,
        "section": np.ones(len(TIMES)),
        "torque": torque,
    }
    figure = torques(data, "here")
    panels = [axis for axis in figure.axes if axis.lines]
    assert {axis.get_yscale() for axis in panels} == {scale}
    assert all(axis.get_ylim()[1] > 1e3 * spike for axis in panels)


def test_estimators_stand_together_with_the_bound_as_rms_over_runs() -> None:
    one, two = RNG.standard_normal((2, 8, len(TIMES))) * np.pi / 180
    data = {"time_s": TIMES, "rate/best": one, "rate/bound": two, "pitch/best": one}
    figure = estimators_over_time(data, "here")
    assert labels(figure) == ["best", "bound"]
    rate, pitch = figure.axes
    assert (rate.get_ylabel(), pitch.get_ylabel()) == ("rate [deg/s]", "pitch [deg]")
    expected = np.degrees(np.sqrt((one**2).mean(axis=0)))
    assert rate.lines[0].get_ydata() == pytest.approx(expected)
    assert len(rate.collections) == 1, "the band of the estimator, none of the bound"


def test_the_target_tells_which_features_are_seen() -> None:
    measured = np.zeros((len(TIMES), 2, 3))
    measured[:50, 1] = np.nan
    data = {
        "true_point_b": np.eye(3)[:2],
        "measured_point": measured,
        "feature": np.array(["nose", "tail"]),
    }
    figure = target(data, "here")
    axes = figure.axes[1]
    assert [text.get_text().strip() for text in axes.texts] == ["nose 100 %", "tail 50 %"]
    marks = [line for line in axes.lines if line.get_marker() == "o"]
    assert [mark.get_markerfacecolor() != "white" for mark in marks] == [True, False]
