"""Quaternions against scipy's Rotation, and the axioms of the group."""

import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from debrisest.arrays import Array
from debrisest.attitude import quaternion

ANGLES = [0.0, 1e-300, 1e-160, 1e-12, 1e-8, 1e-4, 1.0, np.pi / 2, 3.0]
ANGLES += [np.pi - 1e-4, np.pi - 1e-8, np.pi - 1e-12, np.pi, np.pi + 1e-8, 4.0, 2 * np.pi]
AXES = [[1, 0, 0], [0, -1, 0], [0, 0, 1], [1, 1, 0], [1, -1, 1], [1, 1e-9, 0], [-1e-9, 1e-9, 1]]
IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])


@st.composite
def unit_quaternions(draw: st.DrawFn) -> Array:
    """Rotations about random and special axes by angles around the singular ones."""
    components = st.floats(-1.0, 1.0, allow_subnormal=False)
    random_axis = hnp.arrays(float, 3, elements=components).filter(lambda a: a @ a > 1e-12)
    axis = draw(st.one_of(st.sampled_from(AXES).map(np.array), random_axis))
    angle = draw(st.one_of(st.sampled_from(ANGLES), st.floats(0.0, 2 * np.pi)))
    axis = axis / np.linalg.norm(axis)
    q = np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * axis])
    return q if draw(st.booleans()) else -q


def as_rotation(q: Array) -> Rotation:
    return Rotation.from_quat(q, scalar_first=True)


def assert_same_rotation(p: Array, q: Array, tolerance: float = 1e-14) -> None:
    assert min(np.abs(p - q).max(), np.abs(p + q).max()) < tolerance


@given(unit_quaternions(), unit_quaternions(), unit_quaternions())
def test_group_axioms(p: Array, q: Array, r: Array) -> None:
    left = quaternion.multiply(quaternion.multiply(p, q), r)
    right = quaternion.multiply(p, quaternion.multiply(q, r))
    np.testing.assert_allclose(left, right, atol=1e-15)
    np.testing.assert_array_equal(quaternion.multiply(p, IDENTITY), p)
    np.testing.assert_array_equal(quaternion.multiply(IDENTITY, p), p)
    np.testing.assert_allclose(
        quaternion.multiply(p, quaternion.conjugate(p)), IDENTITY, atol=1e-15
    )


@given(unit_quaternions(), unit_quaternions())
def test_matches_scipy_rotation(p: Array, q: Array) -> None:
    v = np.array([0.3, -1.2, 2.0])
    np.testing.assert_allclose(quaternion.to_matrix(q), as_rotation(q).as_matrix(), atol=1e-15)
    np.testing.assert_allclose(quaternion.rotate(q, v), as_rotation(q).apply(v), atol=4e-15)
    product = (as_rotation(p) * as_rotation(q)).as_quat(scalar_first=True)
    assert_same_rotation(quaternion.multiply(p, q), product)
    angle = (as_rotation(p).inv() * as_rotation(q)).magnitude()
    assert quaternion.angle_between(p, q) == pytest.approx(angle, abs=1e-15, rel=1e-12)


@given(unit_quaternions())
def test_matrix_round_trip_at_every_trace(q: Array) -> None:
    back = quaternion.from_matrix(as_rotation(q).as_matrix())
    assert back[0] >= 0.0
    assert_same_rotation(back, q)


@given(unit_quaternions())
def test_log_is_shortest_and_inverts_exp(q: Array) -> None:
    vector = quaternion.log(q)
    assert np.linalg.norm(vector) <= np.pi * (1 + 1e-15)
    assert_same_rotation(quaternion.exp(vector), q)
    if np.linalg.norm(vector) < np.pi - 1e-7:
        np.testing.assert_allclose(vector, as_rotation(q).as_rotvec(), rtol=1e-8, atol=1e-15)


@given(hnp.arrays(float, 3, elements=st.floats(-1e-3, 1e-3)))
def test_exp_keeps_every_digit_of_small_vectors(vector: Array) -> None:
    np.testing.assert_allclose(
        quaternion.log(quaternion.exp(vector)), vector, rtol=4e-15, atol=1e-300
    )
    np.testing.assert_allclose(2 * quaternion.exp(vector)[1:], vector, rtol=1e-6, atol=1e-300)


