"""One bad run is an outcome of that run, and of no other."""

import numpy as np
import pytest

from debrisest.filters.kalman.unscented import UnscentedParameters, unscented
from debrisest.filters.model import Model
from debrisest.filters.status import FilterStatus

RUNS, EPOCHS, BAD = 5, 12, 2
GOOD = [run for run in range(RUNS) if run != BAD]


def cubic_model():
    """Grows without bound once |x| is large; a run whose second component exceeds 50 is blind."""
    return Model(
        process=lambda x, _: np.stack(
            [x[..., 0] * (1 + 0.01 * x[..., 0] ** 2), np.sin(x[..., 0]) + 0.9 * x[..., 1]], axis=-1
        ),
        measurement=lambda x, _: np.where(x[:, :1, 1:] > 50.0, 1.0, x[..., :1] + x[..., 1:] ** 2),
        process_noise=np.diag([1e-3, 1e-3]),
        measurement_noise=np.array([[0.0]]),
        error_names=("x", "y"),
    )


def problem():
    rng = np.random.default_rng(0)
    start = 0.3 * rng.normal(size=(RUNS, 2))
    covariance = np.stack([np.diag([0.1, 0.2])] * RUNS)
    y = 0.3 * rng.normal(size=(RUNS, EPOCHS, 1))
    y[:, 0] = np.nan
    return start, covariance, y


CAUSES = {
    "overflow": (0, (BAD, 0), 1e200, FilterStatus.DIVERGED, 1),
    "singular innovation covariance": (0, (BAD, 1), 60.0, FilterStatus.DIVERGED, 1),
    "infinite measurement": (2, (BAD, 7), np.inf, FilterStatus.DIVERGED, 7),
    "no start": (0, BAD, np.nan, FilterStatus.NO_START, 0),
    "no start covariance": (1, (BAD, 0, 1), np.inf, FilterStatus.NO_START, 0),
}


@pytest.mark.parametrize("redraw", [False, True])
@pytest.mark.parametrize("cause", CAUSES)
def test_divergence_stays_in_its_run(cause, redraw):
    which, where, value, status, epoch = CAUSES[cause]
    given = problem()
    sound = unscented(cubic_model(), *given, keep=[3, 8], redraw=redraw)
    given[which][where] = value
    history = unscented(cubic_model(), *given, keep=[3, 8], redraw=redraw)

    for name in ("state", "sigma", "covariance", "nis", "nis_dof", "status"):
        assert np.array_equal(getattr(history, name)[GOOD], getattr(sound, name)[GOOD]), name
    assert np.array_equal(history.counts["repairs"][GOOD], sound.counts["repairs"][GOOD])
    assert (sound.status == FilterStatus.FINISHED.sentence).all()
    assert (sound.diverged_at == -1).all()
    assert history.status[BAD] == status.sentence
    assert history.diverged_at[BAD] == epoch
    for values in (history.state, history.sigma, history.nis):
        assert np.isfinite(values[BAD, :epoch]).all()
        assert np.isnan(values[BAD, epoch:]).all()
    assert not history.nis_dof[BAD, epoch:].any()
    assert np.array_equal(np.isnan(history.covariance[BAD, :, 0, 0]), history.kept >= epoch)


def test_a_run_does_not_depend_on_its_neighbours():
    start, covariance, y = problem()
    together = unscented(cubic_model(), start, covariance, y)
    for run in range(RUNS):
        one = slice(run, run + 1)
        alone = unscented(cubic_model(), start[one], covariance[one], y[one])
        assert np.array_equal(alone.state[0], together.state[run])


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
    start, covariance, y = problem()
    with pytest.raises(ValueError, match="start covariance of shape"):
        unscented(cubic_model(), start, covariance[:2], y)
    with pytest.raises(ValueError, match="kept epochs"):
        unscented(cubic_model(), start, covariance, y, keep=[EPOCHS])
    with pytest.raises(ValueError, match="must be positive"):
        unscented(cubic_model(), start, covariance, y, UnscentedParameters(kappa=-2.0))
