"""The compiled loops of the stereo pose problem against the numpy code, whose oracles are near."""

import numpy as np
import pytest

from debrisest import compiled
from debrisest.dynamics.relative_arc import rotation_arc
from debrisest.dynamics.relative_orbit import leader_orbit
from debrisest.filters.replay.frame_update import Belief, covariance_of, predict, update
from debrisest.filters.replay.gauss_newton import move
from debrisest.filters.replay.measured_arc import linearize, measured_arc
from debrisest.problems.stereo_pose.model import Shown

pytest.importorskip("numba")

TURNED = (0.5, -0.5, 0.5, 0.5)


def both(monkeypatch: pytest.MonkeyPatch, function):
    """Return what a function gives with numba and without."""
    with monkeypatch.context() as patch:
        patch.setattr(compiled, "available", lambda: True)
        fast = function()
        patch.setattr(compiled, "available", lambda: False)
        return fast, function()


def same(fast, slow, rtol: float = 1e-12) -> None:
    """Hold arrays to a part of the largest number in each."""
    for one, other in zip(fast, slow):
        np.testing.assert_allclose(
            one, other, rtol=0, atol=rtol * np.abs(other).max(initial=1e-300)
        )


@pytest.mark.parametrize("speed", [1e-9, 0.02, 0.4, 3.0])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_arcs_of_torque_free_rotation_are_the_same(monkeypatch, speed, way) -> None:
    """Rounding of an angle is a part of the angle."""
    draws = np.random.default_rng(3)
    times = way * np.concatenate([[5.0], 5.0 + np.cumsum(draws.uniform(0.2, 2.0, 60))])
    q = draws.normal(size=(8, 4))
    start = q / np.linalg.norm(q, axis=-1, keepdims=True), speed * draws.normal(size=(8, 3))
    ratios = 0.2 * draws.normal(size=(8, 2))
    ratios[0] = 0.0
    orbit = leader_orbit(np.arange(61.0), 7.17e6, 0.05, 0.0)
    angle = speed * np.ptp(times)
    found = both(monkeypatch, lambda: rotation_arc(times, *start, ratios, orbit))
    same(*found, 1e-12 * max(1.0, angle))


@pytest.mark.parametrize("q_lc", [(1, 0, 0, 0), TURNED])
@pytest.mark.parametrize(("first", "last"), [(0, 11), (7, 3), (4, 4), (4, 5)])
def test_arcs_relative_to_the_leader_are_the_same(monkeypatch, experiment, q_lc, first, last):
    test = experiment(3, 12, 1, q_lc=q_lc)
    same(*both(monkeypatch, lambda: test.model.trajectory(test.prior, first, last)))
    same(*both(monkeypatch, lambda: test.model.shown(test.prior, last)))
    same(*both(monkeypatch, lambda: (test.model.rewind(test.prior, last),)))


@pytest.mark.parametrize(
    "shown",
    [Shown(), Shown(flow=False), Shown(acceleration=True), Shown(False, False, False, True)],
)
@pytest.mark.parametrize("q_lc", [(1, 0, 0, 0), TURNED])
def test_linearised_costs_are_the_same(monkeypatch, experiment, shown, q_lc) -> None:
    def found():
        test = experiment(3, 20, 2, shown=shown, q_lc=q_lc)
        assert (test.model.sums is not None) == compiled.available()
        arc = measured_arc(test.model, test.prior, test.covariance, test.measured)
        arc.weight[:, 5:9] *= 0.3
        return linearize(test.model, arc, test.prior, 14)

    same(*both(monkeypatch, found))


@pytest.mark.parametrize("gate", [False, True])
@pytest.mark.parametrize(
    "shown", [Shown(), Shown(flow=False), Shown(acceleration=True), Shown(True, False, False, True)]
)
def test_a_frame_of_the_filter_is_the_same(monkeypatch, experiment, shown, gate) -> None:
    def found():
        test = experiment(3, 20, 2, shown=shown, q_lc=TURNED, rate=(-9.0, 5.0, 7.0))
        assert (test.model.frames is not None) == compiled.available()
        measured = test.measured.copy()
        measured[0, 12, 3:5] += gate
        measured[1, 12, -2:] = np.nan
        arc = measured_arc(test.model, test.prior, test.covariance, measured)
        at = linearize(test.model, arc, test.truth[:, 0], 11)
        belief = Belief(at.last_state, 1e-2 * at.information)
        belief, frame = update(test.model, predict(test.model, belief, 12), arc, 12, gate)
        assert frame.rejected[0] == 2 * gate
        moved = move(test.model, belief.state, np.linspace(-2.0, 1.5, 87).reshape(3, 29))
        return *belief, frame.nis, covariance_of(test.model, belief), arc.weight, moved

    same(*both(monkeypatch, found), 1e-9)


@pytest.mark.parametrize("options", [{}, {"gate": True}])
def test_estimates_are_the_same(monkeypatch, experiment, options) -> None:
    def found():
        return experiment(3, 30, 4).estimate(**options, keep=[10])

    fast, slow = both(monkeypatch, found)
    apart = np.abs(fast.state[..., :9] - slow.state[..., :9])
    assert np.nanmax(apart / slow.sigma[..., :9]) < 1e-6
    np.testing.assert_allclose(fast.sigma, slow.sigma, rtol=1e-6)
    np.testing.assert_allclose(fast.nis, slow.nis, rtol=1e-5, atol=1e-6)
    np.testing.assert_array_equal(fast.status, slow.status)
