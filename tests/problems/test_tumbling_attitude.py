"""The problem of a tumbling body against textbook equations and another integrator."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from debrisest.assessment.principal_axes import RELABELINGS
from debrisest.clock import Clock
from debrisest.dynamics import integrators
from debrisest.parts.filters.kalman import Unscented
from debrisest.problems.tumbling import attitude as problem
from debrisest.roles import Given

BODIES = {
    "tumbling": ([0.618, 0.707, 0.345], [0.126, 0.096, -0.028]),
    "slender": ([0.295, 0.781, 0.551], [0.126, 0.004, -0.230]),
    "about_the_middle": ([0.3, 0.5, 0.7], [1e-3, 0.2, 1e-3]),
    "symmetric": ([0.7, 0.7, 0.3], [0.1, 0.05, 0.2]),
}


def rk4(state: np.ndarray, step: float) -> np.ndarray:
    return problem.process(np.array([state, state]), step, integrators.rk4_step)[0]


def euler(state: np.ndarray, step: float) -> np.ndarray:
    return problem.process(np.array([state, state]), step, integrators.euler_step)[0]


def change(state: np.ndarray) -> np.ndarray:
    """Return the time derivative, which is what one Euler step of one second adds."""
    return euler(state, 1.0) - state


def unit(values: Any) -> np.ndarray:
    values = np.asarray(values, dtype=float)
    return values / np.linalg.norm(values, axis=-1, keepdims=True)


def state_of(moments: Any, rate: Any) -> np.ndarray:
    q_ib, q_bf = unit([0.5, -0.1, 0.7, 0.3]), unit([0.9, 0.2, -0.3, 0.1])
    return np.concatenate([q_ib, q_bf, rate, unit(moments)])


def textbook(moments: Any, rate: Any, times: np.ndarray, sign: float = -1.0) -> np.ndarray:
    """Rates of ``J w' = sign (w x J w)``; the laws of physics have the minus."""
    inertia = np.diag(moments)

    def law(_: float, w: np.ndarray) -> np.ndarray:
        return np.linalg.solve(inertia, sign * np.cross(w, inertia @ w))

    return solve_ivp(law, times[[0, -1]], rate, "DOP853", times, rtol=1e-12, atol=1e-13).y.T


def attitudes(moments: Any, rate: Any, start: np.ndarray, times: np.ndarray) -> Rotation:
    """Attitude by integrating the matrix ``R' = R [w]``, an independent description."""
    inertia = np.diag(moments)

    def motion(_: float, x: np.ndarray) -> np.ndarray:
        w, matrix = x[:3], x[3:].reshape(3, 3)
        cross = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
        change = np.linalg.solve(inertia, np.cross(inertia @ w, w))
        return np.concatenate([change, (matrix @ cross).ravel()])

    first = np.concatenate([rate, Rotation.from_quat(start, scalar_first=True).as_matrix().ravel()])
    found = solve_ivp(motion, times[[0, -1]], first, "DOP853", times, rtol=1e-11, atol=1e-12)
    return Rotation.from_matrix(found.y[3:].T.reshape(-1, 3, 3))


def propagated(step: Any, state: np.ndarray, times: np.ndarray) -> np.ndarray:
    states = [state]
    for _ in times[1:]:
        states.append(step(states[-1], times[1] - times[0]))
    return np.array(states)


@pytest.mark.parametrize("name", BODIES)
def test_runge_kutta_follows_the_textbook(name: str) -> None:
    moments, rate = BODIES[name]
    times = np.arange(0.0, 60.0, 0.2)
    states = propagated(rk4, state_of(moments, rate), times)
    assert states[:, problem.RATE] == pytest.approx(textbook(moments, rate, times), abs=2e-7)
    truth = attitudes(moments, rate, states[0, problem.Q_IB], times)
    found = Rotation.from_quat(states[:, problem.Q_IB], scalar_first=True)
    assert (found.inv() * truth).magnitude().max() < 2e-6
    for constant in (problem.Q_BF, problem.MOMENTS):
        assert (states[:, constant] == states[0, constant]).all()


