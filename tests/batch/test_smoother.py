"""The smoother against dense least squares, and on rotations that obey no law."""

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation

from debrisest.batch.attitudes import Attitudes
from debrisest.batch.local_rates import local_rates
from debrisest.batch.smoother import Wander, smooth, wander

SIGMA = 0.01


def swinging(count=150, seed=0):
    """A rotation whose axis and speed change, and its noisy attitudes."""
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.05, 0.15, count))
    angle = lambda t: np.stack(  # noqa: E731
        [0.8 * np.sin(1.1 * t), 0.5 * np.cos(0.7 * t), 0.6 * np.sin(0.4 * t + 1.0)], axis=-1
    )
    attitude = Rotation.from_euler("zyx", angle(times))
    small = 1e-5
    ahead, back = (Rotation.from_euler("zyx", angle(times + s)) for s in (small, -small))
    rate = (back.inv() * ahead).as_rotvec() / (2.0 * small)
    measured = Rotation.from_rotvec(SIGMA * rng.normal(size=(count, 3))) * attitude
    return times, attitude, rate, measured.as_quat(scalar_first=True)


def evidence_of(times, q):
    return Attitudes(times, q, np.tile(np.eye(3) / SIGMA**2, (len(times), 1, 1)))


@pytest.mark.parametrize("order", [2, 3])
def test_small_turns_are_those_of_dense_least_squares(order) -> None:
    """About one axis and for small angles the problem is linear: solve it with all unknowns."""
    rng = np.random.default_rng(1)
    times = np.linspace(0.0, 2.0, 12) + 0.05 * rng.uniform(size=12)
    angles = 1e-4 * rng.normal(size=12)
    q = Rotation.from_rotvec(np.outer(angles, [0, 0, 1.0])).as_quat(scalar_first=True)
    evidence = evidence_of(times, q)
    local = local_rates(times, evidence.seen())
    intensity = 1e-3
    path = smooth(evidence, local, Wander(order, intensity, 1.0), times)
    rows, noise, right = [], [], []
    size = order * len(times)
    for k in range(len(times)):
        row = np.zeros((1, size))
        row[0, order * k] = 1.0
        rows.append(row), noise.append([[SIGMA**2]]), right.append([angles[k]])
    prior = np.zeros((order, size))
    prior[:, :order] = np.eye(order)
    speed2 = np.max(np.sum(local.rate**2, axis=-1)) + np.trace(
        local.covariance[np.argmin(np.abs(local.time - times[0]))]
    )
    nearest = local.rate[np.argmin(np.abs(local.time - times[0]))]
    rows.append(prior)
    noise.append(np.diag([1.0, speed2, speed2 / local.half**2][:order]))
    right.append([angles[0], nearest[2], 0.0][:order])
    for k, step in enumerate(np.diff(times)):
        row = np.zeros((order, size))
        powers = {2: [[1, step], [0, 1]], 3: [[1, step, step**2 / 2], [0, 1, step], [0, 0, 1]]}
        row[:, order * k : order * (k + 1)] = -np.array(powers[order])
        row[:, order * (k + 1) : order * (k + 2)] = np.eye(order)
        fine = np.linspace(0.0, step, 2001)
        middle = 0.5 * (fine[1:] + fine[:-1])
        fed = np.stack([middle**2 / 2.0, middle, np.ones(2000)][3 - order :])
        rows.append(row)
        noise.append(intensity * (fed @ fed.T) * (fine[1] - fine[0]))
        right.append(np.zeros(order))
    design, weight = np.vstack(rows), np.linalg.inv(block_diag(*noise))
    covariance = np.linalg.inv(design.T @ weight @ design)
    solution = covariance @ design.T @ weight @ np.concatenate(right)
    turn = Rotation.from_quat(path.q, scalar_first=True).as_rotvec()[:, 2]
    np.testing.assert_allclose(turn, solution[::order], atol=1e-8)
    np.testing.assert_allclose(path.rate[:, 2], solution[1::order], atol=1e-6)
    sigma = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(path.turn_sigma[:, 2], sigma[::order], rtol=1e-3)
    np.testing.assert_allclose(path.rate_sigma[:, 2], sigma[1::order], rtol=1e-3)


def test_swinging_is_followed_within_its_sigmas() -> None:
    times, attitude, rate, q = swinging()
    evidence = evidence_of(times, q)
    local = local_rates(times, evidence.seen())
    found = wander(evidence, local)
    path = smooth(evidence, local, found, times)
    turn = (Rotation.from_quat(path.q, scalar_first=True) * attitude.inv()).as_rotvec()
    assert np.mean(np.abs(turn) < 3.0 * path.turn_sigma) > 0.97
    assert np.mean(np.abs(path.rate - rate) < 3.0 * path.rate_sigma) > 0.95
    raw = (Rotation.from_quat(q, scalar_first=True) * attitude.inv()).as_rotvec()
    assert np.sum(turn**2) < 0.5 * np.sum(raw**2)
    assert found.noise == pytest.approx(1.0, abs=0.15)


def test_times_without_measurements_have_larger_sigmas() -> None:
    times, _, _, q = swinging()
    hidden = (times > 6.0) & (times < 8.0)
    evidence = evidence_of(times[~hidden], q[~hidden])
    local = local_rates(evidence.times, evidence.seen())
    path = smooth(evidence, local, Wander(2, 0.1, 1.0), times)
    sigma = path.turn_sigma.max(axis=1)
    assert sigma[hidden].max() > 3.0 * np.median(sigma[~hidden])
    assert np.array_equal(path.times, times)
