"""The best rotation against a brute-force search, and what it must not see."""

import numpy as np
import pytest
from scipy.optimize import minimize

from debrisest.arrays import Array
from debrisest.assessment.shape_alignment import best_rotation, rms_distance, shape_error
from debrisest.attitude import quaternion

RNG = np.random.default_rng(5)


def _turn(seed: int) -> Array:
    drawn = np.random.default_rng(seed).standard_normal(4)
    return quaternion.to_matrix(quaternion.normalize(drawn))


@pytest.mark.parametrize("noise", [0.01, 0.3])
def test_against_a_search_over_rotations(noise: float) -> None:
    true = RNG.standard_normal((8, 3))
    estimated = (true + noise * RNG.standard_normal((8, 3))) @ _turn(1)

    def misfit(vector: Array) -> float:
        turn = quaternion.to_matrix(quaternion.exp(vector))
        return float(((estimated @ turn.T - true) ** 2).sum())

    starts = [quaternion.log(quaternion.from_matrix(_turn(seed))) for seed in range(2, 14)]
    least = min(minimize(misfit, start, tol=1e-12).fun for start in starts)
    turn = best_rotation(estimated, true)
    assert np.isclose(np.linalg.det(turn), 1.0)
    assert ((estimated @ turn.T - true) ** 2).sum() == pytest.approx(least, rel=1e-6)


def test_a_rotation_is_found_exactly_and_a_mirror_image_is_not_taken_for_one() -> None:
    true = RNG.standard_normal((5, 7, 3))
    turns = np.stack([_turn(seed) for seed in range(5)])
    found = best_rotation(true @ turns, true)
    assert np.allclose(found, turns)
    mirrored = true * [1.0, 1.0, -1.0]
    turn = best_rotation(mirrored, true)
    assert np.allclose(np.linalg.det(turn), 1.0)
    assert (rms_distance(mirrored @ np.swapaxes(turn, -1, -2), true) > 0.1).all()


def test_the_centre_of_mass_is_not_moved() -> None:
    true = RNG.standard_normal((7, 3))
    shifted = true + np.array([0.5, 0.0, 0.0])
    assert rms_distance(shifted @ best_rotation(shifted, true).T, true) > 0.1


def test_unknown_points_do_not_count_and_points_in_line_give_none() -> None:
    true = RNG.standard_normal((7, 3))
    estimated = true @ _turn(3)
    estimated[2] = np.nan
    assert np.allclose(best_rotation(estimated, true), _turn(3))
    assert rms_distance(estimated @ _turn(3).T, true) < 1e-12
    line = np.arange(1.0, 4.0)[:, None] * [1.0, 2.0, 3.0]
    assert np.isnan(best_rotation(line, line)).all()
    assert np.isnan(rms_distance(np.full((3, 3), np.nan), line))


def test_the_shape_error_is_free_of_the_scale() -> None:
    tensor = np.diag([1.0, 2.0, 2.5])
    assert shape_error(7 * tensor, tensor) == pytest.approx(0, abs=1e-15)
    assert shape_error(np.diag([1.01, 2.0, 2.5]), tensor) == pytest.approx(2.99e-3, rel=0.01)
