"""A start from the first points of a body whose points are known."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.attitude.points import wahba
from debrisest.clock import Clock
from debrisest.problems.tumbling.points import MotionVariances
from debrisest.roles import StartPart


class FirstPoints(StartPart):
    """Attitude and rate from the first epochs that have an attitude, equal moments.

    These epochs are measurements too: the guess tells where to begin, and variances should be wide
    enough that it carries practically no information of its own.
    """

    needs = ("measured_point", "known_point_f")
    guesses = ("q_if", "rate_f", "log_inertia")
    kind: Literal["first_points"]
    samples: Annotated[int, Field(ge=2)] = 5
    """The rate is the mean of one turn less than that."""
    variance: MotionVariances
    """Variances of the start."""

    def start(self, data: Data, clock: Clock) -> tuple[Data, Data]:
        """Return the initial guess by name, NaN without an attitude, and its variance by name."""
        q_if = quaternion.from_matrix(wahba(data["known_point_f"][0], data["measured_point"]))
        rate = _first_rate(q_if, clock.steps, self.samples)
        first = np.argmax(np.isfinite(q_if[..., 0]), axis=-1)
        turned_back = quaternion.exp(-rate * (clock.times[first] - clock.times[0])[:, None])
        guess: Data = {
            "q_if": quaternion.multiply(q_if[np.arange(len(q_if)), first], turned_back),
            "rate_f": rate,
            "log_inertia": np.zeros((len(q_if), 5)),
        }
        known, runs = self.variance, len(q_if)
        return guess, {
            "q_if": np.full((runs, 3), known.attitude_rad2),
            "rate_f": np.full((runs, 3), known.rate_rad2_s2),
            "log_inertia": np.full((runs, 5), known.log_inertia),
        }


def _first_rate(q: Array, steps: Array, samples: int) -> Array:
    """Mean rate (run, 3) of the first ``samples - 1`` pairs of epochs that tell it."""
    turn = quaternion.log(quaternion.multiply(quaternion.conjugate(q[:, :-1]), q[:, 1:]))
    turn /= steps[:, None]
    known = np.isfinite(turn).all(axis=-1)
    used = (known & (np.cumsum(known, axis=-1) < samples))[..., None]
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(used, turn, 0.0).sum(axis=1) / used.sum(axis=1))
