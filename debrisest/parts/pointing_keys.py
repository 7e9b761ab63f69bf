"""Keys of the pointing control: gains of its two stages, and when it changes between them."""

from typing import Annotated

import numpy as np
from pydantic import Field

from debrisest.control.robust_term import Gains
from debrisest.control.two_stage import Switch
from debrisest.roles import Keys, NonNegative, Positive

_Pair = Annotated[list[Positive], Field(min_length=2, max_length=2)]
_Triple = Annotated[list[Positive], Field(min_length=3, max_length=3)]
_Five = Annotated[list[Positive], Field(min_length=5, max_length=5)]


class Tracking(Keys):
    """Gains of the first stage: two pixels, three rates."""

    proportional: _Five = [5.0, 5.0, 1.0, 1.0, 1.0]
    damping: _Pair = [3.0, 3.0]
    robustness: _Five = [0.1, 0.1, 0.001, 0.0005, 0.001]
    boundary: _Five = [60.0, 60.0, 0.3, 0.3, 0.3]


class Holding(Keys):
    """Gains of the second stage: three Euler angles."""

    proportional: _Triple = [10.0, 10.0, 10.0]
    damping: _Triple = [1.0, 1.0, 1.0]
    robustness: _Triple = [0.001, 0.001, 0.001]
    boundary: _Triple = [0.2, 0.2, 0.2]


class Switching(Keys):
    """When the first stage has done its work, and how long the second lasts."""

    pixel_px: Positive = 1.5
    rate_rad_s: Positive = 0.01
    calm_s: NonNegative = 0.5
    least_s: NonNegative = 3.0
    most_s: Positive = 40.0
    hold_s: NonNegative = 15.0


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
