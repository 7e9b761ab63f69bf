"""The costs by which simulations judge a batch."""

import numpy as np

from debrisest.filters.landmarks.against_truth import costs
from debrisest.filters.landmarks.batch_start import Batch, batch_problem
from debrisest.filters.landmarks.growing_windows import Window
from debrisest.filters.landmarks.whole_arc import whole_arc

WINDOWS = [Window(10, 1), Window(20, 1), Window(40, 1), Window(70, 2), Window(100, 1)]
SEEN_ONCE = 10


def test_a_point_that_the_estimate_does_not_tell_does_not_count(experiment) -> None:
    """It was seen once, and another was taken for it: no other frame says where it is."""
    case = experiment(2, 101, 8)
    seen, shown = case.observed.seen.copy(), case.observed.shown.copy()
    seen[:, :, SEEN_ONCE] = False
    seen[:, 45, SEEN_ONCE], shown[:, 45, SEEN_ONCE] = True, shown[:, 45, 0] + 90.0
    observed = case.observed._replace(seen=seen, shown=shown)
    settings = Batch(windows=WINDOWS, robust=True)
    task = batch_problem(case.model, observed, case.parameters, case.covariance, settings)
    with np.errstate(all="ignore"):
        arc = whole_arc(task, [100])
        own, true, numbers = costs(task, arc, case.core[:, 0], case.points)
    assert not arc.anchors[-1].present[:, SEEN_ONCE].any()
    errors = case.covariance.shape[-1] - 3 * len(case.points[0]) + 3 * SEEN_ONCE
    np.testing.assert_array_equal(numbers, errors)
    assert (np.abs((true - own) / numbers - 1) < 5 * np.sqrt(2 / numbers)).all()
