"""The target's track in local axes against differences in time."""

import numpy as np
import pytest

from debrisest.control.track import between


@pytest.mark.parametrize("axes", ["repaired", "printed"])
def test_velocities_are_those_in_turning_axes(track, axes) -> None:
    """The axes' turning makes a kilometre per second of the target's distance."""
    there = track(60, axes)
    differenced = 0.5 * (there.point_o[:, 2:] - there.point_o[:, :-2])
    np.testing.assert_allclose(there.velocity_o[:, 1:-1], differenced, atol=0.01)


def test_points_between_epochs_lie_on_the_curve(track) -> None:
    """Every tenth epoch given, those between are found, to the cubic's error of (h/2)^4 / 24."""
    fine = track(41)
    coarse = fine._replace(
        point_o=fine.point_o[:, ::10],
        velocity_o=fine.velocity_o[:, ::10],
        rate_o=fine.rate_o[:, ::10],
    )
    for epoch in range(4):
        found = between(coarse, epoch, 10.0, 10)
        expected = np.moveaxis(fine.point_o[:, 10 * epoch : 10 * epoch + 10], 1, 0)
        np.testing.assert_allclose(found, expected, atol=0.01)
