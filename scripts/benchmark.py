"""Ratios of CPU time to well-known peers, at equal results, measured in turns in one process.

Usage: python scripts/benchmark.py [ROUNDS]    (needs the extra [bench])

Times of one machine say little; the ratios to a peer that runs beside it do. Every comparison
checks first that both give the same numbers. Where numba can be imported, a kernel is also held
against plain loops that it compiles (`compiled.py`).
"""

import os

for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_variable] = "1"

import io
import logging
import math
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from typing import NamedTuple

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter, MerweScaledSigmaPoints, UnscentedKalmanFilter
from rich.console import Console
from rich.table import Table
from scipy.fft import fft, ifft
from scipy.sparse.linalg import LinearOperator
from spgl1 import spg_lasso

from debrisest.arrays import Array, BoolArray
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.dynamics.torque_free import torque_free
from debrisest.filters.kalman.extended import extended
from debrisest.filters.kalman.unscented import UnscentedParameters, unscented
from debrisest.filters.model import Model
from debrisest.filters.replay.replay import replay
from debrisest.problems.camera_range.redundant_model import CameraGeometry as Redundant
from debrisest.problems.camera_range.redundant_model import process as shape_process
from debrisest.problems.camera_range.redundant_model import redundant_model
from debrisest.problems.stereo_pose.additive import additive_model
from debrisest.problems.stereo_pose.model import StereoGeometry, measurement, stereo_geometry
from debrisest.problems.stereo_pose.replay import replay_model
from debrisest.problems.stereo_pose.truth import draw_guess, simulate_truth
from debrisest.problems.tumbling.attitude import TumblingAttitude, Variances
from debrisest.recovery.basis_pursuit import basis_pursuit
from debrisest.recovery.fourier import l1_norm

try:
    from compiled import compiled_states
except ImportError:
    compiled_states = None

MOMENTS, RATE = np.array([0.618, 0.707, 0.345]), np.radians([7.2, 5.525, -1.624])
NOISE = Variances(q_ib=1e-9, q_bf=1e-11, rate_rad2_s2=1e-9, moments=1e-10)
START = Variances(q_ib=1e-2, q_bf=0.1, rate_rad2_s2=2e-2, moments=0.02)
logging.getLogger("spgl1").setLevel(logging.CRITICAL)

GAP = 1e-4
"""Objectives closer than this, relatively, count as equal."""


class Row(NamedTuple):
    """One comparison: CPU seconds per unit of work, ours and the peer's, by round."""

    name: str
    unit: str
    ours: list[float]
    peer: list[float]
    agreement: str


def cpu(action: Callable[[], object]) -> float:
    """Return the CPU seconds of an action."""
    before = time.process_time()
    action()
    return time.process_time() - before


# --- the unscented filter against filterpy ----------------------------------------------------


def tumbling(runs: int, epochs: int) -> tuple[Model, Array, Array, Array]:
    """Return model, start and noisy attitudes (run, time, 4) of the paper's first case."""
    problem = TumblingAttitude(
        kind="tumbling_attitude", integrator="rk4", process_noise=NOISE, measurement_noise=1e-4
    )
    q, _ = torque_free(np.arange(float(epochs)), np.array([1.0, 0, 0, 0]), RATE, MOMENTS)
    noise = 0.01 * np.random.default_rng(1).standard_normal((runs, epochs, 4))
    measured = quaternion.normalize(q + noise)
    state = np.concatenate([q[0], [1, 0, 0, 0], RATE, np.full(3, 1 / np.sqrt(3))])
    return (
        problem.model({}, Clock.regular(epochs, 1.0)),
        np.tile(state, (runs, 1)),
        np.tile(START.diagonal(), (runs, 1, 1)),
        measured,
    )


