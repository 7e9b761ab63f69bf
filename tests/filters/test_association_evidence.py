"""What innovations say against a model, from likelihoods of all the data and from counting."""

from itertools import pairwise

import numpy as np
import pytest

from debrisest.filters.association.companions import pairs
from debrisest.filters.association.evidence import score_correlation, score_sigma
from debrisest.filters.association.restless import FACTORS, log_ratio
from debrisest.filters.association.self_tests import agitation_test, companion_test, crowd_test
from debrisest.filters.association.single import associated
from debrisest.filters.association.weights import Validation
from debrisest.filters.doubt import Doubt
from debrisest.filters.scan_model import ScanModel
from debrisest.filters.self_test import score_test, scores_test

RUNS, EPOCHS = 400, 60
F = np.array([[1.0, 1.0], [0.0, 1.0]])
H = np.stack([np.eye(2), [[1.0, 0.5], [0.3, -1.0]]])
INPUT = np.array([0.5, 1.0])
Q = 1e-4 * np.outer(INPUT, INPUT)
R = np.diag([0.3, 0.5])
P0 = np.diag([4.0, 0.04])
COLUMNS = np.random.default_rng(5).normal(size=(EPOCHS, 2, 2, 2))
"""Derivative (epoch, sensor, d, doubt) of what is seen."""

MODEL = ScanModel(
    process=lambda x, _: x @ F.T,
    process_jacobian=lambda _x, _k: F,
    process_noise=Q,
    points=lambda x, _: (H @ x[..., None, :, None])[..., 0],
    points_jacobian=lambda _x, _k: H,
    noise=R,
    error_names=("x", "v"),
    doubts=(Doubt("a", 1.0), Doubt("b", 1.0)),
    doubted=lambda x, k: np.broadcast_to(COLUMNS[k], (*x.shape[:-1], 2, 2, 2)),
)


def causes(factor=1.0):
    """What start and accelerations do to all data (time sensor d) and to the last state.

    Each a column per unit normal number; accelerations are so many times as large as stated.
    """
    states = [np.linalg.matrix_power(F, k) @ P0**0.5 for k in range(EPOCHS)]
    kick = [np.linalg.matrix_power(F, k) @ (1e-2 * factor * INPUT) for k in range(EPOCHS)]
    moved = np.stack(
        [
            np.stack([kick[k - j] if k >= j else np.zeros(2) for j in range(1, EPOCHS)], 1)
            for k in range(EPOCHS)
        ]
    )
    every = np.concatenate([np.stack(states), moved], axis=-1)
    return (np.concatenate(H) @ every).reshape(4 * EPOCHS, -1), every[-1]


def covariance_of_all_data(factor=1.0):
    """Dense (time sensor d, time sensor d)."""
    shown, _ = causes(factor)
    return shown @ shown.T + np.kron(np.eye(2 * EPOCHS), R)


def drawn(seed, acceleration=1.0, doubt=(0.0, 0.0)):
    """Measurements (run, time, sensor, 1, 2) of motions that begin about zero."""
    rng = np.random.default_rng(seed)
    state = rng.normal(size=(RUNS, 2)) * P0.diagonal() ** 0.5
    shown = []
    for k in range(EPOCHS):
        noise = rng.normal(size=(RUNS, 2, 2)) * R.diagonal() ** 0.5
        shown.append(MODEL.points(state, k) + COLUMNS[k] @ doubt + noise)
        state = state @ F.T + 1e-2 * acceleration * rng.normal(size=(RUNS, 1)) * INPUT
    return np.stack(shown, axis=1)[:, :, :, None]


def followed(scans, model=MODEL):
    start = np.zeros((RUNS, 2)), np.tile(P0, (RUNS, 1, 1))
    return associated(model, *start, scans, Validation(), method="known").counts


def size_and_sigma(counts):
    size = counts["score"] / np.diagonal(counts["information"], 0, -2, -1)
    return size, size / sigmas(counts)


def all_together(counts):
    return scores_test(sigmas(counts), score_correlation(counts["information"]))


def sigmas(counts):
    return counts["score"] / score_sigma(counts["square"], counts["information"])


