"""Windows with outliers are told by a larger covariance, so that no descent starts there."""

import numpy as np

from debrisest.batch.local_rates import local_rates
from debrisest.batch.point_sums import KnownPoints
from debrisest.batch.starts import best_windows
from debrisest.batch.tracks import tracks


def test_a_start_avoids_windows_with_wrong_matches(tumbling, box) -> None:
    points = tumbling.points(np.random.default_rng(2), 0.05)
    points[:200:5] += 3.0 * np.random.default_rng(3).normal(size=points[:200:5].shape)
    evidence = KnownPoints(tracks(tumbling.times, points, 0.05), box)
    local = local_rates(evidence.times, evidence.seen())
    chosen = local.time[best_windows(local)]
    assert np.all(chosen > tumbling.times[200] - local.half)
    clean = KnownPoints(tracks(tumbling.times[200:], points[200:], 0.05), box)
    assert abs(local.noise - 1.0) < 0.5
    assert abs(local_rates(clean.times, clean.seen()).noise - 1.0) < 0.5