def scalar_process(x: Array, step: float) -> Array:
    """Return a state (14,) one step later, in Python floats, the fastest without a compiler."""
    ja, jb, jc = (math.copysign(max(abs(j), 0.02), j) for j in x[11:].tolist())
    a, b, c = (jb - jc) / ja, (jc - ja) / jb, (ja - jb) / jc
    now = [*x[:4].tolist(), *x[8:11].tolist()]
    count = max(1, math.ceil(math.hypot(*now[4:]) * step / 0.1))
    h = step / count

    def rates(y: list[float]) -> tuple[float, ...]:
        q0, q1, q2, q3, w1, w2, w3 = y
        return (
            -0.5 * (q1 * w1 + q2 * w2 + q3 * w3),
            0.5 * (q0 * w1 + q2 * w3 - q3 * w2),
            0.5 * (q0 * w2 + q3 * w1 - q1 * w3),
            0.5 * (q0 * w3 + q1 * w2 - q2 * w1),
            a * w2 * w3,
            b * w3 * w1,
            c * w1 * w2,
        )

    for _ in range(count):
        k1 = rates(now)
        k2 = rates([y + 0.5 * h * k for y, k in zip(now, k1)])
        k3 = rates([y + 0.5 * h * k for y, k in zip(now, k2)])
        k4 = rates([y + h * k for y, k in zip(now, k3)])
        now = [y + h / 6 * (p + 2 * (q + r) + s) for y, p, q, r, s in zip(now, k1, k2, k3, k4)]
    return np.array([*now[:4], *x[4:8], *now[4:], *x[11:]])


def scalar_measurement(x: Array) -> Array:
    """Return the product of both quaternions of a state (14,), in Python floats."""
    a0, a1, a2, a3, b0, b1, b2, b3 = x[:8].tolist()
    return np.array(
        [
            a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3,
            a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2,
            a0 * b2 - a1 * b3 + a2 * b0 + a3 * b1,
            a0 * b3 + a1 * b2 - a2 * b1 + a3 * b0,
        ]
    )


def filterpy_states(model: Model, state: Array, covariance: Array, measured: Array) -> Array:
    """Return the states (time, 14) of filterpy's filter on the same model, for one run."""
    points = MerweScaledSigmaPoints(14, alpha=1.0, beta=2.0, kappa=0.0)
    peer = UnscentedKalmanFilter(
        dim_x=14,
        dim_z=4,
        dt=1.0,
        fx=scalar_process,
        hx=scalar_measurement,
        points=points,
    )
    peer.x, peer.P = state.copy(), covariance.copy()
    peer.Q, peer.R = model.process_noise, model.measurement_noise
    states = []
    for epoch, y in enumerate(measured):
        if epoch == 0:
            peer.sigmas_f = points.sigma_points(peer.x, peer.P)
        else:
            peer.predict()
        peer.update(-y if y @ scalar_measurement(peer.x) < 0 else y)
        peer.x = model.retract(peer.x, np.zeros(14))
        states.append(peer.x.copy())
    return np.array(states)


def benchmark_unscented(runs: int, epochs: int, rounds: int) -> Row:
    """Compare a batch of runs with filterpy, which takes them one at a time."""
    ours = tumbling(runs, epochs)
    one = tumbling(1, 40)
    theirs = filterpy_states(one[0], one[1][0], one[2][0], one[3][0])
    gap = np.abs(unscented(*one, redraw=True).state[0] - theirs).max()
    assert gap < 1e-8, f"filterpy's states differ by {gap}"
    row = Row(f"unscented filter, {runs} at a time / filterpy", "run-step", [], [], f"{gap:.0e}")
    for _ in range(rounds):
        row.ours.append(cpu(lambda: unscented(*ours)) / (runs * epochs))
        row.peer.append(cpu(lambda: filterpy_states(one[0], one[1][0], one[2][0], one[3][0])) / 40)
    return row


def benchmark_compiled(runs: int, epochs: int, rounds: int) -> Row:
    """Compare a batch of runs with compiled loops over the same runs."""
    model, start, covariance, measured = problem = tumbling(runs, epochs)

    def loops() -> Array:
        found: Array = compiled_states(start, covariance, measured, model.process_noise, 1e-4, 1.0)
        return found

    gap = np.abs(unscented(*problem, redraw=True).state - loops()).max()
    assert gap < 1e-10, f"the compiled states differ by {gap}"
    row = Row(f"unscented filter, {runs} at a time / compiled", "run-step", [], [], f"{gap:.0e}")
    for _ in range(rounds):
        row.ours.append(cpu(lambda: unscented(*problem, redraw=True)) / (runs * epochs))
        row.peer.append(cpu(loops) / (runs * epochs))
    return row


