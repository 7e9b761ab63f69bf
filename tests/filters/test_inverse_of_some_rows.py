"""Inverses of transitions, most of whose rows are those of the unit matrix."""

import numpy as np

from debrisest.filters.linear_algebra import inverse_of_some_rows


def test_it_is_the_inverse_whichever_rows_move() -> None:
    draws = np.random.default_rng(0)
    for moved in ([0, 1, 2], [1, 4], [], [0, 1, 2, 3, 4]):
        matrix = np.repeat(np.eye(5)[None], 4, axis=0)
        matrix[:, moved] += 0.3 * draws.normal(size=(4, len(moved), 5))
        unit = np.broadcast_to(np.eye(5), matrix.shape)
        np.testing.assert_allclose(matrix @ inverse_of_some_rows(matrix), unit, atol=1e-12)


def test_what_has_no_inverse_leaves_the_others_theirs() -> None:
    matrix = np.array([np.diag([2.0, 1.0, 1.0]), np.diag([0.0, 1.0, 1.0])])
    inverse = inverse_of_some_rows(matrix)
    np.testing.assert_array_equal(inverse[0], np.diag([0.5, 1.0, 1.0]))
    assert np.isnan(inverse[1]).any()
