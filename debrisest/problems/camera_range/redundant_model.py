"""Pose and shape from one camera and a range, with every point in two frames.

State (Volpe et al. 2017, Eq 17, in another order): quaternion ``q_cb`` body to camera, rate,
the chaser's position rho and velocity in the Hill frame, six elements of the inertia, then the
points ``p_i`` in the body and ``r_i`` in the camera, N of each: 6N + 19 components. The camera's
attitude follows from the state, since it looks at the centre of mass exactly. What is left out of
the order of Eq 17 changes nothing but that most sigma points share the first 19 components.

The discrete step is exact for Eq 18a, ``r_i = R_cb p_i + |rho| e_z`` up to a constant, closed form
for the relative orbit, and one Runge-Kutta step of Eq 18d for the attitude relative to the Hill
frame.
"""

from functools import partial
from typing import NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.dynamics.clohessy_wiltshire import transition
from debrisest.dynamics.pointing import camera_axes
from debrisest.dynamics.tumbling_in_orbit import Body, step
from debrisest.filters.model import Model, PairedSteps
from debrisest.sensors import pinhole

Q, RATE, POSITION, VELOCITY = slice(0, 4), slice(4, 7), slice(7, 10), slice(10, 13)
INERTIA = slice(13, 19)
CORE = 19
ELEMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Rows and columns of the elements of the inertia: xx, yy, zz, xy, xz, yz."""
MATRIX = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])
"""Where the elements lie in the tensor."""


class CameraGeometry(NamedTuple):
    """What is known without error."""

    points: int
    mean_motion: float
    step: float
    focal_px: float

    @property
    def body_points(self) -> slice:
        """Where the points in the body lie in the state."""
        return slice(CORE, CORE + 3 * self.points)

    @property
    def camera_points(self) -> slice:
        """Where the points in the camera lie in the state."""
        return slice(CORE + 3 * self.points, CORE + 6 * self.points)


def redundant_model(
    known: CameraGeometry,
    pixel_noise: float,
    range_noise: float,
    process_noise: Array | float = 0.0,
) -> Model:
    """Return the model, with noises of 1 sigma and variances ``(n,)`` per step.

    These are zero in the paper, since the motion is exact (Sec. 7.1).
    """
    size = CORE + 6 * known.points
    noise = np.append(np.full(2 * known.points, pixel_noise**2), range_noise**2)
    return Model(
        process=lambda state, _: process(known, state),
        measurement=lambda state, _: measurement(known, state),
        process_noise=process_noise * np.eye(size),
        measurement_noise=np.diag(noise),
        error_names=error_names(known.points),
        retract=_correct,
        paired=_paired(known),
    )


def error_names(points: int) -> tuple[str, ...]:
    """Names of the components of the state."""
    core = [f"q_{i}" for i in range(4)] + [f"w_{axis}" for axis in "xyz"]
    core += ["x", "y", "z", "vx", "vy", "vz", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz"]
    named = [f"{kind}{i + 1}_{axis}" for kind in "pr" for i in range(points) for axis in "xyz"]
    return (*core, *named)


def measurement(known: CameraGeometry, state: Array) -> Array:
    """Pixels point by point, then the range to the centre of mass ``(..., 2N + 1)`` (Eq 23)."""
    batch = state.shape[:-1]
    seen = state[..., known.camera_points].reshape(*batch, known.points, 3)
    pixels = pinhole.project(seen, known.focal_px).reshape(*batch, 2 * known.points)
    return np.concatenate([pixels, _length(state[..., POSITION])], axis=-1)


def process(known: CameraGeometry, state: Array) -> Array:
    """State ``(run, ..., n)`` one step later.

    Of sigma points, those with the core of the first one are moved by that one's motion.
    """
    if state.ndim != 3:
        return _moved(known, state[..., None, :], state[..., None, :])[..., 0, :]
    core = state[..., :CORE]
    own = np.append(True, (core[:, 1:] != core[:, :1]).any((0, 2)))
    result = np.empty_like(state)
    result[:, own] = _moved(known, state[:, own, None], state[:, own, None])[:, :, 0]
    if not own.all():
        result[:, ~own] = _moved(known, state[:, None, 0], state[:, ~own])
    return result


def _paired(known: CameraGeometry) -> PairedSteps:
    if not compiled.available():
        return PairedSteps(move=partial(_move_pairs, known), show=partial(_show_pairs, known))
    from debrisest.problems.camera_range.redundant_loops import moved_pairs, shown_pairs

    orbit = transition(known.mean_motion, known.step)
    pace = known.mean_motion, 3.0 * known.mean_motion**2
    return PairedSteps(
        move=lambda x, columns, scale: moved_pairs(x, columns, scale, orbit, pace, known.step),
        show=lambda x, columns, scale: shown_pairs(x, columns, scale, known.focal_px),
    )


def _move_pairs(known: CameraGeometry, state: Array, columns: Array, scale: float) -> Array:
    """Pairs that move the core are moved as they are; the other columns turn with the state."""
    error = scale * columns[:, :CORE]
    points = np.concatenate([state[:, None], state[:, None] + error, state[:, None] - error], 1)
    moved = process(known, points)
    before = state[:, None, Q] / _length(state[:, None, Q])
    turned = _turned(known, columns[:, CORE:], before, moved[:, :1, Q])
    columns[:, CORE:, known.camera_points] += turned
    state[:] = moved[:, 0]
    return np.concatenate(_halves(moved, scale), axis=1)


def _show_pairs(
    known: CameraGeometry, state: Array, columns: Array, scale: float
) -> tuple[Array, Array, Array]:
    error = scale * columns
    points = np.concatenate([state[:, None], state[:, None] + error, state[:, None] - error], 1)
    shown = measurement(known, points)
    return shown[:, 0], *_halves(shown, scale)


def _halves(values: Array, scale: float) -> tuple[Array, Array]:
    """Half the differences of pairs, and half their sums without the first one, by the scale."""
    up, down = np.split(values[:, 1:], 2, axis=1)
    return 0.5 / scale * (up - down), (0.5 * (up + down) - values[:, :1]) / scale


def _moved(known: CameraGeometry, leader: Array, state: Array) -> Array:
    """States ``(..., copy, n)`` moved with the core of their ``leader (..., 1, n)``."""
    core, before, after = _core_step(known, leader)
    result = state.copy()
    result[..., :CORE] = core
    receding = _length(core[..., POSITION]) - _length(leader[..., POSITION])
    seen = _turned(known, state, before, after)
    seen[..., 2::3] += receding
    result[..., known.camera_points] += seen
    return result


def _turned(known: CameraGeometry, state: Array, before: Array, after: Array) -> Array:
    """How points ``(..., copy, 3N)`` of the body change place as attitudes (..., 1, 4) do."""
    body = state[..., known.body_points].reshape(*state.shape[:-2], -1, 3)
    turned = body @ np.swapaxes(_matrix(after) - _matrix(before), -1, -2)[..., 0, :, :]
    return turned.reshape(*state.shape[:-1], -1)


def _core_step(known: CameraGeometry, leader: Array) -> tuple[Array, Array, Array]:
    """The core one step later, and the attitude ``q_cb`` before and after it."""
    before = leader[..., Q] / _length(leader[..., Q])
    orbit = leader[..., 7:13] @ transition(known.mean_motion, known.step).T
    inertia = leader[..., INERTIA][..., MATRIX]
    shape = Body(inertia, np.asarray(np.linalg.inv(inertia), dtype=np.float64), np.empty(0))
    q_hb = quaternion.multiply(_camera(leader[..., POSITION]), before)
    turned, rate, _ = step(q_hb, leader[..., RATE], shape, known.mean_motion, known.step)
    after = quaternion.multiply(quaternion.conjugate(_camera(orbit[..., :3])), turned)
    after *= np.where((after * before).sum(-1, keepdims=True) < 0.0, -1.0, 1.0)
    core = np.concatenate([after, rate, orbit, leader[..., INERTIA]], axis=-1)
    return core, before, after


def _camera(position: Array) -> Array:
    return quaternion.from_matrix(camera_axes(position))


def _matrix(q: Array) -> Array:
    return quaternion.to_matrix(q)


def _length(vector: Array) -> Array:
    return np.asarray(np.sqrt((vector * vector).sum(-1, keepdims=True)))


def _correct(state: Array, error: Array) -> Array:
    corrected = state + error
    corrected[..., Q] /= _length(corrected[..., Q])
    return corrected
