"""States whose errors live in another space."""

import numpy as np
import pytest

from debrisest.filters.kalman.unscented import UnscentedParameters, unscented
from tests.filters.circle import ANGLE, CIRCLE, either_sign, on_circle, projecting, turning


@pytest.mark.parametrize("redraw", [False, True])
@pytest.mark.parametrize("spread", [UnscentedParameters(), UnscentedParameters(0.5, 2.0, 1.0)])
def test_circle_equals_angle(spread, redraw):
    rate, start, covariance, y = turning()
    flat = unscented(ANGLE, start, covariance, y, spread, redraw=redraw)
    curved = unscented(CIRCLE, on_circle(start), covariance, y, spread, redraw=redraw)
    np.testing.assert_allclose(curved.state, on_circle(flat.state), atol=1e-11)
    np.testing.assert_allclose(curved.sigma, flat.sigma, rtol=1e-10)
    np.testing.assert_allclose(curved.covariance, flat.covariance, atol=1e-12)
    np.testing.assert_allclose(curved.nis, flat.nis, rtol=1e-9, atol=1e-11)
    assert np.abs(flat.state[:, -1, 1] - rate).max() < 0.1


def test_a_retraction_may_project_the_corrected_state():
    model, drawn, given = projecting()
    history = unscented(model, *given)
    np.testing.assert_allclose(np.linalg.norm(history.state, axis=-1), 1.0, rtol=1e-14)
    assert np.abs(np.concatenate(drawn) - 1.0).max() > 0.01


def test_ambiguous_sign_is_left_to_the_model():
    """A measurement known up to its sign, as that of a quaternion, read either way."""
    free, start, y, flipped = either_sign()
    plain = unscented(free._replace(innovation=CIRCLE.innovation), *start, y)
    assert np.array_equal(plain.state, unscented(free, *start, flipped).state)
