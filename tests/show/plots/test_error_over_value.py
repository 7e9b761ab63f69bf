"""The figure of what the tables say against the value of a key."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D

from debrisest.arrays import Data
from debrisest.results.assessed import Result
from debrisest.scenario.load import load_scenario
from debrisest.show.plots.along import along_curves
from debrisest.show.plots.error_over_value import COLUMNS, error_over_value
from debrisest.show.plots.style import ESTIMATOR_COLOURS, INK
from debrisest.show.tables.cells import cells as cells_of

VALUES = [0.001, 0.01, 0.1]


def cells(estimator: str, factor: float, published: float = np.nan) -> pd.DataFrame:
    measured = factor * np.array(VALUES)
    told = {"measured": measured, "ci_low": measured / 2, "ci_high": measured * 2}
    same = {"key": "sensors.points.noise_m", "table": "1", "quantity": "pitch", "unit": "deg"}
    same |= {"statistic": "rmse", "window": "0-9 s", "estimator": estimator}
    return pd.DataFrame({"value": VALUES, "published": published, **told}).assign(**same)


def data_of(*parts: pd.DataFrame) -> Data:
    together = pd.concat(parts)
    return {name: together[name].to_numpy() for name in COLUMNS}


def test_each_estimator_is_a_line_with_its_interval_and_the_bound_is_dashed() -> None:
    given = data_of(cells("wahba", 3.0, 0.2), cells("bound", 1.0))
    figure = error_over_value(given, "a scenario")
    _, axis = figure.axes
    lines = {to_hex(line.get_color()): line for line in axis.lines if line.get_marker() == "o"}
    np.testing.assert_allclose(lines[ESTIMATOR_COLOURS[0].lower()].get_ydata(), [0.003, 0.03, 0.3])
    assert lines[INK].is_dashed()
    bands = [band.get_paths()[0].vertices[:, 1] for band in axis.collections]
    ends = [(band.min(), band.max()) for band in bands]
    np.testing.assert_allclose(ends, [(0.0015, 0.6), (0.0005, 0.2)])
    assert axis.get_xscale() == axis.get_yscale() == "log"
    assert axis.get_xlabel() == "noise_m"
    told = [text.get_text() for text in figure.legends[0].get_texts()]
    assert told == ["wahba", "bound", "95 % interval", "published"]


def test_published_values_are_marks_where_they_are_known() -> None:
    given = cells("wahba", 3.0)
    given.loc[1, "published"] = 0.5
    _, axis = error_over_value(data_of(given), "").axes
    (marks,) = (line for line in axis.lines if line.get_marker() == "D")
    assert isinstance(marks, Line2D)
    assert (list(marks.get_xdata()), list(marks.get_ydata())) == ([0.01], [0.5])


def test_quantities_that_cannot_be_on_a_logarithmic_axis_are_on_a_linear_one() -> None:
    given = cells("wahba", 3.0).assign(measured=[-1.0, 0.0, 100.0])
    _, axis = error_over_value(data_of(given), "").axes
    assert axis.get_yscale() == "linear"


@pytest.fixture
def with_grid(small: Path) -> Path:
    text = small.read_text().partition("\ncases:")[0].replace("  published: small.csv\n", "")
    grid = "grid: {sensors.points.noise_m: [0.03, 0.01, 0.02]}"
    small.write_text(f"{text.replace('[slow, fast]', '[]')}\n{grid}\n")
    return small


def test_the_cells_of_a_grid_stand_in_the_order_of_its_values(with_grid: Path) -> None:
    scenario = load_scenario(with_grid)
    times = np.arange(61.0)
    errors = {
        (case, "wahba"): Result({"pitch": np.full((2, 61), k + 1.0)}, times, {}, 2)
        for k, case in enumerate(scenario.cases)
    }
    sources = list(along_curves(scenario, cells_of(scenario, errors)))
    assert [source.names for source in sources] == [("noise_m",)]
    pitch = pd.DataFrame(sources[0].data).query("quantity == 'pitch'")
    assert set(pitch["value"]) == {0.01, 0.02, 0.03}
    assert (pitch["value"].diff().dropna() >= 0).all()
    by_value = pitch.groupby("value")["measured"].first()
    np.testing.assert_allclose(by_value / by_value.min(), [2.0, 3.0, 1.0], rtol=1e-5)
    del errors[next(iter(scenario.cases)), "wahba"]
    assert list(along_curves(scenario, cells_of(scenario, errors))) == []
