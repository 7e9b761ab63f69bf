"""Features of images and their matches, in COLMAP's database; what is there is not done again."""

from collections.abc import Iterator, Sequence
from typing import TypeVar

from debrisest.arrays import Array
from debrisest.reconstruction.structure import How, image_name
from debrisest.reconstruction.structure_job import Job, tell, threads

_Item = TypeVar("_Item")
_AT_ONCE = 20
_PEAK = 0.003
"""Of features: half of what is usual, since bodies are dark where the sun does not reach."""
_NEXT_FRAMES = 4
_LOOP = 3
"""Each frame of this many is matched with all others of them."""
_ALL_PAIRS = 60
_STILL_PX, _OFF_PX = 2.0, 2.0
"""Where features that stand still are left out: what that is, and how far matches may be off."""


def find_features(job: Job) -> None:
    """Detect features in each camera's images, all with the camera's own matrix."""
    colmap, frames, how = job.colmap, job.frames, job.how
    total = frames * len(job.rig.matrix)
    extraction = colmap.FeatureExtractionOptions(num_threads=threads(), use_gpu=False)
    extraction.sift.max_num_features = 2000
    extraction.sift.first_octave = 0
    extraction.sift.peak_threshold = _PEAK
    for camera, k in enumerate(job.rig.matrix):
        names = [image_name(camera, frame) for frame in range(frames)]
        for number, some in enumerate(_portions(names, _AT_ONCE)):
            reader = colmap.ImageReaderOptions(
                existing_camera_id=_known_camera(job, names), **_lens(k, how)
            )
            if not how.leave_out_still:
                reader.mask_path = job.folder / "masks"
            colmap.extract_features(
                *(job.database, job.images, list(some)),
                *(colmap.CameraMode.SINGLE, reader, extraction),
            )
            done = camera * frames + number * _AT_ONCE + len(some)
            tell("images with features", done, total)


def _lens(k: Array, how: How) -> dict[str, str]:
    """Return the kind of a camera and its numbers, as COLMAP has them."""
    middle = f"{k[0, 2] + 0.5},{k[1, 2] + 0.5}"
    if how.calibrate:
        return {"camera_model": "SIMPLE_PINHOLE", "camera_params": f"{k[0, 0]},{middle}"}
    return {"camera_model": "PINHOLE", "camera_params": f"{k[0, 0]},{k[1, 1]},{middle}"}


def _known_camera(job: Job, names: Sequence[str]) -> int:
    """Return the number of the camera that took images, -1 where none of them is there yet."""
    if not job.database.is_file():
        return -1
    with job.colmap.Database.open(job.database) as opened:
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


def match_features(job: Job) -> None:
    """Match pairs of images; each draws for itself, so that a second attempt finds the same."""
    colmap, pairs = job.colmap, _pairs(len(job.rig.matrix), job.frames, job.how)
    matching = colmap.FeatureMatchingOptions(num_threads=threads(), use_gpu=False)
    verification = colmap.TwoViewGeometryOptions()
    verification.ransac.random_seed = 1
    if job.how.leave_out_still:
        verification.filter_stationary_matches = True
        verification.stationary_matches_max_error = _STILL_PX
        verification.ransac.max_error = _OFF_PX
    done = 0
    for some in _portions(pairs, 5 * _AT_ONCE):
        path = job.folder / "pairs.txt"
        path.write_text("".join(f"{one} {other}\n" for one, other in some))
        pairing = colmap.ImportedPairingOptions(match_list_path=path)
        colmap.match_image_pairs(job.database, matching, pairing, verification)
        done += len(some)
        tell("pairs of images matched", done, len(pairs))


def _portions(items: Sequence[_Item], size: int) -> Iterator[Sequence[_Item]]:
    for begin in range(0, len(items), size):
        yield items[begin : begin + size]
