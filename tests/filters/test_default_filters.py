"""With the keys that they have by default, filters are the Kalman filter on a linear model."""

import numpy as np
import pytest

from debrisest.catalog import CATALOG, kind_of
from debrisest.clock import Clock
from debrisest.filters.model import Model
from debrisest.roles import Given

EPOCHS, STEP_S = 12, 0.5
FILTERS = [part for part in CATALOG["filter"] if part.takes == "model"]
TRANSITION = np.kron([[1.0, STEP_S], [0.0, 1.0]], np.eye(2))
DRIVEN = np.kron(
    [[STEP_S**3 / 3, STEP_S**2 / 2], [STEP_S**2 / 2, STEP_S]], [[2.0, 0.5], [0.5, 1.0]]
)
NOISE = np.array([[0.4, 0.1], [0.1, 0.3]])


def conditioned(start: np.ndarray, prior: np.ndarray, measured: np.ndarray, k: int) -> tuple:
    """Mean and covariance of the state at epoch k, of the joint law of all that was measured."""
    powers = [np.linalg.matrix_power(TRANSITION, i) for i in range(k + 1)]
    law = np.zeros((k + 1, 4, k + 1, 4))
    for i in range(k + 1):
        for j in range(k + 1):
            law[i, :, j] = powers[i] @ prior @ powers[j].T
            for since in range(1, min(i, j) + 1):
                law[i, :, j] += powers[i - since] @ DRIVEN @ powers[j - since].T
    seen = law[:, :2, :, :2].reshape(2 * k + 2, -1) + np.kron(np.eye(k + 1), NOISE)
    cross = law[k][:, :, :2].reshape(4, -1)
    expected = np.stack([power @ start for power in powers])
    missed = (measured[: k + 1] - expected[:, :2]).ravel()
    gain = np.linalg.solve(seen, cross.T).T
    return expected[k] + gain @ missed, law[k, :, k] - gain @ cross.T


@pytest.mark.parametrize("part", FILTERS, ids=kind_of)
def test_a_body_that_is_pushed_at_random(part: type) -> None:
    """Position and velocity in a plane, driven by white accelerations: the noise is large."""
    rng = np.random.default_rng(4)
    measured, start = rng.normal(size=(3, EPOCHS, 2)), rng.normal(size=(3, 4))
    prior = np.diag([4.0, 3.0, 2.0, 1.0])
    model = Model(
        process=lambda x, k: x @ TRANSITION.T,
        measurement=lambda x, k: x[..., :2],
        process_noise=DRIVEN,
        measurement_noise=NOISE,
        error_names=("x", "y", "v_x", "v_y"),
    )
    clock = Clock.regular(EPOCHS * STEP_S, STEP_S)
    given = Given(start, np.stack([prior] * 3), measured, clock)
    found = part(kind=kind_of(part)).run(model, given)
    for run in range(3):
        for k in range(EPOCHS):
            mean, covariance = conditioned(start[run], prior, measured[run], k)
            np.testing.assert_allclose(found.state[run, k], mean, atol=1e-10)
            np.testing.assert_allclose(found.sigma[run, k] ** 2, np.diag(covariance), atol=1e-10)
