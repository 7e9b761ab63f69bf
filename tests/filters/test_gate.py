"""Innovation gate and lock-out detector, alone and in the extended filter."""

import numpy as np
import pytest
from scipy.stats import binom, chi2

from debrisest.filters.gate import Gate, Gatekeeper
from debrisest.filters.kalman.extended import extended
from debrisest.filters.model import Model

GROUPS = (7, 3, 7, 3, 3, 0, 3)
"""Of sizes 1, 2 and 4, so that the number of rejected components tells which groups they are."""

NEVER = 10**9


def probable(count, trials, rate, tail=1e-8):
    return binom.ppf(tail, trials, rate) <= count <= binom.ppf(1 - tail, trials, rate)


def covariances(rng, runs, m):
    root = rng.normal(size=(runs, m, m))
    return root @ np.swapaxes(root, -2, -1) + 0.1 * np.eye(m)


@pytest.mark.parametrize("groups", [GROUPS, None, (0,) * 7])
def test_groups_are_judged_by_their_own_chi_square(groups):
    """Group by group with the rows of missing components cut out."""
    rng = np.random.default_rng(0)
    total = covariances(rng, 40, 7)
    innovation = 2.5 * np.sqrt(np.diagonal(total, 0, 1, 2)) * rng.normal(size=(40, 7))
    measured = rng.random((40, 7)) < 0.7
    innovation[~measured] = np.nan
    total[~(measured[:, :, None] & measured[:, None])] = np.nan
    gate = Gate(false_alarm=0.05, lockout_epochs=NEVER)
    verdict = Gatekeeper(gate, groups, total, 7).judge(measured, innovation, total, total[0])
    accepted = verdict.accepted

    labels = np.arange(7) if groups is None else np.array(groups)
    expected = np.zeros_like(measured)
    for run in range(40):
        for label in set(labels):
            rows = np.flatnonzero((labels == label) & measured[run])
            nu = innovation[run, rows]
            squared = nu @ np.linalg.inv(total[run][np.ix_(rows, rows)]) @ nu
            expected[run, rows] = squared <= chi2.isf(0.05, max(len(rows), 1))
    assert np.array_equal(accepted, expected)
    assert 0 < accepted.sum() < measured.sum()


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("rate", [0.1, 0.003])
def test_good_data_are_rejected_at_the_theoretical_rate(rate, seed):
    rng = np.random.default_rng(seed)
    runs = 10000
    h, r = rng.normal(size=(7, 3)), covariances(rng, 1, 7)[0]
    x = rng.normal(size=(runs, 3))
    y = x @ h.T + rng.multivariate_normal(np.zeros(7), r, size=runs)
    model = Model(
        process=lambda x, _: x,
        measurement=lambda x, _: x @ h.T,
        process_noise=np.zeros((3, 3)),
        measurement_noise=r,
        error_names=("a", "b", "c"),
        measurement_jacobian=lambda x, _: h,
        gate_groups=GROUPS,
    )
    start, covariance = np.zeros((runs, 3)), np.stack([np.eye(3)] * runs)
    history = extended(model, start, covariance, y[:, None], gate=Gate(false_alarm=rate))
    rejected = history.counts["rejected"][:, 0]
    assert np.array_equal(history.nis_dof[:, 0], 7 - rejected)
    for size in (1, 2, 4):
        assert probable((rejected & size > 0).sum(), runs, rate)


F = np.eye(4) + np.eye(4, k=2)
H = np.eye(3, 4)
R = np.diag([0.25, 0.3, 0.2])
NAMES = ("x", "y", "v_x", "v_y")


def tracking(q):
    h = H.copy()
    h[2, :2] = 1.0
    return Model(lambda x, _: x @ F.T, lambda x, _: x @ h.T, q * np.eye(4), R, NAMES)


def campaign(q, seed=0, runs=20, epochs=60):
    rng = np.random.default_rng(seed)
    model = tracking(q)
    covariance = np.diag([4.0, 4.0, 0.1, 0.1])
    truth = np.empty((runs, epochs, 4))
    truth[:, 0] = rng.multivariate_normal(np.zeros(4), covariance, size=runs)
    for k in range(1, epochs):
        truth[:, k] = model.process(truth[:, k - 1], 0) + np.sqrt(q) * rng.normal(size=(runs, 4))
    noise = np.sqrt(np.diagonal(R)) * rng.normal(size=(runs, epochs, 3))
    start = np.zeros((runs, 4)), np.stack([covariance] * runs)
    return model, truth, start, model.measurement(truth, 0) + noise


@pytest.mark.parametrize("iterations", [1, 5])
def test_an_outlier_of_100_sigma_counts_as_missing(iterations):
    model, truth, start, y = campaign(q=1e-3)
    rng = np.random.default_rng(1)
    outlying = rng.random(y.shape) < 0.05
    signs = rng.choice([-1.0, 1.0], size=y.shape)
    spoiled = y + outlying * 100 * signs * np.sqrt(np.diagonal(R))
    gated = extended(model, *start, spoiled, gate=Gate(), iterations=iterations)
    missing = extended(model, *start, np.where(outlying, np.nan, y), iterations=iterations)
    assert np.array_equal(gated.counts["rejected"], outlying.sum(-1))
    assert np.array_equal(gated.nis_dof, missing.nis_dof)
    np.testing.assert_allclose(gated.state, missing.state, atol=1e-10)
    np.testing.assert_allclose(gated.covariance, missing.covariance, atol=1e-12)
    assert not gated.counts["reopened"].any()
    lost = extended(model, *start, spoiled, iterations=iterations)
    assert rms(lost.state - truth) > 5 * rms(gated.state - truth)


