"""A structure as arrays, and how well the rig gives its scale."""

from typing import Any

import numpy as np

from debrisest.reconstruction.structure import CAMERAS, Lens, Rig


def result_of(model: Any, lens: Lens, rig: Rig, frames: int) -> dict[str, Any]:
    """Return the arrays of a `Structure` by the library's model, or why there is none."""
    if model is None:
        return {
            "failure": "fewer than half of the images find a place in one structure; take more "
            "images with smaller turns between them, or a body with more texture"
        }
    rotation, translation = np.full((frames, 3, 3), np.nan), np.full((frames, 3), np.nan)
    points = {key: number for number, key in enumerate(model.points3D)}
    seen = np.zeros((frames, len(points)), dtype=np.bool_)
    for image in filter(lambda image: image.has_pose, model.images.values()):
        camera, frame = image.name.removeprefix(CAMERAS).removesuffix(".png").split("/")
        pose = image.cam_from_world().matrix()
        back = rig.rotation[int(camera)].T
        rotation[int(frame)] = back @ pose[:, :3]
        translation[int(frame)] = back @ (pose[:, 3] - rig.translation[int(camera)])
        ids = [point.point3D_id for point in image.points2D if point.has_point3D()]
        seen[int(frame), [points[key] for key in ids]] = True
    return {
        "rotation": rotation,
        "translation": translation,
        "points": np.array([point.xyz for point in model.points3D.values()]),
        "seen": seen,
        "scale_sigma": _scale_sigma(model) if len(rig.matrix) > 1 else np.inf,
        "reprojection_px": model.compute_mean_reprojection_error(),
        **lens._asdict(),
    }


def _scale_sigma(model: Any) -> float:
    """Return the standard error of the scale, of it, by what the pairs' disparities leave.

    What all points of a pair leave is taken for one error, which differs from pair to pair.
    """
    images = {image.name: image for image in model.images.values()}
    left, disparity, pairs = [], [], 0
    for name, first in images.items():
        second = images.get(name.replace(f"{CAMERAS}0/", f"{CAMERAS}1/"))
        if second is None or second is first:
            continue
        found = [_residuals(model, image) for image in (first, second)]
        both = found[0].keys() & found[1].keys()
        left += [np.linalg.norm(found[0][key][1] - found[1][key][1]) for key in both]
        disparity += [np.linalg.norm(found[0][key][0] - found[1][key][0]) for key in both]
        pairs += bool(both)
    if pairs < 3:
        return float(np.inf)
    spread = np.sqrt(np.mean(np.square(left))) / np.median(disparity)
    return float(spread / np.sqrt(pairs))


def _residuals(model: Any, image: Any) -> dict[int, tuple[Any, Any]]:
    """Return for each point that an image sees its pixel, and by how much the model misses it."""
    seen = {point.point3D_id: point.xy for point in image.points2D if point.has_point3D()}
    return {
        key: (pixel, pixel - image.project_point(model.points3D[key].xyz))
        for key, pixel in seen.items()
    }
