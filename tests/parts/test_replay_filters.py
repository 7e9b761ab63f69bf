"""The bound as an estimator."""

import numpy as np
import pytest

from debrisest.clock import Clock
from debrisest.parts.filters.bound import Efficient
from debrisest.parts.filters.kalman import kept_epochs
from debrisest.roles import Given


def test_the_bound_needs_the_truth() -> None:
    given = Given(np.zeros((1, 2)), np.eye(2)[None], np.zeros((1, 3, 1)), Clock.regular(3.0, 1.0))
    with pytest.raises(ValueError, match="linearised at the truth"):
        Efficient(kind="efficient").run(None, given)


def test_kept_times_become_epochs_within_the_scenario() -> None:
    assert kept_epochs([50.0, 0.0, 1.0, 1.1], Clock.regular(10.0, 0.5)) == [0, 2]
