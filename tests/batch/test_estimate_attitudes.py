"""Motion from attitudes and from rates."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.batch.estimate import estimate_from_attitudes, estimate_from_rates
from debrisest.batch.motion import Judged, Status
from debrisest.batch.observability import inertia_directions
from debrisest.dynamics import log_inertia

FIVE_SIGMA = 31.8


def noisy(truth, rng, sigma):
    turns = Rotation.from_rotvec(sigma * rng.normal(size=(len(truth.times), 3)))
    return (turns * truth.attitude).as_quat(scalar_first=True)


def inertia_square(truth, motion, axes=None) -> float:
    axes = np.eye(3) if axes is None else axes
    true = log_inertia.log_ratios(axes @ truth.inertia @ axes.T)
    error = motion.arc.log_inertia - true
    return float(error @ np.linalg.solve(motion.covariance[6:, 6:], error))


@pytest.mark.parametrize("given", ["sigma", "covariance", None])
def test_attitudes(tumbling, given) -> None:
    rng = np.random.default_rng(1)
    sigma = np.radians(2.0)
    q = noisy(tumbling, rng, sigma) * rng.choice([-1.0, 1.0], (len(tumbling.times), 1))
    q[rng.uniform(size=len(q)) < 0.1] = np.nan
    spread = {"sigma": sigma, "covariance": np.tile(sigma**2 * np.eye(3), (len(q), 1, 1))}
    motion = estimate_from_attitudes(tumbling.times, q, spread.get(given))
    assert motion.status is Status.ACCEPTED
    assert motion.judged is (Judged.CHI_SQUARE_AND_BLOCKS if given else Judged.NOISE_UNKNOWN)
    for square in tumbling.errors(motion):
        assert np.all(square < FIVE_SIGMA)
    assert inertia_square(tumbling, motion) < 5 + 5 * np.sqrt(10.0)
    if given is None:
        assert motion.noise == pytest.approx(sigma, rel=0.15)


def test_wild_attitudes_are_left_out(tumbling) -> None:
    rng = np.random.default_rng(2)
    q = noisy(tumbling, rng, 0.03)
    wild = rng.uniform(size=len(q)) < 0.1
    q[wild] = Rotation.random(int(wild.sum()), rng=rng).as_quat(scalar_first=True)
    motion = estimate_from_attitudes(tumbling.times, q, 0.03)
    assert motion.status is Status.ACCEPTED
    assert np.mean(motion.used[wild]) < 0.05
    assert np.mean(motion.used[~wild]) > 0.99
    for square in tumbling.errors(motion):
        assert np.all(square < FIVE_SIGMA)


def test_rates_show_the_inertia(tumbling) -> None:
    """The body axes of a gyro are its own: rate and inertia are compared without any turn."""
    rng = np.random.default_rng(3)
    sigma = np.radians(0.1)
    rate = tumbling.rate + sigma * rng.normal(size=tumbling.rate.shape)
    motion = estimate_from_rates(tumbling.times, rate, sigma)
    assert motion.status is Status.ACCEPTED
    error = motion.path.rate - tumbling.rate
    assert np.all(np.abs(error) < 5.0 * motion.path.rate_sigma)
    assert inertia_square(tumbling, motion) < 5 + 5 * np.sqrt(10.0)


def test_rates_of_a_pushed_body_claim_no_inertia(body_of) -> None:
    times = np.arange(0.0, 200.0)
    truth = body_of(times, [4.0, -3.0, 5.0], [1.0, 0.8, 0.5], lambda t: np.array([4e-4, 0, -3e-4]))
    rng = np.random.default_rng(4)
    sigma = np.radians(0.05)
    rate = truth.rate + sigma * rng.normal(size=truth.rate.shape)
    motion = estimate_from_rates(times, rate, sigma)
    assert motion.status is Status.NOT_TORQUE_FREE
    inside = np.abs(motion.path.rate - truth.rate) < 3.0 * motion.path.rate_sigma
    assert np.mean(inside) > 0.95


def test_a_slow_slope_below_the_noise_is_not_torque_free(tumbling) -> None:
    """A slow error of at most a sigma hardly raises the chi-square, but it lasts."""
    rng = np.random.default_rng(5)
    sigma = 0.05
    slow = sigma * np.sin(2.0 * np.pi * tumbling.times / 70.0)
    turns = Rotation.from_rotvec(
        sigma * rng.normal(size=(len(slow), 3)) + slow[:, None] * [0.6, 0.0, 0.8]
    )
    q = (turns * tumbling.attitude).as_quat(scalar_first=True)
    motion = estimate_from_attitudes(tumbling.times, q, sigma)
    assert motion.status is Status.NOT_TORQUE_FREE
    assert motion.fit.noise_below
    assert not motion.fit.steady


def test_sigma_of_the_inertia_follows_the_noise(tumbling) -> None:
    sigmas = []
    for sigma in (0.0005, 0.002):
        q = noisy(tumbling, np.random.default_rng(6), sigma)
        motion = estimate_from_attitudes(tumbling.times, q, sigma)
        sigmas.append(inertia_directions(motion.covariance)[0])
    np.testing.assert_allclose(sigmas[1] / sigmas[0], 4.0, rtol=0.1)
