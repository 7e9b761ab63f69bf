"""CPU time of numpy's code over that of the loops that numba compiles, in turns in one process.

Usage: python scripts/benchmark_kernels.py [ROUNDS]    (needs the extra [fast])

Kernels are called as an estimator calls them: what is left around the loops counts. `benchmark.py`
holds whole filters against their peers.
"""

import os

for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_variable] = "1"

import sys
import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

import numpy as np
from rich.box import MARKDOWN
from rich.console import Console
from rich.table import Table

from debrisest import compiled
from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.batch.align_clouds import align_clouds
from debrisest.batch.arc import Arc, along, course, displaced
from debrisest.batch.descent import descend_all
from debrisest.batch.free_points import FreePoints
from debrisest.batch.local_rates import local_rates
from debrisest.batch.path import path_of
from debrisest.batch.point_sums import KnownPoints
from debrisest.batch.rigid_sets import pairs
from debrisest.batch.smoother import Wander, smooth
from debrisest.batch.spread import straight
from debrisest.batch.tracks import tracks
from debrisest.batch.windows import refitted
from debrisest.clock import Clock
from debrisest.control.camera import Camera
from debrisest.control.closed_loop import ClosedLoop
from debrisest.control.rigid_spacecraft import spacecraft
from debrisest.control.track import seen_from
from debrisest.control.two_stage import Controller
from debrisest.dynamics import kepler
from debrisest.dynamics.integrators import rk4_step
from debrisest.dynamics.log_inertia import log_ratios
from debrisest.dynamics.pointing import camera_axes
from debrisest.filters.association.single import associated
from debrisest.filters.association.weights import Validation
from debrisest.filters.bound.information import Information, gather
from debrisest.filters.kalman.extended import extended
from debrisest.filters.kalman.unscented import unscented
from debrisest.filters.landmark_model import split
from debrisest.filters.landmarks import update as landmarks
from debrisest.filters.landmarks.cost import Prior, Unknowns, cost
from debrisest.filters.model import Model
from debrisest.filters.replay.frame_update import Belief, covariance_of, predict, update
from debrisest.filters.replay.measured_arc import linearize, measured_arc
from debrisest.filters.replay.replay import replay
from debrisest.filters.replay_model import ReplayModel
from debrisest.problems.camera_range import course as in_orbit
from debrisest.problems.camera_range import model as camera_range
from debrisest.problems.camera_range import redundant_model
from debrisest.problems.camera_range.projection import landmark_model
from debrisest.problems.orbit_from_pixels.model import ObserverGeometry, scan_model
from debrisest.problems.stereo_pose import model as stereo_pose
from debrisest.problems.stereo_pose.replay import replay_model
from debrisest.problems.stereo_pose.truth import draw_guess
from debrisest.problems.tumbling import attitude

RATE, MOMENTS = np.radians([7.2, 5.525, -1.624]), np.array([0.618, 0.707, 0.345])
IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])
CALLS, LONGEST = 10, 0.5  # of a round, the latter in s

Kernel = Callable[[], Any]


def kernels() -> dict[str, Kernel]:
    """Return what the loops replace, by name (two kernels have rows for one run)."""
    arc = Arc(300.0, IDENTITY, RATE, log_ratios(np.diag(MOMENTS)))
    times = {count: np.arange(float(count)) for count in (10, 300, 1500)}
    core = np.zeros((20, camera_range.LOG_INERTIA.stop))
    core[:, camera_range.Q], core[:, camera_range.RATE] = IDENTITY, 0.2 * RATE
    core[:, camera_range.LOG_INERTIA] = arc.log_inertia
    orbit: Any = SimpleNamespace(mean_motion=1e-3, step=1.0, gravity_gradient=True)
    return {
        **{
            f"motion and derivatives of an arc, {count} epochs": lambda t=t: course(arc, t)
            for count, t in times.items()
        },
        "rotation in orbit and derivatives, 20 runs of 1165 epochs": lambda: in_orbit.rotation(
            orbit, core, 1165, 1
        ),
        "the same, one run": lambda: in_orbit.rotation(orbit, core[:1], 1165, 1),
        **of_known_points(),
        "unscented filter, 91 states, 20 runs of two epochs": sigma_points(),
        "unscented filter, 14 states, 100 runs of ten epochs": attitude_filter(),
        "iterated filter, 30 states, 100 runs of four epochs": iterated(),
        "bound, 53 unknowns, 20 runs of 16 epochs": bound(),
        **of_landmarks(),
        **{f"{name} ": kernel for name, kernel in of_replay().items()},
        **{
            f"association, 30 epochs of three detections, {runs} runs": association(runs)
            for runs in (100, 1)
        },
        **unknown_points(),
        "pointing loop of two satellites, 40 s": pointing(),
    }