@pytest.mark.parametrize(("step", "order"), [(rk4, 4), (euler, 1)])
def test_the_steps_have_their_order(step: Any, order: int) -> None:
    moments, rate = BODIES["slender"]
    errors = []
    for length in (0.08, 0.04):  # so short that no step is divided
        times = np.arange(0.0, 20.0 + length / 2, length)
        last = propagated(step, state_of(moments, rate), times)[-1, problem.RATE]
        errors.append(np.linalg.norm(last - textbook(moments, rate, np.array([0, 20.0]))[-1]))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.4)


positive = st.floats(0.1, 3.0)
moments_of_bodies = st.tuples(positive, positive, positive).map(
    lambda m: np.array([m[1] + m[2], m[0] + m[2], m[0] + m[1]])
)
vectors = st.tuples(*[st.floats(-1, 1)] * 3).map(np.array)


@given(moments_of_bodies, vectors)
def test_the_derivative_is_eulers_equation(moments: np.ndarray, rate: np.ndarray) -> None:
    inertia = np.diag(moments)
    torque_free = np.linalg.solve(inertia, -np.cross(rate, inertia @ rate))
    found = change(state_of(moments, rate))
    assert found[problem.RATE] == pytest.approx(torque_free, abs=1e-12)
    assert found[problem.Q_IB] @ state_of(moments, rate)[problem.Q_IB] == pytest.approx(
        0, abs=1e-14
    )
    assert not found[problem.Q_BF].any()
    assert not found[problem.MOMENTS].any()


@given(moments_of_bodies, vectors)
def test_energy_and_momentum_do_not_change(moments: np.ndarray, rate: np.ndarray) -> None:
    added = change(state_of(moments, rate))[problem.RATE]
    assert (moments * rate) @ added == pytest.approx(0, abs=1e-11)
    assert (moments**2 * rate) @ added == pytest.approx(0, abs=1e-11)


@given(st.integers(0, 23), moments_of_bodies, vectors)
def test_relabeled_axes_move_alike(index: int, moments: np.ndarray, rate: np.ndarray) -> None:
    turn = RELABELINGS[index]
    plain = change(state_of(moments, rate))[problem.RATE]
    turned = change(state_of(np.abs(turn) @ moments, turn @ rate))[problem.RATE]
    assert turned == pytest.approx(turn @ plain, abs=1e-12)


def test_leading_axes_are_a_batch() -> None:
    states = np.stack([state_of(*body) for body in BODIES.values()]).reshape(2, 2, 14)
    each = np.array([[rk4(state, 0.5) for state in row] for row in states])
    assert problem.process(states, 0.5, integrators.rk4_step) == pytest.approx(each, abs=1e-15)


@pytest.mark.parametrize(
    "shape",
    [
        *((14,), (1, 14), (1, 1, 14)),
        *((2, 14), (1, 29, 14)),
    ],
)
def test_a_step_leaves_its_argument_alone(shape: tuple[int, ...]) -> None:
    states = np.broadcast_to(state_of(*BODIES["slender"]), shape).copy()
    before = states.copy()
    problem.process(states, 0.5, integrators.rk4_step)
    assert np.array_equal(states, before)


# the sign of the printed Eq 29: J w' = +w x J w


def ratios(moments: Any) -> np.ndarray:
    """``r_i = (J_j - J_k) / J_i``, all that the rates know of the inertia."""
    a, b, c = moments
    return np.array([(b - c) / a, (c - a) / b, (a - b) / c])


def with_opposite_ratios(moments: Any) -> np.ndarray:
    """The inertia whose ratios are the negative of the given ones.

    The three equations ``J_j - J_k + r_i J_i = 0`` are linear in J and have a common solution.
    """
    r1, r2, r3 = -ratios(moments)
    system = np.array([[-r1, 1.0, -1.0], [-1.0, -r2, 1.0], [1.0, -1.0, -r3]])
    *_, right = np.linalg.svd(system)
    return np.abs(unit(right[-1]))


