"""Rotation relative to the Hill frame: an inertial integrator, a constant of motion, differences.

The Hill frame turns at n about its third axis; a body on a circular orbit conserves
``H = w I w / 2 + 3/2 n^2 o I o - n c I w`` with o radial and c normal direction in body axes.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from debrisest.attitude import quaternion
from debrisest.dynamics import gravity_gradient, log_inertia, tumbling_in_orbit

N, STEP, RUNS = 1.078e-3, 5.0, 6


def starts(seed: int = 0, rate: float = 1.2) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    q = quaternion.normalize(rng.normal(size=(RUNS, 4)))
    direction = rng.normal(size=(RUNS, 3))
    w = np.radians(rate) * direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    return q, w, 0.3 * rng.normal(size=(RUNS, 5))


def propagated(q, w, s, epochs, step=STEP, mean_motion=N):
    shape = tumbling_in_orbit.body(s)
    for _ in range(epochs):
        q, w, _ = tumbling_in_orbit.step(q, w, shape, mean_motion, step)
    return q, w


def test_against_an_inertial_integrator_of_another_formula() -> None:
    q_hb, w, s = starts()
    times = STEP * np.arange(121)
    found = propagated(q_hb, w, s, 240, 0.5 * STEP)
    radius = (gravity_gradient.MU_EARTH / N**2) ** (1 / 3)
    for run in range(2):
        q_ib, rate = gravity_gradient.tumble(
            *(times, q_hb[run], w[run], log_inertia.inertia(s[run])),
            lambda t: radius * np.array([np.cos(N * t), np.sin(N * t), 0.0]),
        )
        half = N * times[-1] / 2
        q_ih = np.array([np.cos(half), 0.0, 0.0, np.sin(half)])
        back = quaternion.multiply(quaternion.conjugate(q_ih), q_ib[-1])
        assert quaternion.angle_between(found[0][run], back) < 1e-5
        np.testing.assert_allclose(found[1][run], rate[-1], atol=1e-7)


def energy(q, w, s, mean_motion):
    turn = quaternion.to_matrix(q)
    radial, normal = turn[..., 0, :], turn[..., 2, :]
    moment = log_inertia.inertia(s)

    def form(a, b):
        return (a[:, None] @ moment @ b[..., None])[:, 0, 0]

    return (
        0.5 * form(w, w)
        + 1.5 * mean_motion**2 * form(radial, radial)
        - mean_motion * form(normal, w)
    )


@pytest.mark.parametrize("mean_motion", [N, 20 * N])
def test_jacobi_integral_on_a_circular_orbit(mean_motion: float) -> None:
    q, w, s = starts(1, rate=0.5)
    before = energy(q, w, s, mean_motion)
    q, w = propagated(q, w, s, 400, 2.0, mean_motion)
    np.testing.assert_allclose(energy(q, w, s, mean_motion), before, rtol=1e-6)


def test_the_step_is_of_fourth_order() -> None:
    start = starts(2, rate=3.0)
    fine = propagated(*start, 64, 0.625)
    errors = [
        np.abs(propagated(*start, count, 40.0 / count)[1] - fine[1]).max() for count in (8, 16)
    ]
    assert 10.0 < errors[0] / errors[1] < 25.0


def derivative(_, state, s, mean_motion):
    """Equations of motion with the attitude as a matrix."""
    turn, w = state[:9].reshape(3, 3), state[9:]
    moment = log_inertia.inertia(s)
    radial, normal = turn[0], turn[2]
    relative = w - mean_motion * normal
    torque = 3 * mean_motion**2 * np.cross(radial, moment @ radial) - np.cross(w, moment @ w)
    spin = np.cross(relative, turn)  # rows of R: d/dt e^T R = e^T R [w x] = -w x (R^T e)
    return np.concatenate([-spin.ravel(), np.linalg.solve(moment, torque)])


def test_sensitivities_against_differences_of_an_adaptive_integrator() -> None:
    q, w, s = (values[:1] for values in starts(3))
    mean_motion = 10 * N
    shape = tumbling_in_orbit.body(s)
    stages = tumbling_in_orbit.step(q, w, shape, mean_motion, STEP)[2]
    found = tumbling_in_orbit.sensitivity(stages, shape, mean_motion, STEP)[0]

    def final(error):
        turned = quaternion.multiply(q[0], quaternion.exp(error[:3]))
        start = np.concatenate([quaternion.to_matrix(turned).ravel(), w[0] + error[3:6]])
        solution = solve_ivp(
            *(derivative, (0.0, STEP), start, "DOP853"),
            args=(s[0] + error[6:], mean_motion),
            rtol=1e-12,
            atol=1e-14,
        )
        return solution.y[:9, -1].reshape(3, 3), solution.y[9:, -1]

    for k, step in enumerate(1e-4 * np.eye(11)):
        (turn_up, up), (turn_down, down) = final(step), final(-step)
        turn = quaternion.log(quaternion.from_matrix(turn_down.T @ turn_up))
        numeric = np.concatenate([turn, up - down]) / 2e-4
        np.testing.assert_allclose(found[:, k], numeric, atol=2e-5 * np.abs(found).max())


def test_runs_do_not_depend_on_their_companions() -> None:
    q, w, s = starts(4)
    together = propagated(q, w, s, 10)
    alone = propagated(q[2:3], w[2:3], s[2:3], 10)
    np.testing.assert_allclose(together[0][2:3], alone[0], rtol=1e-14)
