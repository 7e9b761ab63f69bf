"""Attitude from points: exact data, missing and collinear features, scipy as oracle."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from debrisest.arrays import Array
from debrisest.attitude.points import features_frame, triad, wahba, wahba_information

seeds = st.integers(0, 2**32 - 1)
METHODS = [triad, wahba]


def scene(seed: int, epochs: int = 4, features: int = 6) -> tuple[Array, Array, Array]:
    """A random model, attitudes ``(epoch, 3, 3)`` and noiseless points far from the origin."""
    rng = np.random.default_rng(seed)
    model = rng.normal(size=(features, 3)) * [3.0, 1.0, 5.0]
    attitude = Rotation.random(epochs, rng=rng).as_matrix()
    shift = rng.normal(size=(epochs, 1, 3)) * 50.0
    return model, attitude, shift + model @ np.swapaxes(attitude, -1, -2)


@pytest.mark.parametrize("method", METHODS)
@given(seeds)
def test_noiseless_points_give_the_attitude(method, seed) -> None:
    model, attitude, measured = scene(seed)
    np.testing.assert_allclose(method(model, measured), attitude, atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
@given(seeds, st.sets(st.integers(0, 5)))
def test_three_features_are_needed_and_are_enough(method, seed, hidden) -> None:
    model, attitude, measured = scene(seed)
    measured[1, list(hidden)] = np.nan
    estimate = method(model, measured)
    if 6 - len(hidden) < 3:
        assert np.isnan(estimate[1]).all()
        attitude[1] = np.nan
    np.testing.assert_allclose(estimate, attitude, atol=1e-8)


@pytest.mark.parametrize("method", METHODS)
def test_one_unknown_coordinate_hides_the_feature(method) -> None:
    model, attitude, measured = scene(7, features=4)
    measured[0, 2, 1] = np.nan
    measured[1, :2, 0] = np.nan
    estimate = method(model, measured)
    assert np.isnan(estimate[1]).all()
    np.testing.assert_allclose(estimate[[0, 2, 3]], attitude[[0, 2, 3]], atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
@given(seeds)
def test_features_in_line_give_no_attitude(method, seed) -> None:
    rng = np.random.default_rng(seed)
    model = np.concatenate([np.outer([0.0, 1.0, 3.0, -2.0], rng.normal(size=3)), np.ones((1, 3))])
    model += rng.normal(size=3)
    attitude = Rotation.random(rng=rng).as_matrix()
    measured = np.stack([model @ attitude.T] * 2) + rng.normal(size=3)
    measured[0, 4] = np.nan
    measured += 1e-3 * rng.normal(size=measured.shape)
    estimate = method(model, measured)
    assert np.isnan(estimate[0]).all()
    assert np.isfinite(estimate[1]).all()


@pytest.mark.parametrize("method", METHODS)
@given(seeds)
def test_axes_of_batch_and_proper_rotations(method, seed) -> None:
    """Flat sets with noise invite reflections; runs and epochs are leading axes."""
    model, _, measured = scene(seed, epochs=6, features=3)
    measured = measured + 0.5 * np.random.default_rng(seed).normal(size=measured.shape)
    estimate = method(model, measured.reshape(2, 3, 3, 3))
    assert estimate.shape == (2, 3, 3, 3)
    identity = np.broadcast_to(np.eye(3), estimate.shape)
    np.testing.assert_allclose(estimate @ np.swapaxes(estimate, -1, -2), identity, atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(estimate), 1.0, atol=1e-12)
    np.testing.assert_array_equal(estimate[1, 0], method(model, measured[3]))


@given(seeds, st.sets(st.integers(0, 5), max_size=3))
def test_wahba_is_the_optimum_of_align_vectors(seed, hidden) -> None:
    model, _, measured = scene(seed)
    measured = measured + 0.2 * np.random.default_rng(seed + 1).normal(size=measured.shape)
    measured[:, list(hidden)] = np.nan
    kept = [i for i in range(6) if i not in hidden]
    for points, estimate in zip(measured, wahba(model, measured)):
        a, b = points[kept], model[kept]
        best, _ = Rotation.align_vectors(a - a.mean(axis=0), b - b.mean(axis=0))
        np.testing.assert_allclose(estimate, best.as_matrix(), atol=1e-7)


@given(seeds)
def test_triad_takes_the_first_three_in_catalogue_order(seed) -> None:
    model, attitude, measured = scene(seed)
    measured[:, 1] = np.nan
    measured[:, 4:] += 10.0
    np.testing.assert_allclose(triad(model, measured), attitude, atol=1e-8)
    measured[:, 3] += 10.0
    assert np.abs(triad(model, measured) - attitude).max() > 1e-2


@given(seeds)
def test_features_frame_is_right_handed_and_moves_with_the_points(seed) -> None:
    model, attitude, measured = scene(seed)
    frame = features_frame(model)
    first = model[1] - model[0]
    np.testing.assert_allclose(frame[:, 0], first / np.linalg.norm(first), atol=1e-14)
    np.testing.assert_allclose(frame[:, 1] @ (model[:3] - model[0]).T, 0.0, atol=1e-12)
    assert frame[:, 2] @ (model[2] - model[0]) < 0.0
    assert np.linalg.det(frame) == pytest.approx(1.0)
    np.testing.assert_allclose(features_frame(measured), attitude @ frame, atol=1e-9)
    assert np.isnan(features_frame(np.outer([0.0, 1.0, 2.0], first))).any()


@pytest.mark.parametrize("seen", [[0, 1, 2], [0, 1, 3, 5], [0, 1, 2, 3, 4, 5]])
def test_information_of_the_least_squares_attitude_is_that_of_its_errors(seen) -> None:
    """Sum of the variances about the three axes, over 4000 noisy attitudes."""
    rng = np.random.default_rng(12)
    model, attitude, measured = scene(3, epochs=1)
    measured[:, [k for k in range(6) if k not in seen]] = np.nan
    noisy = measured + 0.01 * rng.standard_normal((4000, 6, 3))
    turns = Rotation.from_matrix(np.swapaxes(attitude, -1, -2) @ wahba(model, noisy))
    square = turns.magnitude() ** 2 / 0.01**2
    expected = 1.0 / wahba_information(model, measured)[0]
    assert abs(square.mean() - expected) < 5 * square.std() / 4000**0.5


def test_features_in_line_or_hidden_tell_nothing() -> None:
    model, _, measured = scene(5, epochs=3)
    measured[0] = np.nan
    measured[1, 1:] = np.nan
    measured[2, 2:] = np.nan
    np.testing.assert_allclose(wahba_information(model, measured), 0.0, atol=1e-12)
