"""Covariances of a path, where errors are large, against drawn errors."""

import numpy as np

from debrisest.batch.arc import Arc, along, course, displaced
from debrisest.batch.path import path_of
from debrisest.batch.spread import straight


def test_second_order_is_much_nearer_to_drawn_errors_than_the_linear_covariance() -> None:
    """The size of the rate is known to 1e-4, its direction to a tenth: errors lie on a sphere.

    What two axes of the covariance do together is left out, so that a sigma may still be too small
    (docs/batch.md, known weaknesses): this holds the gain, not that the sigma is right.
    """
    rng = np.random.default_rng(1)
    arc = Arc(0.0, np.array([1.0, 0, 0, 0]), np.array([0.0, 0.02, 0.1]), 0.2 * rng.normal(size=5))
    sigma = np.array([0.02] * 3 + [0.01, 0.01, 1e-5] + [1e-3] * 5)
    times = np.array([0.0, 20.0, 60.0])
    path = path_of(arc, straight(arc, np.diag(sigma**2)), times)
    _, rate = along(displaced(arc, sigma * rng.normal(size=(4000, 11))), times)
    off = rate - path.rate
    motion = course(arc, times)
    linear = motion.rate_by @ np.diag(sigma**2) @ np.swapaxes(motion.rate_by, -1, -2)
    second = largest_share(off[:, -1], path.rate_covariance[-1])
    assert second < 0.25 * largest_share(off[:, -1], linear[-1])


def largest_share(errors, spread) -> float:
    """How many sigma a drawn error's root mean square is, in the direction where it is most."""
    root = np.linalg.inv(np.linalg.cholesky(spread))
    drawn = root @ (errors.T @ errors / len(errors)) @ root.T
    return float(np.sqrt(np.linalg.eigvalsh(drawn)[-1]))


def test_attitude_rate_and_inertia_are_covered_together() -> None:
    """Rates in principal axes follow from rate and inertia, whose errors nearly cancel.

    Of a straight spread the joint covariance is that of the linear motion, not block by block.
    """
    rng = np.random.default_rng(2)
    arc = Arc(0.0, np.array([1.0, 0, 0, 0]), np.array([0.05, 0.02, 0.1]), 0.3 * rng.normal(size=5))
    root = 1e-7 * rng.normal(size=(11, 11))
    times = np.array([0.0, 60.0])
    path = path_of(arc, straight(arc, root @ root.T), times)
    motion = course(arc, times)
    by = np.broadcast_to(np.eye(11), (2, 11, 11)).copy()
    by[:, :3], by[:, 3:6] = motion.turn_by, motion.rate_by
    linear = by @ root @ root.T @ np.swapaxes(by, -1, -2)
    whitened = np.linalg.solve(np.linalg.cholesky(linear), np.linalg.cholesky(path.joint))
    np.testing.assert_allclose(np.linalg.svd(whitened, compute_uv=False), 1.0, atol=0.1)
