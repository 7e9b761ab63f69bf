"""The replay filter on linear models, where it is the Kalman filter, and its outcomes as values."""

import numpy as np
import pytest
from scipy.optimize import least_squares, lsq_linear

from debrisest.filters.replay.gauss_newton import gauss_newton
from debrisest.filters.replay.measured_arc import linearize, measured_arc
from debrisest.filters.replay.replay import anchors, replay, smooth
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.status import ReplayStatus
from tests.filters.constants import constants

F = np.array([[1.0, 0.5], [-0.1, 0.95]])
H = np.array([[1.0, 0.0], [0.3, 1.0], [0.0, -2.0]])
SIGMA = np.array([0.5, 1.0, 2.0])
RUNS, EPOCHS = 4, 12
COVARIANCE = np.array([[4.0, 0.5], [0.5, 1.0]])


def power(k):
    return np.linalg.matrix_power(F if k >= 0 else np.linalg.inv(F), abs(k))


def linear_model(shape=lambda x: x, slope=lambda x: np.ones_like(x)):
    """``y = H shape(x)``; sensitivities are the transition matrices, and the chart is skewed."""
    skew = np.array([[1.0, 2.0], [0.0, 1.0]])

    def trajectory(state, first, last):
        ks = range(first, last + 1) if last >= first else range(first, last - 1, -1)
        matrices = np.array([power(k - first) for k in ks])
        states = (matrices @ state[:, None, :, None])[..., 0]
        return states, np.broadcast_to(matrices, (len(state), *matrices.shape))

    def rows(states, sensitivity, first, epochs):
        assert states.shape[1] == len(epochs)
        return shape(states) @ H.T, (H * slope(states)[..., None, :]) @ sensitivity

    return ReplayModel(
        trajectory=trajectory,
        rows=rows,
        transition=lambda sensitivity, first, last: sensitivity,
        rewind=lambda state, epoch: state @ power(-epoch).T,
        chart=lambda state: np.broadcast_to(skew, (len(state), 2, 2)),
        inverse_chart=lambda state: np.broadcast_to(np.linalg.inv(skew), (len(state), 2, 2)),
        retract=lambda state, error: state + error @ np.linalg.inv(skew).T,
        difference=lambda state, reference: (state - reference) @ skew.T,
        plain_difference=lambda state, reference: state - reference,
        start=lambda prior, shown, epoch: prior,
        sigma=SIGMA,
        error_names=("a", "b"),
    )


def data(seed, shape=lambda x: x):
    rng = np.random.default_rng(seed)
    prior = rng.normal(size=(RUNS, 2))
    truth = prior + rng.normal(size=(RUNS, 2)) @ np.linalg.cholesky(COVARIANCE).T
    states = np.stack([truth @ power(k).T for k in range(EPOCHS)], axis=1)
    measured = shape(states) @ H.T + SIGMA * rng.normal(size=(RUNS, EPOCHS, 3))
    return prior, np.tile(COVARIANCE, (RUNS, 1, 1)), measured, truth


def kalman(prior, covariance, measured):
    """Textbook filter of one run; rows that are NaN are left out."""
    state, history = prior, []
    for k, y in enumerate(measured):
        if k:
            state, covariance = F @ state, F @ covariance @ F.T
        seen = ~np.isnan(y)
        h, nu = H[seen], y[seen] - H[seen] @ state
        s = h @ covariance @ h.T + np.diag(SIGMA[seen] ** 2)
        gain = covariance @ h.T @ np.linalg.inv(s)
        nis = nu @ np.linalg.solve(s, nu) if seen.any() else 0.0
        state, covariance = state + gain @ nu, covariance - gain @ s @ gain.T
        history.append((state, covariance, nis, seen.sum()))
    return history


@pytest.mark.parametrize("ratio", [1.0, 1.25, 2.0])
@pytest.mark.parametrize("missing", [False, True])
def test_it_is_the_kalman_filter_on_a_linear_model(ratio, missing):
    prior, covariance, measured, _ = data(0)
    if missing:
        measured[np.random.default_rng(1).random(measured.shape) < 0.4] = np.nan
        measured[:, :2] = np.nan
        measured[1, 7] = np.nan
    keep = [0, 5]
    estimates = replay(linear_model(), prior, covariance, measured, ratio=ratio, keep=keep)
    assert np.all(estimates.status == ReplayStatus.CONVERGED.sentence)
    np.testing.assert_array_equal(estimates.kept, [0, 5, EPOCHS - 1])
    for run in range(RUNS):
        expected = kalman(prior[run], covariance[run], measured[run])
        for k, (state, spread, nis, dof) in enumerate(expected):
            np.testing.assert_allclose(estimates.state[run, k], state, atol=1e-10)
            np.testing.assert_allclose(estimates.sigma[run, k] ** 2, np.diag(spread), rtol=1e-9)
            assert estimates.nis[run, k] == pytest.approx(nis, abs=1e-9)
            assert estimates.nis_dof[run, k] == dof
        for slot, k in enumerate(estimates.kept):
            np.testing.assert_allclose(estimates.covariance[run, slot], expected[k][1], atol=1e-10)


