"""Every figure on small made-up data: what it shows, and that nothing breaks its limits."""

from collections.abc import Callable

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from debrisest.arrays import Array, Data
from debrisest.show.plots.error_over_time import error_over_time
from debrisest.show.plots.rates import rates
from debrisest.show.plots.raw_quaternion import raw_quaternion
from debrisest.show.plots.recovered_quaternion import recovered_quaternion
from debrisest.show.plots.sign_hypotheses import (
    first_hypotheses,
    hypothesis_scores,
    next_hypotheses,
)

EPOCHS = 400
TIMES = np.arange(EPOCHS, dtype=float)
POINTS = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.2, 1.0], [0.0, 0.0, -1.0]])
TRUTHS = ("true_q_ib", "true_point_b", "true_rate_b", "true_inertia_b")
CYCLE = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
ONE_RUN = [(raw_quaternion, 4), (recovered_quaternion, 5), (rates, 4)]


def _scalar_first(rotation: Rotation) -> Array:
    return np.asarray(rotation.as_quat(scalar_first=True))


def _features() -> Rotation:
    """The frame of the features: from point 1 to point 2, normal to the plane, and the third."""
    first = POINTS[1] - POINTS[0]
    normal = np.cross(first, POINTS[2] - POINTS[0])
    axes = [first, normal, np.cross(first, normal)]
    return Rotation.from_matrix(np.transpose([axis / np.linalg.norm(axis) for axis in axes]))


@pytest.fixture
def data() -> Data:
    """A spin about the third axis, seen in two pieces, estimated with permuted axes."""
    rng = np.random.default_rng(1)
    body = Rotation.from_rotvec(np.outer(0.05 * TIMES, [0.0, 0.0, 1.0]))
    recovered = -_continuous(_scalar_first(body * _features()))
    piece = np.where(TIMES < 150, 0.0, np.where(TIMES < 170, np.nan, 1.0))
    sign = np.array([1.0, -1.0])
    raw = recovered * np.where(piece == 1, -1, 1)[:, None]
    raw[np.isnan(piece)] = np.nan
    rate = np.tile([0.01, -0.02, 0.05], (EPOCHS, 1))
    return {
        "time_s": TIMES,
        "raw_q_if": raw,
        "piece": piece,
        "sign": sign,
        "q_if": recovered,
        "true_q_ib": _scalar_first(body),
        "true_point_b": POINTS,
        "true_rate_b": rate,
        "true_inertia_b": np.diag([1.0, 2.0, 2.5]),
        "relabeling": CYCLE,
        "rate_b": (rate + 1e-4 * rng.standard_normal(rate.shape)) @ CYCLE,
        "rate_b_sigma": np.tile([1e-4, 2e-4, 3e-4], (EPOCHS, 1)),
    }


def _continuous(q: Array) -> Array:
    turns = np.where(np.sum(q[1:] * q[:-1], axis=-1) < 0, -1.0, 1.0)
    return q * np.cumprod(np.concatenate([[1.0], turns]))[:, None]


def _check(figure: Figure, axes: int, drawn: bool = True) -> None:
    if drawn:
        figure.draw_without_rendering()
    assert len(figure.axes) == axes
    for axis in figure.axes:
        limits = [*axis.get_xlim(), *axis.get_ylim()]
        assert np.isfinite(limits).all()
        assert limits[0] < limits[1] and limits[2] < limits[3]


def _lines(figure: Figure, axis: int) -> list[Array]:
    return [np.asarray(line.get_ydata(), dtype=float) for line in figure.axes[axis].get_lines()]


@pytest.mark.parametrize(("draw", "axes"), ONE_RUN)
def test_with_truth(draw: Callable[[Data, str], Figure], axes: int, data: Data) -> None:
    figure = draw(data, "scenario, case 1, estimator best, run 0")
    _check(figure, axes)
    assert "run 0" in figure.axes[0].get_title(loc="left")


