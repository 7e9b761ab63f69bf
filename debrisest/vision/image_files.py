"""Image sequences in folders, and videos: in both, a frame of every camera at each time.

A folder of one camera holds the images, one of a stereo pair the folders ``left`` and ``right``
with the same names; ``times.csv`` (``frame,time_s``) has the times, if it is there.
"""

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array
from debrisest.errors import UserError
from debrisest.files import replacing, require_ending
from debrisest.vision.image_names import TIMES, check_numbers, names_in
from debrisest.vision.libraries import vision_library
from debrisest.vision.one_image import alike, as_held, image_of, opacity_of, reduced
from debrisest.vision.videos import VIDEOS, count_frames, read_video

PAIR = ("left", "right")
_NO_COLOUR, _LEAST_COLOUR, _OPAQUE = 128, 1.5, 255


class ImageSequence(NamedTuple):
    """Grey images of one camera or several."""

    source: str
    cameras: tuple[str, ...]
    frames: NDArray[np.uint8]
    """(time, camera, row, column)."""
    times: Array | None
    """Seconds (time,), where a file tells them."""
    reduced: float = 1.0
    """Their width over that in the files."""
    names: tuple[str, ...] = ()
    """Of the files of the first camera, in a folder."""
    chroma: NDArray[np.uint8] | None = None
    """Cr and Cb (time, camera, row, column, 2), 128 without colour; none where all is grey."""
    opacity: NDArray[np.uint8] | None = None
    """(time, camera, row, column), 255 where nothing shines through; none where that is so
    everywhere."""


def read_images(
    path: Path,
    widest: int | None = None,
    gaps: bool = False,
    colours: bool = False,
    masks: bool = False,
    every: int = 1,
) -> ImageSequence:
    """Return the images of a folder, in the order of the numbers in their names, or of a video.

    Images with more columns than ``widest`` are reduced to that many. ``gaps``: whether numbers may
    be missing among the frames. ``colours``: whether chroma and opacity of images in a folder are
    wanted.
    ``masks``: whether of a folder that holds both images and masks the latter are meant. ``every``:
    one of so many is read.

    Raises `UserError`: nothing there, no images, unreadable or damaged ones, other sizes, missing
    frames, times that do not fit.
    """
    if path.is_dir():
        found = _folder(path, widest, gaps, masks, every)
        return _coloured(path, found, widest) if colours else found
    if not path.is_file():
        raise UserError(f"{path}: no such folder or file")
    if path.suffix.lower() in VIDEOS:
        film = read_video(path, widest, every)
        return ImageSequence(str(path), ("camera",), film.frames[:, None], *film[1:])
    allowed = ", ".join(VIDEOS)
    raise UserError(f"{path}: neither a folder of images nor a video file ({allowed})")


def count_images(path: Path) -> int:
    """Return how many images of a camera a folder or a video says that it has; 0 if it is none."""
    if path.is_dir():
        left = path / PAIR[0]
        return len(names_in(left if left.is_dir() else path))
    return count_frames(path) if path.suffix.lower() in VIDEOS and path.is_file() else 0


def write_images(folder: Path, images: ImageSequence) -> None:
    """Write a folder that `read_images` reads, PNG without loss."""
    cv2 = vision_library("cv2")
    for index, camera in enumerate(images.cameras):
        place = folder / camera if len(images.cameras) > 1 else folder
        for number, frame in enumerate(images.frames[:, index]):
            coded = cv2.imencode(".png", frame)[1]
            with replacing(place / f"{number:06d}.png") as temporary:
                temporary.write_bytes(coded.tobytes())
    if images.times is not None:
        rows = (f"{number:06d}.png,{time!r}\n" for number, time in enumerate(images.times.tolist()))
        with replacing(folder / TIMES) as temporary:
            temporary.write_text("frame,time_s\n" + "".join(rows), encoding="utf-8")


def _folder(path: Path, widest: int | None, gaps: bool, masks: bool, every: int) -> ImageSequence:
    cameras = PAIR if all((path / name).is_dir() for name in PAIR) else ("camera",)
    folders = _folders(path, cameras)
    names = [names_in(folder, masks) for folder in folders]
    for folder, own in zip(folders, names):
        if lacking := sorted(set(names[0]) ^ set(own)):
            raise UserError(
                f"{path}: {lacking[0]} is not in both {' and '.join(cameras)} "
                f"({len(lacking)} such frames); remove it, or add the other image"
            )
        if not gaps:
            check_numbers(folder, own)
    taken = names[0][::every]
    flag = as_held([folder / name for folder in folders for name in taken])
    shape = image_of(folders[0] / taken[0], flag).shape
    found = [[alike(folder / name, flag, shape, widest) for name in taken] for folder in folders]
    frames = np.stack([np.stack(own) for own in found], axis=1)
    times = _times(path / TIMES, names[0])
    told = None if times is None else times[::every]
    reduction = frames.shape[3] / shape[1]
    return ImageSequence(str(path), cameras, frames, told, reduction, tuple(taken))


def _folders(path: Path, cameras: Sequence[str]) -> list[Path]:
    """Return the folder of each camera."""
    return [path / name for name in cameras] if len(cameras) > 1 else [path]


def _coloured(path: Path, images: ImageSequence, widest: int | None) -> ImageSequence:
    """Return a folder's images with Cr and Cb, and with their opacity, where they have them."""
    cv2 = vision_library("cv2")
    paths = [[one / name for one in _folders(path, images.cameras)] for name in images.names]
    flag = cv2.IMREAD_COLOR | as_held([each for epoch in paths for each in epoch])
    chroma = np.empty((*images.frames.shape, 2), np.uint8)
    for epoch, own in enumerate(paths):
        for camera, each in enumerate(own):
            bright = cv2.cvtColor(image_of(each, flag), cv2.COLOR_BGR2YCrCb)
            chroma[epoch, camera] = reduced(bright, widest)[..., 1:]
    coloured = np.abs(chroma.astype(np.int16) - _NO_COLOUR).mean() > _LEAST_COLOUR
    return images._replace(chroma=chroma if coloured else None, opacity=_opacity(paths, widest))


def _opacity(paths: Sequence[Sequence[Path]], widest: int | None) -> NDArray[np.uint8] | None:
    """Return the opacity of images, which all have if the first has; None: all is opaque."""
    flag = vision_library("cv2").IMREAD_UNCHANGED
    if image_of(paths[0][0], flag).shape[2:] != (4,):
        return None
    found = [[reduced(opacity_of(image_of(each, flag)), widest) for each in own] for own in paths]
    return None if np.min(found) == _OPAQUE else np.array(found)


def _times(path: Path, names: Sequence[str]) -> Array | None:
    if not path.exists():
        return None
    require_ending(path)
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    try:
        told = {row["frame"]: float(row["time_s"]) for row in rows}
        times = np.array([told[name] for name in names])
    except KeyError as error:
        raise UserError(f"{path}: no {error.args[0]} there; it has frame,time_s") from None
    except (TypeError, ValueError) as error:
        raise UserError(f"{path}: a time that is no number: {error}") from None
    if not np.isfinite(times).all() or (np.diff(times) <= 0).any():
        raise UserError(f"{path}: the times must ascend with the names of the frames")
    return times