def test_the_smoother_is_the_least_squares_solution():
    prior, covariance, measured, _ = data(2)
    model = linear_model()
    filtered = replay(model, prior, covariance, measured)
    final = smooth(model, prior, covariance, measured, filtered, keep=range(EPOCHS))
    root = np.linalg.inv(np.linalg.cholesky(COVARIANCE))
    rows = np.concatenate([root, *(H @ power(k) / SIGMA[:, None] for k in range(EPOCHS))])
    spread = np.linalg.inv(rows.T @ rows)
    for run in range(RUNS):
        right = np.concatenate([root @ prior[run], (measured[run] / SIGMA).ravel()])
        start, cost, *_ = np.linalg.lstsq(rows, right)
        for k in range(EPOCHS):
            np.testing.assert_allclose(final.state[run, k], power(k) @ start, atol=1e-10)
            np.testing.assert_allclose(
                final.covariance[run, k], power(k) @ spread @ power(k).T, atol=1e-10
            )
        assert final.counts["cost"][run, -1] == pytest.approx(cost.item())


def test_anchors_are_spaced_geometrically():
    assert anchors(1, 100) == [1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 19, 24, 30, 37, 47, 58, 73, 91]
    assert anchors(3, 7, 1.0) == [3, 4, 5, 6]
    assert anchors(5, 5) == []


def test_what_is_not_finite_is_a_value():
    prior, covariance, measured, _ = data(3)
    prior[0, 1] = np.nan
    measured[2, 6, 0] = np.inf
    estimates = replay(linear_model(), prior, covariance, measured)
    converged = ReplayStatus.CONVERGED
    ends = [ReplayStatus.NO_START, converged, ReplayStatus.DIVERGED, converged]
    expected = [end.sentence for end in ends]
    np.testing.assert_array_equal(estimates.status, expected)
    np.testing.assert_array_equal(estimates.diverged_at, [0, -1, 6, -1])
    assert np.isnan(estimates.state[0]).all()
    assert np.isnan(estimates.state[2, 6:]).all()
    assert np.isfinite(estimates.state[2, :6]).all()
    clean = replay(linear_model(), prior[[1, 3]], covariance[[1, 3]], measured[[1, 3]])
    np.testing.assert_allclose(estimates.state[[1, 3]], clean.state, rtol=0, atol=1e-13)
    final = smooth(linear_model(), prior, covariance, measured, estimates)
    np.testing.assert_array_equal(final.status, expected)


@pytest.mark.parametrize("gate", [True, False])
def test_runs_that_all_lack_a_start_end_in_a_status(gate):
    prior, covariance, measured, _ = data(3)
    lost = replay(linear_model(), np.nan * prior, covariance, measured, gate=gate)
    final = smooth(linear_model(), np.nan * prior, covariance, measured, lost, gate=gate)
    for estimates in (lost, final):
        assert set(estimates.status) == {ReplayStatus.NO_START.sentence}
        assert np.isnan(estimates.state).all()


def test_without_measurements_the_prior_is_propagated():
    prior, covariance, measured, _ = data(4)
    measured[:] = np.nan
    estimates = replay(linear_model(), prior, covariance, measured)
    np.testing.assert_allclose(estimates.state[:, -1], prior @ power(EPOCHS - 1).T, atol=1e-10)
    assert np.all(estimates.nis_dof == 0)


def test_the_gate_finds_outliers_of_any_epoch():
    """Also of the first, which no innovation gives away under a vague prior."""
    prior, _, measured, _ = data(5)
    covariance = np.tile(1e4 * np.eye(2), (RUNS, 1, 1))
    clean = replay(linear_model(), prior, covariance, measured)
    spoilt = measured.copy()
    spoilt[:, 0, 0] += 60.0
    spoilt[:, 5, 1] -= 80.0
    model = linear_model()
    gated, open_ = (replay(model, prior, covariance, spoilt, gate=g) for g in (True, False))
    error = np.abs(gated.state[:, -1] - clean.state[:, -1])
    assert np.all(error < 2.0 * clean.sigma[:, -1])
    assert np.abs(open_.state[:, -1] - clean.state[:, -1]).max() > 5.0 * error.max()
    np.testing.assert_array_equal(gated.counts["rejected"][:, 5] >= 1, True)
    assert "rejected" not in open_.counts


