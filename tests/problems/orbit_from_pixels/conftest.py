"""The debris of Li et al. before two cameras."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics import kepler, perturbed_orbit
from debrisest.parts.sensors.attitude_knowledge import AttitudeKnowledge
from debrisest.parts.sensors.detections import Detections
from debrisest.parts.starts.drawn_orbit import DrawnOrbit
from debrisest.parts.starts.guess import Guess
from debrisest.problems.orbit_from_pixels.problem import OrbitFromPixels


class TwoObservers:
    """The debris of Li et al. before two cameras: estimation, a turn from 25 to 66 s, estimation.

    The cameras turn steadily to the attitudes that the closed loop ends with; their frames are
    written out as a chain of direction cosines.
    """

    CLOCK = Clock.regular(470.0, 1.0)
    ENDS = np.radians([[5.4, -0.9, 21.8], [5.8, -1.7, 36.5]])

    def __init__(self, runs, seed=1, noise=0.0, bias_mrad=0.0, **points):
        deg, times = np.radians, self.CLOCK.times
        draws = Draws(seed, "case", list(range(runs)))
        self.rng = np.random.default_rng(seed)
        debris = kepler.state_from_elements(7.493e6, 0.1, deg(20), deg(35), deg(70), deg(8))
        extra = noise * self.rng.normal(size=(runs, len(times) - 1, 3))
        own = kepler.state_from_elements(7.5e6, 0.1, deg(30), deg([10.0, 7.0]), deg(90), deg(8))
        position = np.swapaxes(kepler.propagate(*own, times)[0], 0, 1)
        orbit = perturbed_orbit.propagate(*debris, times, 0.0, extra)
        self.matrix = self.to_camera(times)
        q_ic = Rotation.from_matrix(np.swapaxes(self.matrix, -1, -2).reshape(-1, 3, 3)).as_quat(
            scalar_first=True
        )
        away = orbit[0][:, :, None] - position
        point = (self.matrix @ away[..., None])[..., 0]
        pixel = 335.0 * point[..., :2] / point[..., 2:]
        seen = (point[..., 2] > 0) & (np.abs(pixel) <= [240, 180]).all(-1)
        section = np.select([times < 25, times < 66], [0.0, 1.0], 2.0)
        self.data = {
            "time_s": times,
            "orbit_position": orbit[0],
            "orbit_velocity": orbit[1],
            "observer_position": np.stack([position] * runs),
            "true_q_ic": np.stack([q_ic.reshape(len(times), 2, 4)] * runs),
            "focal_px": np.full(runs, 335.0),
            "image_half_size": np.tile([240.0, 180.0], (runs, 1)),
            "section": np.tile(section, (runs, 1)),
            "true_pixel": np.where(seen[..., None], pixel, np.nan),
        }
        points = points or {"clutter": {"count": 2, "half_width_px": 10.0}}
        for part in (
            AttitudeKnowledge(kind="attitude_knowledge", bias_mrad=bias_mrad),
            Detections(kind="detections", **points),
            DrawnOrbit(kind="drawn_orbit", position_sigma_m=100.0, velocity_sigma_m_s=100.0),
        ):
            self.data |= part.simulate(self.data, self.CLOCK, draws)

    @classmethod
    def to_camera(cls, times):
        """R2 C1(phi) C2(theta) C3(psi) PERM C3(nu + w) C1(i) C3(node), (time, 2, 3, 3)."""
        share = np.clip((times - 25) / 30, 0, 1)
        mean_motion = np.sqrt(kepler.MU_EARTH / 7.5e6**3)
        start = 2 * np.arctan(np.sqrt(0.9 / 1.1) * np.tan(np.radians(4.0)))
        mean, e = start - 0.1 * np.sin(start) + mean_motion * times, 0.1
        eccentric = mean + 0.1
        for _ in range(30):
            eccentric = mean + e * np.sin(eccentric)
        anomaly = 2 * np.arctan(np.sqrt(1.1 / 0.9) * np.tan(eccentric / 2))
        camera = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
        relabel = np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]])
        found = np.empty((len(times), 2, 3, 3))
        for k, (part, nu) in enumerate(zip(share, anomaly)):
            for s, node in enumerate(np.radians([10.0, 7.0])):
                phi, theta, psi = part * cls.ENDS[s]
                orbit = turn(3, nu + np.pi / 2) @ turn(1, np.radians(30)) @ turn(3, node)
                found[k, s] = (
                    camera @ turn(1, phi) @ turn(2, theta) @ turn(3, psi) @ relabel @ orbit
                )
        return found

    def problem(self, **keys):
        given = {"kind": "orbit_from_pixels", "acceleration_noise_m_s2": 0.1}
        return OrbitFromPixels(**given | keys)

    def given(self, problem):
        """Model, first guess, covariance, detections."""
        guess = Guess(kind="guess").start(self.data, self.CLOCK)
        model = problem.model(self.data, self.CLOCK)
        return model, *problem.pack(*guess), problem.measurements(self.data)

    def errors(self, history):
        """Distance from the truth (run, time), m."""
        away = history.state[..., :3] - self.data["orbit_position"]
        return np.linalg.norm(away, axis=-1)

    def nees(self, history, at):
        """Per dimension, of the orbit, at one of the kept epochs."""
        truth = np.concatenate([self.data["orbit_position"], self.data["orbit_velocity"]], -1)
        error = (history.state[..., :6] - truth)[:, at]
        covariance = history.covariance[:, list(history.kept).index(at), :6, :6]
        scale = np.sqrt(np.diagonal(covariance, 0, -2, -1))
        scaled = covariance / scale[:, :, None] / scale[:, None]
        white = np.linalg.solve(scaled, (error / scale)[..., None])[..., 0]
        return (error / scale * white).sum(-1) / 6


def turn(axis, angle):
    """Direction cosine matrix C_axis(angle): components in axes turned by the angle."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = {1: (1, 2), 2: (2, 0), 3: (0, 1)}[axis]
    result = np.eye(3)
    result[[i, i, j, j], [i, j, i, j]] = [c, s, -s, c]
    return result


@pytest.fixture(scope="session")
def two_observers() -> Callable[..., TwoObservers]:
    """Make the experiment of two observers; the same one is made once."""

    @cache
    def make(runs, seed=1, noise=0.0, bias_mrad=0.0, companions_km=0.0):
        points = {"companions": {"count": 2, "spread_km": companions_km}} if companions_km else {}
        return TwoObservers(runs, seed, noise, bias_mrad, **points)

    return make
