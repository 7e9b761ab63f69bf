"""What F and D of the control law bound, by hand-made errors; unlike bodies side by side."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from debrisest.arrays import Array
from debrisest.control.model_error import drift_mismatch, gain_mismatch, state_function
from debrisest.control.rigid_spacecraft import scaled, spacecraft

RNG = np.random.default_rng(5)
ANGLES, RATES = 0.5 * RNG.normal(size=(2, 30, 3))


def test_rates_of_105_percent_make_the_printed_f(inertia: Array) -> None:
    """The state function is quadratic in the rates: 1.05^2 is 1 + 0.1025."""
    craft = spacecraft(inertia)
    error, modelled = drift_mismatch(craft, craft, (ANGLES, RATES), (ANGLES, 1.05 * RATES))
    np.testing.assert_allclose(error, (1 / 1.1025 - 1) * modelled, atol=1e-12)


def test_the_state_function_is_the_second_derivative_of_the_angles(inertia: Array) -> None:
    craft, step = spacecraft(inertia), 1e-4
    still = np.zeros_like(RATES)
    ahead, _ = craft.move(ANGLES, RATES, still, still, step)
    behind, _ = craft.move(ANGLES, RATES, still, still, -step)
    numeric = (ahead - 2 * ANGLES + behind) / step**2
    np.testing.assert_allclose(state_function(craft, ANGLES, RATES), numeric, atol=1e-6)


def test_gains_of_a_known_plant(inertia: Array) -> None:
    """Heavier by a quarter and pushed by 0.9 of the torque: 0.9 / 1.25 - 1 in every axis."""
    craft = spacecraft(inertia)
    right = gain_mismatch(craft, craft, 1.0, ANGLES, ANGLES)
    np.testing.assert_allclose(right, 0.0, atol=1e-12)
    wrong = gain_mismatch(craft, spacecraft(1.25 * inertia), 0.9, ANGLES, ANGLES)
    np.testing.assert_allclose(wrong, 0.28, atol=1e-12)


@given(st.lists(st.floats(-3, 3), min_size=3, max_size=3))
def test_scaled_masses_are_those_of_a_body(logs: list[float]) -> None:
    moments = np.array([3.0, 4.0, 5.0])
    body = scaled(np.diag(moments), np.exp(np.array(logs)))
    spacecraft(body)
    second = np.exp(logs) * (moments.sum() / 2 - moments)
    np.testing.assert_allclose(np.diag(body), second.sum() - second, rtol=1e-12)


def test_bodies_side_by_side_move_as_each_by_itself(inertia: Array) -> None:
    bodies = scaled(np.array([inertia, 2 * inertia]), np.array([[1.0, 1.3, 0.8], [0.7, 1.0, 1.1]]))
    angles, rates = ANGLES[:2], RATES[:2]
    torque, still = 1e-3 * RNG.normal(size=(2, 3)), np.zeros((2, 3))
    together = spacecraft(bodies).move(angles, rates, torque, still, 0.02)
    for k, body in enumerate(bodies):
        one = slice(k, k + 1)
        alone = spacecraft(body).move(angles[one], rates[one], torque[one], still[one], 0.02)
        np.testing.assert_allclose([x[k] for x in together], np.concatenate(alone), atol=1e-14)
    with pytest.raises(ValueError, match="no body"):
        spacecraft(np.array([inertia, np.diag([1.0, 1.0, 3.0])]))