def test_step_control_only_goes_down():
    """A cubic sensor and a poor prior: plain Gauss-Newton steps overshoot."""
    shape, slope = (lambda x: x**3), (lambda x: 3 * x**2)
    model = linear_model(shape, slope)
    prior, covariance, measured, truth = data(6, shape)
    arc = measured_arc(model, prior, covariance, measured)
    start = 0.05 * np.sign(truth)
    costs = [linearize(model, arc, start, 8).cost]
    for iterations in (2, 4, 8, 60):
        solution = gauss_newton(model, arc, start, 8, iterations)
        costs.append(solution.at.cost)
    assert np.all(np.diff(costs, axis=0) <= 0)
    assert solution.converged.all()
    at_truth = linearize(model, arc, truth, 8).cost
    assert np.median(solution.cost - at_truth) < 0


def test_wrong_shapes_are_refused():
    prior, covariance, measured, _ = data(7)
    with pytest.raises(ValueError, match="need a start covariance of shape"):
        replay(linear_model(), prior, covariance[..., :1], measured)
    with pytest.raises(ValueError, match="at least 1"):
        replay(linear_model(), prior, covariance, measured, ratio=0.5)
    with pytest.raises(ValueError, match="kept epochs"):
        replay(linear_model(), prior, covariance, measured, keep=[EPOCHS])


# costs


def rows_of(k):
    """What is least in a least squares fit of the state at epoch 0 to the epochs up to k."""
    root = np.linalg.inv(np.linalg.cholesky(COVARIANCE))
    return np.concatenate([root, *(H @ power(i) / SIGMA[:, None] for i in range(k + 1))]), root


def test_costs_are_those_of_the_least_squares_problem():
    """Of the estimate, which is its solution, and of any motion beside it."""
    prior, covariance, measured, truth = data(3)
    reference = truth
    options = {"ratio": 2.0, "keep": [3, 7], "reference": reference}
    found = replay(linear_model(), prior, covariance, measured, **options)
    final = smooth(linear_model(), prior, covariance, measured, found, reference=reference)
    for k, estimates in ((3, found), (7, found), (EPOCHS - 1, found), (EPOCHS - 1, final)):
        rows, root = rows_of(k)
        for run in range(RUNS):
            right = np.concatenate([root @ prior[run], (measured[run, : k + 1] / SIGMA).ravel()])
            _, least, *_ = np.linalg.lstsq(rows, right)
            assert estimates.counts["cost"][run, k] == pytest.approx(least.item(), rel=1e-9)
            other = np.sum((rows @ reference[run] - right) ** 2)
            assert estimates.counts["cost_of_truth"][run, k] == pytest.approx(other, rel=1e-9)
    assert np.isnan(np.delete(found.counts["cost_of_truth"], [3, 7, EPOCHS - 1], axis=1)).all()


def test_no_estimate_depends_on_the_motion_beside_it():
    prior, covariance, measured, truth = data(4)
    measured[1, 5] = 300.0
    for gate in (False, True):
        alone = replay(linear_model(), prior, covariance, measured, gate=gate, keep=[4])
        other = replay(
            linear_model(), prior, covariance, measured, gate=gate, keep=[4], reference=truth
        )
        for name in ("state", "sigma", "covariance", "nis"):
            np.testing.assert_array_equal(getattr(alone, name), getattr(other, name))
        np.testing.assert_array_equal(alone.counts["cost"], other.counts["cost"])
        assert "cost_of_truth" not in alone.counts


def test_what_the_gate_rejects_counts_in_neither_cost():
    """An outlier in both costs would not move their difference; in one, by thousands."""
    prior, covariance, measured, truth = data(5)
    clean = replay(linear_model(), prior, covariance, measured, gate=True, reference=truth)
    wild = measured.copy()
    wild[:, 6, 0] += 200 * SIGMA[0]
    gated = replay(linear_model(), prior, covariance, wild, gate=True, reference=truth)
    for estimates in (clean, gated):
        assert estimates.counts["cost"][:, -1].max() < 200
        excess = estimates.counts["cost_of_truth"][:, -1] - estimates.counts["cost"][:, -1]
        assert excess.min() > -1e-6
        assert excess.max() < 40


