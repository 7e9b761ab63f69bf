"""The figure of the whole motion on made-up data."""

import numpy as np
import pytest

from debrisest.arrays import Data
from debrisest.show.plots.motion import long_gaps, motion

TIMES = np.concatenate([np.arange(0.0, 40.0, 2.0), np.arange(100.0, 160.0, 2.0)])


@pytest.fixture
def data() -> Data:
    half = 0.03 * TIMES / 2
    zero = 0.0 * TIMES
    rejected = np.zeros(len(TIMES))
    rejected[[3, 30]] = 2
    return {
        "time_s": TIMES,
        "rate_f": np.tile([0.0, 0.01, 0.03], (len(TIMES), 1)),
        "rate_f_sigma": np.full((len(TIMES), 3), 1e-3),
        "q_if": np.stack([np.cos(half), zero, zero, np.sin(half)], axis=-1),
        "q_if_sigma": np.full((len(TIMES), 4), 1e-2),
        "rejected": rejected,
        "accepted": np.asarray(1.0),
    }


def test_rates_are_in_degrees_and_bands_three_sigma_wide(data: Data) -> None:
    axis = motion(data, "made").axes[0]
    np.testing.assert_allclose(axis.lines[2].get_ydata()[0], np.degrees(0.03))
    band = axis.collections[2].get_paths()[0].vertices[:, 1]
    np.testing.assert_allclose(np.ptp(band), np.degrees(6e-3))
    assert axis.get_ylabel() == "rate [deg/s]"


def test_no_line_goes_across_a_gap(data: Data) -> None:
    assert long_gaps(TIMES) == [(38.0, 62.0)]
    for axis in motion(data, "made").axes:
        x, y = axis.lines[0].get_data()
        assert np.isnan(y[(x > 38.0) & (x < 100.0)]).all()
        assert np.isfinite(y).sum() == len(TIMES)


def test_rejected_epochs_are_marked(data: Data) -> None:
    marks = motion(data, "made").axes[0].lines[-1]
    np.testing.assert_array_equal(marks.get_xdata(), TIMES[[3, 30]])
    assert not len(motion(data | {"rejected": np.zeros(50)}, "").axes[0].lines[-1].get_xdata())


def test_the_title_says_what_is_not_accepted(data: Data) -> None:
    def title(data: Data) -> str:
        return " ".join(text.get_text() for text in motion(data, "made").axes[0].texts)

    assert "NOT" not in title(data)
    assert "NOT accepted" in title(data | {"accepted": np.asarray(0.0)})


@pytest.mark.parametrize("epochs", [1, 2, 50])
def test_motion_of_which_nothing_is_known_is_drawn(data: Data, epochs: int) -> None:
    one_run = ("accepted",)
    few = {name: v if name in one_run else v[:epochs] for name, v in data.items()}
    unknown = {k: np.full_like(v, np.nan) for k, v in few.items() if k not in ("time_s", *one_run)}
    motion(few | unknown, "made").canvas.draw()
