"""The camera as the images of a turning body tell it: bundle adjustment of a whole structure.

Model: one focal length, the principal point in the middle, no distortion. A body that fills a part
of the image does not tell distortion from focal length: in real photographs of a box a free
coefficient drew the focal length from 1 % to 35 % off. The 1-sigma of the focal length is that of
the adjustment with all poses and points free, scaled by what the pixels leave, and one percent for
what the model leaves out: a principal point that is not in the middle, a lens that bends.
"""

from typing import Any

import numpy as np

from debrisest.reconstruction.structure import Lens

_LEFT_OUT = 0.01


def lens_of(colmap: Any, model: Any) -> Lens:
    """Return the camera of a structure in which all images have the same one.

    ``colmap`` is the library, ``model`` its reconstruction. The spread is infinite where the images
    do not tell the focal length.
    """
    (camera,) = model.cameras.values()
    focal, u, v = camera.params
    matrix = np.array([[focal, 0.0, u - 0.5], [0.0, focal, v - 0.5], [0.0, 0.0, 1.0]])
    return Lens(matrix, np.zeros(5), _spread(colmap, model, camera))


def _spread(colmap: Any, model: Any, camera: Any) -> float:
    """Return the 1-sigma of the focal length, of it."""
    config = colmap.BundleAdjustmentConfig()
    for image in model.reg_image_ids():
        config.add_image(image)
    config.fix_gauge(colmap.BundleAdjustmentGauge.TWO_CAMS_FROM_WORLD)
    options = colmap.BundleAdjustmentOptions(refine_principal_point=False)
    adjuster = colmap.create_default_ceres_bundle_adjuster(options, config, model)
    adjuster.solve()
    found = colmap.estimate_ba_covariance(colmap.BACovarianceOptions(), model, adjuster)
    cofactor = None if found is None else found.get_other_params_cov(camera.params)
    if cofactor is None:
        return float(np.inf)
    variance = float(cofactor[0, 0]) * _pixel_variance(model)
    return float(np.hypot(np.sqrt(variance) / camera.params[0], _LEFT_OUT))


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
