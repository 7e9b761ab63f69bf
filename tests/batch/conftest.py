"""Tumbling bodies by numerical integration, and what cameras would see of them."""

from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

BOX = np.array(
    [
        *([1.2, 0.9, -2.0], [-1.0, 1.1, 2.2], [1.1, -1.2, 1.9], [-1.3, -0.8, -1.8]),
        *([0.2, 1.4, 0.3], [1.5, 0.1, 0.4], [-1.4, 0.2, -0.5], [0.1, -1.5, 0.6]),
    ]
)
NORMALS = np.array(
    [[1.0, 0, 0], [0, 1, 0], [0, -1, 0], [-1, 0, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0], [0, -1, 0]]
)


class Truth(NamedTuple):
    """Motion by integration of Euler's equations; rotations are scipy's."""

    times: np.ndarray
    attitude: Rotation
    rate: np.ndarray
    inertia: np.ndarray

    @property
    def q(self) -> np.ndarray:
        return self.attitude.as_quat(scalar_first=True)

    def points(self, rng: np.random.Generator, sigma: float, model: np.ndarray = BOX) -> np.ndarray:
        """Noisy points at a translation that differs from epoch to epoch, those in front only."""
        axes = self.attitude.as_matrix()
        turned = np.einsum("kij,cj->kci", axes, model)
        outward = np.einsum("kij,cj->kci", axes, NORMALS[: len(model)])
        seen = np.einsum("kci,i->kc", outward, np.array([0.6, -0.7, 0.4])) > -0.2
        moved = turned + 5.0 * rng.normal(size=(len(axes), 1, 3))
        return np.where(seen[..., None], moved + sigma * rng.normal(size=moved.shape), np.nan)

    def errors(self, motion, at_epoch: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Errors of attitude and rate over their sigmas, as chi-squares of three (time,).

        ``at_epoch``: the body axes are named by the attitude at the arc's epoch.
        """
        estimated = Rotation.from_quat(motion.path.q, scalar_first=True)
        axes = Rotation.identity()
        if at_epoch:
            k = int(np.argmin(np.abs(self.times - motion.arc.epoch)))
            assert self.times[k] == motion.arc.epoch
            axes = Rotation.from_quat(motion.arc.q, scalar_first=True).inv() * self.attitude[k]
        turn = (estimated * axes * self.attitude.inv()).as_rotvec()
        rate = motion.path.rate - axes.apply(self.rate)
        return (
            normalised(turn, motion.path.turn_covariance),
            normalised(rate, motion.path.rate_covariance),
        )


def normalised(error: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    floor = 1e-9 * np.trace(covariance, axis1=1, axis2=2)[:, None, None] + 1e-18
    solved = np.linalg.solve(covariance + floor * np.eye(3), error[..., None])[..., 0]
    return np.sum(solved * error, axis=-1)


def integrated(times, rate0, inertia, torque=lambda t: np.zeros(3), start=None) -> Truth:
    """A body by DOP853, from ``rate0`` in deg/s at the first time, in axes of any direction."""
    inertia = np.asarray(inertia, dtype=float)
    inertia = np.diag(inertia) if inertia.ndim == 1 else inertia
    inverse = np.linalg.inv(inertia)
    begin = (start or Rotation.from_rotvec([0.3, -0.2, 0.5])).as_quat(scalar_first=True)

    def derivative(t: float, state: np.ndarray) -> np.ndarray:
        q, w = state[:4], state[4:]
        q_dot = 0.5 * np.concatenate([[-q[1:] @ w], q[0] * w + np.cross(q[1:], w)])
        return np.concatenate([q_dot, inverse @ (torque(t) - np.cross(w, inertia @ w))])

    solution = solve_ivp(
        derivative,
        (times[0], times[-1]),
        np.concatenate([begin, np.radians(rate0)]),
        "DOP853",
        t_eval=times,
        rtol=1e-10,
        atol=1e-12,
    )
    attitude = Rotation.from_quat(solution.y[:4].T, scalar_first=True)
    return Truth(times, attitude, solution.y[4:].T, inertia)


SKEW = Rotation.from_rotvec([0.4, 0.7, -0.3]).as_matrix()
GENERAL = SKEW @ np.diag([1.0, 0.8, 0.55]) @ SKEW.T


@pytest.fixture(scope="session")
def tumbling() -> Truth:
    """A general body over 400 s, epochs that are not evenly spaced."""
    rng = np.random.default_rng(5)
    times = np.sort(rng.choice(np.arange(0.0, 480.0), 401, replace=False))
    return integrated(times, [4.0, -3.0, 5.0], GENERAL)


@pytest.fixture(scope="session")
def body_of():
    return integrated


@pytest.fixture(scope="session")
def box() -> np.ndarray:
    return BOX
