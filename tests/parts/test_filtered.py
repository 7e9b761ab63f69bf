"""What every filter of labelled and of unlabelled measurements hands over of its history."""

import numpy as np
import pytest

from debrisest.filters.history import FilterStatus, History
from debrisest.parts.filters.filtered import filtered

RUNS, EPOCHS = 2, 4


@pytest.fixture
def history() -> History:
    series, counts = np.ones((RUNS, EPOCHS)), np.arange(RUNS * EPOCHS).reshape(RUNS, EPOCHS)
    known = {
        "state": series[..., None],
        "sigma": 2 * series[..., None],
        "covariance": np.ones((RUNS, 1, 1, 1)),
        "kept": np.array([3]),
        "nis": 3 * series,
        "repairs": np.array([9, 0]),
        "status": np.array([FilterStatus.FINISHED, FilterStatus.DIVERGED]),
        "reopened": np.array([7, 8]),
    }
    others = {name: counts + k for k, name in enumerate(History._fields)}
    return History(**(others | known))


def test_estimates_and_words(history: History) -> None:
    found = filtered(history)
    for name in ("state", "sigma", "covariance", "kept", "nis", "nis_dof"):
        np.testing.assert_array_equal(getattr(found, name), getattr(history, name))
    assert found.status[0] == "finished"
    assert found.status[1].startswith("diverged: ")


def test_repairs_are_always_told_and_the_gate_where_there_is_one(history: History) -> None:
    assert filtered(history).counts == {"repairs": history.repairs}
    gated = filtered(history, True, updates=history.iterations).counts
    assert list(gated) == ["repairs", "rejected", "reopened", "updates"]
    np.testing.assert_array_equal(gated["rejected"], history.rejected)
    np.testing.assert_array_equal(gated["reopened"], [7, 8])