def test_a_gate_that_rejects_nothing_changes_nothing():
    model, _, start, y = campaign(q=1e-3)
    y[:, ::5, 1] = np.nan
    plain, gated = extended(model, *start, y), extended(model, *start, y, gate=Gate(1e-30))
    assert np.array_equal(plain.counts["updates"], gated.counts["updates"])
    assert not gated.counts["rejected"].any() and not gated.counts["reopened"].any()
    for a, b in zip(plain[:-1], gated[:-1]):
        assert np.array_equal(a, b)


def rms(error):
    return np.sqrt((error**2).mean())


def jumped(y, model, size, runs=slice(None, None, 2)):
    """By how much truth and measurements of some runs jump at epoch 30."""
    jump = np.zeros((*y.shape[:2], 4))
    jump[runs, 30:, 0] = size
    return jump, model.measurement(jump, 0)


@pytest.mark.parametrize("size, openings", [(30.0, 3), (500.0, 8)])
@pytest.mark.parametrize("q", [1e-6, 0.0])
@pytest.mark.parametrize("iterations", [1, 5])
def test_a_jump_locks_out_all_but_the_detector(iterations, q, size, openings):
    """Every other run jumps; two of its three components show it. Sigma was 2 at the start."""
    model, truth, start, y = campaign(q, epochs=120)
    jump, shown = jumped(y, model, size)
    rule = {"iterations": iterations}
    locked = extended(model, *start, y + shown, gate=Gate(lockout_epochs=NEVER), **rule)
    freed = extended(model, *start, y + shown, gate=Gate(), **rule)

    error = np.abs(locked.state - truth - jump)[::2, -1, 0]
    assert (error > 0.8 * size).all() and (locked.counts["rejected"][::2, 30:] == 2).all()
    assert not locked.counts["reopened"].any()

    assert (freed.counts["rejected"][::2, 30:33] == 2).all()
    reopened = freed.counts["reopened"][::2]
    assert ((reopened >= 1) & (reopened <= openings)).all()
    assert not freed.counts["rejected"][:, -40:].any()
    assert (np.abs(freed.state - truth - jump)[:, -1] < 6 * freed.sigma[:, -1]).all()
    assert (freed.sigma[:, :, :2] < 2).all()
    for name in ("state", "sigma", "nis", "rejected", "reopened"):
        first, second = ({**e._asdict(), **e.counts}[name] for e in (freed, locked))
        assert np.array_equal(first[1::2], second[1::2])


def test_a_gate_that_opens_still_keeps_an_outlier_out():
    model, _, start, y = campaign(q=1e-3)
    _, shown = jumped(y, model, 30.0, slice(None))
    y = y + shown
    y[:, 33, 1] += 1e5
    history = extended(model, *start, y, gate=Gate())
    y[:, 33, 1] = np.nan
    missing = extended(model, *start, y, gate=Gate())
    assert (history.counts["reopened"] >= 1).all()
    assert (history.counts["rejected"][:, 33] == 1).all()
    assert rms(history.state - missing.state) < 0.1 * rms(history.sigma)


def test_a_gate_that_doubt_cannot_widen_opens_all_the_same():
    """Both components are likely, their difference is not, whatever the factor."""
    noise = 0.001 * np.eye(2)
    total = np.full((1, 2, 2), 100.0) + noise
    keeper = Gatekeeper(Gate(lockout_epochs=1), (0, 0), total, 2)
    measured, innovation = np.ones((1, 2), dtype=bool), np.array([[3.0, -3.0]])
    first, second = (keeper.judge(measured, innovation, total, noise) for _ in range(2))
    assert not first.accepted.any() and not first.reopened[0]
    assert second.accepted.all() and second.reopened[0] and second.factor[0] == 1.0


def test_a_run_that_has_diverged_is_no_longer_counted():
    model, _, (start, covariance), y = campaign(q=1e-3)
    start[3] = np.nan
    y[:, 20:] += 1e3
    history = extended(model, start, covariance, y, gate=Gate())
    assert not history.counts["reopened"][3] and not history.counts["rejected"][3].any()
    assert (np.delete(history.counts["reopened"], 3) > 0).all()


def test_epochs_without_measurements_neither_add_to_a_lockout_nor_end_it():
    gate = Gate(lockout_epochs=3)
    one = np.ones((1, 2), dtype=bool)
    far, near, total = np.full((1, 2), 99.0), np.zeros((1, 2)), np.eye(2)[None]
    keeper = Gatekeeper(gate, None, total, 2)
    told = [
        keeper.judge(seen, nu, total, np.eye(2) / 2).reopened[0]
        for seen, nu in [
            *[(one, far), (one, far), (one, near)],
            *[(one, far), (~one, far), (one, far), (one, far), (~one, far)],
            *[(one, far), (one, far)],
        ]
    ]
    assert told == [False] * 8 + [True, False]


def test_a_minority_of_rejections_is_no_lockout():
    model, _, start, y = campaign(q=1e-3)
    y[:, 20:, 0] += 1e4
    history = extended(model, *start, y, gate=Gate())
    assert (history.counts["rejected"][:, 20:] == 1).all()
    assert not history.counts["reopened"].any()


def test_wrong_settings_are_refused():
    for wrong in (Gate(0.0), Gate(1.0), Gate(lockout_share=1.0), Gate(lockout_epochs=0)):
        with pytest.raises(ValueError, match="a gate needs"):
            Gatekeeper(wrong, None, R[None], 3)
    with pytest.raises(ValueError, match="3 components need as many gate groups, not 2"):
        Gatekeeper(Gate(), (0, 1), R[None], 3)
