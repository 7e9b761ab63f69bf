"""Signs and gaps against a closed form: a body with an axis of symmetry has exactly four lines."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from debrisest.attitude import quaternion
from debrisest.recovery.basis_pursuit import basis_pursuit
from debrisest.recovery.direction_cosines import attitude_of, entries, signs_from
from debrisest.recovery.line_spectrum import LineStatus, line_spectrum
from debrisest.recovery.pieces import continuous, pieces

seeds = st.integers(0, 2**32 - 1)
TIME, PRECESSION, SPIN = 600, 0.113, 0.0419
NOISE = 0.03


def symmetric(rng):
    """Matrices (time, 3, 3): precession about the angular momentum, constant tilt, proper spin."""
    angles = rng.uniform(0, 2 * np.pi, 2) + np.outer(np.arange(TIME), [PRECESSION, SPIN])
    tilt = np.full(TIME, 1.0)
    axes = Rotation.from_euler("ZXZ", np.stack([angles[:, 0], tilt, angles[:, 1]], axis=-1))
    return (Rotation.random(rng=rng) * axes * Rotation.random(rng=rng)).as_matrix()


def measured(rng, true, runs=1):
    """Noisy attitudes (run, time, 3, 3) of which every 60 epochs 12 are not observed."""
    turns = Rotation.from_rotvec(NOISE * rng.standard_normal((runs * TIME, 3))).as_matrix()
    noisy = true @ turns.reshape(runs, TIME, 3, 3)
    noisy[:, np.arange(TIME) % 60 >= 48] = np.nan
    return noisy


def raw_with_flips(rng, matrix):
    """Quaternions (run, time, 4), each piece of them with a sign of its own, and the piece."""
    q = quaternion.from_matrix(matrix)
    piece = pieces(np.isfinite(q[..., 0]))
    flips = rng.choice([-1.0, 1.0], (len(q), 10))
    return continuous(q, piece) * np.take_along_axis(flips, np.maximum(piece, 0), 1)[
        ..., None
    ], piece


def angle(q, true):
    """In radians, by scipy."""
    estimate = Rotation.from_quat(q.reshape(-1, 4), scalar_first=True)
    reference = Rotation.from_matrix(np.broadcast_to(true, (len(q), TIME, 3, 3)).reshape(-1, 3, 3))
    return (reference.inv() * estimate).magnitude().reshape(len(q), TIME)


def by_pursuit(matrix, *, joint=False):
    signal = np.moveaxis(entries(matrix), -1, 1)
    found = basis_pursuit(signal, np.isfinite(signal), 2 * TIME, 1.0, joint=joint).signal
    return attitude_of(np.moveaxis(found, 1, -1))


def by_lines(matrix):
    return attitude_of(line_spectrum(entries(matrix)).signal)


@pytest.mark.parametrize("recover", [by_pursuit, by_lines])
@given(seeds)
@settings(max_examples=5, deadline=None)
def test_signs_need_no_search_and_gaps_are_filled(recover, seed):
    rng = np.random.default_rng(seed)
    true = symmetric(rng)
    matrix = measured(rng, true, 2)
    raw, piece = raw_with_flips(rng, matrix)
    q, sign = signs_from(recover(matrix), raw, piece)
    assert (np.sum(q[:, 1:] * q[:, :-1], axis=-1) > 0.9).all()
    assert (sign[:, 0] == 1).all()
    each = np.take_along_axis(sign, np.maximum(piece, 0), axis=1)
    assert (np.sum(q * raw, axis=-1) * each)[piece >= 0].min() > 0.9
    assert angle(q, true).max() < 0.15


def test_a_symmetric_body_has_the_lines_of_its_closed_form():
    """cos of precession and spin, and their products; errors of tens of unknowns, not of epochs."""
    rng = np.random.default_rng(1)
    true = symmetric(rng)
    found = line_spectrum(entries(measured(rng, true, 20)))
    lines = [SPIN, PRECESSION - SPIN, PRECESSION, PRECESSION + SPIN]
    assert (found.status == LineStatus.COMPLETE).all()
    assert (np.isfinite(found.frequency).sum(axis=-1) == 4).all()
    np.testing.assert_allclose(
        np.sort(found.frequency)[:, :4], np.broadcast_to(lines, (20, 4)), atol=2e-4
    )
    error = angle(attitude_of(found.signal), true)
    unknowns = 9 * 9 + 4
    share = unknowns / (3 * 480)
    assert np.mean(error**2) < 3 * NOISE**2 * share
    assert np.sqrt(np.mean(error[:, np.arange(TIME) % 60 >= 48] ** 2)) < 0.4 * NOISE


def test_few_lines_are_nearer_than_those_of_the_grid():
    rng = np.random.default_rng(2)
    true = symmetric(rng)
    matrix = measured(rng, true, 5)
    grid, joint, lines = (
        np.sqrt(np.mean(angle(q, true) ** 2))
        for q in (by_pursuit(matrix), by_pursuit(matrix, joint=True), by_lines(matrix))
    )
    assert 2 * lines < min(grid, joint)


def test_no_matrix_is_no_attitude():
    cosines = np.zeros((1, 4, 9))
    cosines[0, 1:] = 0.7 * np.eye(3).ravel()
    q = attitude_of(cosines)
    assert np.isnan(q[0, 0]).all()
    np.testing.assert_allclose(q[0, 1:], np.tile([1.0, 0, 0, 0], (3, 1)), atol=1e-12)


def test_runs_with_fewer_pieces_or_none():
    q = np.tile([0.6, 0.8, 0.0, 0.0], (3, 6, 1))
    piece = np.array([[0, 0, -1, 1, -1, 2], [0, 0, 0, 0, 0, 0], [-1] * 6])
    raw = np.where((piece < 0)[..., None], np.nan, -q)
    raw[0, 3] *= -1
    turned, sign = signs_from(q, raw, piece)
    np.testing.assert_array_equal(sign, [[1, -1, 1], [1, np.nan, np.nan], [np.nan] * 3])
    np.testing.assert_array_equal(turned, q * np.array([-1, -1, 1])[:, None, None])
    assert signs_from(q, np.full_like(q, np.nan), np.full((3, 6), -1))[1].shape == (3, 0)