@pytest.mark.parametrize(
    ("draw", "axes"), [(raw_quaternion, 4), (recovered_quaternion, 5), (rates, 1)]
)
def test_without_truth(draw: Callable[[Data, str], Figure], axes: int, data: Data) -> None:
    for name in (*TRUTHS, "relabeling"):
        del data[name]
    _check(draw(data, "tracks"), axes, drawn=False)


@pytest.mark.parametrize(("draw", "axes"), ONE_RUN)
def test_a_run_of_nan(draw: Callable[[Data, str], Figure], axes: int, data: Data) -> None:
    for name in ("raw_q_if", "piece", "q_if", "rate_b", "rate_b_sigma"):
        data[name] = np.full_like(data[name], np.nan)
    data["sign"] = np.zeros(0)
    _check(draw(data, "lost"), axes)


@pytest.mark.parametrize(("draw", "axes"), ONE_RUN)
def test_two_epochs(draw: Callable[[Data, str], Figure], axes: int, data: Data) -> None:
    whole = ("true_point_b", "true_inertia_b", "sign", "relabeling")
    short = {name: value if name in whole else value[:2] for name, value in data.items()}
    _check(draw(short, "short"), axes, drawn=False)


def test_raw_samples_are_all_shown_in_two_colours(data: Data) -> None:
    figure = raw_quaternion(data, "")
    for component in range(4):
        odd, even = _lines(figure, component)
        assert not np.any(np.isfinite(odd) & np.isfinite(even))
        shown = np.where(np.isfinite(odd), odd, even)
        np.testing.assert_array_equal(shown, data["raw_q_if"][:, component])


def test_samples_and_truth_take_the_sign_of_the_recovered_signal(data: Data) -> None:
    figure = recovered_quaternion(data, "")
    seen = np.isfinite(data["piece"])
    for axis, component in enumerate((0, 0, 1, 2, 3)):
        samples, recovered, truth = _lines(figure, axis)
        np.testing.assert_array_equal(recovered, data["q_if"][:, component])
        np.testing.assert_allclose(samples[seen], recovered[seen], atol=1e-12)
        assert np.isnan(samples[~seen]).all()
        np.testing.assert_allclose(truth, recovered, atol=1e-12)
    assert figure.axes[0].get_xlim() == (0, 400)
    assert figure.axes[1].get_xlim() == (100, 400)


def test_rates_are_relabeled_and_in_degrees(data: Data) -> None:
    figure = rates(data, "")
    shown = _lines(figure, 0)
    for index in range(3):
        estimate, truth = shown[2 * index : 2 * index + 2]
        np.testing.assert_allclose(truth, np.degrees(data["true_rate_b"][:, index]))
        np.testing.assert_allclose(_lines(figure, 1 + index)[0], estimate - truth)
        band = figure.axes[1 + index].collections[0].get_paths()[0].vertices
        sigma = (2e-4, 3e-4, 1e-4)[index]
        assert np.max(np.asarray(band)[:, 1]) == pytest.approx(3 * np.degrees(sigma))
    assert "deg/s" in figure.axes[0].get_ylabel()


def test_rates_stay_readable_beside_a_wild_start(data: Data) -> None:
    data["rate_b"][:3] += 1e3
    data["rate_b_sigma"][:3] = 1e3
    for axis in rates(data, "").axes[1:]:
        assert max(np.abs(axis.get_ylim())) < 1


def _errors(runs: int = 5) -> Data:
    rng = np.random.default_rng(2)
    shape = (runs, EPOCHS)
    return {"time_s": TIMES} | {f"rate_{i}": rng.normal(0, 1e-3, shape) for i in (1, 2, 3)}


