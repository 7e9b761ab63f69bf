"""Rate and inertia of a torque-free body from the attitude of a frame fixed in it.

The state (14) is ``q_ib`` (principal axes to inertial), ``q_bf`` (feature frame to principal
axes, constant), the rate in principal axes and the principal moments, scaled to unit norm. What is
measured is ``q_if = q_ib q_bf``, up to its sign. The source is Biondi et al. (2017), Eqs 29-31.

We depart from the printed Eq 29 in the sign of Euler's term (see `debrisest.dynamics.integrators`;
with the printed sign the filter finds the same rates and a wrong inertia) and in the size of its
zero block for ``q_bf`` (4, not 3). The body's axes ``b`` of a filter are principal axes known only
up to a relabeling, see `debrisest.assessment.principal_axes`.
"""

from typing import Literal

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.dynamics.integrators import Integrator, euler_step, rk4_step
from debrisest.dynamics.substeps import LARGEST_TURN, MOST
from debrisest.filters.estimates import Estimates
from debrisest.filters.model import Model
from debrisest.problems.tumbling.score import scores
from debrisest.roles import Keys, Positive, ProblemPart, Window

Q_IB, Q_BF, RATE, MOMENTS = slice(0, 4), slice(4, 8), slice(8, 11), slice(11, 14)
ERROR_NAMES = tuple(
    f"{name}_{index}"
    for name, indices in (("q_ib", "0123"), ("q_bf", "0123"), ("rate", "123"), ("moment", "123"))
    for index in indices
)
LEAST_MOMENT = 0.02
"""Sigma points of the moments, which have unit norm, are kept this far from zero."""


def process(state: Array, step: float, integrator: Integrator) -> Array:
    """Return the states (..., 14) after ``step`` seconds; offset and moments do not change."""
    if integrator is rk4_step and compiled.available():
        from debrisest.problems.tumbling.attitude_loops import moved

        flat = np.ascontiguousarray(state).reshape(-1, 14)
        return moved(flat, step, LEAST_MOMENT, LARGEST_TURN, MOST).reshape(state.shape)
    last = state.ndim - 1
    following = np.array(state.transpose(last, *range(last)), order="C")
    moments = following[MOMENTS]
    j1, j2, j3 = np.copysign(np.maximum(np.abs(moments), LEAST_MOMENT), moments)
    ratio = np.stack([(j2 - j3) / j1, (j3 - j1) / j2, (j1 - j2) / j3])
    following[Q_IB], following[RATE] = integrator(following[Q_IB], following[RATE], ratio, step)
    return following.transpose(*range(1, state.ndim), 0)


def measured_attitude(state: Array) -> Array:
    """Return ``q_if`` (..., 4) of states (..., 14), as in Eq 30."""
    return quaternion.multiply(state[..., Q_IB], state[..., Q_BF])


def correct(state: Array, error: Array) -> Array:
    """Add an error (..., 14), then scale both quaternions and the moments to unit norm."""
    corrected = state + error
    for block in (Q_IB, Q_BF, MOMENTS):
        vector = corrected[..., block]
        vector /= np.sqrt((vector * vector).sum(-1, keepdims=True))
    return corrected


def sign_free_innovation(measured: Array, predicted: Array) -> Array:
    """Return ``+-measured - predicted``, whichever sign lies nearer: both are one attitude."""
    product = (measured * predicted).sum(-1, keepdims=True)
    return np.where(product < 0, -measured, measured) - predicted


_INTEGRATORS: dict[str, Integrator] = {"euler": euler_step, "rk4": rk4_step}


class Variances(Keys):
    """A variance for each block of the state."""

    q_ib: Positive
    """Variance of each component of `q_ib`."""
    q_bf: Positive
    """Variance of each component of `q_bf`."""
    rate_rad2_s2: Positive
    """Variance of each rate."""
    moments: Positive
    """Variance of each scaled moment."""

    def diagonal(self) -> Array:
        """Return the covariance (14, 14)."""
        blocks = (self.q_ib, self.q_bf, self.rate_rad2_s2, self.moments)
        return np.diag(np.repeat(blocks, (4, 4, 3, 3)))


class TumblingAttitude(ProblemPart):
    """The problem of this file, with its integrator and its noises (variances)."""

    version = 2
    needs = ("q_if",)
    model_kind = "model"
    start_needs = ("q_ib", "q_bf", "rate_b", "moments_b")
    kind: Literal["tumbling_attitude"]
    integrator: Literal["euler", "rk4"]
    """One step of the model per epoch: explicit Euler, or classical Runge-Kutta."""
    process_noise: Variances
    """Variances added per epoch."""
    measurement_noise: Positive
    """Variance of each quaternion component."""

    def measurements(self, data: Data) -> Array:
        """Return the recovered attitude (run, time, 4)."""
        return data["q_if"]

    def model(self, data: Data, clock: Clock) -> Model:
        """Return process and measurement; each epoch has its own step, and all the same noise."""
        integrator, steps = _INTEGRATORS[self.integrator], clock.steps
        return Model(
            process=lambda state, k: process(state, steps[k], integrator),
            measurement=lambda state, _: measured_attitude(state),
            process_noise=self.process_noise.diagonal(),
            measurement_noise=self.measurement_noise * np.eye(4),
            error_names=ERROR_NAMES,
            retract=correct,
            innovation=sign_free_innovation,
        )

    def pack(self, guess: Data, variance: Data) -> tuple[Array, Array]:
        """Return the initial state (run, 14) and covariance (run, 14, 14)."""
        state, diagonal = (
            np.concatenate([parts[name] for name in self.start_needs], axis=-1)
            for parts in (guess, variance)
        )
        return state, diagonal[..., None] * np.eye(14)

    def unpack(self, filtered: Estimates) -> Data:
        """Return the estimated quantities by name, each with its sigma."""
        blocks = {"q_ib": Q_IB, "q_bf": Q_BF, "rate_b": RATE, "moments_b": MOMENTS}
        return {name: filtered.state[..., block] for name, block in blocks.items()} | {
            f"{name}_sigma": filtered.sigma[..., block] for name, block in blocks.items()
        }

    def assess(self, data: Data, scored: Window) -> Data:
        """Return errors of attitude, rate and inertia in true principal axes, if known."""
        return scores(data, scored, data["covariance"][..., RATE, RATE])
