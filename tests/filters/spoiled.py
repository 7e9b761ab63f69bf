"""Runs of a cubic model, one of which is spoiled in some way."""

import numpy as np
import pytest

from debrisest.filters.model import Model
from debrisest.filters.status import FilterStatus

RUNS, EPOCHS, BAD = 5, 12, 2
GOOD = [run for run in range(RUNS) if run != BAD]
CAUSES = {
    "overflow": (0, (BAD, 0), 1e200, FilterStatus.DIVERGED, 1),
    "singular innovation covariance": (0, (BAD, 1), 60.0, FilterStatus.DIVERGED, 1),
    "infinite measurement": (2, (BAD, 7), np.inf, FilterStatus.DIVERGED, 7),
    "no start": (0, BAD, np.nan, FilterStatus.NO_START, 0),
    "no start covariance": (1, (BAD, 0, 1), np.inf, FilterStatus.NO_START, 0),
}
"""What is spoiled of a problem, where, with what; the status that follows, and from which epoch."""


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
    """A start, its covariance, and measurements."""
    rng = np.random.default_rng(0)
    start = 0.3 * rng.normal(size=(RUNS, 2))
    covariance = np.stack([np.diag([0.1, 0.2])] * RUNS)
    y = 0.3 * rng.normal(size=(RUNS, EPOCHS, 1))
    y[:, 0] = np.nan
    return start, covariance, y


def per_run(estimates):
    fields = estimates._asdict()
    return {name: fields[name] for name in fields.keys() - {"kept", "counts"}} | estimates.counts


def assert_divergence_stays_in_its_run(filtered, cause):
    """One bad run is an outcome of that run, and of no other.

    ``filtered`` takes a start, its covariance, measurements and epochs to keep.
    """
    which, where, value, status, epoch = CAUSES[cause]
    given = problem()
    sound = filtered(*given, keep=[3, 8])
    given[which][where] = value
    history = filtered(*given, keep=[3, 8])

    for name, values in per_run(sound).items():
        assert np.array_equal(per_run(history)[name][GOOD], values[GOOD]), name
    assert (sound.status == FilterStatus.FINISHED.sentence).all()
    assert (sound.diverged_at == -1).all()
    assert history.status[BAD] == status.sentence
    assert history.diverged_at[BAD] == epoch
    for values in (history.state, history.sigma, history.nis):
        assert np.isfinite(values[BAD, :epoch]).all()
        assert np.isnan(values[BAD, epoch:]).all()
    for counts in [history.nis_dof, *per_epoch(history)]:
        assert not counts[BAD, epoch:].any()
    assert np.array_equal(np.isnan(history.covariance[BAD, :, 0, 0]), history.kept >= epoch)


def per_epoch(history):
    return [counts for counts in history.counts.values() if counts.shape[1:] == (EPOCHS,)]


def assert_no_run_depends_on_another(filtered, given):
    """Each run alone gives what it gives among others."""
    together = filtered(*given)
    for run in range(RUNS):
        alone = filtered(*(values[run : run + 1] for values in given))
        for name, values in per_run(together).items():
            assert np.array_equal(per_run(alone)[name][0], values[run]), name
    return together


def assert_wrong_shapes_are_refused(filtered):
    start, covariance, y = problem()
    with pytest.raises(ValueError, match="start covariance of shape"):
        filtered(start, covariance[:2], y)
    with pytest.raises(ValueError, match="kept epochs"):
        filtered(start, covariance, y, keep=[EPOCHS])
