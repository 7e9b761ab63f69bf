"""What the covariances promise among clutter: kept by probabilities, broken by certainty."""

import numpy as np
import pytest
from scipy.stats import chi2

from debrisest.filters.association.single import associated, jointly_associated
from debrisest.filters.association.weights import Validation
from debrisest.filters.scan_model import ScanModel

RUNS, EPOCHS = 200, 40
F = np.eye(4) + np.eye(4, k=2)
INPUT = np.concatenate([0.5 * np.eye(2), np.eye(2)])
H = np.stack([np.eye(2, 4), np.array([[0.8, 0.6, 0.0, 0.0], [-0.6, 0.8, 0.0, 0.0]])])
P0 = np.diag([4.0, 4.0, 1.0, 1.0])
RULE = Validation(gate=9.21, detection_probability=0.9)


def points(x, _):
    return (H @ x[..., None, :, None])[..., 0]


MODEL = ScanModel(
    process=lambda x, _: x @ F.T,
    process_jacobian=lambda _x, _k: F,
    process_noise=0.01 * INPUT @ INPUT.T,
    points=points,
    points_jacobian=lambda _x, _k: H,
    noise=np.eye(2),
    error_names=("x", "y", "u", "v"),
)


def motion(rng):
    truth = np.empty((RUNS, EPOCHS, 4))
    truth[:, 0] = 10.0 * rng.normal(size=(RUNS, 4))
    for k in range(1, EPOCHS):
        truth[:, k] = truth[:, k - 1] @ F.T + 0.1 * rng.normal(size=(RUNS, 2)) @ INPUT.T
    return truth


def seen(rng, truth, detected=1.0):
    shown = points(truth, 0)
    found = shown + rng.normal(size=shown.shape)
    found[rng.random(shown.shape[:3]) > detected] = np.nan
    return found


def guessed(rng, truth):
    return truth[:, 0] + rng.multivariate_normal(np.zeros(4), P0, size=RUNS)


def among_clutter(seed, count, width):
    rng = np.random.default_rng(seed)
    truth = motion(rng)
    own = seen(rng, truth, RULE.detection_probability)
    size = (RUNS, EPOCHS, 2, count, 2)
    clutter = points(truth, 0)[..., None, :] + rng.uniform(-width, width, size=size)
    return truth, np.concatenate([own[..., None, :], clutter], axis=-2), guessed(rng, truth)


def nees(truth, scans, guess, epochs, **options):
    """Per component, of each run, mean over the epochs."""
    history = associated(
        *(MODEL, guess, np.stack([P0] * RUNS), scans, RULE), keep=range(EPOCHS), **options
    )
    error = (history.state - truth)[:, epochs, None, :]
    inverse = np.linalg.inv(history.covariance[:, epochs])
    return (error @ inverse @ np.swapaxes(error, -1, -2))[..., 0, 0].mean(-1) / 4


@pytest.mark.parametrize("seed", [0, 1])
def test_known_detections_leave_chi_square_errors(seed):
    truth, scans, guess = among_clutter(seed, 1, 4.0)
    options = {"method": "known"}
    for k in (0, EPOCHS // 2, EPOCHS - 1):
        total = 4 * nees(truth, scans[..., :1, :], guess, [k], **options).sum()
        assert chi2.ppf(1e-8, 4 * RUNS) < total < chi2.isf(1e-8, 4 * RUNS)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("stacked", [False, True])
def test_probabilities_are_consistent_where_the_nearest_is_overconfident(seed, stacked):
    """The mixture's errors are not Gaussian, so that only their mean square is held to."""
    world = among_clutter(seed, 1, 4.0)
    late = np.arange(EPOCHS // 2, EPOCHS)
    assert 0.85 < nees(*world, late, stacked=stacked).mean() < 1.2
    assert nees(*world, late, method="nearest", stacked=stacked).mean() > 1.6


@pytest.mark.parametrize("seed", [0, 1])
def test_in_dense_clutter_the_nearest_is_lost(seed):
    world = among_clutter(seed, 3, 5.0)
    late = np.arange(EPOCHS // 2, EPOCHS)
    assert nees(*world, late).mean() < 1.6
    assert nees(*world, late, method="nearest").mean() > 4.0


@pytest.mark.parametrize("seed", [0, 1])
def test_tracking_what_flies_along_keeps_the_target_apart(seed):
    rng = np.random.default_rng(seed)
    target = motion(rng)
    drift = 5.0 * rng.normal(size=(2, RUNS, 1, 4)) * [1.0, 1.0, 0.0, 0.0]
    pieces = [target, *(target + drift)]
    scans = np.stack([seen(rng, piece) for piece in pieces], axis=-2)
    guess = np.stack([guessed(rng, piece) for piece in pieces], axis=1)
    covariance = np.broadcast_to(P0, (RUNS, 3, 4, 4))
    rule = Validation()
    alone = associated(MODEL, guess[:, 0], covariance[:, 0], scans, rule)
    joint = jointly_associated(MODEL, guess, covariance, scans, rule)
    lost = [np.linalg.norm((h.state - target)[:, -1, :2], axis=-1) > 3.0 for h in (alone, joint)]
    assert lost[1].mean() < 0.8 * lost[0].mean()
