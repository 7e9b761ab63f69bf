"""Camera and range finder near a tumbling target of unknown shape: the minimal state.

The core is ``[q_hb 4 | w 3 | rho 3 | v 3 | s 5 | extra]``: attitude of the body relative to the
Hill frame, inertial rate in body axes, chaser relative to target in the Hill frame, log-ratios of
the inertia, and constants of the sensors; its errors have a rotation vector theta in body axes in
place of the quaternion. Behind it come the points ``p_i`` in body axes, which are the camera's axes
at time zero by definition.

A point lies at ``r_i = R_ch (R_hb p_i - rho)`` in the camera (Volpe et al. 2017, Eq 14, with the
points of the body in place of their redundant copies in the camera's axes). The camera's attitude
is either known or, as in the paper, implied by rho: it then looks at the centre of mass exactly,
``r_i = R_ch(rho) R_hb p_i + (0, 0, |rho|)``. The attitude at time zero follows from the camera's,
so that with an implied one it is tied to rho, by the derivative G of the camera's rotation.
"""

from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
from debrisest.dynamics import clohessy_wiltshire, tumbling_in_orbit
from debrisest.dynamics.pointing import camera_axes, camera_rate

CameraAttitude = Literal["known", "implied"]
RangeModel = Literal["centre", "bias", "landmark"]

Q, RATE, POSITION, VELOCITY, LOG_INERTIA = (
    *(slice(0, 4), slice(4, 7), slice(7, 10), slice(10, 13)),
    slice(13, 18),
)
CORE = 18
ATTITUDE_ERROR = slice(0, 3)
RATE_ERROR, POSITION_ERROR, VELOCITY_ERROR, LOG_INERTIA_ERROR = (
    *(slice(3, 6), slice(6, 9), slice(9, 12)),
    slice(12, 17),
)
CORE_ERRORS = 17
_TURNING = np.r_[0:6, 12:17]
"""Errors that the rotation depends on."""
_TURNED = RATE.stop
_LARGEST_TURN = 0.125
"""Angle, rad, up to which one Runge-Kutta step of order 4 is far below what pixels show."""
_MOST_SUBSTEPS = 64.0


class CameraRangeGeometry(NamedTuple):
    """What is known without error."""

    camera: Array
    """Known ``R_hc (run, time, 3, 3)``."""
    points: int
    """Number of landmarks."""
    mean_motion: float
    step: float
    focal: float
    """Focal length, px."""
    pixel_sigma: float
    range_sigma: float
    attitude_sigma: float = 0.0
    """White noise of the known camera attitude per axis, rad."""
    attitude: CameraAttitude = "known"
    range_model: RangeModel = "centre"
    camera_bias: bool = False
    """Whether a constant error of the known attitude is estimated."""
    depth_sigma: float = 1.5
    """Half the target's depth along the line of sight, 1 sigma, m."""
    gravity_gradient: bool = True
    """Whether the Earth turns the target."""

    @property
    def extras(self) -> int:
        """Number of constants behind the inertia: the range's bias, the camera's three."""
        return int(self.range_model == "bias") + 3 * int(self.camera_bias)

    def of(self, runs: IntArray) -> "CameraRangeGeometry":
        """Return what is known of some runs."""
        return self._replace(camera=self.camera[runs])


def error_names(known: CameraRangeGeometry) -> tuple[str, ...]:
    """Return the names of all errors, points last."""
    names = [
        f"{part}_{axis}" for part in ("attitude", "rate", "position", "velocity") for axis in "xyz"
    ]
    names += [f"log_inertia_{i + 1}" for i in range(5)]
    names += ["range_bias"] if known.range_model == "bias" else []
    names += [f"camera_bias_{axis}" for axis in "xyz"] if known.camera_bias else []
    return (*names, *(f"p{i + 1}_{axis}" for i in range(known.points) for axis in "xyz"))


def start(known: CameraRangeGeometry, parameters: Array) -> tuple[Array, Array]:
    """Core ``(run, n)`` whose body axes are the camera's, and derivative of its errors.

    They are those of the camera as it is known, exactly so, whatever the error of this knowledge.
    ``parameters (run, n_c - 3)`` are the core without the quaternion.
    """
    n_p = parameters.shape[-1]
    rho = parameters[..., 3:6]
    derivative = np.zeros((*parameters.shape[:-1], n_p + 3, n_p))
    derivative[..., 3:, :] = np.eye(n_p)
    if known.attitude == "implied":
        q_hb = quaternion.from_matrix(camera_axes(rho))
        derivative[..., :3, 3:6] = turn_by_position(rho)
    else:
        q_hb = quaternion.from_matrix(known.camera[:, 0])
    return np.concatenate([q_hb, parameters], axis=-1), derivative


def turn_by_position(position: Array) -> Array:
    """``G (..., 3, 3)``: turn of the implied camera, in its own axes, by the chaser's position."""
    still = position[..., None, :]
    return np.swapaxes(
        camera_rate(still, np.broadcast_to(np.eye(3), (*position.shape, 3)), 0.0), -1, -2
    )


def mirror(parameters: Array, points: Array) -> tuple[Array, Array]:
    """Reverse the depth: the motion that an infinitely distant camera could not tell from this.

    Points, rates and inertia are reflected in the image plane of the camera at time zero.
    """
    reflected = parameters.copy()
    reflected[..., :2] *= -1.0
    reflected[..., _CROSS_TERMS] *= -1.0
    return reflected, points * np.array([1.0, 1.0, -1.0])


_CROSS_TERMS = [LOG_INERTIA.start - 4 + 3, LOG_INERTIA.start - 4 + 4]
"""Inertia's xz and yz among the parameters."""


