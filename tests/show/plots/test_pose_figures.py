"""Figures of pose estimates on small made-up data."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from scipy.stats import chi2

from debrisest.arrays import Array, Data
from debrisest.show.plots.histograms import QUANTITIES, histograms
from debrisest.show.plots.nees_over_time import nees_over_time
from debrisest.show.plots.pose_errors import pose_errors

TIMES = np.arange(101.0)
RUNS, DIMENSIONS = 40, 29
VECTORS = {
    "position_error": "position_sigma",
    "velocity_error": "velocity_sigma",
    "rate_error": "rate_l_sigma",
}
RATIOS = {"inertia_ratio_error": "inertia_ratio_sigma"}


def _check(figure: Figure) -> None:
    figure.draw_without_rendering()
    for axis in figure.axes:
        limits = [*axis.get_xlim(), *axis.get_ylim()]
        assert np.isfinite(limits).all()
        assert limits[0] < limits[1] and limits[2] < limits[3]


def _lines(figure: Figure, axis: int) -> list[Array]:
    return [np.asarray(line.get_ydata(), dtype=float) for line in figure.axes[axis].get_lines()]


def _errors(seed: int = 0) -> Data:
    rng = np.random.default_rng(seed)
    return {"time_s": TIMES} | {
        name: rng.gamma(4.0, 1e-3, (RUNS, 1)) * rng.uniform(0.5, 1.5, (RUNS, len(TIMES)))
        for name in QUANTITIES
    }


def _panels(figure: Figure) -> list[int]:
    return [index for index, axis in enumerate(figure.axes) if axis.get_xlabel()]


def _counts(figure: Figure, index: int) -> int:
    (steps,) = figure.axes[index].patches
    return int(steps.get_data().values.sum())


def test_histograms_show_every_run_and_the_median() -> None:
    data = _errors()
    figure = histograms(data, "40 runs")
    _check(figure)
    assert len(_panels(figure)) == len(QUANTITIES)
    for index, name in zip(_panels(figure), QUANTITIES):
        angular = name in ("rate", "attitude")
        error = data[name] * (180 / np.pi if angular else 1.0)
        means = [run[10:].sum() / 91 for run in error]
        assert figure.axes[index].get_lines()[0].get_xdata()[0] == pytest.approx(np.median(means))
        assert _counts(figure, index) == RUNS
        assert figure.axes[index].get_xlabel().startswith(name)
    assert "10-100 s" in figure.axes[0].get_title(loc="left")


def test_histograms_forget_signs_and_the_start() -> None:
    data = {"time_s": TIMES, "position": np.full((3, 101), -0.5)}
    data["position"][:, :10] = 1e6
    figure = histograms(data, "")
    (index,) = _panels(figure)
    np.testing.assert_allclose(figure.axes[index].get_lines()[0].get_xdata(), 0.5)


def test_histograms_leave_out_lost_runs_and_count_distant_ones() -> None:
    data = _errors()
    data["k1"][0, 50:] = np.nan
    data["k1"][1:3] = 1e3
    figure = histograms(data, "")
    _check(figure)
    index = _panels(figure)[QUANTITIES.index("k1")]
    assert _counts(figure, index) == RUNS - 3
    assert "2 beyond" in [text.get_text() for text in figure.axes[index].texts]


@pytest.mark.parametrize("value", [0.0, np.nan, np.inf])
def test_histograms_of_nothing(value: float) -> None:
    _check(histograms({"time_s": TIMES, "velocity": np.full((4, 101), value)}, ""))


def _one_run(seed: int = 0) -> Data:
    rng = np.random.default_rng(seed)
    data: Data = {"time_s": TIMES}
    for names, components in ((VECTORS, 3), (RATIOS, 2)):
        for error, sigma in names.items():
            data[error] = rng.normal(0, 1e-2, (len(TIMES), components))
            data[sigma] = np.full((len(TIMES), components), 1e-2) * np.arange(1, components + 1)
    return data


def test_pose_errors_and_bands() -> None:
    data = _one_run()
    figure = pose_errors(data, "run 0")
    _check(figure)
    panels = [index for index, axis in enumerate(figure.axes) if axis.get_lines()]
    assert len(panels) == 11
    expected = [
        (error, sigma, component)
        for error, sigma in (VECTORS | RATIOS).items()
        for component in range(data[error].shape[-1])
    ]
    for index, (error, sigma, component) in zip(panels, expected):
        scale = 180 / np.pi if error == "rate_error" else 1.0
        np.testing.assert_allclose(_lines(figure, index)[0], scale * data[error][:, component])
        band = np.asarray(figure.axes[index].collections[0].get_paths()[0].vertices)
        assert np.max(band[:, 1]) == pytest.approx(3 * scale * data[sigma][0, component])
    assert "run 0" in figure.axes[0].get_title(loc="left")


def test_pose_errors_draw_what_there_is() -> None:
    data = _one_run()
    figure = pose_errors({name: data[name] for name in ("time_s", "position_error")}, "")
    _check(figure)
    assert sum(bool(axis.get_lines()) for axis in figure.axes) == 3
    assert not any(axis.collections for axis in figure.axes)
    for name in data:
        if name != "time_s":
            data[name] = np.full_like(data[name], np.nan)
    _check(pose_errors(data, "lost"))


def test_pose_errors_stay_readable_beside_a_wild_start() -> None:
    data = _one_run()
    data["position_error"][:5] = 1e4
    data["position_sigma"][:5] = 1e4
    assert max(np.abs(pose_errors(data, "").axes[1].get_ylim())) < 1


def _nees(seed: int = 0) -> Data:
    rng = np.random.default_rng(seed)
    known = np.isin(TIMES, [1, 10, 50, 100])
    nees = rng.chisquare(DIMENSIONS, (RUNS, len(TIMES))) / DIMENSIONS
    return {
        "time_s": TIMES,
        "nees": np.where(known, nees, np.nan),
        "nees_dof": np.full((RUNS, len(TIMES)), float(DIMENSIONS)),
    }


def test_nees_over_the_runs_and_its_interval() -> None:
    data = _nees()
    data["nees"][3, 50:] = np.nan
    figure = nees_over_time(data, "40 runs")
    _check(figure)
    mean, median = [line for line in _lines(figure, 0) if len(line) == 4]
    known = data["nees"][:, [1, 10, 50, 100]]
    np.testing.assert_allclose(mean, np.nanmean(known, axis=0))
    np.testing.assert_allclose(median, np.nanmedian(known, axis=0))
    bars = [bar for bar in figure.axes[0].patches if isinstance(bar, Rectangle)]
    assert len(bars) == 4
    band = np.array(
        [edge for bar in bars for edge in (bar.get_y(), bar.get_y() + bar.get_height())]
    )
    freedom = DIMENSIONS * (RUNS - 1)
    np.testing.assert_allclose(
        [band.min(), band.max()], chi2.ppf([0.025, 0.975], freedom) / freedom
    )
    assert figure.axes[0].get_yscale() == "log"


@pytest.mark.parametrize("value", [0.0, np.nan, 1e9])
def test_nees_that_is_hard_to_show(value: float) -> None:
    data = _nees()
    data["nees"][:, 10:60] = value
    _check(nees_over_time(data, ""))
    data["nees"][:] = value
    _check(nees_over_time(data, ""))
    del data["nees_dof"]
    _check(nees_over_time(data, ""))