# --- stereo pose: the extended filter against filterpy, the replay filter against itself ----------

ORBIT = (7.17e6, 0.05, 0.0)


def stereo_pose(runs: int, epochs: int) -> tuple[Array, Array, StereoGeometry]:
    """Return guesses (run, n), measurements (run, time, m) and setup of a slowly turning target."""
    rng = np.random.default_rng(3)
    start = np.zeros((runs, 30))
    start[:, :9] = [10, 60, 10, 0.01, -0.0225, -0.01, *np.radians([-0.1, -0.1, 0.034])]
    start[:, 9:15] = [0, 0, 0, 1, -0.186, -0.0797]
    start[:, 15:] = rng.uniform(-1.5, 1.5, (runs, 15))
    known = stereo_geometry(Clock.regular(epochs, 1.0), *ORBIT)
    truth = simulate_truth(np.arange(float(epochs)), start, *ORBIT)
    shown = np.stack([measurement(known, truth[:, k], k) for k in range(epochs)], axis=1)
    guess = draw_guess(start, VARIANCE, rng.standard_normal(start.shape))
    return guess, shown + 1e-5 * rng.standard_normal(shown.shape), known


VARIANCE = 1e-4 * np.repeat([1.0, np.radians(1) ** 2, 1e-5, 0.5, 1.0], [6, 3, 4, 2, 15])
"""A good start, since the plain extended filter loses most runs from the paper's."""
STEREO_NOISE = np.diag(np.repeat([0.0, 3.5e-2, 0.0, 7e-5, 0.0], [3, 3, 0, 3, 21]) ** 2)


def numeric_jacobian(function: Callable[[Array], Array], x: Array) -> Array:
    """Return a Jacobian by central differences, a Python loop over the state."""
    columns = []
    for i in range(len(x)):
        step = np.zeros(len(x))
        step[i] = 1e-5
        columns.append((function(x + step) - function(x - step)) / 2e-5)
    return np.stack(columns, axis=-1)


def filterpy_extended(model: Model, guess: Array, measured: Array, numeric: bool) -> Array:
    """Return the states (time, n) of filterpy's extended filter on the same model, for one run."""
    assert model.process_jacobian is not None and model.measurement_jacobian is not None
    n, m = len(guess), measured.shape[-1]
    peer = ExtendedKalmanFilter(dim_x=n, dim_z=m)
    peer.x, peer.P = guess.copy(), np.diag(VARIANCE)
    peer.Q, peer.R = model.process_noise, model.measurement_noise
    states = []
    for k, y in enumerate(measured):
        if k > 0:
            peer.F = (
                numeric_jacobian(lambda x, k=k: model.process(x[None], k - 1)[0], peer.x)
                if numeric
                else model.process_jacobian(peer.x[None], k - 1)[0]
            )
            peer.x = model.process(peer.x[None], k - 1)[0]
            peer.P = peer.F @ peer.P @ peer.F.T + peer.Q
        peer.update(
            y,
            (lambda x, k=k: numeric_jacobian(lambda v: model.measurement(v[None], k)[0], x))
            if numeric
            else (lambda x, k=k: model.measurement_jacobian(x[None], k)[0]),
            lambda x, k=k: model.measurement(x[None], k)[0],
        )
        peer.x = model.retract(peer.x[None], np.zeros((1, n)))[0]
        states.append(peer.x.copy())
    return np.array(states)


def benchmark_extended(rounds: int, numeric: bool) -> Row:
    """Compare the extended filter, 100 runs at a time, with filterpy's."""
    guess, measured, known = stereo_pose(100, 40)
    model = additive_model(known, STEREO_NOISE, 1e-10 * np.eye(45))
    covariance = np.tile(np.diag(VARIANCE), (100, 1, 1))
    theirs = filterpy_extended(model, guess[0], measured[0, :8], numeric)
    ours = extended(model, guess[:1], covariance[:1], measured[:1, :8]).state[0]
    gap = np.abs(ours - theirs).max()
    kind = "loop over the state" if numeric else "our Jacobians"
    row = Row(f"extended filter, 100 / filterpy, {kind}", "run-step", [], [], f"{gap:.0e}")
    for _ in range(rounds):
        row.ours.append(cpu(lambda: extended(model, guess, covariance, measured)) / 4000)
        row.peer.append(
            cpu(lambda: filterpy_extended(model, guess[0], measured[0, :8], numeric)) / 8
        )
    return row


