"""A mesh of a body from images whose places are known, and its mass properties."""

from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.filters.estimates import Estimates
from debrisest.outcome import Outcome, sentences
from debrisest.parts.recoveries.structure import padded
from debrisest.problems.shape.model import ShapeModel
from debrisest.reconstruction.body import (
    LEAST_COVERAGE,
    LEAST_GUESSED,
    Body,
    Method,
    Support,
    reconstructed_body,
)
from debrisest.reconstruction.error_bars import packed
from debrisest.reconstruction.outline_choice import Outline
from debrisest.roles import FilterPart, Given

_ON_TABLE = (
    "; it turned about one axis, seen from above: its base is taken to be flat at the lowest "
    "points seen, and does not count as unseen (support: none, or --no-support, if it hangs free)"
)
_SUPPORT_CUT = (
    "; it stands on a plane that turns with it, which is cut off: the base is taken to be flat "
    "there, and does not count as unseen (support: none, or --no-support, if the plane is its own)"
)


_GUESS = "not confident: a guess, since much was never seen; the bars count that"


class SurfaceStatus(Outcome):
    """How a mesh ended; `sentence` tells the user."""

    CLOSED = 0, "a closed mesh; the error bars count scale, coverage and resolution"
    NO_SCALE = 1, "a closed mesh without a scale: only ratios are told"
    UNSEEN = 2, "too much was never seen: no number is told; let it turn more, or look lower too"
    GUESSED = 3, f"{_GUESS}; let it turn more, or look lower too"
    GUESSED_RATIOS = 4, f"{_GUESS}; without a scale: only ratios are told"


_METHODS: dict[Method, str] = {
    "fusion": "silhouettes fused with depth: closes whatever is seen and keeps thin panels",
    "poisson": "screened Poisson surface of the dense cloud: for compact bodies",
}


class Surface(FilterPart):
    """A closed surface from depth and silhouettes."""

    takes = "shape_model"
    makes_start = True
    version = 4
    libraries = ("cv2", "pycolmap", "skimage")
    kind: Literal["surface"]
    method: Method = "fusion"
    """Silhouettes fused with depth, which closes whatever is seen and keeps thin panels, or the
    screened Poisson surface of the dense cloud, for compact bodies."""
    outline: Outline = "silhouettes"
    """What the body ends at in each image: its silhouette, or, where silhouettes do not hold four
    of five points of the cloud, the convex hull of the cloud."""
    support: Support = "found"
    """Where the outline is `either`: a table on which the body turned is looked for, cut off, and
    closes its base; or there is none, and the body goes on below as far as images let it."""

    def run(self, model: ShapeModel, given: Given) -> Estimates:
        """Return volume, centre and inertia of density one, the same at all epochs, and meshes."""
        runs, epochs = given.measured.shape[:2]
        bodies = [self._body(model, run) for run in range(runs)]
        scaled = np.isfinite(model.data["scale_spread"]) | (model.known_length is not None)
        told = np.array([body.coverage >= LEAST_GUESSED for body in bodies])
        confident = np.array([body.coverage >= LEAST_COVERAGE for body in bodies])
        blank = np.where(told, 1.0, np.nan)[:, None]
        state = np.stack([packed(body.properties) for body in bodies]) * blank
        sigma = np.stack([body.sigma for body in bodies]) * blank
        status = np.where(told, np.where(confident, 0, 3) + np.where(scaled, 0, 1), 2)
        return Estimates(
            state=np.repeat(state[:, None], epochs, axis=1),
            sigma=np.repeat(sigma[:, None], epochs, axis=1),
            covariance=(sigma**2)[:, None, :, None] * np.eye(sigma.shape[1]),
            kept=np.array([epochs - 1], dtype=np.int64),
            nis=np.full((runs, epochs), np.nan),
            nis_dof=np.zeros((runs, epochs), dtype=np.int64),
            status=sentences(status, SurfaceStatus),
            counts={
                **_meshes(bodies),
                "scaled": scaled.astype(np.float64),
                "confident": (confident & scaled).astype(np.float64),
            },
        )

    def _body(self, model: ShapeModel, run: int) -> Body:
        images = model.images(run, several=self.outline == "either")
        return reconstructed_body(
            *images, self.method, model.known_length, self.outline, self.support
        )


def _in_words(body: Body) -> str:
    """Return how a mesh was made, and why."""
    below = _SUPPORT_CUT if body.support_cut else _ON_TABLE * body.on_table
    return _METHODS[body.method] + below


def _meshes(bodies: list[Body]) -> Data:
    vertices = max(len(body.mesh.vertices) for body in bodies)
    triangles = max(len(body.mesh.triangles) for body in bodies)
    return {
        "vertex_r": np.stack([padded(body.mesh.vertices, vertices) for body in bodies]),
        "triangle_r": np.stack(
            [padded(body.mesh.triangles.astype(np.float64), triangles) for body in bodies]
        ),
        "triangle_seen": np.stack(
            [padded(body.seen.astype(np.float64), triangles) for body in bodies]
        ),
        "mesh_method": np.array([_in_words(body) for body in bodies]),
        "outline": np.array([body.outline for body in bodies]),
        "mended": np.array(["; ".join(body.mesh.mended) for body in bodies]),
        "cell": np.array([body.cell for body in bodies]),
        "surface_seen": np.array([body.coverage for body in bodies]),
        "hull_volume": np.array([body.hull_volume for body in bodies]),
        "silhouette_volume": np.array([body.silhouette_volume for body in bodies]),
    }
