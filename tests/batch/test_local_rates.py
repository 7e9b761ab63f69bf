"""Windows with outliers are told by a larger covariance, so that no descent starts there."""

import numpy as np

from debrisest.attitude import quaternion
from debrisest.batch.evidence import Seen
from debrisest.batch.local_rates import _fits, local_rates
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


def test_windows_end_with_the_data_however_their_spacing_is_rounded() -> None:
    """Of 300 spans some have a last multiple of the spacing that rounding lifts above the end."""
    rng = np.random.default_rng(4)
    q, information = np.tile([1.0, 0.0, 0.0, 0.0], (30, 1)), np.tile(np.eye(3), (30, 1, 1))
    for start, length in rng.uniform(1.0, 1500.0, (300, 2)):
        times = np.linspace(start, start + length, 30)
        assert _fits(times, q, information, 0.0) is None


def test_windows_are_found_in_what_turns_into_view_as_often_as_they_are_spaced() -> None:
    """Sixty windows of 1200 s are 20 s apart: a grid meets each stretch at its first epoch."""
    times = np.arange(1.0, 1202.0)
    times = times[(times - 1.0) % 20.0 < 7.0]
    q = quaternion.exp(0.15 * times[:, None] * [0.0, 0.0, 1.0])
    local = local_rates(times, Seen(q, np.tile(np.eye(3), (len(times), 1, 1))))
    assert len(local.time) >= 12
    np.testing.assert_allclose(
        local.rate, np.tile([0.0, 0.0, 0.15], (len(local.time), 1)), atol=1e-9
    )
