"""Images of a textured body in sunlight, by ray casting."""

from typing import NamedTuple

import numpy as np
import scipy

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.vision.camera import PinholeImage
from debrisest.vision.room import Room
from debrisest.vision.surface import Surface

_WHITE = 255.0
"""Grey of a white surface that faces the sun."""
_SPECULAR, _SHARPNESS = 0.1, 20
SAMPLES = (np.indices((2, 2)).reshape(2, 4).T - 0.5) * 0.5
"""Points of a pixel, from its middle, at which it is sampled."""


class Light(NamedTuple):
    """The sun and what comes from everywhere else."""

    sun: Array
    """Unit vector (3,) towards it, first camera's axes."""
    ambient: float
    """Part of the light, between 0 and 1."""


class Pose(NamedTuple):
    """Of the body, in the axes of the first camera, at each of a pixel's samples."""

    q: Array
    """(sample, 4), body to camera axes."""
    position: Array
    """(sample, 3), m."""


class Renderer:
    """One camera, whose rays are made once; the samples of a pixel are those of its exposure."""

    def __init__(self, camera: PinholeImage, surface: Surface, light: Light, room: Room | None):
        self._camera, self._surface, self._light = camera, surface, light
        self._rays = [camera.rays(offset).reshape(-1, 3) for offset in SAMPLES]
        self._behind = [
            np.zeros(len(rays)) if room is None else room.shown(camera.position, rays)
            for rays in self._rays
        ]

    def image(self, pose: Pose, blur: float) -> Array:
        """Return grey values (height, width) without noise, blurred by a sigma in pixels."""
        shown = [self._sample(*each) for each in zip(self._rays, self._behind, *pose)]
        width, height = self._camera.size
        grey = _WHITE * np.mean(shown, axis=0).reshape(height, width)
        return np.asarray(scipy.ndimage.gaussian_filter(grey, blur) if blur else grey)

    def _sample(self, rays: Array, behind: Array, q: Array, position: Array) -> Array:
        """Return the light (ray,) of one point of every pixel."""
        turn = quaternion.to_matrix(q)
        origin, sun = (self._camera.position - position) @ turn, self._light.sun @ turn
        hits = self._surface.hits(origin, rays @ turn)
        cosine = self._surface.lit(hits, sun)
        ambient = self._light.ambient
        light = self._surface.colour(hits) * (ambient + (1.0 - ambient) * cosine)
        shown = behind.copy()
        shown[hits.ray] = light + _glint(hits.points, hits.normals, origin, sun) * (cosine > 0.0)
        return shown


def _glint(points: Array, normals: Array, eye: Array, sun: Array) -> Array:
    """Return the specular part (hit,), by the half vector of Blinn."""
    to_eye = eye - points
    half = sun + to_eye / np.linalg.norm(to_eye, axis=-1, keepdims=True)
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    return np.asarray(_SPECULAR * np.maximum(np.sum(normals * half, axis=-1), 0.0) ** _SHARPNESS)


def grey_levels(image: Array, noise: Array) -> Array:
    """Return an image (...) and its noise as whole grey levels from 0 to 255 (uint8)."""
    return np.asarray(np.clip(np.rint(image + noise), 0, 255).astype(np.uint8))