def unknown_points() -> dict[str, Kernel]:
    """Return how clouds of points are laid over each other, and what these tell of an arc."""
    evidence, truth = eight_points(1000)
    points = FreePoints(evidence.tracks, evidence.model)
    motion = course(truth, evidence.times)
    return {
        "unknown points, clouds of 1000 epochs": lambda: (align_clouds(evidence.tracks).model,),
        "unknown points, normal equations": lambda: (points.normal(motion).hold,),
    }


def of_known_points() -> dict[str, Kernel]:
    """Return what the batch does with eight points of a body that tumbles."""
    evidence, truth = eight_points(150)
    draws = np.random.default_rng(2)
    errors = np.repeat([1e-3, 1e-5, 0.02], [3, 3, 5]) * draws.normal(size=(4, 11))
    starts = [displaced(truth, error) for error in errors]
    longer, middle = eight_points(1500)
    known = straight(middle, 1e-10 * np.eye(11))
    local = local_rates(evidence.times, evidence.seen())
    assert local is not None
    wander = Wander(3, 1e-6, 1.0)
    return {
        "descents on known points, 4 arcs of 150 epochs": lambda: tuple(
            end.hold for end in descend_all(evidence, starts, 12)
        ),
        "fit of a window and its tests, 150 epochs": lambda: fit_of(evidence, starts[0]),
        "distances of eight points, 1500 epochs": lambda: (
            np.nan_to_num(pairs(longer.tracks, longer.model).noise),
        ),
        "motion with its spread, 1500 epochs": lambda: path_of(middle, known, longer.times)[1:],
        "smoother, 150 epochs": lambda: smooth(evidence, local, wander, evidence.times)[1:5],
    }


def eight_points(count: int) -> tuple[KnownPoints, Arc]:
    """Return the points at so many epochs, and the motion."""
    draws, times = np.random.default_rng(2), np.linspace(0.0, 2.0 * count, count)
    truth = Arc(float(count), IDENTITY, RATE, log_ratios(np.diag(MOMENTS)))
    model = draws.normal(size=(8, 3))
    turned = model @ np.swapaxes(quaternion.to_matrix(along(truth, times)[0]), -1, -2)
    seen = tracks(times, turned + 0.02 * draws.normal(size=turned.shape), 0.02)
    return KnownPoints(seen, model), truth


def fit_of(evidence: KnownPoints, start: Arc) -> tuple[Array, ...]:
    """Return what a window's fit from a start is made of."""
    growth = refitted(evidence, start)
    return growth.found.hold, growth.fit.blocks


def sigma_points() -> Kernel:
    """Return a filter of 91 errors, two epochs long."""
    draws = np.random.default_rng(1)
    known = redundant_model.CameraGeometry(points=12, mean_motion=1e-3, step=1.0, focal_px=1000.0)
    state = draws.normal(size=(20, 91))
    state[:, redundant_model.RATE] *= 0.02
    state[:, redundant_model.POSITION] += [5.0, 17.0, 6.0]
    state[:, redundant_model.INERTIA] = [135.0, 208.0, 260.0, 5.0, -3.0, 8.0]
    state[:, known.camera_points][:, 2::3] += 20.0
    covariance = np.tile(1e-4 * np.eye(91), (20, 1, 1))
    shown = redundant_model.measurement(known, state)
    measured = shown[:, None] + draws.normal(size=(20, 2, 25)) * [*24 * [1.0], 0.01]

    def kernel() -> tuple[Array]:
        model = redundant_model.redundant_model(known, 1.0, 0.01)
        return (unscented(model, state, covariance, measured).state,)

    return kernel


def bound() -> Kernel:
    """Return the bound of 53 unknowns over 16 epochs of 25 sparse rows."""
    draws = np.random.default_rng(6)
    rows = draws.normal(size=(20, 16, 25, 53)) * (np.arange(53) % 3 == 0)
    residual, moved = draws.normal(size=(20, 16, 25)), draws.normal(size=(20, 16, 17, 17))
    prior = np.tile(np.eye(53), (20, 1, 1))
    return lambda: gather(Information(prior.copy(), np.zeros((20, 53))), rows, residual, moved)


def attitude_filter() -> Kernel:
    """Return an unscented filter of 14 errors, ten epochs long."""
    draws = np.random.default_rng(8)
    state = np.tile(np.append(np.zeros(11), MOMENTS), (100, 1))
    state[:, [0, 4]], state[:, attitude.RATE] = 1.0, 0.2 * RATE
    model = Model(
        process=lambda x, _: attitude.process(x, 1.0, rk4_step),
        measurement=lambda x, _: attitude.measured_attitude(x),
        process_noise=1e-6 * np.eye(14),
        measurement_noise=1e-4 * np.eye(4),
        error_names=attitude.ERROR_NAMES,
        retract=attitude.correct,
        innovation=attitude.sign_free_innovation,
    )
    measured = IDENTITY + 1e-2 * draws.normal(size=(100, 10, 4))
    covariance = np.tile(1e-3 * np.eye(14), (100, 1, 1))
    return lambda: (unscented(model, state, covariance, measured, redraw=False).state,)


