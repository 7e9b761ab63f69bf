"""CPU time of numpy's code over that of the loops that numba compiles, in turns in one process.

Usage: python scripts/benchmark_kernels.py [ROUNDS]    (needs the extra [fast])

Kernels are called as an estimator calls them: what is left around the loops counts. `benchmark.py`
holds whole filters against their peers.
"""

import sys
import time
from collections.abc import Callable
from functools import partial
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
from debrisest.batch.arc import Arc, along, course, displaced
from debrisest.batch.descent import descend_all
from debrisest.batch.local_rates import local_rates
from debrisest.batch.path import path_of
from debrisest.batch.point_sums import KnownPoints
from debrisest.batch.rigid_sets import pairs
from debrisest.batch.smoother import Wander, smooth
from debrisest.batch.spread import straight
from debrisest.batch.tracks import tracks
from debrisest.batch.windows import refitted
from debrisest.clock import Clock
from debrisest.dynamics.log_inertia import log_ratios
from debrisest.filters.association.evidence import Beside
from debrisest.filters.association.restless import Bank
from debrisest.filters.association.sensor import updated
from debrisest.filters.association.update import Scan, Tracks
from debrisest.filters.association.weights import Validation, probabilistic
from debrisest.filters.replay.measured_arc import linearize, measured_arc
from debrisest.filters.replay.replay import replay
from debrisest.filters.replay_model import ReplayModel
from debrisest.problems.camera_range import model as camera_range
from debrisest.problems.camera_range import redundant_model
from debrisest.problems.stereo_pose import model as stereo_pose
from debrisest.problems.stereo_pose.replay import replay_model
from debrisest.problems.stereo_pose.truth import draw_guess

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
        "rotation in orbit and derivatives, 20 runs of 1165 epochs": lambda: camera_range._rotation(
            orbit, core, 1165, 1
        ),
        "the same, one run": lambda: camera_range._rotation(orbit, core[:1], 1165, 1),
        **of_known_points(),
        "91 states, sigma points of 20 runs moved": sigma_points(),
        **{f"{name} ": kernel for name, kernel in of_replay().items()},
        **{
            f"association, one sensor of seven detections, {runs} runs": association(runs)
            for runs in (100, 1)
        },
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
    """Return a step of the points of 91 errors, of which four fifths share their core."""
    draws = np.random.default_rng(1)
    known = redundant_model.CameraGeometry(points=12, mean_motion=1e-3, step=1.0, focal_px=1000.0)
    state = np.zeros((20, 183, 91))
    state[...] = draws.normal(size=(20, 1, 91))
    state[..., redundant_model.RATE] *= 0.02
    state[..., redundant_model.POSITION] += [5.0, 17.0, 6.0]
    state[..., redundant_model.INERTIA] = [135.0, 208.0, 260.0, 5.0, -3.0, 8.0]
    moved = np.arange(1, 1 + redundant_model.CORE)
    state[:, moved, moved - 1] += 1e-3
    state[:, 91 + moved, moved - 1] -= 1e-3
    return lambda: (redundant_model.process(known, state),)


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
        return fast if compiled.available() else fast._replace(sums=None)

    return {
        "stereo pose, motion and sensitivities of 100 runs, 101 epochs": lambda: fast.trajectory(
            guess, 0, epochs - 1
        )[1],
        "the same, one step": lambda: fast.trajectory(guess, 3, 4)[1],
        "the same, one run of 101 epochs": lambda: fast.trajectory(guess[:1], 0, epochs - 1)[1],
        "stereo pose, linearised cost of 100 runs, 101 epochs": lambda: (
            linearize(model(), arc, guess, epochs - 1).information
        ),
        "replay, 100 runs of 101 epochs": lambda: replay(model(), *data).state,
        "the same, one run": lambda: replay(model(), *(each[:1] for each in data)).state,
    }


def association(runs: int) -> Kernel:
    """Return the update of a target's track, and of what runs beside it, by one sensor."""
    draws = np.random.default_rng(runs)

    def positive(*axes: int) -> Array:
        root = draws.normal(size=(*axes, 6, 8))
        return root @ np.swapaxes(root, -2, -1)

    tracks = Tracks(draws.normal(size=(runs, 1, 6)), positive(runs, 1))
    bank = Bank(draws.normal(size=(runs, 2, 6)), positive(runs, 2))
    beside = Beside(draws.normal(size=(runs, 6, 7)), bank)
    seen = draws.normal(size=(runs, 1, 1, 7, 2)), draws.normal(size=(runs, 1, 1, 2, 6))
    doubted = draws.normal(size=(runs, 1, 2, 7))
    weigh = partial(probabilistic, validation=Validation(), d=2)

    def kernel() -> tuple[Array, ...]:
        new, apart, shown, _ = updated(tracks, beside, Scan(*seen), doubted, np.eye(2), 9.21, weigh)
        return (*new, apart.pull, *apart.bank, shown.score, shown.likelihood)

    return kernel


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
