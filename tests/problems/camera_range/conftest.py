"""A tumbling box, filmed and ranged for some minutes; its truth from other integrators."""

from typing import NamedTuple

import numpy as np
import pytest

from debrisest.attitude import quaternion
from debrisest.dynamics import clohessy_wiltshire, gravity_gradient, log_inertia
from debrisest.dynamics.pointing import camera_axes
from debrisest.filters.landmark_model import LandmarkModel, Observations, split
from debrisest.filters.landmarks.batch_start import Batch, batch_problem
from debrisest.filters.landmarks.growing_windows import Window
from debrisest.filters.landmarks.landmark_filter import landmark_filter
from debrisest.filters.landmarks.self_tests import self_tests
from debrisest.filters.landmarks.update import Belief, UpdateSettings
from debrisest.filters.landmarks.whole_arc import whole_arc
from debrisest.filters.verdict import judged
from debrisest.problems.camera_range.model import CameraRangeGeometry
from debrisest.problems.camera_range.projection import landmark_model

N, STEP, FOCAL = 1.078007613e-3, 5.0, 1000.0
CORNERS = np.array([[x, y, z] for x in (1, -1) for y in (0.75, -0.75) for z in (0.5, -0.5)])
POINTS = np.concatenate([CORNERS, [[0.35, 2, 0.1], [-0.35, 2, 0.1], [0, -0.3, 0.9]]])
RHO = np.array([5.0, 17.3205081, 5.90884652])
VELOCITY = np.array([9.33582e-3, -2 * N * 5.0, -1.12315e-3])
WINDOWS = [Window(10, 1), Window(20, 1), Window(40, 1), Window(70, 2), Window(100, 1)]


class Started(NamedTuple):
    """What a batch says at epoch 0, and of itself."""

    core: np.ndarray
    points: np.ndarray
    covariance: np.ndarray
    present: np.ndarray
    last: np.ndarray
    verdict: np.ndarray
    sentence: np.ndarray
    restarts: np.ndarray
    ratio: np.ndarray


class Experiment(NamedTuple):
    """Setup, model, observed and truth of all epochs, and a first guess with its covariance."""

    known: CameraRangeGeometry
    model: LandmarkModel
    observed: Observations
    core: np.ndarray
    points: np.ndarray
    parameters: np.ndarray
    covariance: np.ndarray

    def with_observed(self, observed: Observations) -> "Experiment":
        return self._replace(observed=observed)

    def batch(self, ends: tuple = (), **options) -> Started:
        """Batch over windows, and on over longer ones up to some ends."""
        settings = Batch(**({"windows": WINDOWS} | options))
        task = batch_problem(self.model, self.observed, self.parameters, self.covariance, settings)
        with np.errstate(all="ignore"):
            arc = whole_arc(task, [settings.windows[-1].last, *ends])
            said = judged(self_tests(task, arc), len(self.parameters))
        last = arc.anchors[-1]
        return Started(
            *last.start,
            present=last.present,
            last=np.full(len(said.code), last.epoch),
            verdict=said.code,
            sentence=said.sentence,
            restarts=arc.found.restarts,
            ratio=arc.found.best.found.ratio,
        )

    def filtered(self, started: Started, **rule):
        belief = Belief(started.core, started.points, started.covariance)
        return landmark_filter(
            self.model, belief, started.present, started.last, self.observed, UpdateSettings(**rule)
        )

    def start_error(self, started: Started) -> np.ndarray:
        """Errors (run, n_e) of the start."""
        core = self.model.difference(started.core, self.core[:, 0])
        return np.concatenate([core, (started.points - self.points).reshape(len(core), -1)], -1)