def test_scores_are_those_of_the_likelihood_of_all_data() -> None:
    scans = drawn(0)
    counts, dense = followed(scans), covariance_of_all_data()
    columns = COLUMNS.reshape(-1, 2)
    expected = scans.reshape(RUNS, -1) @ np.linalg.solve(dense, columns)
    np.testing.assert_allclose(counts["score"], expected, rtol=1e-8, atol=1e-8)
    information = columns.T @ np.linalg.solve(dense, columns)
    expected = np.tile(information, (RUNS, 1, 1))
    np.testing.assert_allclose(counts["information"], expected, rtol=1e-9)


@pytest.mark.parametrize("factor", FACTORS)
def test_likelihoods_of_the_bank_are_those_of_all_data(factor: float) -> None:
    scans = drawn(1)
    found = followed(scans)["likelihood"][:, np.flatnonzero(factor == FACTORS)[0]]
    total, flat = covariance_of_all_data(factor), scans.reshape(RUNS, -1)
    square = (flat * np.linalg.solve(total, flat.T).T).sum(-1)
    expected = -0.5 * (square + np.linalg.slogdet(total)[1])
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)


def test_the_mixture_is_that_of_two_least_squares_fits_to_all_data() -> None:
    scans = drawn(1, acceleration=1.7)
    flat, means, spreads, weights = scans.reshape(RUNS, -1), [], [], []
    for factor in FACTORS:
        shown, last = causes(factor)
        total = covariance_of_all_data(factor)
        white = np.linalg.solve(total, flat.T).T
        means.append(white @ shown @ last.T)
        spreads.append(
            last @ (np.eye(last.shape[1]) - shown.T @ np.linalg.solve(total, shown)) @ last.T
        )
        weights.append(-0.5 * (flat * white).sum(-1) - 0.5 * np.linalg.slogdet(total)[1])
    weight = 1.0 / (1.0 + np.exp(np.array(weights[::-1]) - weights))
    assert 0.05 < np.median(weight[1]) < 0.95
    mean = (weight[..., None] * means).sum(0)
    apart = np.array(means) - mean
    spread = np.array(spreads)[:, None] + apart[..., :, None] * apart[..., None, :]
    start = np.zeros((RUNS, 2)), np.tile(P0, (RUNS, 1, 1))
    found = associated(MODEL, *start, scans, Validation(), method="known", restless=True)
    np.testing.assert_allclose(found.state[:, -1], mean, rtol=1e-8, atol=1e-9)
    expected = (weight[..., None, None] * spread).sum(0)
    np.testing.assert_allclose(found.covariance[:, -1], expected, rtol=1e-8)


def test_a_right_model_has_normal_scores() -> None:
    found = sigmas(followed(drawn(2)))
    assert np.abs(found.mean(0)).max() < 4.0 / RUNS**0.5
    assert found.std(0).min() > 0.85 and found.std(0).max() < 1.15
    assert np.abs(found).max() < 4.5


def test_each_wrong_model_is_told_by_its_own_score() -> None:
    counts = followed(drawn(4, doubt=(0.0, 0.5)))
    size, sigma = size_and_sigma(counts)
    assert score_test(size[:, 1], sigma[:, 1], "b").failed.mean() > 0.95
    np.testing.assert_allclose(size[:, 1].mean(), 0.5, rtol=0.1)
    assert not score_test(size[:, 0], 3.0 * sigma[:, 0], "a").failed.any()


def test_scores_together_are_a_chi_square() -> None:
    """A little more, since their sigma is the lesser of two."""
    tests = [all_together(followed(drawn(seed))) for seed in range(20, 30)]
    assert 0.95 < np.mean([test.value for test in tests]) < 1.1
    assert np.mean([test.failed for test in tests]) < 0.003


def test_doubts_that_are_small_each_are_told_together() -> None:
    """Two numbers, each off by the same number of sigmas, in a direction that tells most."""
    counts = followed(drawn(31, doubt=(0.16, 0.16)))
    size, sigma = size_and_sigma(counts)
    apart = [score_test(size[:, i], sigma[:, i], "").failed for i in range(2)]
    assert all_together(counts).failed.mean() > 1.5 * np.logical_or(*apart).mean()


