"""The process of its own in which COLMAP runs: ``python -m ... FOLDER``.

Features and matches are kept in a database; what is there is not done again. The process ends with
the one that started it.
"""

import ctypes
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from debrisest.arrays import Array
from debrisest.reconstruction.self_calibration import lens_of
from debrisest.reconstruction.structure import CAMERAS, RESULT, How, Lens, Rig, image_name
from debrisest.vision.libraries import vision_library

_Item = TypeVar("_Item")
_AT_ONCE = 20
_PEAK = 0.003
"""Of features: half of what is usual, since bodies are dark where the sun does not reach."""
_NEXT_FRAMES = 4
_LOOP = 3
"""Each frame of this many is matched with all others of them."""
_ALL_PAIRS = 60
_STILL_PX, _OFF_PX = 2.0, 2.0
"""Where features that stand still are left out: what that is, and how far features may be off."""
_PLACINGS, _SETTLED = 4, 0.02
_LEAST_SHARE = 0.5
"""Of the frames that have to find a place in one model."""


def main(folder: Path) -> None:
    """Reconstruct what the folder holds, tell progress on standard output, write the result."""
    _end_with_parent()
    vision_library("cv2")
    colmap = vision_library("pycolmap")
    colmap.logging.minloglevel = 1
    with np.load(folder / "rig.npz") as kept:
        rig = Rig(kept["matrix"], kept["rotation"], kept["translation"])
        frames = int(kept["frames"])
        how = How(bool(kept["calibrate"]), bool(kept["leave_out_still"]))
    database = folder / "database.db"
    _features(colmap, folder, database, rig, frames, how)
    _matches(colmap, folder, database, _pairs(len(rig.matrix), frames, how), how)
    model, lens = _model_and_lens(colmap, folder, database, rig, frames, how)
    result = _result(model, lens, rig, frames)
    partial = folder / f"partial-{RESULT}"
    np.savez(partial, **result)
    os.replace(partial, folder / RESULT)


