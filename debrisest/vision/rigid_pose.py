"""The pose of a rigid body from points that a stereo pair sees, some of them wrong."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.attitude import quaternion
from debrisest.attitude.points import wahba
from debrisest.vision.stereo_pair import StereoPair

_TRIPLES = 200
_ITERATIONS = 6
_FEWEST = 5
"""Points that must agree: three fit any pose."""


class RigidPose(NamedTuple):
    """Takes points of the body to the camera's axes: ``rotation x_b + translation``."""

    rotation: Array
    """(3, 3)."""
    translation: Array
    """(3,), m."""

    def of(self, points: Array) -> Array:
        """Return points (..., 3) of the body in the camera's axes."""
        return np.asarray(points @ self.rotation.T + self.translation)

    def back(self, points: Array) -> Array:
        """Return points (..., 3) of the camera's axes in those of the body."""
        return np.asarray((points - self.translation) @ self.rotation)

    def after(self, before: "RigidPose") -> "RigidPose":
        """Return where the body comes if it moves once more as from ``before`` to here."""
        turn = self.rotation @ before.rotation.T
        return RigidPose(
            turn @ self.rotation, turn @ (self.translation - before.translation) + self.translation
        )


def fit(
    pair: StereoPair, body: Array, pixels: Array, gate: float, draws: np.random.Generator
) -> tuple[RigidPose, BoolArray] | None:
    """Return the pose that most points agree on, and which do: to less than ``gate`` px.

    Triples of points (Fischler and Bolles 1981), then least squares of the pixels ``(n, camera,
    2)`` of those that agree. ``body (n, 3)``, m. None where fewer than five agree.
    """
    if len(body) < _FEWEST:
        return None
    seen, _ = pair.points(pixels)
    pose = _best_triple(pair, body, seen, pixels, gate, draws)
    for _ in range(_ITERATIONS):
        agree = off(pair, pose, body, pixels) < gate
        if agree.sum() < _FEWEST:
            return None
        pose = _step(pair, pose, body[agree], pixels[agree])
    agree = off(pair, pose, body, pixels) < gate
    return (pose, agree) if agree.sum() >= _FEWEST else None


def off(pair: StereoPair, pose: RigidPose, body: Array, pixels: Array) -> Array:
    """Return how far points are from where a pose shows them (n,), px, in the worse image."""
    shown = pair.project(pose.of(body))
    distance = np.linalg.norm(shown - pixels, axis=-1).max(axis=-1)
    return np.asarray(np.where(np.isfinite(distance), distance, np.inf))


def _best_triple(
    pair: StereoPair,
    body: Array,
    seen: Array,
    pixels: Array,
    gate: float,
    draws: np.random.Generator,
) -> RigidPose:
    triples = np.argsort(draws.random((_TRIPLES, len(body))), axis=-1)[:, :3]
    turns = np.stack([wahba(body[one], seen[one]) for one in triples])
    turns = np.where(np.isfinite(turns), turns, np.eye(3))
    shifts = seen[triples].mean(axis=1) - np.einsum("kij,kj->ki", turns, body[triples].mean(axis=1))
    shown = pair.project(body @ np.swapaxes(turns, -1, -2) + shifts[:, None])
    distance = np.linalg.norm(shown - pixels, axis=-1).max(axis=-1)
    cost = np.minimum(np.where(np.isfinite(distance), distance, np.inf), gate).sum(axis=-1)
    best = int(cost.argmin())
    return RigidPose(turns[best], shifts[best])


def _step(pair: StereoPair, pose: RigidPose, body: Array, pixels: Array) -> RigidPose:
    """Return the pose after a step of Gauss and Newton."""
    points = pose.of(body)
    residual = (pixels - pair.project(points)).reshape(-1)
    by_point = pair.derivative(points)
    arm = points - pose.translation
    turn = np.cross(np.eye(3), arm[:, None]).swapaxes(-1, -2)
    by_turn = np.einsum("ncij,njk->ncik", by_point, turn)
    jacobian = np.concatenate([by_turn, by_point], axis=-1).reshape(-1, 6)
    step = np.linalg.lstsq(jacobian, residual)[0]
    rotation = quaternion.to_matrix(quaternion.exp(step[:3])) @ pose.rotation
    return RigidPose(rotation, pose.translation + step[3:])
