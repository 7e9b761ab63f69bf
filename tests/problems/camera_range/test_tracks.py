"""Landmarks on trial, and runs that are lost at the very end."""

import numpy as np

from debrisest.filters.landmark_model import points_of
from debrisest.filters.status import ReplayStatus


def test_a_false_first_match_does_not_become_a_landmark(nominal) -> None:
    """It shows another landmark for three frames, which passes the gate of those on trial."""
    case, started = nominal
    present, covariance = started.present.copy(), started.covariance.copy()
    present[:, 2] = False
    covariance[:, 23:26] = covariance[:, :, 23:26] = 0.0
    shown, seen = case.observed.shown.copy(), case.observed.seen.copy()
    seen[:, :110, 2] = False
    shown[:, 110:113, 2] = shown[:, 110:113, 5]
    case = case.with_observed(case.observed._replace(shown=shown, seen=seen))
    found = case.filtered(started._replace(present=present, covariance=covariance))
    error = np.abs(points_of(case.model, found.state) - case.points[:, None])[:, :, 2]
    assert (found.counts["dropped"] >= 1).all()
    assert np.isfinite(error[:, -1]).all()
    assert np.nanmax(error) < 1.0  # m; the other landmark is 2.5 m away


def test_divergence_in_the_last_frame_is_told(nominal) -> None:
    case, started = nominal
    shown = case.observed.shown.copy()
    shown[1, -1, 0] = np.nan
    result = case.with_observed(case.observed._replace(shown=shown)).filtered(
        started, false_alarm=None
    )
    status, at = result.status, result.diverged_at
    ends = [ReplayStatus.DIVERGED if run == 1 else ReplayStatus.CONVERGED for run in range(4)]
    assert status.tolist() == [end.sentence for end in ends]
    assert at.tolist() == [-1, case.core.shape[1] - 1, -1, -1]
    assert np.isnan(result.state[1, -1]).all()
    assert np.isfinite(result.state[[0, 2, 3], -1]).all()