def test_errors_are_averaged_and_maximised_over_runs() -> None:
    data = _errors()
    data["rate_2"][1] = np.nan
    data["rate_2"][0, 7] = 0.0
    figure = error_over_time(data, "5 runs")
    _check(figure, 3)
    for index, axis in enumerate(figure.axes):
        error = np.abs(np.degrees(data[f"rate_{index + 1}"]))
        largest, mean = _lines(figure, index)
        np.testing.assert_allclose(largest, np.nanmax(error, axis=0))
        np.testing.assert_allclose(mean, np.nanmean(error, axis=0))
        assert axis.get_yscale() == "log"
        assert "deg/s" in axis.get_ylabel()


@pytest.mark.parametrize("value", [0.0, np.nan])
def test_errors_that_no_log_axis_can_show(value: float) -> None:
    data = _errors()
    data["rate_1"][:, 10:20] = value
    _check(error_over_time(data, ""), 3)
    for name in ("rate_1", "rate_2", "rate_3"):
        data[name] = np.full_like(data[name], value)
    _check(error_over_time(data, ""), 3)


def test_settings_of_the_caller_are_kept_and_do_not_matter(data: Data) -> None:
    with mpl.rc_context({"font.size": 31.0, "axes.grid": False}):
        before = dict(mpl.rcParams)
        figure = rates(data, "")
        assert dict(mpl.rcParams) == before
    label = rates(data, "").axes[0].yaxis.label
    assert figure.axes[0].yaxis.label.get_fontsize() == label.get_fontsize()


def test_long_contexts_are_wrapped(data: Data) -> None:
    context = "scenario, case " + ",".join(f"key_{i}=0.12345" for i in range(12)) + ", run 0"
    figure = rates(data, context)
    _check(figure, 4)
    texts = figure.axes[0].findobj(lambda artist: "0.12345" in getattr(artist, "get_text", str)())
    assert len(texts) == 1
    assert 0 < texts[0].get_window_extent().x1 < figure.bbox.x1


@pytest.fixture
def tried(data: Data) -> Data:
    """Both signs of the second piece; the one that turns it is the better one."""
    sign = np.array([[1.0, 1.0], [1.0, -1.0]])
    shown = {"hypothesis_sign": sign, "hypothesis_score": np.array([2.0, 1.0])}
    return data | shown | {"hypothesis_q0": np.tile(data["q_if"][:, 0], (2, 1))}


def test_hypotheses_show_the_samples_with_their_signs(tried: Data) -> None:
    figure = first_hypotheses(tried, "case spin")
    figure.draw_without_rendering()
    panels = [axis for axis in figure.axes if axis.get_lines()]
    assert [axis.texts[0].get_text() for axis in panels] == ["0", "1"]
    raw, second = tried["raw_q_if"][:, 0], tried["piece"] == 1
    for axis, factor in zip(panels, (1.0, -1.0)):
        samples, signal = (line.get_ydata() for line in axis.get_lines())
        np.testing.assert_array_equal(samples[second], factor * raw[second])
        np.testing.assert_array_equal(signal, tried["q_if"][:, 0])


def test_the_bars_are_the_penalties(tried: Data) -> None:
    figure = hypothesis_scores(tried, "case spin")
    _check(figure, 1)
    (axis,) = figure.axes
    assert [bar.get_height() for bar in axis.patches] == [2.0, 1.0]
    assert [label.get_text() for label in axis.get_xticklabels()] == ["0", "1"]


def test_the_step_after_the_first_is_drawn_apart(tried: Data) -> None:
    first = tried["hypothesis_sign"] * [1.0, np.nan]
    both = {name: np.concatenate([tried[name]] * 2) for name in tried if "hypothesis" in name}
    both["hypothesis_sign"] = np.concatenate([first, tried["hypothesis_sign"]])
    for draw, labels in ((first_hypotheses, ["", ""]), (next_hypotheses, ["0", "1"])):
        panels = [axis for axis in draw(tried | both, "").axes if axis.get_lines()]
        assert [axis.texts[0].get_text() for axis in panels] == labels