def benchmark_replay(rounds: int) -> Row:
    """Compare the replay filter on 100 runs at a time with one run at a time."""
    guess, measured, known = stereo_pose(100, 60)
    plain = np.concatenate([VARIANCE[:9], 4 * VARIANCE[9:12], VARIANCE[13:]])
    model = replay_model(known, np.full(45, 1e-5), np.sqrt(plain))
    covariance = np.tile(np.diag(plain), (100, 1, 1))
    alone = replay(model, guess[:1], covariance[:1], measured[:1])
    together = replay(model, guess, covariance, measured)
    gap = np.abs(alone.state[0] - together.state[0]).max()
    row = Row("replay filter, 100 at a time / one", "run", [], [], f"{gap:.0e}")
    for _ in range(rounds):
        row.ours.append(cpu(lambda: replay(model, guess, covariance, measured)) / 100)
        row.peer.append(cpu(lambda: replay(model, guess[:1], covariance[:1], measured[:1])))
    return row


# --- pose and shape: the 91-state filter against filterpy, and its cost over the points -----------

MEAN_MOTION = 1.078e-3
CUBATURE = UnscentedParameters(1.0, 0.0, 0.0)


def shape_run(runs: int, epochs: int, points: int) -> tuple[Model, Array, Array, Array]:
    """Return model, start and measurements (run, time, m) of a target of so many points."""
    rng, known = np.random.default_rng(4), Redundant(points, MEAN_MOTION, 5.0, 1000.0)
    rho = np.array([5.0, 17.3, 5.9, 9.3e-3, -1.078e-2, -1.1e-3])
    body = rng.uniform(-1, 1, (points, 3))
    seen = body + np.array([0.0, 0.0, np.linalg.norm(rho[:3])])
    core = [1.0, 0, 0, 0, *np.radians([0.6, 0.4, 1.0]), *rho, 135.4, 208.3, 260.4, 0, 0, 0]
    states = [np.concatenate([core, body.ravel(), seen.ravel()])[None]]
    for _ in range(epochs - 1):
        states.append(shape_process(known, states[-1]))
    sigma = np.repeat([1e-4, 1e-3, 0.3, 3e-3, 0.1, 0.1], [4, 3, 3, 3, 6, 6 * points])
    model = redundant_model(known, 1.04, 0.01)
    shown = np.concatenate([model.measurement(state, 0) for state in states])
    noise = np.sqrt(np.diag(model.measurement_noise)) * rng.standard_normal((runs, *shown.shape))
    guess = states[0] + sigma * rng.standard_normal((runs, len(sigma)))
    start = model.retract(guess, np.zeros_like(guess))
    return model, start, np.tile(np.diag(sigma**2), (runs, 1, 1)), shown + noise


def filterpy_shape(model: Model, state: Array, covariance: Array, measured: Array) -> Array:
    """Return the states (time, n) of filterpy's filter on the same model, for one run."""
    n, m = len(state), measured.shape[-1]
    points = MerweScaledSigmaPoints(n, alpha=1.0, beta=0.0, kappa=0.0)
    peer = UnscentedKalmanFilter(
        dim_x=n,
        dim_z=m,
        dt=5.0,
        fx=lambda x, _: model.process(x[None], 0)[0],
        hx=lambda x: model.measurement(x[None], 0)[0],
        points=points,
    )
    peer.x, peer.P = state.copy(), covariance.copy()
    peer.Q, peer.R = model.process_noise, model.measurement_noise
    states = []
    for epoch, y in enumerate(measured):
        if epoch > 0:
            peer.predict()
        peer.sigmas_f = points.sigma_points(peer.x, peer.P)
        peer.update(y)
        peer.x = model.retract(peer.x[None], np.zeros((1, n)))[0]
        states.append(peer.x.copy())
    return np.array(states)