@pytest.mark.parametrize("name", ["tumbling", "slender"])
def test_the_printed_sign_hides_in_another_inertia(name: str) -> None:
    moments, rate = BODIES[name]
    times = np.arange(0.0, 60.0, 0.5)
    other = with_opposite_ratios(moments)
    assert ratios(other) == pytest.approx(-ratios(moments), abs=1e-12)
    assert 2 * other.max() < other.sum()
    assert np.abs(other - unit(moments)).max() > 0.02
    physical = textbook(moments, rate, times)
    printed = textbook(moments, rate, times, sign=+1.0)
    assert np.abs(printed - physical).max() > 0.02
    assert textbook(other, rate, times, sign=+1.0) == pytest.approx(physical, abs=1e-9)
    ours = propagated(rk4, state_of(moments, rate), times)[:, problem.RATE]
    assert np.abs(ours - physical).max() < 1e-5 < np.abs(ours - printed).max()


@given(moments_of_bodies)
def test_opposite_ratios_belong_to_a_body(moments: np.ndarray) -> None:
    if np.abs(ratios(moments)).max() < 0.99:
        other = with_opposite_ratios(moments)
        assert (other > 0).all()
        assert 2 * other.max() <= other.sum() + 1e-9


# what is measured


def test_the_measurement_is_the_product_of_both_attitudes() -> None:
    state = state_of(*BODIES["tumbling"])
    q_ib, q_bf = (Rotation.from_quat(state[b], scalar_first=True) for b in (slice(4), slice(4, 8)))
    measured = Rotation.from_quat(problem.measured_attitude(state), scalar_first=True)
    assert (measured.inv() * q_ib * q_bf).magnitude() < 1e-14


quaternions = st.tuples(*[st.floats(-1, 1)] * 4).map(np.array)


@given(quaternions, quaternions)
def test_the_innovation_does_not_know_signs(measured: np.ndarray, predicted: np.ndarray) -> None:
    innovation = problem.sign_free_innovation(measured, predicted)
    nearer = min(np.linalg.norm(measured - predicted), np.linalg.norm(measured + predicted))
    assert np.linalg.norm(innovation) == pytest.approx(nearer, abs=1e-12)
    if abs(measured @ predicted) > 1e-12:
        assert np.array_equal(problem.sign_free_innovation(-measured, predicted), innovation)


def test_what_was_not_observed_stays_nan() -> None:
    predicted = unit([[1.0, 2, 3, 4], [4, 3, 2, 1]])
    measured = np.stack([np.full(4, np.nan), -predicted[1]])
    innovation = problem.sign_free_innovation(measured, predicted)
    assert np.isnan(innovation[0]).all()
    assert innovation[1] == pytest.approx(np.zeros(4))


@given(st.integers(0, 2**32))
def test_a_correction_keeps_the_norms(seed: int) -> None:
    rng = np.random.default_rng(seed)
    state = np.broadcast_to(state_of(*BODIES["slender"]), (3, 14))
    before = state.copy()
    corrected = problem.correct(state, 0.1 * rng.standard_normal((3, 14)))
    for block in (problem.Q_IB, problem.Q_BF, problem.MOMENTS):
        assert np.linalg.norm(corrected[:, block], axis=-1) == pytest.approx(np.ones(3))
    assert np.array_equal(state, before)


# assessment

COVARIANCE = [1e-6, 4e-6, 2e-6]
"""Of the rate, in the axes of the estimate."""


def estimate(turn: np.ndarray, moments: np.ndarray, offset: np.ndarray) -> dict[str, np.ndarray]:
    """A perfect estimate in relabeled axes, but for an offset of the rate."""
    times = np.arange(0.0, 30.0, 1.0)
    rate = textbook(moments, [0.12, 0.1, -0.05], times) * 1.0
    truth = attitudes(moments, [0.12, 0.1, -0.05], np.array([1.0, 0, 0, 0]), times)
    to_body = Rotation.from_matrix(turn)
    points = np.array([[1.0, 0, 0.5], [0, 1.2, -0.4], [-1, 0, 0.7]])
    x = unit(points[1] - points[0])
    y = unit(np.cross(x, points[2] - points[0]))
    frame = Rotation.from_matrix(np.stack([x, y, np.cross(x, y)], axis=-1))
    runs = {
        "true_q_ib": truth.as_quat(scalar_first=True),
        "true_rate_b": rate,
        "true_inertia_b": np.diag(moments),
        "true_point_b": points,
        "q_ib": (truth * to_body.inv()).as_quat(scalar_first=True),
        "q_bf": np.tile((to_body * frame).as_quat(scalar_first=True), (30, 1)),
        "rate_b": (rate + offset) @ turn.T,
        "moments_b": np.tile(np.abs(turn) @ unit(moments), (30, 1)),
        "covariance": np.tile(np.diag([9.0] * 8 + COVARIANCE + [9.0] * 3), (2, 1, 1)),
    }
    kept = {"time_s": times, "covariance_time_s": times[[20, 29]]}
    return {name: value[None] for name, value in runs.items()} | kept