def test_a_doubt_that_nothing_shows_takes_nothing_from_the_others() -> None:
    columns = COLUMNS * [1.0, 0.0]
    blind = MODEL._replace(
        doubted=lambda x, k: np.broadcast_to(columns[k], (*x.shape[:-1], 2, 2, 2))
    )
    counts = followed(drawn(32, doubt=(0.5, 0.0)), blind)
    assert all_together(counts).failed.mean() > 0.95


def agitated(seed, acceleration):
    likelihood = followed(drawn(seed, acceleration))["likelihood"]
    return agitation_test(log_ratio(likelihood)).failed.mean()


def test_accelerations_larger_than_stated_are_told() -> None:
    assert agitated(3, 10.0) > 0.95


@pytest.mark.parametrize("acceleration", [0.0, 1.0])
def test_those_that_are_not_are_seldom_doubted(acceleration: float) -> None:
    assert agitated(5, acceleration) <= 0.02


def test_clutter_in_the_gate_is_not_taken_for_accelerations() -> None:
    scans = drawn(8)
    apart = np.random.default_rng(9).uniform(-4.0, 4.0, (RUNS, EPOCHS, 2, 3, 2))
    start = np.zeros((RUNS, 2)), np.tile(P0, (RUNS, 1, 1))
    crowd = np.concatenate([scans, scans + apart], axis=-2)
    counts = associated(MODEL, *start, crowd, Validation(9.21, 0.99)).counts
    assert agitation_test(log_ratio(counts["likelihood"])).failed.mean() <= 0.02


def share_of_pairs(shown):
    """Test of detections (time, run, sensor, detection, 2) with unit noise."""
    counted = [pairs(*each, np.eye(2)) for each in pairwise(shown)]
    return companion_test(*np.sum(counted, axis=0))


@pytest.mark.parametrize("width", [6.0, 10.0, 200.0])
@pytest.mark.parametrize("count", [2, 10])
def test_clutter_that_is_new_in_every_frame_is_not_told(width: float, count: int) -> None:
    clutter = np.random.default_rng(6).uniform(-width, width, size=(101, 100, 2, count, 2))
    assert not share_of_pairs(clutter).failed.any()


@pytest.mark.parametrize("count", [0, 2])
def test_pieces_that_stay_are_told_also_among_clutter(count: int) -> None:
    rng = np.random.default_rng(7)
    place = 10.0 * rng.normal(size=(100, 2, 2, 2))
    pieces = place + rng.normal(size=(301, 100, 2, 2, 2))
    clutter = rng.uniform(-20.0, 20.0, size=(301, 100, 2, count, 2))
    assert share_of_pairs(np.concatenate([pieces, clutter], axis=-2)).failed.mean() > 0.95


@pytest.mark.parametrize(("count", "told"), [(30, True), (1, False)])
def test_the_nearest_is_wrong_as_often_as_the_distances_say(count: int, told: bool) -> None:
    rng = np.random.default_rng(7)
    own = rng.normal(size=(RUNS, EPOCHS, 2, 1, 2)) * R.diagonal() ** 0.5
    clutter = rng.uniform(-5.0, 5.0, (RUNS, EPOCHS, 2, count, 2))
    scans = np.concatenate([own, clutter], axis=-2)
    still = MODEL._replace(process_noise=np.zeros((2, 2)), doubts=(), doubted=None)
    start = np.zeros((RUNS, 2)), np.tile(1e-12 * np.eye(2), (RUNS, 1, 1))
    found = associated(still, *start, scans, Validation(gate=20.0), method="nearest").counts
    square = (scans**2 / R.diagonal()).sum(-1)
    wrong = (np.argmin(square, axis=-1) > 0).mean()
    np.testing.assert_allclose(found["mistaken"].sum() / found["looked"].sum(), wrong, rtol=0.05)
    test = crowd_test(found["mistaken"].sum(-1), found["looked"].sum(-1))
    assert test.failed.mean() == float(told)
