"""Poses of a structure by its small features: large ones lie inside of a rounded surface.

A feature is an area, not a point. Of one of scale s (its sigma, px) on a surface of radius r, the
middle of what an image shows lies nearer to the body's middle than the surface does, since the side
that faces away is foreshortened: ``sin(a + b)``, weighted by ``cos(a + b)`` with a variance
``(s/r)^2`` of b, has the mean ``sin a (1 - 3/2 (s/r)^2)``. On a rendered stage, triangulated with
the true poses, features of 1.6 to 8 px lie inside by this ``3/2 s^2/r``; near the outline, where a
part of them is hidden, they draw the poses too. So the half of each image's features that are
smallest tell these, and what is off counts by the law of Cauchy.
"""

from collections import Counter
from typing import Any

import numpy as np

from debrisest.arrays import Array
from debrisest.reconstruction.structure_job import Job, threads

_SHARE = 0.5
"""Of the features of an image, the smallest, that are kept."""
_USUAL_PX = 0.2
"""How far small features are off; beyond this they count less."""
_LEAST_SEEN = 0.1
"""Of the points that a frame usually sees, below which it has no place."""
_MOST_PX, _LEAST_DEG = 4.0, 1.5
"""How far a point may be off where it is seen, least angle between lines of sight (COLMAP's)."""


def placed_by_small_features(job: Job, model: Any) -> Any:
    """Return a structure whose poses are those of the smaller half of each image's features.

    The camera stays what it is. Points of large features come back with the poses that were found.
    """
    small = job.colmap.Reconstruction(model)
    with job.colmap.Database.open(job.database) as opened:
        keypoints = {number: opened.read_keypoints(number) for number in small.images}
    for number, image in small.images.items():
        _keep_small(small, number, _scales(image, np.asarray(keypoints[number])))
    job.colmap.bundle_adjustment(small, _options(job))
    job.colmap.bundle_adjustment(small, _options(job, robust=True))
    return _with_all_points(job, model, small)


def _with_all_points(job: Job, model: Any, placed: Any) -> Any:
    """Return the structure with poses of another one, and its points adjusted to them."""
    for number in placed.reg_frame_ids():
        model.frames[number].rig_from_world = placed.frames[number].rig_from_world
    options = _options(job, robust=True)
    options.refine_rig_from_world = False
    job.colmap.bundle_adjustment(model, options)
    manager = job.colmap.ObservationManager(model)
    manager.filter_all_points3D(_MOST_PX, _LEAST_DEG)
    for frame in _strays(model):
        manager.deregister_frame(frame)
    return model


def _strays(model: Any) -> list[int]:
    """Return frames that see next to nothing of what others see: chance has placed them."""
    seen: Counter[int] = Counter()
    for image in model.images.values():
        seen[image.frame_id] += image.num_points3D
    least = _LEAST_SEEN * float(np.median(list(seen.values())))
    return [frame for frame, count in seen.items() if count < least]


def _options(job: Job, robust: bool = False) -> Any:
    options = job.colmap.BundleAdjustmentOptions(
        refine_focal_length=False,
        refine_principal_point=False,
        refine_extra_params=False,
        refine_sensor_from_rig=False,
        print_summary=False,
    )
    options.ceres.solver_options.num_threads = threads()
    if robust:
        options.ceres.loss_function_type = job.colmap.LossFunctionType.CAUCHY
        options.ceres.loss_function_scale = _USUAL_PX
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
