"""The one record of estimates, and its writer: runs leave the batch one by one."""

import numpy as np
import pytest

from debrisest.filters.estimates import EstimatesWriter
from debrisest.filters.runs import put, take
from debrisest.filters.status import FilterStatus, ReplayStatus

RUNS, EPOCHS, N = 4, 3, 2
NAMES = ("x", "y")


def batch(runs, value=1.0):
    return np.full((runs, N), value), np.tile(4.0 * np.eye(N), (runs, 1, 1))


def written(**options):
    """Run 0 has no start, run 2 is lost at epoch 1; every epoch counts one repair and one pixel."""
    state, covariance = batch(RUNS)
    state[0, 1] = np.nan
    writer = EstimatesWriter(NAMES, state, covariance, EPOCHS, [0], **options)
    assert writer.runs.tolist() == [1, 2, 3]
    for k in range(EPOCHS):
        state, covariance = batch(len(writer.runs), k)
        covariance[1 if k == 1 else slice(0), 0, 0] = np.inf
        ones = np.ones(len(state), dtype=np.int64)
        figures = {"nis": 2.0 * ones, "nis_dof": ones, "repairs": ones, "rejected": ones}
        going = writer.record(k, state, covariance, figures)
        assert going.tolist() == ([0, 2] if k == 1 else list(range(len(state))))
    return writer.estimates()


def test_a_lost_run_is_nan_from_there_on():
    found = written(counts={"rejected": 0, "cost": np.nan}, totals=["repairs"])
    expected = np.full((RUNS, EPOCHS), np.nan)
    expected[[1, 3]], expected[2, 0] = [0, 1, 2], 0
    np.testing.assert_array_equal(found.state[..., 0], expected)
    np.testing.assert_array_equal(found.sigma[..., 1], np.where(np.isnan(expected), np.nan, 2.0))
    np.testing.assert_array_equal(found.nis, np.where(np.isnan(expected), np.nan, 2.0))
    np.testing.assert_array_equal(found.nis_dof, np.isfinite(expected))
    assert found.kept.tolist() == [0, EPOCHS - 1]
    np.testing.assert_array_equal(
        np.isnan(found.covariance[:, :, 0, 0]), np.isnan(expected[:, ::2])
    )
    assert found.diverged_at.tolist() == [0, -1, 1, -1]


def test_only_what_is_wanted_is_counted():
    assert written().counts == {}
    counts = written(counts={"rejected": 0, "cost": np.nan}, totals=["repairs"]).counts
    assert list(counts) == ["rejected", "cost", "repairs"]
    assert counts["rejected"].tolist() == [[0, 0, 0], [1, 1, 1], [1, 0, 0], [1, 1, 1]]
    assert counts["repairs"].tolist() == [0, 3, 1, 3]
    assert np.isnan(counts["cost"]).all()


@pytest.mark.parametrize("outcomes", [FilterStatus, ReplayStatus])
def test_how_runs_end_is_told_in_words(outcomes):
    words = [text.split(":")[0] for text in written(outcomes=outcomes).status]
    good = "finished" if outcomes is FilterStatus else "converged"
    assert words == ["not started", good, "diverged", good]


def test_a_state_may_hide_parts_that_are_not_to_be_shown():
    writer = EstimatesWriter(NAMES, *batch(2), 1)
    state, covariance = batch(2)
    going = writer.record(0, state, covariance, {}, shown=np.where([True, False], state, np.nan))
    assert going.tolist() == [0, 1]
    assert np.isnan(writer.estimates().state[..., 1]).all()
    assert writer.estimates().diverged_at.tolist() == [-1, -1]


def test_wrong_shapes_and_epochs_are_refused():
    state, covariance = batch(2)
    with pytest.raises(ValueError, match="2 runs with 2 error names need a start covariance"):
        EstimatesWriter(NAMES, state, covariance[:1], 3)
    with pytest.raises(ValueError, match="within the 3 measured ones"):
        EstimatesWriter(NAMES, state, covariance, 3, [3])


def test_some_runs_of_nested_tuples():
    from debrisest.filters.landmarks.cost import Prior
    from debrisest.filters.landmarks.growing_windows import Fit

    def fit(values):
        prior = Prior(values.copy(), values[:, None].copy())
        return Fit(prior, prior._replace(mean=-values), prior)

    whole, runs = fit(np.arange(5.0)), np.array([3, 1])
    part = take(whole, runs)
    assert part.prior.mean.tolist() == [-3, -1] and part.at.information.tolist() == [[3], [1]]
    put(whole, runs, fit(np.array([30.0, 10.0])))
    assert whole.prior.mean.tolist() == [0, -10, -2, -30, -4]
