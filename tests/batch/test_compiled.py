"""The compiled loops of the motion against the numpy code, whose oracles are in test_arc.py."""

import numpy as np
import pytest

from debrisest import compiled
from debrisest.attitude import quaternion
from debrisest.batch import arc as arcs
from debrisest.batch.arc import Arc, along, course, displaced
from debrisest.batch.descent import NOTHING_ELSE, Prior, covariance, descend_all
from debrisest.batch.point_sums import KnownPoints
from debrisest.batch.spread import shift
from debrisest.batch.tracks import tracks

pytest.importorskip("numba")

TIMES = np.concatenate([np.linspace(-300.0, 400.0, 500), [0.0]])


def both(monkeypatch: pytest.MonkeyPatch, function, *arguments):
    """Return what a function gives with numba and without."""
    with monkeypatch.context() as patch:
        patch.setattr(compiled, "available", lambda: True)
        fast = function(*arguments)
        patch.setattr(compiled, "available", lambda: False)
        return fast, function(*arguments)


def drawn(count: int, spread: float) -> Arc:
    draws = np.random.default_rng(count)
    q = draws.normal(size=(count, 4))
    q /= np.linalg.norm(q, axis=-1, keepdims=True)
    rates, logs = draws.normal(size=(count, 3)), draws.normal(size=(count, 5))
    return Arc(20.0, q, 0.1 * rates, spread * logs)


@pytest.mark.parametrize("spread", [0.3, 0.01, 1e-9, 0.0])
def test_motion_is_the_same(monkeypatch: pytest.MonkeyPatch, spread: float) -> None:
    arc = drawn(40, spread)
    for fast, slow in zip(*both(monkeypatch, along, arc, TIMES)):
        turned = 1.0 + np.abs(TIMES).max() * np.linalg.norm(arc.rate, axis=-1)
        np.testing.assert_array_less(np.abs(fast - slow).max((1, 2)), 1e-12 * turned)


def test_special_motions_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """At rest, about a principal axis, also the middle one, on the separatrix, of equal moments."""
    logs = np.array([0.2, 0.1, 0.0, 0.0, 0.0])
    moments = np.exp([0.2 / 2**0.5 + 0.1 / 6**0.5, -0.2 / 2**0.5 + 0.1 / 6**0.5, -0.2 / 6**0.5])
    low, middle, high = np.argsort(moments)
    edge = np.zeros(3)
    edge[low] = np.sqrt((moments[high] - moments[middle]) * moments[high])
    edge[high] = np.sqrt((moments[middle] - moments[low]) * moments[low])
    rates = [np.zeros(3), *0.1 * np.eye(3), 0.1 * edge / np.linalg.norm(edge)]
    for rate in rates:
        for log_inertia in (logs, np.zeros(5), np.array([0.0, 0.3, 0.0, 0.0, 0.0])):
            arc = Arc(0.0, np.array([1.0, 0.0, 0.0, 0.0]), rate, log_inertia)
            for fast, slow in zip(*both(monkeypatch, along, arc, TIMES / 10.0)):
                np.testing.assert_allclose(fast, slow, atol=1e-11)


def test_derivatives_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    for fast, slow in zip(*both(monkeypatch, course, drawn(5, 0.3), TIMES)):
        np.testing.assert_allclose(fast, slow, atol=1e-7 * np.abs(slow).max())


def test_no_epoch_and_no_number_are_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    arc = drawn(2, 0.3)
    lost = arc._replace(rate=np.full((2, 3), np.nan))
    monkeypatch.setattr(compiled, "available", lambda: True)
    assert along(arc, np.zeros(0))[0].shape == (2, 0, 4)
    with np.errstate(invalid="ignore"):
        assert np.isnan(along(lost, TIMES)[1]).all()


def test_without_numba_numpy_does_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arcs.compiled, "available", lambda: False)
    monkeypatch.setattr(arcs, "_along_compiled", None)
    assert np.isfinite(along(drawn(2, 0.3), TIMES)[0]).all()


def test_normal_equations_of_points_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    draws = np.random.default_rng(3)
    points = draws.normal(size=(len(TIMES), 6, 3))
    points[draws.random(points.shape[:2]) < 0.3] = np.nan
    evidence = KnownPoints(tracks(TIMES, points, 0.1), draws.normal(size=(6, 3)))
    motions = course(drawn(4, 0.3), TIMES)
    for fast, slow in zip(*both(monkeypatch, evidence.normal, motions)):
        np.testing.assert_allclose(fast, slow, atol=1e-12 * np.abs(slow).max())


def seen_of(arc: Arc, noise: float) -> KnownPoints:
    """Return six points of a body that moves so, of which a third is not seen."""
    draws = np.random.default_rng(5)
    body = draws.normal(size=(6, 3))
    points = body @ np.swapaxes(quaternion.to_matrix(along(arc, TIMES)[0]), -1, -2)
    points += noise * draws.normal(size=points.shape)
    points[draws.random(points.shape[:2]) < 0.3] = np.nan
    return KnownPoints(tracks(TIMES, points, noise), body)


def test_descents_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of starts near and far, free and held, one of them no body."""
    truth = Arc(20.0, np.array([0.5, 0.5, 0.5, 0.5]), np.array([0.02, 0.01, -0.015]), np.zeros(5))
    truth = truth._replace(log_inertia=np.array([0.2, 0.1, 0.0, -0.1, 0.05]))
    evidence, draws = seen_of(truth, 0.05), np.random.default_rng(6)
    errors = np.repeat([1e-4, 1e-5, 1e-3], [3, 3, 5]) * draws.normal(size=(4, 11))
    starts = [displaced(truth, error) for error in errors]
    starts[1] = starts[1]._replace(rate=2.0 * starts[1].rate)
    starts[2] = starts[2]._replace(log_inertia=np.full(5, 4.0))
    held = [NOTHING_ELSE] * 3 + [Prior(np.full(5, 0.05), 1e4 * np.eye(5))]
    fast, slow = both(monkeypatch, descend_all, evidence, starts, 30, held)
    sigma = np.sqrt(np.diag(covariance(slow[0].hold)))
    for one, other, near in zip(fast, slow, (True, False, True, True)):
        assert (one.settled, np.isfinite(one.chi2)) == (other.settled, np.isfinite(other.chi2))
        if near:
            np.testing.assert_array_less(np.abs(shift(one.arc, other.arc)), 1e-4 * sigma)
            np.testing.assert_allclose(one.chi2, other.chi2, rtol=1e-10)
            np.testing.assert_allclose(one.hold, other.hold, atol=1e-5 * np.abs(other.hold).max())
    assert slow[0].settled and slow[3].settled
    assert np.isinf(slow[2].chi2)
