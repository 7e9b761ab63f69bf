"""Keys of the pointing control: gains of its two stages, and when it changes between them."""

from typing import Annotated, Self

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from debrisest.control import attitude_hold, pixel_tracking
from debrisest.control.rigid_spacecraft import spacecraft
from debrisest.control.robust_term import Gains
from debrisest.control.two_stage import Switch
from debrisest.roles import Keys, NonNegative, Positive, Vector3

_SWITCH = Switch()

_Pair = Annotated[list[Positive], Field(min_length=2, max_length=2)]
_Triple = Annotated[list[Positive], Field(min_length=3, max_length=3)]
_Five = Annotated[list[Positive], Field(min_length=5, max_length=5)]


def _of_a_body(inertia: list[list[float]]) -> list[list[float]]:
    spacecraft(np.array(inertia))
    return inertia


Tensor = Annotated[list[Vector3], Field(min_length=3, max_length=3), AfterValidator(_of_a_body)]


class OwnSatellite(Keys):
    """What one satellite has of its own."""

    inertia_kg_m2: Tensor | None = None
    """Inertia tensor, body axes, instead of the common one."""
    angles_deg: Vector3 = [0.0, 0.0, 0.0]
    """Euler angles 3-2-1 at the start."""


class Tracking(Keys):
    """Gains of the first stage: two pixels, three rates."""

    proportional: _Five = pixel_tracking.GAINS.proportional.tolist()
    """Gain of the error and of its integral."""
    damping: _Pair = pixel_tracking.GAINS.damping.tolist()
    """Gain of the pixel's rate."""
    robustness: _Five = pixel_tracking.GAINS.robustness.tolist()
    """Gain of the sliding surface."""
    boundary: _Five = pixel_tracking.GAINS.boundary.tolist()
    """Half the linear stretch of `saturated`."""


class Holding(Keys):
    """Gains of the second stage: three Euler angles."""

    proportional: _Triple = attitude_hold.GAINS.proportional.tolist()
    """Gain of the error and of its integral."""
    damping: _Triple = attitude_hold.GAINS.damping.tolist()
    """Gain of the angles' rate."""
    robustness: _Triple = attitude_hold.GAINS.robustness.tolist()
    """Gain of the sliding surface."""
    boundary: _Triple = attitude_hold.GAINS.boundary.tolist()
    """Half the linear stretch of `saturated`."""


class Switching(Keys):
    """When the first stage has done its work, and how long the second lasts."""

    pixel_px: Positive = _SWITCH.pixel
    """The pixel is small below that."""
    rate_rad_s: Positive = _SWITCH.rate
    """The rate is small below that."""
    calm_s: NonNegative = _SWITCH.calm
    """The first stage ends after pixel and rate were small so long."""
    least_s: NonNegative = _SWITCH.least
    """The first stage does not end before."""
    most_s: Positive = _SWITCH.most
    """The first stage ends at the latest then; from `least_s`."""
    hold_s: NonNegative = _SWITCH.hold
    """Length of the second stage."""

    @model_validator(mode="after")
    def _least_below_most(self) -> Self:
        if self.least_s > self.most_s:
            raise ValueError(
                f"least_s, {self.least_s:g} s, must not be longer than most_s, {self.most_s:g} s"
            )
        return self


def gains(keys: Tracking | Holding) -> Gains:
    """Return the gains as arrays."""
    return Gains(
        np.array(keys.proportional),
        np.array(keys.damping),
        np.array(keys.robustness),
        np.array(keys.boundary),
    )


def switch(keys: Switching) -> Switch:
    """Return when the stages change."""
    return Switch(
        keys.pixel_px, keys.rate_rad_s, keys.calm_s, keys.least_s, keys.most_s, keys.hold_s
    )
