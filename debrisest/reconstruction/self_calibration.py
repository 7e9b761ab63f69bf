"""The camera as the images of a turning body tell it: bundle adjustment of a whole structure.

Model: one focal length, the principal point in the middle, and one coefficient k1 of distortion
where the images tell it: a body that fills a part of the image may not tell distortion from focal
length (in real photographs of a box a free coefficient drew the focal length from 1 % to 35 % off).
It is taken where it is far from zero by its own 1-sigma, leaves the focal length known and much
as it was, and draws the corners no farther out than lenses do: glints that stay while a glossy body
turns had told k1 = .49. The 1-sigma of the focal length is that of the adjustment with all poses
and points free, scaled by what the pixels leave, and one percent for what the model leaves out: a
principal point that is not in the middle, a lens that bends otherwise.
"""

from typing import Any

import numpy as np

from debrisest.arrays import Array
from debrisest.reconstruction.structure import Lens

_LEFT_OUT = 0.01
_SIGMAS, _FOCAL_KNOWN, _FOCAL_KEPT, _CORNERS_OUT = 5.0, 0.03, 0.1, 0.03
"""A coefficient is taken that is so many sigma from zero and leaves the focal length a spread below
this, and within this of what it was without, and the corners no farther out than this."""


def bent_as_told(colmap: Any, model: Any, lens: Lens) -> tuple[Any, Lens]:
    """Return a structure without distortion and its lens; with distortion where the images tell it.

    ``colmap`` is the library, ``model`` its reconstruction, in which all images have one camera.
    """
    bent = _bending(colmap, model)
    found = lens_of(colmap, bent)
    told = abs(found.distortion[0]) > _SIGMAS * found.distortion_sigma
    kept = abs(found.matrix[0, 0] / lens.matrix[0, 0] - 1.0) < _FOCAL_KEPT
    known = found.focal_spread < _FOCAL_KNOWN and _corners_out(found) < _CORNERS_OUT
    return (bent, found) if told and kept and known else (model, lens)


def _corners_out(lens: Lens) -> float:
    """Return how far, of its distance from the middle, k1 draws the corner of an image outwards."""
    corner = (lens.matrix[:2, 2] + 0.5) / lens.matrix[0, 0]
    return float(lens.distortion[0] * corner @ corner)


def _bending(colmap: Any, model: Any) -> Any:
    """Return a copy of a structure whose camera has one coefficient of distortion, adjusted."""
    copy = colmap.Reconstruction(model)
    (camera,) = copy.cameras.values()
    params = [*camera.params, 0.0]
    camera.model = colmap.CameraModelId.SIMPLE_RADIAL
    camera.params = params
    colmap.bundle_adjustment(copy, colmap.BundleAdjustmentOptions(refine_principal_point=False))
    return copy


def lens_of(colmap: Any, model: Any) -> Lens:
    """Return the camera of a structure in which all images have the same one.

    The spread is infinite where the images do not tell the focal length.
    """
    (camera,) = model.cameras.values()
    focal, u, v, *bent = camera.params
    matrix = np.array([[focal, 0.0, u - 0.5], [0.0, focal, v - 0.5], [0.0, 0.0, 1.0]])
    sigma = np.sqrt(_cofactors(colmap, model, camera) * _pixel_variance(model))
    spread = float(np.hypot(sigma[0] / focal, _LEFT_OUT))
    distortion = np.array([*bent, *[0.0] * 5])[:5]
    return Lens(matrix, distortion, spread, float(sigma[-1]) if bent else 0.0)


def _cofactors(colmap: Any, model: Any, camera: Any) -> Array:
    """Return the variances of the camera's numbers for pixels of variance one; inf: unknown."""
    config = colmap.BundleAdjustmentConfig()
    for image in model.reg_image_ids():
        config.add_image(image)
    config.fix_gauge(colmap.BundleAdjustmentGauge.TWO_CAMS_FROM_WORLD)
    options = colmap.BundleAdjustmentOptions(refine_principal_point=False)
    adjuster = colmap.create_default_ceres_bundle_adjuster(options, config, model)
    adjuster.solve()
    found = colmap.estimate_ba_covariance(colmap.BACovarianceOptions(), model, adjuster)
    cofactor = None if found is None else found.get_other_params_cov(camera.params)
    return np.full(len(camera.params), np.inf) if cofactor is None else np.diag(cofactor)


def _pixel_variance(model: Any) -> float:
    """Return the variance of a pixel's coordinate, by what the structure leaves of all."""
    left = [
        point.xy - image.project_point(model.points3D[point.point3D_id].xyz)
        for image in model.images.values()
        for point in image.points2D
        if point.has_point3D()
    ]
    free = 2 * len(left) - 3 * len(model.points3D) - 6 * len(model.images)
    return float(np.square(left).sum() / max(free, 1))
