"""What epochs tell, against residuals written out point by point."""

import numpy as np
from scipy.spatial.transform import Rotation

from debrisest.batch.arc import Arc, along, course, displaced
from debrisest.batch.attitudes import Attitudes
from debrisest.batch.free_points import FreePoints
from debrisest.batch.point_sums import KnownPoints
from debrisest.batch.tracks import tracks
from debrisest.dynamics import log_inertia


def small(tumbling, box, epochs=12):
    """A few epochs with weights that differ, and an arc that is a little off."""
    rng = np.random.default_rng(1)
    points = tumbling.points(rng, 0.03)[:epochs]
    sigma = rng.uniform(0.02, 0.05, points.shape[:2])
    arc = Arc(0.0, tumbling.q[0], tumbling.rate[0], log_inertia.log_ratios(tumbling.inertia))
    off = displaced(arc, 1e-3 * rng.normal(size=11))
    return tumbling.times[:epochs] - tumbling.times[0], points, sigma, off


def residuals(points, sigma, axes, model):
    """Weighted residuals with the best translation of each epoch, all in one vector."""
    parts = []
    for z, s, r in zip(points, sigma, axes):
        seen = np.isfinite(z[:, 0])
        difference = z[seen] - model[seen] @ r.T
        mean = np.average(difference, axis=0, weights=s[seen] ** -2)
        parts.append(((difference - mean) / s[seen, None]).ravel())
    return np.concatenate(parts)


def matrices(q):
    return Rotation.from_quat(q, scalar_first=True).as_matrix()


def jacobian(function, count, step=1e-6):
    columns = [(function(e) - function(-e)) / (2.0 * step) for e in step * np.eye(count)]
    return np.stack(columns, axis=-1)


def test_known_points(tumbling, box) -> None:
    times, points, sigma, arc = small(tumbling, box)

    def residual(error):
        q, _ = along(displaced(arc, error), times)
        return residuals(points, sigma, matrices(q), box)

    evidence = KnownPoints(tracks(times, points, sigma), box)
    normal = evidence.normal(course(arc, times))
    by = jacobian(residual, 11)
    at = residual(np.zeros(11))
    assert np.isclose(normal.chi2, at @ at, rtol=1e-9)
    for found, expected in ((normal.hold, by.T @ by), (normal.pull, -by.T @ at)):
        np.testing.assert_allclose(found, expected, atol=1e-4 * np.abs(expected).max())


def test_free_points_are_eliminated_as_in_the_dense_problem(tumbling, box) -> None:
    """All unknowns at once by finite differences, then the Schur complement."""
    times, points, sigma, arc = small(tumbling, box)
    evidence = FreePoints(tracks(times, points, sigma), box)
    q, _ = along(arc, times)
    settled = evidence.settled(q)

    def residual(error):
        turned, _ = along(displaced(arc, error[:11]), times)
        model = settled.model + error[11:].reshape(-1, 3)
        return residuals(points, sigma, matrices(turned), model)

    by = jacobian(residual, 11 + box.size, 1e-5)
    at = residual(np.zeros(by.shape[1]))
    hold = by.T @ by
    schur = hold[:11, :11] - hold[:11, 11:] @ np.linalg.pinv(hold[11:, 11:], 1e-6) @ hold[11:, :11]
    normal = evidence.normal(course(arc, times))
    pull = -by.T @ at
    assert np.isclose(normal.chi2, at @ at, rtol=1e-9)
    assert np.abs(pull[11:]).max() < 1e-4 * np.abs(pull[:11]).max()
    np.testing.assert_allclose(normal.hold, schur, rtol=1e-3, atol=1e-4 * np.abs(schur).max())
    np.testing.assert_allclose(normal.pull, pull[:11], atol=1e-4 * np.abs(pull).max())


def test_turning_all_axes_changes_nothing_where_points_are_free(tumbling, box) -> None:
    """The three unknowns that are fixed are no information: the frame is free."""
    times, points, sigma, arc = small(tumbling, box)
    evidence = FreePoints(tracks(times, points, sigma), box)
    q, rate = along(arc, times)
    turn = Rotation.from_rotvec([0.3, -0.5, 0.9])
    turned = (Rotation.from_quat(q, scalar_first=True) * turn).as_quat(scalar_first=True)
    assert np.isclose(evidence.chi2(q, rate), evidence.chi2(turned, rate), rtol=1e-9)


def test_two_points_tell_two_directions(tumbling, box) -> None:
    points = tumbling.points(np.random.default_rng(0), 0.01)[:1]
    shown = np.flatnonzero(np.isfinite(points[0, :, 0]))[:2]
    hidden = np.setdiff1d(np.arange(8), shown)
    points[0, hidden] = np.nan
    evidence = KnownPoints(tracks(tumbling.times[:1], points, 0.01), box)
    values = np.linalg.eigvalsh(evidence.told(tumbling.q[:1], tumbling.rate[:1]).hold[0])
    assert values[0] < 1e-9 * values[1]
    assert evidence.dof[0] == 3.0
    assert np.isnan(evidence.seen().q).all()


def test_attitudes_of_either_sign_tell_the_same(tumbling) -> None:
    hold = np.tile(np.diag([4.0, 9.0, 16.0]), (5, 1, 1))
    signs = np.array([1.0, -1, -1, 1, -1])[:, None]
    q, rate = tumbling.q[:5], tumbling.rate[:5]
    turn = np.array([0.01, 0.02, -0.01])
    off = (Rotation.from_rotvec(turn) * tumbling.attitude[:5]).as_quat(scalar_first=True)
    told = Attitudes(tumbling.times[:5], signs * off, hold).told(q, rate)
    np.testing.assert_allclose(told.chi2, turn @ hold[0] @ turn, rtol=1e-9)
    np.testing.assert_allclose(told.pull, np.tile(hold[0] @ turn, (5, 1)), rtol=1e-9)


def test_a_gate_takes_the_wrong_points_only(tumbling, box) -> None:
    rng = np.random.default_rng(2)
    points = tumbling.points(rng, 0.02)
    wrong = np.isfinite(points[..., 0]) & (rng.uniform(size=points.shape[:2]) < 0.05)
    points[wrong] += 1.0
    evidence = KnownPoints(tracks(tumbling.times, points, 0.02), box)
    kept = evidence.gated(tumbling.q, tumbling.rate, 25.0)
    several = evidence.tracks.seen.sum(axis=1) >= 4
    gone = evidence.tracks.seen & ~kept.tracks.seen
    few_wrong = several & (wrong.sum(axis=1) <= 1)
    assert np.array_equal(gone[few_wrong], wrong[few_wrong])