def simulate(
    runs: int,
    epochs: int,
    seed: int,
    rate_deg_s: tuple = (0.6, 0.4, 1.0),
    noise: float = 1.0,
    false_share: float = 0.0,
    guess: float = 1.0,
    range_to: str = "centre",
    **setup,
) -> Experiment:
    """Film one box ``runs`` times; ``noise`` and ``guess`` scale the errors."""
    rng = np.random.default_rng(seed)
    times = STEP * np.arange(epochs)
    core = _truth(times, np.radians(rate_deg_s))
    camera = camera_axes(core[:, 7:10])
    turn = np.swapaxes(camera, -1, -2)
    body = quaternion.to_matrix(core[:, :4])
    sight = POINTS @ np.swapaxes(body, -1, -2) - core[:, None, 7:10]
    seen = sight @ np.swapaxes(turn, -1, -2)
    pixel = FOCAL * seen[..., :2] / seen[..., 2:] + noise * rng.normal(
        size=(runs, *seen[..., :2].shape)
    )
    false = rng.random(pixel.shape[:-1]) < false_share
    pixel[false] = rng.uniform(-200, 200, (false.sum(), 2))
    distance = np.linalg.norm(core[:, 7:10], axis=-1)
    offset = 0.7 if range_to == "bias" else 0.0
    ranges = distance - offset + 0.01 * noise * rng.normal(size=(runs, epochs))
    shown = [pixel.reshape(runs, epochs, -1), ranges[..., None]]
    if range_to == "landmark":
        lengths = np.full((runs, *seen.shape[:2], 1), np.nan)
        near = np.argmin(seen[..., 2], axis=-1)
        to_point = np.linalg.norm(seen, axis=-1)[np.arange(epochs), near]
        drawn = to_point + 0.01 * noise * rng.normal(size=(runs, epochs))
        lengths[:, np.arange(epochs), near, 0] = drawn
        shown = [np.concatenate([pixel, lengths], -1).reshape(runs, epochs, -1)]
    known = CameraRangeGeometry(
        camera=np.broadcast_to(camera, (runs, *camera.shape)),
        points=len(POINTS),
        mean_motion=N,
        step=STEP,
        focal=FOCAL,
        range_model=range_to,
        **({"pixel_sigma": 1.0, "range_sigma": 0.01} | setup),
    )
    model = landmark_model(known)
    sigma = np.repeat([np.radians(0.3), 0.5, 0.02, 0.5], (3, 3, 3, 5))
    spread = np.concatenate([sigma, np.full(known.extras, 0.3), np.full(3 * len(POINTS), 1.5)])
    extra = np.full((runs, known.extras), offset)
    states = np.concatenate(
        [
            np.broadcast_to(core, (runs, *core.shape)),
            np.broadcast_to(extra[:, None], (runs, epochs, known.extras)),
        ],
        -1,
    )
    parameters = model.parameters(states[:, 0])
    parameters[:, :9] += guess * sigma[:9] * rng.normal(size=(runs, 9))
    parameters[:, 9:14] = 0.0 if guess else parameters[:, 9:14]
    return Experiment(
        known,
        model,
        split(model, np.concatenate(shown, axis=-1)),
        states,
        np.broadcast_to(POINTS, (runs, *POINTS.shape)),
        parameters,
        np.tile(np.diag(spread**2), (runs, 1, 1)),
    )


def _truth(times: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Core (time, 18); body axes are the camera's at time zero."""
    inertia = np.diag([135.4, 208.3, 260.4])
    start = quaternion.from_matrix(camera_axes(RHO))
    radius = (gravity_gradient.MU_EARTH / N**2) ** (1 / 3)
    q_ib, rates = gravity_gradient.tumble(
        *(times, start, rate, inertia),
        lambda t: radius * np.array([np.cos(N * t), np.sin(N * t), 0.0]),
    )
    half = 0.5 * N * times
    back = np.stack([np.cos(half), 0 * half, 0 * half, -np.sin(half)], axis=-1)
    position, velocity = clohessy_wiltshire.propagate(RHO, VELOCITY, N, times)
    ratios = np.broadcast_to(log_inertia.log_ratios(inertia), (len(times), 5))
    return np.concatenate([quaternion.multiply(back, q_ib), rates, position, velocity, ratios], -1)


@pytest.fixture(scope="session")
def experiment():
    return simulate


@pytest.fixture(scope="session")
def nominal() -> tuple[Experiment, Started]:
    """Four noisy runs of 150 epochs, and their batch of the first 101."""
    found = simulate(4, 150, 0)
    return found, found.batch()
