"""The surface of a body as light meets it: hits of rays, shadows, texture."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.vision.libraries import vision_library
from debrisest.vision.polyhedron import face_normals
from debrisest.vision.solids import Solid
from debrisest.vision.texture import SolidNoise

_OFF_SURFACE = 1e-4
"""Of the body's size: from where a shadow is looked for."""


class Hits(NamedTuple):
    """Where rays meet a body; only those that do."""

    ray: IntArray
    """Which rays (hit,)."""
    points: Array
    """(hit, 3), m, body axes."""
    normals: Array
    """Outward, of unit length (hit, 3)."""
    triangles: IntArray


class Surface:
    """A textured body, with the library embree to cast rays at it."""

    def __init__(self, solid: Solid, texture: SolidNoise) -> None:
        corners = solid.vertices[solid.triangles]
        normals = face_normals(corners)
        self.radius = float(np.linalg.norm(solid.vertices, axis=-1).max())
        self._normals = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
        self._corners, self._albedo, self._texture = corners[:, 0], solid.albedo, texture
        self._scene = vision_library("embreex.rtcore_scene").EmbreeScene()
        mesh = vision_library("embreex.mesh_construction").TriangleMesh
        mesh(
            self._scene,
            solid.vertices.astype(np.float32),
            np.ascontiguousarray(solid.triangles, dtype=np.int32),
        )

    def hits(self, origin: Array, directions: Array) -> Hits:
        """Return what rays (n, 3) from one origin (3,) meet, in body axes."""
        ray = np.flatnonzero(self._near(origin, directions))
        hit = self._cast(np.broadcast_to(origin, (len(ray), 3)), directions[ray])
        ray, hit = ray[hit >= 0], hit[hit >= 0]
        normals = self._normals[hit]
        depth = np.sum((self._corners[hit] - origin) * normals, axis=-1)
        scale = depth / np.sum(directions[ray] * normals, axis=-1)
        return Hits(ray, origin + scale[:, None] * directions[ray], normals, hit)

    def lit(self, hits: Hits, sun: Array) -> Array:
        """Return the cosine (hit,) of the sun's direction (3,) to the normals; 0 in shadow."""
        cosine = np.maximum(hits.normals @ sun, 0.0)
        faces = np.flatnonzero(cosine > 0.0)
        start = hits.points[faces] + _OFF_SURFACE * self.radius * hits.normals[faces]
        hidden = self._cast(start, np.broadcast_to(sun, start.shape)) >= 0
        cosine[faces[hidden]] = 0.0
        return np.asarray(cosine)

    def colour(self, hits: Hits) -> Array:
        """Return the part of the light (hit,) that the surface sends back."""
        pattern = self._texture(hits.points)
        return np.asarray(self._albedo[hits.triangles] * (0.25 + 0.75 * pattern))

    def _near(self, origin: Array, directions: Array) -> BoolArray:
        """Return which rays pass the sphere about the body."""
        closest = np.linalg.norm(np.cross(directions, origin), axis=-1)
        return np.asarray(closest <= self.radius * np.linalg.norm(directions, axis=-1))

    def _cast(self, origins: Array, directions: Array) -> IntArray:
        """Return the first triangle that each ray meets, -1 if none."""
        if not len(origins):
            return np.zeros(0, dtype=np.int64)
        found = self._scene.run(
            np.ascontiguousarray(origins, dtype=np.float32),
            np.ascontiguousarray(directions, dtype=np.float32),
        )
        return np.asarray(found, dtype=np.int64)
