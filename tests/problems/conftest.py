"""The stereo pose experiment, over a few seconds."""

import numpy as np
import pytest

from debrisest.filters.replay import replay
from debrisest.problems import stereo_pose_model as stereo_pose
from debrisest.problems.stereo_pose_replay import replay_model
from debrisest.problems.stereo_pose_truth import draw_guess, simulate_truth

ORBIT = (7.17e6, 0.05, 0.0)
POINTS = 5


class Experiment:
    """The paper's case C, or A with the angular acceleration, over a few seconds."""

    def __init__(self, runs, epochs, seed, slow=False, shown=None):
        rng = np.random.default_rng(seed)
        rate = (-0.1, -0.1, 0.034) if slow else (-1.0, -1.0, 0.934)
        start = np.zeros((runs, 15 + 3 * POINTS))
        start[:, :9] = [10, 60, 10, 0.01, -0.0225, -0.01, *np.radians(rate)]
        start[:, 9:15] = [0, 0, 0, 1, -0.186, -0.0797]
        start[:, 15:] = rng.uniform(-1.5, 1.5, (runs, 3 * POINTS))
        shown = shown or stereo_pose.Shown(acceleration=slow)
        self.known = stereo_pose.setup(epochs, 1.0, *ORBIT, points=POINTS, shown=shown)
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
        return replay(self.model, self.prior, self.covariance, self.measured, **options)


@pytest.fixture(scope="session")
def experiment():
    return Experiment