MODEL = problem.TumblingAttitude.model_construct()


@pytest.mark.parametrize("index", range(0, 24, 5))
def test_a_perfect_estimate_has_no_error_in_whatever_axes(index: int) -> None:
    """The moments follow the permutation without its signs: a negative moment is no moment."""
    moments, offset = np.array([0.7, 0.5, 0.3]), np.array([1e-3, -2e-3, 3e-3])
    errors = MODEL.assess(estimate(RELABELINGS[index], moments, offset), (10.0, 30.0))
    assert np.array_equal(errors["relabeling"][0], RELABELINGS[index].T)
    for axis in range(3):
        assert np.abs(errors[f"inertia_{axis + 1}"]).max() < 1e-12
        assert errors[f"rate_{axis + 1}"] == pytest.approx(np.full((1, 30), offset[axis]))
    assert errors["rate"] == pytest.approx(np.full((1, 30), np.linalg.norm(offset)))
    assert errors["attitude"].max() < 1e-6
    assert np.abs(errors["pitch"]).max() < 1e-6
    assert (errors["convergence_time"] == 0).all()
    in_own_axes = RELABELINGS[index] @ offset
    assert errors["nees"][0, [20, 29]] == pytest.approx(np.mean(in_own_axes**2 / COVARIANCE))
    assert np.isnan(errors["nees"][0, :20]).all()
    assert errors["nees_dof"][0].tolist() == [3 * (k in (20, 29)) for k in range(30)]


def test_without_truth_there_are_no_errors() -> None:
    data = estimate(np.eye(3), np.array([0.7, 0.5, 0.3]), np.zeros(3))
    seen = {name: value for name, value in data.items() if not name.startswith("true_")}
    assert not MODEL.assess(seen, (10.0, 30.0))


def test_the_covariances_that_nees_needs_are_kept() -> None:
    clock, state = Clock.regular(10.0, 0.5), state_of(*BODIES["slender"])[None]
    noise = problem.Variances(q_ib=1e-6, q_bf=1e-6, rate_rad2_s2=1e-6, moments=1e-6)
    model = problem.TumblingAttitude(
        kind="tumbling_attitude", integrator="rk4", process_noise=noise, measurement_noise=1e-2
    ).model({}, clock)
    measured = np.broadcast_to(problem.measured_attitude(state)[:, None], (1, 20, 4))
    given_ = Given(state, noise.diagonal()[None], measured, clock)
    found = Unscented(kind="unscented", keep_s=[7.2, 3.0]).run(model, given_)
    assert found.kept.tolist() == [6, 14, 19]
    for slot, epoch in enumerate(found.kept):
        variance = np.diagonal(found.covariance[0, slot])
        assert variance == pytest.approx(found.sigma[0, epoch] ** 2)


@pytest.mark.parametrize("field", ["q_ib", "q_bf", "rate_rad2_s2", "moments"])
def test_variances_are_positive(field: str) -> None:
    given_ = {"q_ib": 1.0, "q_bf": 2.0, "rate_rad2_s2": 3.0, "moments": 4.0}
    diagonal = np.diag(problem.Variances(**given_).diagonal())
    assert diagonal.tolist() == [1.0] * 4 + [2.0] * 4 + [3.0] * 3 + [4.0] * 3
    with pytest.raises(ValueError, match="greater than 0"):
        problem.Variances(**(given_ | {field: 0.0}))
