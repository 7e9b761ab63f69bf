"""The printed control equations and axes of Li et al. (2011) that are wrong, each shown to be."""

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest

from debrisest.attitude import euler
from debrisest.control import two_stage
from debrisest.control.pixel_motion import curvature, rate_matrix
from debrisest.control.pixel_tracking import GAINS, Demand, track_pixel
from debrisest.control.rigid_spacecraft import spacecraft
from debrisest.control.robust_term import Uncertainty
from debrisest.control.two_stage import Controller
from debrisest.dynamics import kepler
from debrisest.dynamics.local_frame import local_axes
from debrisest.sensors import pinhole

SCALE, STEP, HALF = 335.0, 0.02, np.array([240.0, 180.0])
CRAFT = spacecraft(
    1e-7 * np.array([[10662.54, -40.2, 73.65], [-40.2, 10415.43, 48.15], [73.65, 48.15, 9618.74]])
)
RIGHT = SimpleNamespace(damped="rate", solved="pinv")


def law(reading: SimpleNamespace) -> Callable[..., Demand]:
    """Eqs 23-31 for one satellite, misprints and all, with a 5 by 3 matrix."""

    def demand(craft, gains, uncertainty, _, pixel, rate, integral, scale, *_desired) -> Demand:
        p, w = pixel[0, 0], rate[0, 0]
        matrix, free = rate_matrix(p, SCALE), craft.acceleration(w)
        e, e1_dot = -np.concatenate([p, w]), -matrix @ w
        bent = curvature(p, matrix @ w, w, SCALE) + matrix @ free
        drift = np.concatenate([bent, free])
        damped = gains.damping * (e1_dot if reading.damped == "rate" else e[:2])
        v = gains.proportional * e - drift + np.concatenate([damped, np.zeros(3)])
        s = gains.proportional * integral[0, 0]
        s = s + np.concatenate([gains.damping * e[:2] + e1_dot, e[2:]])
        ks = (uncertainty.drift * abs(drift) + uncertainty.gain * v + gains.robustness * s) / 0.6
        to_outputs = np.concatenate([matrix @ craft.inverse, craft.inverse])
        solved = np.linalg.pinv(to_outputs) if reading.solved == "pinv" else to_outputs.T
        return Demand((solved @ (v + ks))[None, None], e[None, None])

    return demand


def test_the_law_as_it_is_meant_is_the_one_in_use() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        pixel, rate = rng.uniform(-180, 180, (1, 1, 2)), rng.normal(size=(1, 1, 3))
        given = CRAFT, GAINS, Uncertainty(), "literal", pixel, rate, rng.normal(size=(1, 1, 5))
        ours, written_out = track_pixel(*given, SCALE), law(RIGHT)(*given, SCALE)
        np.testing.assert_allclose(ours.torque, written_out.torque, rtol=1e-7)
        np.testing.assert_array_equal(ours.growth, written_out.growth)


def flown(monkeypatch: pytest.MonkeyPatch, seconds: float, **wrong: object) -> np.ndarray:
    """Pixels (step, 2) of the second satellite's first turn under a misprinted law."""
    monkeypatch.setattr(two_stage, "track_pixel", law(SimpleNamespace(**vars(RIGHT) | wrong)))
    pixel, angles, rate = np.array([[[237.6, -42.3]]]), np.zeros((1, 1, 3)), np.zeros((1, 1, 3))
    ray = np.array([237.6 / SCALE, -1.0, -42.3 / SCALE])
    controller = Controller(CRAFT, np.array([[SCALE]]))
    controller = controller._replace(switch=controller.switch._replace(calm=np.inf, most=np.inf))
    memory, pixels = two_stage.start(np.rint(pixel), angles), []
    for _ in range(round(seconds / STEP)):
        point_c = ray @ euler.to_matrix(angles) @ pinhole.BODY_TO_CAMERA.T
        pixel = pinhole.project(point_c, SCALE)
        pixels.append(pixel[0, 0])
        measured = np.rint(pixel), 1.05 * angles, 1.05 * rate
        torque, memory = two_stage.advance(controller, memory, *measured, STEP)
        angles, rate = CRAFT.move(angles, rate, torque, np.zeros_like(rate), STEP)
        if not np.abs(rate).max() < 100.0:
            break
    return np.array(pixels)


def test_as_meant_the_pixel_settles(monkeypatch) -> None:
    late = np.abs(flown(monkeypatch, 16.0)).max(-1) > 5.0
    assert STEP * (len(late) - late[::-1].argmax()) == pytest.approx(11.6, abs=0.2)


def test_eq_23_and_30_damp_the_error_where_its_rate_is_meant(monkeypatch) -> None:
    assert np.abs(flown(monkeypatch, 30.0, damped="error")[-500:]).max() > 50.0


def test_eq_23_lacks_an_inverse_and_the_transposed_matrix_is_none(monkeypatch) -> None:
    assert len(flown(monkeypatch, 30.0, solved="transposed")) < 10


def test_with_the_axes_of_eq_2_the_debris_is_behind_both_cameras() -> None:
    """Eq 7 has finite pixels all the same, those of the first satellite nearer to the edge."""
    deg = np.radians
    start = kepler.state_from_elements(7.493e6, 0.1, deg(20), deg(35), deg(70), deg(8))
    own = kepler.state_from_elements(7.5e6, 0.1, deg(30), deg([10.0, 7.0]), deg(90), deg(8))
    for axes, in_front in (("printed", False), ("repaired", True)):
        apart = np.swapaxes(local_axes(*own, axes), -1, -2) @ (start[0] - own[0])[..., None]
        point_c = apart[..., 0] @ pinhole.BODY_TO_CAMERA.T
        pixel = pinhole.project(point_c, SCALE)
        assert np.isfinite(pixel).all()
        assert (pinhole.in_view(point_c, pixel, HALF) == in_front).all()
        if not in_front:
            np.testing.assert_allclose(point_c[:, 2] / 1e3, [-430.6, -760.5], atol=0.1)
