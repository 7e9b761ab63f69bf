"""The answer: the motion of one body, what it is worth, and what the data cannot tell."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.batch.acceptance import Fit
from debrisest.batch.arc import INERTIA, Arc
from debrisest.batch.descent import PRIOR_SIGMA
from debrisest.batch.evidence import Evidence
from debrisest.batch.local_rates import Local
from debrisest.batch.path import Path, path_of, unknown_path
from debrisest.batch.smoother import Wander, smooth
from debrisest.batch.spread import Spread
from debrisest.outcome import Outcome


class Status(Outcome):
    """How an estimate ended."""

    ACCEPTED = 0, "torque-free motion explains the data: attitude, rate and inertia ratios hold"
    ACCEPTED_IN_PART = (
        1,
        "torque-free motion explains the data: attitude and rate hold, but the motion does not "
        "show all of the inertia (a slow or almost steady one does not); use only the directions "
        "whose sigma is small",
    )
    WITHOUT_INERTIA = (
        2,
        "the body turns steadily about one axis, as far as the noise shows, or inertias far from "
        "each other explain the data: attitude and rate hold, of the inertia nothing is shown",
    )
    UNTESTED = (
        3,
        "torque-free motion fits, but the data are too few to test it: more epochs, or more points "
        "at an epoch, would decide",
    )
    MODEL_IN_DOUBT = (
        4,
        "the known points do not fit each other, and the data cannot tell which of them is "
        "elsewhere: check their places, or estimate with unknown points",
    )
    NOT_TORQUE_FREE = (
        5,
        "no torque-free motion explains the data beyond the stated times: attitude and rate are "
        "from a smoother that assumes no law of motion, and no inertia is claimed",
    )
    TOO_FEW = (
        6,
        "too few data for a motion: it takes six epochs, close enough in time that the body turns "
        "less than a quarter turn between them, each with an attitude or three points not in line",
    )

    @property
    def accepted(self) -> bool:
        """Whether torque-free motion has been tested and holds."""
        return self <= Status.WITHOUT_INERTIA


class Judged(Outcome):
    """By which tests."""

    CHI_SQUARE_AND_BLOCKS = 0, "the residuals are as large as the given noise, and none last"
    NOISE_UNKNOWN = (
        1,
        "no noise was given: it is estimated from the residuals, whose size therefore proves "
        "nothing; judged by residuals that last (block test) alone",
    )
    NOISE_LARGER = (
        2,
        "the residuals are larger than the given noise but do not last: the noise is taken as it "
        "is found, and the sigmas with it",
    )


class Motion(NamedTuple):
    """Motion of the feature frame ``f``; with unknown points ``f`` is inertial at the arc's epoch.

    Where the status is `NOT_TORQUE_FREE`, ``arc`` is None and the path is the smoother's.
    """

    status: Status
    judged: Judged
    path: Path
    """At all epochs given."""
    arc: Arc | None
    covariance: Array
    """Of the errors of the arc's unknowns (11, 11), NaN without an arc. That of the inertia is a
    claim only where the status is `ACCEPTED` or `ACCEPTED_IN_PART`, see `claimed`."""
    spread: Spread | None
    """The same as motions, None without an arc."""
    fit: Fit | None
    holds: tuple[float, float]
    """Times, s, over which the best torque-free arc explains the data."""
    noise: float
    """Standard deviation of the measurements as taken, in units of the ones given (or unit: m)."""
    points: Array
    """Places of points (feature, 3), m; NaN for those left out. Without points (0, 3)."""
    points_sigma: Array
    """(feature, 3), m; zero where they were given."""
    kept: BoolArray
    """Which points belong to the body (feature,)."""
    other_body: BoolArray
    """Which of the other points keep their distances from each other (feature,): a second body."""
    used: BoolArray
    """Which observations count: (time, feature), or (time,) without points."""
    rejected: float
    """Share of the observations that do not."""
    evidence: Evidence | None
    local: Local | None
    wander: Wander | None

    @property
    def claimed(self) -> Array:
        """Covariance (11, 11) of what is claimed: the prior's of an inertia that is not shown."""
        return self.claim(self.covariance)

    def claim(self, covariance: Array) -> Array:
        """Return what is claimed of a covariance (..., 11, 11) of attitude, rate and inertia."""
        if self.status in (Status.ACCEPTED, Status.ACCEPTED_IN_PART):
            return covariance
        result = covariance.copy()
        result[..., INERTIA, :], result[..., INERTIA] = 0.0, 0.0
        result[..., INERTIA, INERTIA] = PRIOR_SIGMA**2 * np.eye(5)
        return result

    def at(self, times: Array) -> Path:
        """Return the motion at any ``times (time,)``, s, increasing, with covariances."""
        if self.arc is not None and self.spread is not None:
            return path_of(self.arc, self.spread, times)
        if self.evidence is None or self.local is None or self.wander is None:
            return unknown_path(times)
        return smooth(self.evidence, self.local, self.wander, times)


NO_COVARIANCE = np.full((11, 11), np.nan)
