"""One bad run is an outcome of that run, and of no other."""

from functools import partial

import numpy as np
import pytest

from debrisest.filters.kalman.unscented import UnscentedParameters, unscented
from debrisest.filters.model import Model
from debrisest.filters.status import FilterStatus
from tests.filters.spoiled import (
    BAD,
    CAUSES,
    EPOCHS,
    GOOD,
    assert_divergence_stays_in_its_run,
    assert_no_run_depends_on_another,
    assert_wrong_shapes_are_refused,
    cubic_model,
    problem,
)


@pytest.mark.parametrize("redraw", [False, True])
@pytest.mark.parametrize("cause", CAUSES)
def test_divergence_stays_in_its_run(cause, redraw):
    filtered = partial(unscented, cubic_model(), redraw=redraw)
    assert_divergence_stays_in_its_run(filtered, cause)


def test_a_run_does_not_depend_on_its_neighbours():
    assert_no_run_depends_on_another(partial(unscented, cubic_model()), problem())


def linear_model():
    return Model(lambda x, _: x, lambda x, _: x[..., :1], 1e-3 * np.eye(2), np.eye(1), ("x", "y"))


def test_indefinite_start_is_repaired_and_counted():
    start, covariance, y = problem()
    sound = unscented(linear_model(), start, covariance, y)
    covariance[BAD] = np.diag([0.4, -1e-9])
    history = unscented(linear_model(), start, covariance, y)
    covariance[BAD] = np.diag([0.4, 4e-13])
    nearest = unscented(linear_model(), start, covariance, y)

    assert history.counts["repairs"].tolist() == [0, 0, 1, 0, 0]
    assert not sound.counts["repairs"].any()
    assert np.array_equal(history.state[GOOD], sound.state[GOOD])
    np.testing.assert_allclose(history.state[BAD], nearest.state[BAD], atol=1e-9)
    np.testing.assert_allclose(history.covariance[BAD], nearest.covariance[BAD], atol=1e-9)
    assert history.status[BAD] == FilterStatus.FINISHED.sentence


def test_repair_keeps_the_sound_directions_of_a_correlated_covariance():
    angle = 0.7
    axes = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    indefinite = axes @ np.diag([2.0, -0.5]) @ axes.T
    nothing = np.full((1, 1, 1), np.nan)
    history = unscented(linear_model(), np.zeros((1, 2)), indefinite[None], nothing)
    np.testing.assert_allclose(
        history.covariance[0, 0], axes @ np.diag([2.0, 0.0]) @ axes.T, atol=1e-11
    )


def test_kept_epochs_always_hold_the_last():
    start, covariance, y = problem()
    assert unscented(cubic_model(), start, covariance, y).kept.tolist() == [EPOCHS - 1]
    history = unscented(cubic_model(), start, covariance, y, keep=[8, 3, 8])
    assert history.kept.tolist() == [3, 8, EPOCHS - 1]
    variances = np.diagonal(history.covariance, axis1=-2, axis2=-1)
    assert np.array_equal(np.sqrt(variances), history.sigma[:, history.kept])


def test_every_status_says_what_happened():
    for status in FilterStatus:
        assert FilterStatus(int(status)) is status
        assert status.sentence.startswith(("finished", "diverged: ", "not started: "))


def test_wrong_arguments_are_refused():
    assert_wrong_shapes_are_refused(partial(unscented, cubic_model()))
    with pytest.raises(ValueError, match="must be positive"):
        unscented(cubic_model(), *problem(), UnscentedParameters(kappa=-2.0))