def test_a_limited_state_is_the_best_within_its_limit():
    """As a bounded least squares solver has it: what is free makes up for what is held."""
    prior, covariance, measured, _ = data(8)
    model, limit = linear_model(), 0.5 * prior[:, 0].min()
    whole = model.retract

    def cut(state, error):
        moved = whole(state, error)
        moved[:, 0] = np.minimum(moved[:, 0], limit)
        return moved

    def excess(state, step):
        rows = np.tile([[[1.0, 0.0]]], (len(state), 1, 1))
        return rows, np.minimum(limit - state[:, :1] - step[:, :1], 0.0)

    arc = measured_arc(model, prior, covariance, measured)
    begin = np.minimum(prior, limit)
    limited = model._replace(retract=cut, excess=excess)
    solution = gauss_newton(limited, arc, begin, EPOCHS - 1, 10)
    assert solution.converged.all()
    found = solution.at.state + solution.step
    rows, root = rows_of(EPOCHS - 1)
    held = 0
    for run in range(RUNS):
        right = np.concatenate([root @ prior[run], (measured[run] / SIGMA).ravel()])
        best = lsq_linear(rows, right, (-np.inf, [limit, np.inf]), tol=1e-14)
        np.testing.assert_allclose(found[run], best.x, atol=1e-6)
        assert solution.cost[run] == pytest.approx(2.0 * best.cost, rel=1e-9)
        held += abs(best.x[0] - limit) < 1e-9
    assert 0 < held < RUNS


def test_of_two_limits_one_may_undo_the_other():
    """Two numbers in a box that nearly are one: held in the one, the other may go back inside."""
    rng, runs = np.random.default_rng(12), 300
    shown = np.array([[1.0, 0.95, 0.3], [0.9, 1.0, -0.2], [0.2, -0.3, 1.0], [0.1, 0.1, 0.1]])

    def cut(state):
        return np.concatenate([np.clip(state[..., :2], -1.0, 1.0), state[..., 2:]], -1)

    def rows(states, sensitivity, first, epochs):
        derivative = np.broadcast_to(shown, (*states.shape[:-1], *shown.shape))
        return (derivative @ states[..., None])[..., 0], derivative

    def excess(state, step):
        asked = state + step
        return np.tile(np.eye(3)[:2], (len(state), 1, 1)), (cut(asked) - asked)[:, :2]

    model = constants(rows, np.full(4, 0.5), ("a", "b", "c"), excess=excess)
    model = model._replace(retract=lambda state, error: cut(state + error))
    measured = 2.0 * rng.normal(size=(runs, 1, 4))
    prior, covariance = np.zeros((runs, 3)), np.tile(4.0 * np.eye(3), (runs, 1, 1))
    arc = measured_arc(model, prior, covariance, measured)
    solution = gauss_newton(model, arc, prior, 0, 10)
    assert solution.converged.all()
    found, whole = solution.at.state + solution.step, np.concatenate([shown / 0.5, 0.5 * np.eye(3)])
    box = [-1.0, -1.0, -np.inf], [1.0, 1.0, np.inf]
    undone = 0
    for run in range(runs):
        right = np.concatenate([measured[run, 0] / 0.5, np.zeros(3)])
        best = lsq_linear(whole, right, box, tol=1e-14)
        np.testing.assert_allclose(found[run], best.x, atol=1e-6)
        free = np.linalg.lstsq(whole, right, rcond=None)[0]
        undone += bool(((np.abs(free[:2]) > 1.0) & (np.abs(best.x[:2]) < 0.99)).any())
    assert undone > 10, "limits that are undone are what is tested"


def test_nis_of_the_first_epoch_is_the_cost_that_is_left():
    """With a curved sensor, whose first linearisation promises something else."""
    shape, slope = (lambda x: x + 0.3 * x**3), (lambda x: 1 + 0.9 * x**2)
    prior, covariance, measured, _ = data(9, shape)
    found = replay(linear_model(shape, slope), prior, covariance, measured, keep=[0])
    root = np.linalg.inv(np.linalg.cholesky(COVARIANCE))
    for run in range(RUNS):

        def residual(x, run=run):
            shown = H @ shape(x)
            return np.concatenate([root @ (x - prior[run]), (measured[run, 0] - shown) / SIGMA])

        least = least_squares(residual, prior[run], xtol=1e-14, ftol=1e-14)
        assert found.nis[run, 0] == pytest.approx(2.0 * least.cost, abs=0.02)