def _end_with_parent() -> None:
    """Ask Linux to end this process with its parent; elsewhere it runs to its end."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)


def _tell(what: str, done: int, total: int) -> None:
    sys.stdout.write(f"{done} {total} {what}\n")
    sys.stdout.flush()


def _features(colmap: Any, folder: Path, database: Path, rig: Rig, frames: int, how: How) -> None:
    """Detect features in each camera's images, all with the camera's own matrix."""
    total = frames * len(rig.matrix)
    extraction = colmap.FeatureExtractionOptions(num_threads=_threads(), use_gpu=False)
    extraction.sift.max_num_features = 2000
    extraction.sift.first_octave = 0
    extraction.sift.peak_threshold = _PEAK
    for camera, k in enumerate(rig.matrix):
        names = [image_name(camera, frame) for frame in range(frames)]
        for number, some in enumerate(_portions(names, _AT_ONCE)):
            reader = colmap.ImageReaderOptions(
                existing_camera_id=_known_camera(colmap, database, names), **_lens(k, how)
            )
            if not how.leave_out_still:
                reader.mask_path = folder / "masks"
            colmap.extract_features(
                database,
                folder / "images",
                list(some),
                colmap.CameraMode.SINGLE,
                reader,
                extraction,
            )
            done = camera * frames + number * _AT_ONCE + len(some)
            _tell("images with features", done, total)


def _lens(k: Array, how: How) -> dict[str, str]:
    """Return the kind of a camera and its numbers, as COLMAP has them."""
    middle = f"{k[0, 2] + 0.5},{k[1, 2] + 0.5}"
    if how.calibrate:
        return {"camera_model": "SIMPLE_PINHOLE", "camera_params": f"{k[0, 0]},{middle}"}
    return {"camera_model": "PINHOLE", "camera_params": f"{k[0, 0]},{k[1, 1]},{middle}"}


def _start_from(colmap: Any, database: Path, lens: Lens) -> None:
    """Let the next model begin with a focal length."""
    with colmap.Database.open(database) as opened:
        (camera,) = opened.read_all_cameras()
        camera.params = [lens.matrix[0, 0], *camera.params[1:]]
        opened.update_camera(camera)


def _known_camera(colmap: Any, database: Path, names: Sequence[str]) -> int:
    """Return the number of the camera that took images, -1 where none of them is there yet."""
    if not database.is_file():
        return -1
    with colmap.Database.open(database) as opened:
        there = {image.name: image.camera_id for image in opened.read_all_images()}
    return next((there[name] for name in names if name in there), -1)


def _pairs(cameras: int, frames: int, how: How) -> list[tuple[str, str]]:
    """Return pairs of images to match: one time, following times, sparse loops.

    All, where it is not known that images are in the order of the turn, and they are not many.
    """
    if how.leave_out_still and cameras == 1 and frames <= _ALL_PAIRS:
        return [(image_name(0, a), image_name(0, b)) for a in range(frames) for b in range(a)]
    pairs = [
        (image_name(0, frame), image_name(camera, frame))
        for frame in range(frames)
        for camera in range(1, cameras)
    ]
    pairs += [
        (image_name(camera, frame), image_name(camera, frame + step))
        for camera in range(cameras)
        for step in range(1, _NEXT_FRAMES + 1)
        for frame in range(frames - step)
    ]
    loop = range(0, frames, _LOOP)
    pairs += [
        (image_name(0, one), image_name(0, other))
        for one in loop
        for other in loop
        if other - one > _NEXT_FRAMES
    ]
    return pairs


def _matches(
    colmap: Any, folder: Path, database: Path, pairs: list[tuple[str, str]], how: How
) -> None:
    """Match pairs of images; each draws for itself, so that a second attempt finds the same."""
    matching = colmap.FeatureMatchingOptions(num_threads=_threads(), use_gpu=False)
    verification = colmap.TwoViewGeometryOptions()
    verification.ransac.random_seed = 1
    if how.leave_out_still:
        verification.filter_stationary_matches = True
        verification.stationary_matches_max_error = _STILL_PX
        verification.ransac.max_error = _OFF_PX
    done = 0
    for some in _portions(pairs, 5 * _AT_ONCE):
        path = folder / "pairs.txt"
        path.write_text("".join(f"{one} {other}\n" for one, other in some))
        pairing = colmap.ImportedPairingOptions(match_list_path=path)
        colmap.match_image_pairs(database, matching, pairing, verification)
        done += len(some)
        _tell("pairs of images matched", done, len(pairs))


def _model_and_lens(
    colmap: Any, folder: Path, database: Path, rig: Rig, frames: int, how: How
) -> tuple[Any, Lens]:
    """Return the largest model, None where there is none, and the lens that was given or found.

    A focal length that is far off makes images hang together wrongly: all are placed again with the
    one that was found, until it stays. Its spread counts how much it changed.
    """
    model = _model(colmap, folder, database, rig, frames, how)
    lens = Lens(rig.matrix[0], np.zeros(5))
    told: list[float] = []
    while how.calibrate and model is not None:
        lens = lens_of(colmap, model)
        told.append(float(lens.matrix[0, 0]))
        _tell("placings of the images", len(told), _PLACINGS)
        settled = len(told) > 1 and np.ptp(told[-2:]) < _SETTLED * told[-1]
        if settled or len(told) == _PLACINGS:
            break
        _start_from(colmap, database, lens)
        model = _model(colmap, folder, database, rig, frames, how) or model
    return model, lens._replace(focal_spread=float(np.hypot(lens.focal_spread, _scatter(told))))


def _scatter(values: list[float]) -> float:
    """Return the standard deviation of values, of the last one."""
    return float(np.std(values, ddof=1) / values[-1]) if len(values) > 1 else 0.0


def _model(colmap: Any, folder: Path, database: Path, rig: Rig, frames: int, how: How) -> Any:
    """Return the largest model; None where too few frames hang together."""
    if len(rig.matrix) > 1:
        with colmap.Database.open(database) as opened:
            colmap.apply_rig_config([_rig_config(colmap, rig)], opened)
    options = colmap.IncrementalPipelineOptions(num_threads=_threads(), random_seed=1)
    options.mapper.random_seed = options.triangulation.random_seed = 1
    options.ba_refine_focal_length, options.ba_refine_extra_params = how.calibrate, False
    options.mapper.abs_pose_refine_focal_length = False
    options.mapper.abs_pose_refine_extra_params = False
    if how.leave_out_still:
        options.mapper.filter_max_reproj_error = _OFF_PX
        options.triangulation.merge_max_reproj_error = _OFF_PX
        options.triangulation.complete_max_reproj_error = _OFF_PX
    options.ba_refine_sensor_from_rig = False
    options.mapper.init_min_num_inliers = 50
    options.mapper.init_min_tri_angle = 5.0
    placed = [0]

    def one_more() -> None:
        placed[0] += 1
        _tell("images placed", min(placed[0], frames), frames)

    sparse = folder / "sparse"
    sparse.mkdir(exist_ok=True)
    models = colmap.incremental_mapping(
        database, folder / "images", sparse, options, next_image_callback=one_more
    )
    best = max(models.values(), key=lambda model: model.num_reg_images(), default=None)
    least = _LEAST_SHARE * frames * len(rig.matrix)
    return best if best is not None and best.num_reg_images() >= least else None


def _rig_config(colmap: Any, rig: Rig) -> Any:
    cameras = [colmap.RigConfigCamera(ref_sensor=True, image_prefix=f"{CAMERAS}0/")]
    for number in range(1, len(rig.matrix)):
        pose = np.concatenate([rig.rotation[number], rig.translation[number][:, None]], axis=1)
        camera = colmap.RigConfigCamera(image_prefix=f"{CAMERAS}{number}/")
        camera.cam_from_rig = colmap.Rigid3d(pose)
        cameras.append(camera)
    return colmap.RigConfig(cameras=cameras)


def _result(model: Any, lens: Lens, rig: Rig, frames: int) -> dict[str, Any]:
    """Return the arrays of a `Structure`, or why there is none."""
    if model is None:
        return {
            "failure": "fewer than half of the images find a place in one structure; take more "
            "images with smaller turns between them, or a body with more texture"
        }
    rotation, translation = np.full((frames, 3, 3), np.nan), np.full((frames, 3), np.nan)
    points = {key: number for number, key in enumerate(model.points3D)}
    seen = np.zeros((frames, len(points)), dtype=np.bool_)
    for image in model.images.values():
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


def _portions(items: Sequence[_Item], size: int) -> Iterator[Sequence[_Item]]:
    for begin in range(0, len(items), size):
        yield items[begin : begin + size]


def _threads() -> int:
    return int(os.environ.get("OMP_NUM_THREADS", "1") or 1)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
