"""Poses of a structure by its small features: large ones lie inside of a rounded surface.

A feature is an area, not a point. Of one of scale s (its sigma, px) on a surface of radius r, the
middle of what an image shows lies nearer to the body's middle than the surface does, since the side
that faces away is foreshortened: ``sin(a + b)``, weighted by ``cos(a + b)`` with a variance
``(s/r)^2`` of b, has the mean ``sin a (1 - 3/2 (s/r)^2)``. On a rendered stage, triangulated with
the true poses, features of 1.6 to 8 px lie inside by this ``3/2 s^2/r``. It draws the poses too. So
the half of each image's features that are smallest tell them, and what is off counts by the law of
Cauchy.
"""

from typing import Any

import numpy as np

from debrisest.arrays import Array
from debrisest.reconstruction.structure_job import Job, threads

_SHARE = 0.5
"""Of the features of an image, the smallest, that are kept."""
_USUAL_PX = 0.2
"""How far small features are off; beyond this they count less."""


def with_small_features(job: Job, model: Any) -> Any:
    """Return a copy of a structure with the smaller half of each image's features, adjusted."""
    copy = job.colmap.Reconstruction(model)
    with job.colmap.Database.open(job.database) as opened:
        keypoints = {number: opened.read_keypoints(number) for number in copy.images}
    for number, image in copy.images.items():
        _keep_small(copy, number, _scales(image, np.asarray(keypoints[number])))
    options = _options(job)
    options.refine_focal_length = job.how.calibrate
    job.colmap.bundle_adjustment(copy, options)
    return copy


def placed_by(job: Job, model: Any) -> Any:
    """Return a structure of small features, adjusted so that those that are off count less.

    The camera stays what it is.
    """
    options = _options(job)
    options.ceres.loss_function_type = job.colmap.LossFunctionType.CAUCHY
    options.ceres.loss_function_scale = _USUAL_PX
    job.colmap.bundle_adjustment(model, options)
    return model


def _options(job: Job) -> Any:
    options = job.colmap.BundleAdjustmentOptions(
        refine_focal_length=False,
        refine_principal_point=False,
        refine_extra_params=False,
        refine_sensor_from_rig=False,
        print_summary=False,
    )
    options.ceres.solver_options.num_threads = threads()
    return options


def _scales(image: Any, keypoints: Array) -> dict[int, float]:
    """Return the scale, px, of each feature of an image that is a point's.

    ``keypoints (n, 6)`` are columns, rows and affine shapes.
    """
    shapes = keypoints[:, 2:6].reshape(-1, 2, 2)
    sizes = np.linalg.norm(shapes, axis=1).mean(axis=1)
    points = enumerate(image.points2D)
    return {place: float(sizes[place]) for place, point in points if point.has_point3D()}


def _keep_small(model: Any, number: int, scales: dict[int, float]) -> None:
    """Remove the sightings of an image that are larger than most of them."""
    if not scales:
        return
    most = np.quantile(list(scales.values()), _SHARE)
    for place, scale in scales.items():
        if scale > most and model.images[number].points2D[place].has_point3D():
            model.delete_observation(number, place)