def iterated() -> Kernel:
    """Return an iterated filter of 30 errors and 45 components, four epochs long."""
    draws = np.random.default_rng(7)
    h = draws.normal(size=(45, 30))
    model = Model(
        process=lambda state, _: state,
        measurement=lambda state, _: state @ h.T,
        process_noise=np.zeros((30, 30)),
        measurement_noise=0.1 * np.eye(45),
        error_names=tuple(map(str, range(30))),
        process_jacobian=lambda *_: np.eye(30),
        measurement_jacobian=lambda *_: h,
    )
    given = np.zeros((100, 30)), np.tile(np.eye(30), (100, 1, 1)), draws.normal(size=(100, 4, 45))
    return lambda: (extended(model, *given, iterations=3, stop="relative_norm").state,)


def of_landmarks() -> dict[str, Kernel]:
    """Return those of the landmark batch and filter: 20 runs, twelve points, 200 epochs."""
    draws, frames, runs = np.random.default_rng(5), np.arange(200), 20
    known = camera_range.CameraRangeGeometry(
        camera=np.broadcast_to(camera_axes(np.array([5.0, 17.0, 6.0])), (runs, 200, 3, 3)),
        points=12,
        mean_motion=1e-3,
        step=5.0,
        focal=1000.0,
        pixel_sigma=1.0,
        range_sigma=0.01,
    )
    model = landmark_model(known)
    parameters = np.tile(np.r_[0.01, 0.005, 0.015, 5.0, 17.0, 6.0, np.zeros(8)], (runs, 1))
    parameters[:, 9:] = 0.1 * draws.normal(size=(runs, 5))
    at = Unknowns(parameters, draws.uniform(-1, 1, (runs, 12, 3)), np.ones((runs, 12), np.bool_))
    prior = Prior(at.vector, np.tile(np.eye(50), (runs, 1, 1)))
    cores = model.path(model.start(parameters)[0], 199)
    rows = model.rows(cores, at.points[:, None], frames)
    shown = np.concatenate([rows.shown.reshape(runs, 200, -1), rows.common], axis=-1)
    seen = split(model, shown + model.common_sigma * draws.normal(size=shown.shape))
    belief = landmarks.Belief(cores[:, 9], at.points, np.tile(1e-4 * np.eye(53), (runs, 1, 1)))
    frame, settings = seen.at(slice(None), 9), landmarks.UpdateSettings()
    return {
        "landmarks, linearised cost of 20 runs, 200 epochs": lambda: cost(
            model, seen, prior, at, frames, False
        )[:3],
        "landmarks, an update of 20 runs": lambda: landmarks.update(
            model, belief, frame, 9, settings
        )[0],
        "landmarks, a step of 20 runs": lambda: model.process(belief.core),
    }


def of_replay() -> dict[str, Kernel]:
    """Return those of the replay filter on the stereo pose problem, and the filter itself."""
    runs, epochs = 100, 101
    draws = np.random.default_rng(3)
    start = np.zeros((runs, 30))
    start[:, :9] = [10, 60, 10, 0.01, -0.0225, -0.01, *np.radians([-0.1, -0.1, 0.034])]
    start[:, 9:15] = [0, 0, 0, 1, -0.186, -0.0797]
    start[:, 15:] = draws.uniform(-1.5, 1.5, (runs, 15))
    known = stereo_pose.stereo_geometry(Clock.regular(epochs, 1.0), 7.17e6, 0.05, 0.0)
    variance = np.repeat([1.0, np.radians(1) ** 2, 4e-5, 0.5, 1.0], [6, 3, 3, 2, 15])
    with patch.object(compiled, "available", lambda: True):
        fast = replay_model(known, np.full(45, 1e-5), np.sqrt(variance))
    guess = draw_guess(start, 1e-4 * np.insert(variance, 9, 4e-5), draws.normal(size=start.shape))
    shown = fast.shown(start, epochs - 1)[1]
    covariance = np.tile(1e-4 * np.diag(variance), (runs, 1, 1))
    data = guess, covariance, shown + 1e-5 * draws.normal(size=shown.shape)
    arc = measured_arc(fast, *data)

    def model() -> ReplayModel:
        return fast if compiled.available() else fast._replace(sums=None, frames=None)

    known_so_far = linearize(fast, arc, guess, 50)
    belief = Belief(known_so_far.last_state, known_so_far.information)

    def frame() -> tuple[Array, ...]:
        updated = update(model(), predict(model(), belief, 51), arc, 51, gate=False)[0]
        return *updated, covariance_of(model(), updated)

    return {
        "stereo pose, motion and sensitivities of 100 runs, 101 epochs": lambda: fast.trajectory(
            guess, 0, epochs - 1
        )[1],
        "the same, one step": lambda: fast.trajectory(guess, 3, 4)[1],
        "the same, one run of 101 epochs": lambda: fast.trajectory(guess[:1], 0, epochs - 1)[1],
        "stereo pose, linearised cost of 100 runs, 101 epochs": lambda: (
            linearize(model(), arc, guess, epochs - 1).information
        ),
        "stereo pose, a frame of the filter, 100 runs": frame,
        "replay, 100 runs of 101 epochs": lambda: replay(model(), *data).state,
        "the same, one run": lambda: replay(model(), *(each[:1] for each in data)).state,
    }


