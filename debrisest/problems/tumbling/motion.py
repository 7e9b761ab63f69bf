"""The whole motion of a body at once, from its points, from attitudes or from its rates.

No start is needed, and none is believed: torque-free motion is tested, and what the measurements
do not show is said (`debrisest.batch`). The places of the points may be unknown.
"""

from collections.abc import Callable
from functools import partial
from typing import Literal

import numpy as np
from pydantic import model_validator

from debrisest.arrays import Array, Data
from debrisest.assessment.statistics import per_dimension
from debrisest.attitude import quaternion
from debrisest.batch.arc import Arc
from debrisest.batch.estimate import (
    estimate_from_attitudes,
    estimate_from_rates,
    estimate_from_tracks,
)
from debrisest.batch.motion import Motion
from debrisest.batch.motion_model import Estimate, MotionModel
from debrisest.batch.tracks import tracks
from debrisest.clock import Clock
from debrisest.filters.estimates import Estimates
from debrisest.problems.tumbling import points_motion as body
from debrisest.problems.tumbling.feature_frame import InFeatureFrame
from debrisest.problems.tumbling.gauge import in_true_frame
from debrisest.problems.tumbling.right_or_wrong import right_or_wrong
from debrisest.roles import Window

_NO_NOISE = "points without noise weigh infinitely: their noise must be positive"
_NEEDS = {"points": "measured_point", "attitudes": "measured_q_if", "rates": "measured_rate_f"}


class TumblingMotion(InFeatureFrame):
    """Measurements of one body, each with the noise that is told with it, or none.

    Without known geometry the feature frame is fixed in the body and inertial at some epoch.
    """

    model_kind = "motion_model"
    kind: Literal["tumbling_motion"]
    measured: Literal["points", "attitudes", "rates"] = "points"
    """What is used: `measured_point`, `measured_q_if` or `measured_rate_f`."""
    geometry: Literal["known", "unknown"] = "known"
    """Whether the points' places `known_point_f` are known, or estimated along; the body's axes are
    then free, and inertial at one epoch."""

    @model_validator(mode="after")
    def _geometry_of_points(self) -> "TumblingMotion":
        if self.measured != "points" and self.geometry != "known":
            raise ValueError("geometry is that of points; leave it out")
        return self

    @property
    def needed(self) -> tuple[str, ...]:
        """Return the datasets that are needed: with known geometry that of the points."""
        known = self.measured == "points" and self.geometry == "known"
        return (_NEEDS[self.measured], *(["known_point_f"] if known else []))

    def measurements(self, data: Data) -> Array:
        """Return the measurements by epoch (run, time, m)."""
        values = data[_NEEDS[self.measured]]
        return values.reshape(*values.shape[:2], -1)

    def model(self, data: Data, clock: Clock) -> MotionModel:
        """Return what gives the motion of a run."""
        estimators: dict[str, Callable[[Data, Array, int], Estimate]] = {
            "points": partial(_of_points, self.geometry == "known"),
            "attitudes": partial(partial, _from_attitudes),
            "rates": partial(partial, _from_rates),
        }
        estimate = estimators[self.measured]
        return MotionModel(
            times=clock.times,
            runs=len(data["run"]),
            estimate=partial(estimate, data, clock.times),
            error_names=body.ERROR_NAMES,
            frame_is_given=not self._frame_is_free,
        )

    def unpack(self, filtered: Estimates) -> Data:
        """Return the estimates in feature frame and principal axes, each with its sigma."""
        state, sigma = filtered.state, filtered.sigma
        return super().unpack(filtered) | {
            "q_if": state[..., body.Q],
            "q_if_sigma": 0.5 * _component_sigma(state[..., body.Q], sigma[..., body.TURN_ERROR]),
            "rate_f": state[..., body.RATE],
            "rate_f_sigma": sigma[..., body.RATE_ERROR],
            "log_inertia_f": state[..., body.LOG_INERTIA],
            "log_inertia_f_sigma": sigma[..., body.INERTIA_ERROR],
        }

    def assess(self, data: Data, scored: Window) -> Data:
        """Return errors in true principal axes, if known; unknown geometry leaves a frame free."""
        counted = ("accepted", "fit", "lost_directions", "rejected_share", "features_used")
        seen = data["rejected"] + data["observations_used"]
        share = {"rejected": per_dimension(data["rejected"], seen)}
        said = share | {name: data[name] for name in counted if name in data}
        if self.measured == "points" and {*self.true_state, "point_noise"} <= data.keys():
            said |= right_or_wrong(data, self.truth(data), self._frame_is_free)
        return said | super().assess(data, scored)

    def in_true_frame(self, data: Data) -> Data:
        """Return the data with ``q_bf`` from the true feature frame."""
        return in_true_frame(data) if self._frame_is_free and "true_q_ib" in data else data

    @property
    def _frame_is_free(self) -> bool:
        return self.measured == "points" and self.geometry == "unknown"


def _of_points(known: bool, data: Data, times: Array, run: int) -> Estimate:
    """Return what estimates from the points so far; what these are is looked at once."""
    points, model = data["measured_point"][run], data["known_point_f"][run] if known else None
    sigma = data["point_sigma"][run] if "point_sigma" in data else None
    if sigma is None and "point_noise" in data:
        sigma = np.full(points.shape, data["point_noise"][run])
    plain = tracks(times, points, 1.0)
    weighed = None if sigma is None else tracks(times, points, sigma)

    def estimate(count: int, near: Arc | None, at: Array | None) -> Motion:
        so_far, given = slice(count), None
        if sigma is not None and weighed is not None and not np.isnan(sigma[so_far]).all():
            given = weighed.within(so_far)
            if not np.nanmax(sigma[so_far]) > 0.0:
                raise ValueError(
                    "points without noise weigh infinitely: their noise must be positive"
                )
        return estimate_from_tracks(plain.within(so_far), given, model, near, at)

    return estimate


def _from_attitudes(
    data: Data, times: Array, run: int, count: int, near: Arc | None, at: Array | None
) -> Motion:
    q = data["measured_q_if"][run, :count]
    if "measured_q_if_covariance" in data:
        sigma = data["measured_q_if_covariance"][run, :count]
    else:
        sigma = data["q_if_noise"][run, :count]
    given = None if np.isnan(sigma).all() else sigma
    return estimate_from_attitudes(times[:count], q, given, near, at)


def _from_rates(
    data: Data, times: Array, run: int, count: int, near: Arc | None, at: Array | None
) -> Motion:
    sigma = data["rate_f_noise"][run, :count]
    given = None if np.isnan(sigma).all() else sigma
    return estimate_from_rates(times[:count], data["measured_rate_f"][run, :count], given, near, at)


def _component_sigma(q: Array, turn_sigma: Array) -> Array:
    """Standard deviations (..., 4) of a quaternion's components, twice, of turns in the left axes.

    As if the three angles were uncorrelated.
    """
    by_turn = np.stack(
        [quaternion.multiply(np.insert(axis, 0, 0.0), q) for axis in np.eye(3)], axis=-1
    )
    return np.asarray(np.sqrt((by_turn**2 @ (turn_sigma**2)[..., None])[..., 0]))
