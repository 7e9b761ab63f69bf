"""The stereo pose experiment, over a few seconds, and a tumbling body by integration."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from debrisest.clock import Clock
from debrisest.filters.replay.replay import replay
from debrisest.problems.stereo_pose import model as stereo_pose
from debrisest.problems.stereo_pose.replay import replay_model
from debrisest.problems.stereo_pose.truth import draw_guess, simulate_truth
from debrisest.problems.tumbling import points_motion as body
from debrisest.problems.tumbling.points_inertia import log_tensor

ORBIT = (7.17e6, 0.05, 0.0)
POINTS = 5


class Experiment:
    """The paper's case C, or A with the angular acceleration, over a few seconds."""

    def __init__(self, runs, epochs, seed, slow=False, shown=None, q_lc=(1, 0, 0, 0), rate=None):
        rng = np.random.default_rng(seed)
        rate = rate or ((-0.1, -0.1, 0.034) if slow else (-1.0, -1.0, 0.934))
        start = np.zeros((runs, 15 + 3 * POINTS))
        start[:, :9] = [10, 60, 10, 0.01, -0.0225, -0.01, *np.radians(rate)]
        # The cameras, and the target before them, are turned.
        turn = Rotation.from_quat(q_lc, scalar_first=True)
        start[:, :3] = turn.apply(start[:, :3])
        start[:, 9:15] = [0, 0, 0, 1, -0.186, -0.0797]
        start[:, 15:] = rng.uniform(-1.5, 1.5, (runs, 3 * POINTS))
        shown = shown or stereo_pose.Shown(acceleration=slow)
        self.known = stereo_pose.stereo_geometry(
            Clock.regular(epochs, 1.0),
            *ORBIT,
            points=POINTS,
            shown=shown,
            to_camera=None if q_lc[0] == 1 else turn.inv().as_matrix(),
        )
        self.truth = simulate_truth(np.arange(float(epochs)), start, *ORBIT)
        variance = np.repeat([1.0, np.radians(1) ** 2, 1e-5, 0.5, 1.0], [6, 3, 4, 2, 3 * POINTS])
        self.prior = draw_guess(start, variance, rng.normal(size=start.shape))
        plain = np.concatenate([variance[:9], np.full(3, 4e-5), variance[13:]])
        exact = np.stack(
            [stereo_pose.measurement(self.known, self.truth[:, k], k) for k in range(epochs)], 1
        )
        sigma = np.full(exact.shape[-1], 1e-5)
        if shown.acceleration:
            sigma[-3:] = np.radians(1e-4)
        self.exact, self.measured = exact, exact + sigma * rng.normal(size=exact.shape)
        self.measured[:, 0] = np.nan
        self.covariance = np.tile(np.diag(plain), (runs, 1, 1))
        self.model = replay_model(self.known, sigma, np.sqrt(plain))

    def estimate(self, **options):
        return self.estimate_of(self.measured, **options)

    def estimate_of(self, measured, **options):
        return replay(self.model, self.prior, self.covariance, measured, **options)


@pytest.fixture(scope="session")
def experiment():
    return Experiment


def _integrated(states, times):
    """Attitudes (run, time, 3, 3) and rates (run, time, 3) by integrating ``R' = R [w]``."""
    inertia = np.array([expm(log_tensor(state[body.LOG_INERTIA])) for state in states])
    inverse, runs = np.linalg.inv(inertia), len(states)

    def change(_, x):
        turn, w = x[: 9 * runs].reshape(runs, 3, 3), x[9 * runs :].reshape(runs, 3)
        momentum = (inertia @ w[..., None])[..., 0]
        faster = inverse @ np.cross(momentum, w)[..., None]
        return np.concatenate([np.cross(turn, w[:, None]).ravel(), faster.ravel()])

    first = Rotation.from_quat(states[:, body.Q], scalar_first=True).as_matrix()
    start = np.concatenate([first.ravel(), states[:, body.RATE].ravel()])
    found = solve_ivp(change, times[[0, -1]], start, "DOP853", times, rtol=1e-11, atol=1e-13)
    matrix, rate = np.split(found.y.T, [9 * runs], axis=1)
    return (
        np.moveaxis(matrix.reshape(-1, runs, 3, 3), 1, 0),
        np.moveaxis(rate.reshape(-1, runs, 3), 1, 0),
    )


def _nudged(state, index, step):
    """One state with one of the eleven errors, as their names say."""
    moved = state.copy()
    if index < 3:
        turn = Rotation.from_rotvec(step * np.eye(3)[index])
        moved[:4] = (turn * Rotation.from_quat(state[:4], scalar_first=True)).as_quat(
            scalar_first=True
        )
    else:
        moved[index + 1] += step
    return moved


@pytest.fixture(scope="session")
def integrated():
    return _integrated


@pytest.fixture(scope="session")
def nudged():
    return _nudged
