"""Whether sums of squares of normalised errors are as chance has them."""

import numpy as np
from scipy.special import gammaincinv


def nees(history, truth, k):
    """Sum over the runs of the normalised squared errors at an epoch; all epochs are kept."""
    error = (history.state - truth)[:, k]
    solved = np.linalg.solve(history.covariance[:, k], error[..., None])[..., 0]
    return (error * solved).sum()


def probable(total, dof, tail=1e-8):
    """Whether a chi-square sum lies between its `tail` quantiles."""
    low, high = 2 * gammaincinv(dof / 2, [tail, 1 - tail])
    return low < total < high


def assert_consistent(history, truth, epochs):
    """Innovations, and errors at some epochs: together, and component by component."""
    runs, _, n = truth.shape
    assert probable(history.nis.sum(), history.nis_dof.sum())
    for k in epochs:
        assert probable(nees(history, truth, k), n * runs)
        inside = np.abs(history.state - truth)[:, k] < history.sigma[:, k]
        assert abs(inside.mean() - 0.6827) < 6 * np.sqrt(0.6827 * 0.3173 / runs)


def assert_inconsistent(history, truth, epoch):
    runs, _, n = truth.shape
    assert not probable(history.nis.sum(), history.nis_dof.sum())
    assert not probable(nees(history, truth, epoch), n * runs)
