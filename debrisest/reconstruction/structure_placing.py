"""Where the cameras were, and points: COLMAP's incremental mapping, and a focal length by it."""

from typing import Any

import numpy as np

from debrisest.reconstruction.self_calibration import bent_as_told, lens_of
from debrisest.reconstruction.small_features import placed_by_small_features
from debrisest.reconstruction.structure import CAMERAS, Lens
from debrisest.reconstruction.structure_job import Job, tell, threads

_OFF_PX = 2.0
"""Where features that stand still are left out: how far points may be off."""
_PLACINGS, _SETTLED = 4, 0.02
_LEAST_SHARE = 0.5
"""Of the frames that have to find a place in one model."""


def model_and_lens(job: Job) -> tuple[Any, Lens]:
    """Return the largest model, None where there is none, and the lens that was given or found.

    A focal length that is far off makes images hang together wrongly: all are placed again with the
    one that was found, until it stays. Its spread counts how much it changed.
    """
    model = _model(job)
    lens = Lens(job.rig.matrix[0], np.zeros(5))
    told: list[float] = []
    while job.how.calibrate and model is not None:
        lens = lens_of(job.colmap, model)
        told.append(float(lens.matrix[0, 0]))
        tell("placings of the images", len(told), _PLACINGS)
        settled = len(told) > 1 and np.ptp(told[-2:]) < _SETTLED * told[-1]
        if settled or len(told) == _PLACINGS:
            break
        _start_from(job, lens)
        model = _model(job) or model
    if model is None:
        return model, lens
    if job.how.calibrate:
        model, lens = bent_as_told(job.colmap, model, lens)
    lens = lens._replace(focal_spread=float(np.hypot(lens.focal_spread, _scatter(told))))
    return placed_by_small_features(job, model), lens


def _start_from(job: Job, lens: Lens) -> None:
    """Let the next model begin with a focal length."""
    with job.colmap.Database.open(job.database) as opened:
        (camera,) = opened.read_all_cameras()
        camera.params = [lens.matrix[0, 0], *camera.params[1:]]
        opened.update_camera(camera)


def _scatter(values: list[float]) -> float:
    """Return the standard deviation of values, of the last one."""
    return float(np.std(values, ddof=1) / values[-1]) if len(values) > 1 else 0.0


def _model(job: Job) -> Any:
    """Return the largest model; None where too few frames hang together."""
    rig, frames, options = job.rig, job.frames, _options(job)
    if len(rig.matrix) > 1:
        with job.colmap.Database.open(job.database) as opened:
            job.colmap.apply_rig_config([_rig_config(job)], opened)
    placed = [0]

    def one_more() -> None:
        placed[0] += 1
        tell("images placed", min(placed[0], frames), frames)

    sparse = job.folder / "sparse"
    sparse.mkdir(exist_ok=True)
    models = job.colmap.incremental_mapping(
        job.database, job.images, sparse, options, next_image_callback=one_more
    )
    best = max(models.values(), key=lambda model: model.num_reg_images(), default=None)
    least = _LEAST_SHARE * frames * len(rig.matrix)
    return best if best is not None and best.num_reg_images() >= least else None


def _options(job: Job) -> Any:
    options = job.colmap.IncrementalPipelineOptions(num_threads=threads(), random_seed=1)
    options.mapper.random_seed = options.triangulation.random_seed = 1
    options.ba_refine_focal_length, options.ba_refine_extra_params = job.how.calibrate, False
    options.mapper.abs_pose_refine_focal_length = False
    options.mapper.abs_pose_refine_extra_params = False
    if job.how.leave_out_still:
        options.mapper.filter_max_reproj_error = _OFF_PX
        options.triangulation.merge_max_reproj_error = _OFF_PX
        options.triangulation.complete_max_reproj_error = _OFF_PX
    options.ba_refine_sensor_from_rig = False
    options.mapper.init_min_num_inliers = 50
    options.mapper.init_min_tri_angle = 5.0
    return options


def _rig_config(job: Job) -> Any:
    colmap, rig = job.colmap, job.rig
    cameras = [colmap.RigConfigCamera(ref_sensor=True, image_prefix=f"{CAMERAS}0/")]
    for number in range(1, len(rig.matrix)):
        pose = np.concatenate([rig.rotation[number], rig.translation[number][:, None]], axis=1)
        camera = colmap.RigConfigCamera(image_prefix=f"{CAMERAS}{number}/")
        camera.cam_from_rig = colmap.Rigid3d(pose)
        cameras.append(camera)
    return colmap.RigConfig(cameras=cameras)