def benchmark_shape(runs: int, rounds: int) -> Row:
    """Compare the filter of 12 points, 91 states and 183 sigma points with filterpy's."""
    model, start, covariance, measured = shape_run(runs, 12, 12)
    one = start[0], covariance[0], measured[0, :6]
    theirs = filterpy_shape(model, *one)
    ours = unscented(
        model, start[:1], covariance[:1], measured[:1, :6], CUBATURE, redraw=True
    ).state[0]
    gap = np.abs(ours - theirs).max()
    assert gap < 1e-6, f"filterpy's states differ by {gap}"
    row = Row(f"91-state filter, {runs} at a time / filterpy", "run-step", [], [], f"{gap:.0e}")
    for _ in range(rounds):
        seconds = cpu(lambda: unscented(model, start, covariance, measured, CUBATURE, redraw=True))
        row.ours.append(seconds / (12 * runs))
        row.peer.append(cpu(lambda: filterpy_shape(model, *one)) / 6)
    return row


def shape_seconds(problem: tuple[Model, Array, Array, Array], rounds: int) -> float:
    """Return the CPU seconds of the filter over all epochs, the median of the rounds."""
    times = [cpu(lambda: unscented(*problem, CUBATURE, redraw=True)) for _ in range(rounds)]
    return float(np.median(times))


def cost_over_points(rounds: int) -> Table:
    """Return the CPU milliseconds per run and step for several numbers of points."""
    table = Table("points", "states", "sigma points", "ms per run-step, 20 runs", "one run")
    for points in (6, 12, 24, 48):
        shown = []
        for runs, epochs in ((20, 8), (1, 20)):
            seconds = shape_seconds(shape_run(runs, epochs, points), rounds)
            shown.append(f"{1e3 * seconds / (runs * epochs):.2f}")
        n = 6 * points + 19
        table.add_row(str(points), str(n), str(2 * n + 1), *shown)
    return table


# --- basis pursuit against spgl1 --------------------------------------------------------------


def gapped_signals(hypotheses: int) -> tuple[Array, BoolArray]:
    """Return noisy quaternions (hypothesis, component, time) of 1500 s with random gaps."""
    q, _ = torque_free(np.arange(1500.0), np.array([1.0, 0, 0, 0]), RATE, MOMENTS)
    rng = np.random.default_rng(2)
    seen = np.repeat(rng.random(75) < 0.8, 20)
    noisy = q.T + 0.014 * rng.standard_normal((hypotheses, 4, 1500))
    return np.where(seen, noisy, 0.0), seen


def spgl1_objective(
    sample: Array, seen: BoolArray, length: int, tau: float, penalty: float, iterations: int
) -> float:
    """Return the lasso's objective that spgl1 reaches when it is told the right l1 norm."""
    samples = len(sample)

    def synthesise(x: Array) -> Array:
        return np.asarray(length * ifft(x)[:samples][seen])

    def analyse(y: Array) -> Array:
        spread = np.zeros(samples, complex)
        spread[seen] = y
        return np.asarray(fft(spread, length))

    shape = (int(seen.sum()), length)
    operator = LinearOperator(shape, matvec=synthesise, rmatvec=analyse, dtype=complex)
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        x, *_ = spg_lasso(
            operator, sample[seen].astype(complex), tau, iter_lim=iterations, verbosity=0
        )
    misfit = sample[seen] - synthesise(x)
    return float(0.5 * np.sum(np.abs(misfit) ** 2) + penalty * np.abs(x).sum())


def benchmark_salsa(rounds: int) -> Row:
    """Compare 16 hypotheses of 4 components at once with spgl1, one signal at a time."""
    length, penalty, hypotheses = 3000, 0.5, 16
    samples, seen = gapped_signals(hypotheses)

    def ours(iterations: int, tolerance: float = 0.0) -> object:
        return basis_pursuit(samples, seen, length, penalty, 0.1, iterations, tolerance=tolerance)

    exact = basis_pursuit(samples, seen, length, penalty, 0.1, 5000, tolerance=1e-8)
    iterations = next(
        count
        for count in range(5, 400, 5)
        if np.all(
            basis_pursuit(samples, seen, length, penalty, 0.1, count, tolerance=0.0).objective
            < (1 + GAP) * exact.objective
        )
    )
    signal, goal = samples[0, 0], float(exact.objective[0, 0])
    tau = float(l1_norm(exact.coefficients[0, 0], length))
    limit = next(
        count
        for count in (10, 15, 20, 30, 40, 60, 80, 120, 160, 240, 320, 640)
        if spgl1_objective(signal, seen, length, tau, penalty, count) < (1 + GAP) * goal
    )
    row = Row(
        f"basis pursuit, {hypotheses} x 4 ({iterations} its) / spgl1 lasso ({limit} its)",
        "signal",
        [],
        [],
        f"{GAP:.0e}",
    )
    for _ in range(rounds):
        row.ours.append(cpu(lambda: ours(iterations)) / (4 * hypotheses))
        row.peer.append(cpu(lambda: spgl1_objective(signal, seen, length, tau, penalty, limit)))
    return row


