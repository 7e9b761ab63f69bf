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

from typing import Literal, NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
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


def retract(core: Array, error: Array) -> Array:
    """Core ``(..., n)`` moved by an error ``(..., n_c)``."""
    if compiled.available() and core.ndim == 2:
        from debrisest.problems.camera_range.core_loops import retracted

        return retracted(core, np.ascontiguousarray(error))
    moved = np.concatenate([core[..., :4], core[..., 4:] + error[..., 3:]], axis=-1)
    moved[..., Q] = quaternion.multiply(core[..., Q], quaternion.exp(error[..., ATTITUDE_ERROR]))
    return moved


def difference(core: Array, reference: Array) -> Array:
    """Error ``(..., n_c)`` with which `retract` takes the reference to the core."""
    turn = quaternion.multiply(quaternion.conjugate(reference[..., Q]), core[..., Q])
    return np.concatenate([quaternion.log(turn), core[..., 4:] - reference[..., 4:]], axis=-1)
