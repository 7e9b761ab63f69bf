"""Covariances of a path, where errors are large, against drawn errors."""

import numpy as np

from debrisest.attitude import quaternion
from debrisest.batch.arc import Arc, along, course, displaced
from debrisest.batch.path import path_of


def test_no_direction_is_surer_than_drawn_errors_are() -> None:
    """The size of the rate is known to 1e-4, its direction to a tenth: errors lie on a sphere.

    What two axes of the covariance do together is left out, so that a sigma may be half of what it
    should be; the linear one is a thirtieth.
    """
    rng = np.random.default_rng(1)
    arc = Arc(0.0, np.array([1.0, 0, 0, 0]), np.array([0.0, 0.02, 0.1]), 0.2 * rng.normal(size=5))
    sigma = np.array([0.02] * 3 + [0.01, 0.01, 1e-5] + [1e-3] * 5)
    times = np.array([0.0, 20.0, 60.0])
    path = path_of(arc, np.diag(sigma**2), times)
    q, rate = along(displaced(arc, sigma * rng.normal(size=(4000, 11))), times)
    off = rate - path.rate
    turn = quaternion.log(quaternion.multiply(q, quaternion.conjugate(path.q)))
    shares = [
        largest_share(errors[:, k], spread[k])
        for errors, spread in ((turn, path.turn_covariance), (off, path.rate_covariance))
        for k in range(len(times))
    ]
    motion = course(arc, times)
    linear = motion.rate_by @ np.diag(sigma**2) @ np.swapaxes(motion.rate_by, -1, -2)
    assert max(shares) < 2.5
    assert largest_share(off[:, 2], linear[2]) > 10.0


def largest_share(errors, spread) -> float:
    """How many sigma a drawn error's root mean square is, in the direction where it is most."""
    root = np.linalg.inv(np.linalg.cholesky(spread))
    drawn = root @ (errors.T @ errors / len(errors)) @ root.T
    return float(np.sqrt(np.linalg.eigvalsh(drawn)[-1]))
