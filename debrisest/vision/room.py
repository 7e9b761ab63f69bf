"""A room about the cameras that does not turn with the body."""

import numpy as np

from debrisest.arrays import Array
from debrisest.vision.texture import SolidNoise

_BRIGHTNESS = 0.6


class Room:
    """Walls with a pattern: a box about the first camera, reaching as far ahead as it is wide."""

    def __init__(self, half_side: float, texture: SolidNoise) -> None:
        self._half, self._texture = half_side, texture

    def shown(self, origin: Array, rays: Array) -> Array:
        """Return the light (n,) that comes along rays (n, 3) from a point (3,) inside."""
        with np.errstate(divide="ignore"):
            reach = np.min((np.copysign(self._half, rays) - origin) / rays, axis=-1)
        pattern = self._texture(origin + reach[:, None] * rays)
        return np.asarray(_BRIGHTNESS * (0.3 + 0.7 * pattern))