@given(unit_quaternions(), st.floats(-np.pi, np.pi))
def test_exp_solves_the_kinematics(q: Array, angle: float) -> None:
    """A constant body rate multiplies from the right: ``q_dot = 1/2 q * (0, w_b)``."""
    rate_b, step = np.array([0.6, 0.0, -0.8]) * angle, 1e-6
    forward = quaternion.multiply(q, quaternion.exp(rate_b * step))
    backward = quaternion.multiply(q, quaternion.exp(-rate_b * step))
    derivative = 0.5 * quaternion.multiply(q, np.concatenate([[0.0], rate_b]))
    np.testing.assert_allclose((forward - backward) / (2 * step), derivative, atol=1e-9)


def test_angle_between_resolves_tiny_angles() -> None:
    q = quaternion.normalize(np.array([0.3, -0.7, 0.2, 0.5]))
    for angle in (1e-12, 1e-9, np.pi - 1e-9):
        turned = quaternion.multiply(q, quaternion.exp(angle * np.array([0.0, 0.6, 0.8])))
        assert quaternion.angle_between(q, -turned) == pytest.approx(angle, rel=1e-3, abs=1e-15)


def test_batches_broadcast() -> None:
    rng = np.random.default_rng(1)
    p, q = rng.normal(size=(5, 1, 4)), quaternion.normalize(rng.normal(size=(3, 4)))
    assert quaternion.multiply(p, q).shape == (5, 3, 4)
    assert quaternion.angle_between(p, q).shape == (5, 3)
    assert quaternion.rotate(q, rng.normal(size=(5, 1, 3))).shape == (5, 3, 3)
    matrices = quaternion.to_matrix(q)
    assert matrices.shape == (3, 3, 3)
    np.testing.assert_allclose(quaternion.to_matrix(q[1]), matrices[1], rtol=0)
    np.testing.assert_allclose(
        np.abs(np.sum(quaternion.from_matrix(matrices) * q, -1)), 1.0, atol=1e-15
    )


def test_nan_in_gives_nan_out_without_warnings() -> None:
    q = np.stack([IDENTITY, np.full(4, np.nan), IDENTITY])
    seen = np.array([True, False, True])
    vector = np.zeros(3)
    for result in (
        quaternion.multiply(q, IDENTITY),
        quaternion.normalize(q),
        quaternion.rotate(q, vector),
        quaternion.log(q),
        quaternion.exp(q[:, :3]),
        quaternion.angle_between(q, IDENTITY)[:, None],
        quaternion.from_matrix(quaternion.to_matrix(q)),
    ):
        np.testing.assert_array_equal(np.isfinite(result).all(axis=-1), seen)
        assert np.isnan(result[1]).all()
    assert np.isnan(quaternion.normalize(np.zeros(4))).all()


@pytest.mark.parametrize("points", [3, 4, 9])
def test_nearest_to_a_correlation_aligns_vectors(points: int) -> None:
    random = np.random.default_rng(points)
    body = random.normal(size=(40, points, 3))
    body -= body.mean(axis=1, keepdims=True)
    turned = np.stack([r.apply(b) for r, b in zip(Rotation.random(40, random), body)])
    seen = turned + 0.05 * random.normal(size=body.shape)
    found = quaternion.nearest(np.swapaxes(seen, -1, -2) @ body)
    for q, a, b in zip(found, seen, body):
        theirs = quaternion.from_matrix(Rotation.align_vectors(a, b)[0].as_matrix())
        assert quaternion.angle_between(q, theirs) < 1e-7


def test_nearest_is_exact_at_half_turns_and_proper_at_mirrors() -> None:
    half_turns = np.array([np.diag(d) for d in ([1, -1, -1], [-1, 1, -1], [-1, -1, 1])], float)
    np.testing.assert_allclose(quaternion.nearest(half_turns), np.eye(4)[1:], atol=1e-12)
    mirrored = np.diag([3.0, 2.0, -1.0])
    np.testing.assert_allclose(quaternion.nearest(mirrored), np.eye(4)[0], atol=1e-12)


def test_nearest_to_what_tells_no_attitude_is_some_rotation() -> None:
    lines = np.array([np.zeros((3, 3)), np.outer([1.0, 2.0, 3.0], [0.0, 1.0, 1.0])])
    np.testing.assert_allclose(np.linalg.norm(quaternion.nearest(lines), axis=-1), 1.0, rtol=1e-12)