def trajectory(known: CameraRangeGeometry, core: Array, last: int) -> tuple[Array, Array]:
    """Cores ``(run, last + 1, n)`` from that of epoch 0, and errors by those of epoch 0."""
    cores = np.empty((len(core), last + 1, core.shape[-1]))
    cores[:] = core[:, None]
    turning = np.empty((len(core), last + 1, tumbling_in_orbit.TURNING, 11))
    for count, runs in _by_substeps(known, core):
        cores[runs, :, :_TURNED], turning[runs] = _rotation(known, core[runs], last, count)
    centre = clohessy_wiltshire.transition(known.mean_motion, known.step * np.arange(last + 1.0))
    moving = slice(POSITION.start, VELOCITY.stop)
    cores[..., moving] = (centre @ core[:, None, moving, None])[..., 0]
    return cores, _transitions(known, turning, centre)


def process(known: CameraRangeGeometry, core: Array) -> tuple[Array, Array]:
    """Core ``(run, n)`` one step later, and the derivative ``(run, n_c, n_c)`` of its errors."""
    moved = core.copy()
    turning = np.empty((len(core), tumbling_in_orbit.TURNING, 11))
    for count, runs in _by_substeps(known, core):
        turned, by_start = _rotation(known, core[runs], 1, count)
        moved[runs, :_TURNED], turning[runs] = turned[:, 1], by_start[:, 1]
    centre = clohessy_wiltshire.transition(known.mean_motion, known.step)
    moving = slice(POSITION.start, VELOCITY.stop)
    moved[..., moving] = (centre @ core[..., moving, None])[..., 0]
    return moved, _transitions(known, turning, centre)


def _by_substeps(known: CameraRangeGeometry, core: Array) -> Iterator[tuple[int, IntArray]]:
    """Numbers of Runge-Kutta steps in one epoch, powers of two, and the runs that need them."""
    turn = np.linalg.norm(core[..., RATE], axis=-1) * known.step / _LARGEST_TURN
    halvings = np.ceil(np.log2(np.clip(np.nan_to_num(turn, nan=1.0), 1.0, _MOST_SUBSTEPS)))
    for halving in np.unique(halvings):
        yield int(2**halving), np.flatnonzero(halvings == halving)


def _rotation(
    known: CameraRangeGeometry, core: Array, last: int, count: int
) -> tuple[Array, Array]:
    """Attitude and rate (run, last + 1, 7), and their errors by those of epoch 0."""
    shape = tumbling_in_orbit.body(core[..., LOG_INERTIA])
    if compiled.available():
        from debrisest.dynamics.tumbling_in_orbit_loops import rotation

        pace = known.mean_motion, 3.0 * known.mean_motion**2 * known.gravity_gradient
        start = np.ascontiguousarray(core[..., :_TURNED])
        return rotation(start, *shape, pace, known.step / count, last, count)
    products = tumbling_in_orbit.torque_products(shape)
    q, w, n, duration = core[..., Q], core[..., RATE], known.mean_motion, known.step / count
    turned = np.empty((len(core), last + 1, _TURNED))
    rates, radials = (np.empty((len(core), last * count, 4, 3)) for _ in range(2))
    for k in range(last * count):
        if k % count == 0:
            turned[:, k // count, Q], turned[:, k // count, RATE] = q, w
        q, w, stages = tumbling_in_orbit.step(
            q, w, shape, n, duration, products, known.gravity_gradient
        )
        rates[:, k], radials[:, k] = stages
    turned[:, last, Q], turned[:, last, RATE] = q, w
    steps = tumbling_in_orbit.sensitivity(
        tumbling_in_orbit.Stages(rates, radials),
        tumbling_in_orbit.Body(*(part[:, None] for part in shape)),
        n,
        duration,
        known.gravity_gradient,
    )
    return turned, _composed(steps)[:, ::count]


def _composed(steps: Array) -> Array:
    """Products ``(run, epoch + 1, 6, 11)`` of the steps ``(run, epoch, 6, 11)`` so far."""
    result = np.empty((len(steps), steps.shape[1] + 1, 6, 11))
    result[:, 0] = np.eye(6, 11)
    for k in range(steps.shape[1]):
        result[:, k + 1] = steps[:, k, :, :6] @ result[:, k]
        result[:, k + 1, :, 6:] += steps[:, k, :, 6:]
    return result


def _transitions(known: CameraRangeGeometry, turning: Array, centre: Array) -> Array:
    """Derivative ``(..., n_c, n_c)`` of rotation ``(..., 6, 11)`` and centre ``(..., 6, 6)``."""
    n_c = CORE_ERRORS + known.extras
    result = np.zeros((*turning.shape[:-2], n_c, n_c))
    result[...] = np.eye(n_c)
    result[..., :6, _TURNING] = turning
    result[..., 6:12, 6:12] = centre
    return result


def retract(core: Array, error: Array) -> Array:
    """Core ``(..., n)`` moved by an error ``(..., n_c)``."""
    moved = np.concatenate([core[..., :4], core[..., 4:] + error[..., 3:]], axis=-1)
    moved[..., Q] = quaternion.multiply(core[..., Q], quaternion.exp(error[..., ATTITUDE_ERROR]))
    return moved


def difference(core: Array, reference: Array) -> Array:
    """Error ``(..., n_c)`` with which `retract` takes the reference to the core."""
    turn = quaternion.multiply(quaternion.conjugate(reference[..., Q]), core[..., Q])
    return np.concatenate([quaternion.log(turn), core[..., 4:] - reference[..., 4:]], axis=-1)