def association(runs: int) -> Kernel:
    """Return a filter of a target among clutter that two cameras see, over 30 epochs."""
    draws = np.random.default_rng(runs)
    still = np.repeat([[1e6, 0.0, 0.0, 0.0, 0.0, 0.0]], runs, axis=0)
    orbit = ObserverGeometry(
        step=1.0,
        observer=np.tile([[7e6, 0.0, 0.0], [7e6, 1e5, 0.0]], (30, runs, 1, 1)),
        to_camera=np.tile([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]], (30, runs, 2, 1, 1)),
        scale=np.full(runs, 335.0),
        acceleration_noise=np.array(0.1),
        pixel_variance=np.array(1.0),
        with_bias=False,
    )
    still[:, 0] += 7e6
    covariance = np.tile(1e4 * np.eye(6), (runs, 1, 1))
    scans = 5.0 * draws.normal(size=(runs, 30, 2, 3, 2))
    scans[:, :, 1, :, 0] -= 33.5

    def kernel() -> tuple[Array, ...]:
        found = associated(scan_model(orbit), still, covariance, scans, Validation())
        return found.state, found.sigma

    return kernel


def pointing() -> Kernel:
    """Return a closed loop of two satellites that turn for half a minute."""
    times, node = np.arange(40.0), np.radians([10.0, 7.0])
    orbits = kepler.state_from_elements(7.5e6, 0.1, 0.5, node, 1.5, 0.14)
    satellites = (x.swapaxes(0, 1)[None] for x in kepler.propagate(*orbits, times))
    debris = kepler.propagate(*kepler.state_from_elements(7.49e6, 0.1, 0.35, 0.6, 1.2, 0.14), times)
    craft, scale = spacecraft(np.diag([1.07e-3, 1.04e-3, 0.96e-3])), np.array([[335.0]])
    factors = np.full((1, 50, 2, 6), 1.05)
    loop = ClosedLoop(
        controller=Controller(craft, scale),
        camera=Camera(scale, np.array([[[240.0, 180.0]]]), 100.0, rounded=True),
        plant=craft,
        track=seen_from(*(x[None] for x in debris), *satellites),
        step=1.0,
        substeps=50,
        factors=lambda: factors,
    )
    return lambda: (loop.run(np.zeros((1, 2, 3))).angles,)


def compared(kernel: Kernel, rounds: int) -> tuple[list[float], list[float], float]:
    """Return microseconds per call of numpy and of the loops, by round, and how far they differ."""

    def by(loops: bool) -> Any:
        with patch.object(compiled, "available", lambda: loops):
            return kernel()

    def cost(loops: bool) -> float:
        before = time.process_time()
        calls = 0
        while calls < CALLS and time.process_time() - before < LONGEST:
            by(loops)
            calls += 1
        return 1e6 * (time.process_time() - before) / calls

    gap = max(np.abs(a - b).max() / np.abs(a).max() for a, b in zip(by(False), by(True)))
    plain, fast = zip(*((cost(False), cost(True)) for _ in range(rounds)))
    return list(plain), list(fast), float(gap)


def main(rounds: int = 5) -> None:
    """Print one row per kernel: medians, and the ratios' range over the rounds."""
    table = Table("kernel", "numpy, us", "loops, us", "ratio (range)", "agree to", box=MARKDOWN)
    for name, kernel in kernels().items():
        plain, fast, gap = compared(kernel, rounds)
        ratios = np.array(plain) / fast
        spread = f"{np.median(ratios):.2g} ({ratios.min():.2g}-{ratios.max():.2g})"
        table.add_row(
            name, f"{np.median(plain):.0f}", f"{np.median(fast):.0f}", spread, f"{gap:.0e}"
        )
    Console(width=120).print(table)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