# --- growth -----------------------------------------------------------------------------------


def growth(rounds: int) -> Table:
    """Return the exponents with which the CPU time of a whole call grows."""

    def of_unscented(runs: int, epochs: int) -> float:
        problem = tumbling(runs, epochs)
        return min(cpu(lambda: unscented(*problem, redraw=True)) for _ in range(rounds))

    def of_replay(runs: int, epochs: int) -> float:
        guess, measured, known = stereo_pose(runs, epochs)
        plain = np.concatenate([VARIANCE[:9], 4 * VARIANCE[9:12], VARIANCE[13:]])
        model = replay_model(known, np.full(45, 1e-5), np.sqrt(plain))
        covariance = np.tile(np.diag(plain), (runs, 1, 1))
        return min(cpu(lambda: replay(model, guess, covariance, measured)) for _ in range(rounds))

    def of_shape(points: int) -> float:
        return shape_seconds(shape_run(20, 8, points), rounds)

    table = Table("filter", "more", "from", "to", "exponent")
    for name, what, seconds, first, last in (
        ("unscented", "runs", lambda n: of_unscented(n, 60), 100, 400),
        ("unscented", "epochs", lambda n: of_unscented(100, n), 50, 200),
        ("replay", "runs", lambda n: of_replay(n, 30), 20, 80),
        ("replay", "epochs", lambda n: of_replay(20, n), 30, 120),
        ("91 states", "features", of_shape, 12, 24),
    ):
        exponent = math.log(seconds(last) / seconds(first)) / math.log(last / first)
        table.add_row(name, what, str(first), str(last), f"{exponent:.2f}")
    return table


# --- the command line -------------------------------------------------------------------------


def help_seconds(rounds: int) -> list[float]:
    """Return the CPU seconds that ``debrisest --help`` takes, process start included."""
    seconds = []
    for _ in range(rounds):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [sys.executable, "-m", "debrisest", "--help"], check=True, stdout=subprocess.DEVNULL
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds.append(after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime)
    return seconds


def main(rounds: int = 5) -> None:
    """Print one row per comparison: medians, and the ratios' range over the rounds."""
    compiled = [] if compiled_states is None else [100, 1]
    rows = [
        benchmark_unscented(100, 100, rounds),
        benchmark_unscented(1, 300, rounds),
        *(benchmark_compiled(runs, 100, rounds) for runs in compiled),
        benchmark_extended(rounds, numeric=True),
        benchmark_extended(rounds, numeric=False),
        benchmark_replay(rounds),
        benchmark_shape(20, rounds),
        benchmark_shape(1, rounds),
        benchmark_salsa(rounds),
    ]
    table = Table("comparison", "per", "ours, us", "peer, us", "ratio (range)", "results agree to")
    for row in rows:
        ratios = np.array(row.peer) / np.array(row.ours)
        table.add_row(
            row.name,
            row.unit,
            f"{1e6 * np.median(row.ours):.0f}",
            f"{1e6 * np.median(row.peer):.0f}",
            f"{np.median(ratios):.2g} ({ratios.min():.2g}-{ratios.max():.2g})",
            row.agreement,
        )
    console = Console(width=120)
    console.print(table)
    console.print("The filter of pose and shape with every point in two frames, cost over points:")
    console.print(cost_over_points(rounds))
    console.print("Exponents of growth of a whole call:")
    console.print(growth(rounds))
    if compiled_states is None:
        console.print("numba is not installed: nothing was compared with compiled loops")
    seconds = help_seconds(rounds)
    console.print(f"debrisest --help: {np.median(seconds):.3f} s of CPU")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
