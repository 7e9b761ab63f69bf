"""Epochs that are equidistant, and epochs that are not."""

import numpy as np
import pytest

from debrisest.clock import Clock

UNEVEN = Clock(np.array([5.0, 6.0, 7.5, 8.0]))


def test_regular_epochs_are_multiples_of_the_step() -> None:
    clock = Clock.regular(0.9, 0.1)
    assert clock.times.tolist() == [k * 0.1 for k in range(9)]
    assert clock.step == 0.1
    assert clock.steps.tolist() == [0.1] * 8


def test_a_step_of_uneven_epochs_is_refused_in_a_sentence() -> None:
    assert UNEVEN.jitter == pytest.approx(0.5)
    with pytest.raises(ValueError, match=r"equal steps are needed.* up to 0\.5 steps .*resample"):
        _ = UNEVEN.step


def test_uneven_epochs_have_steps_of_their_own() -> None:
    assert UNEVEN.steps.tolist() == [1.0, 1.5, 0.5]


def test_rounding_is_no_jitter() -> None:
    clock = Clock(np.arange(2_000_000) * 0.1 + 1e-9 * np.sin(np.arange(2_000_000)))
    assert clock.step == pytest.approx(0.1)


def test_the_nearest_epoch_of_a_time() -> None:
    assert [UNEVEN.nearest(time) for time in (0.0, 6.1, 7.7, 99.0)] == [0, 1, 2, 3]
    assert [UNEVEN.reaches(time) for time in (5.0, 8.2, 8.3)] == [True, True, False]
