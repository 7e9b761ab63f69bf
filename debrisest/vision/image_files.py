"""Image sequences in folders, and videos: in both, a frame of every camera at each time.

A folder of one camera holds the images, one of a stereo pair the folders ``left`` and ``right``
with the same names; ``times.csv`` (``frame,time_s``) has the times, if it is there.
"""

import csv
import re
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array
from debrisest.errors import UserError
from debrisest.files import content, replacing, require_ending
from debrisest.vision.libraries import vision_library

SUFFIXES = (
    ".png",
    ".jpg",
    ".jpeg",
    ".tif",
    ".tiff",
    ".bmp",
    ".pgm",
    ".ppm",
    ".pnm",
    ".pbm",
    ".webp",
)
VIDEOS = (".mp4", ".avi", ".mov", ".mkv", ".m4v", ".webm")
PAIR = ("left", "right")
TIMES = "times.csv"
_NO_COLOUR, _LEAST_COLOUR = 128, 1.5
_MASK = "mask"
"""How the names of masks end that lie among the images."""
_ORIENTATION, _TURNED = 0x0112, (".jpg", ".jpeg", ".tif", ".tiff", ".webp")
"""EXIF's tag of how a camera was held, and the files that have it."""
_CODECS = {".mp4": "mp4v", ".avi": "MJPG"}


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


def read_images(
    path: Path,
    widest: int | None = None,
    gaps: bool = False,
    colours: bool = False,
    masks: bool = False,
) -> ImageSequence:
    """Return the images of a folder, in the order of the numbers in their names, or of a video.

    Images with more columns than ``widest`` are reduced to that many. ``gaps``: whether numbers may
    be missing among the frames. ``colours``: whether the chroma of images in a folder is wanted.
    ``masks``: whether of a folder that holds both images and masks the latter are meant.

    Raises `UserError`: nothing there, no images, unreadable or damaged ones, other sizes, missing
    frames, times that do not fit.
    """
    if path.is_dir():
        found = _folder(path, widest, gaps, masks)
        return found._replace(chroma=_chroma(path, found, widest)) if colours else found
    if not path.is_file():
        raise UserError(f"{path}: no such folder or file")
    if path.suffix.lower() in VIDEOS:
        return _video(path, widest)
    allowed = ", ".join(VIDEOS)
    raise UserError(f"{path}: neither a folder of images nor a video file ({allowed})")


def has_masks(folder: Path) -> bool:
    """Return whether names of images in a folder end in ``mask``, while others do not."""
    names = [one for one in folder.iterdir() if one.suffix.lower() in SUFFIXES]
    return 0 < sum(map(_is_mask, names)) < len(names)


def count_images(path: Path) -> int:
    """Return how many images of a camera a folder or a video says that it has; 0 if it is none."""
    if path.is_dir():
        left = path / PAIR[0]
        return len(_names(left if left.is_dir() else path))
    if path.suffix.lower() not in VIDEOS or not path.is_file():
        return 0
    cv2 = vision_library("cv2")
    return max(0, int(cv2.VideoCapture(str(path)).get(cv2.CAP_PROP_FRAME_COUNT)))


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


def write_video(path: Path, frames: NDArray[np.uint8], rate_hz: float) -> None:
    """Write frames (time, row, column) of one camera as MP4 or AVI, with loss.

    Raises `UserError` for another format, or where no codec is there.
    """
    cv2 = vision_library("cv2")
    suffix = path.suffix.lower()
    if suffix not in _CODECS:
        raise UserError(f"{path}: videos are written as {' or '.join(_CODECS)}")
    path.parent.mkdir(parents=True, exist_ok=True)
    code = cv2.VideoWriter_fourcc(*_CODECS[suffix])
    writer = cv2.VideoWriter(str(path), code, rate_hz, frames.shape[:0:-1])
    if not writer.isOpened():
        raise UserError(f"{path}: this machine's OpenCV cannot write {suffix}")
    for frame in frames:
        writer.write(cv2.cvtColor(frame, cv2.COLOR_GRAY2BGR))
    writer.release()


def _folder(path: Path, widest: int | None, gaps: bool, masks: bool) -> ImageSequence:
    cameras = PAIR if all((path / name).is_dir() for name in PAIR) else ("camera",)
    folders = [path / name for name in cameras] if len(cameras) > 1 else [path]
    names = [_names(folder, masks) for folder in folders]
    for folder, own in zip(folders, names):
        if lacking := sorted(set(names[0]) ^ set(own)):
            raise UserError(
                f"{path}: {lacking[0]} is not in both {' and '.join(cameras)} "
                f"({len(lacking)} such frames); remove it, or add the other image"
            )
        if not gaps:
            _check_numbers(folder, own)
    flag = _as_held([folder / name for folder in folders for name in names[0]])
    shape = _image(folders[0] / names[0][0], flag).shape
    found = [
        [_alike(folder / name, flag, shape, widest) for name in names[0]] for folder in folders
    ]
    frames = np.stack([np.stack(own) for own in found], axis=1)
    times, reduced = _times(path / TIMES, names[0]), frames.shape[3] / shape[1]
    return ImageSequence(str(path), cameras, frames, times, reduced, tuple(names[0]))


def _chroma(path: Path, images: ImageSequence, widest: int | None) -> NDArray[np.uint8] | None:
    """Return Cr and Cb of a folder's images; None where they have no colours."""
    cv2 = vision_library("cv2")
    folders = [path / name for name in images.cameras] if len(images.cameras) > 1 else [path]
    found = np.empty((*images.frames.shape, 2), np.uint8)
    flag = cv2.IMREAD_COLOR | _as_held([one / name for one in folders for name in images.names])
    for camera, folder in enumerate(folders):
        for epoch, name in enumerate(images.names):
            bright = cv2.cvtColor(_image(folder / name, flag), cv2.COLOR_BGR2YCrCb)
            found[epoch, camera] = _reduced(bright, widest)[..., 1:]
    coloured = np.abs(found.astype(np.int16) - _NO_COLOUR).mean() > _LEAST_COLOUR
    return found if coloured else None


def _names(folder: Path, masks: bool = False) -> list[str]:
    """Return the names of the images in a folder, in the order of the numbers in them.

    Masks among them are left out, or chosen.
    """
    there = [one for one in folder.iterdir() if one.suffix.lower() in SUFFIXES]
    if has_masks(folder):
        there = [one for one in there if _is_mask(one) == masks]
    found = sorted((one.name for one in there if not one.name.startswith(".")), key=in_order)
    if not found:
        allowed = ", ".join(SUFFIXES)
        raise UserError(f"{folder}: no images there ({allowed})")
    return found


def _is_mask(path: Path) -> bool:
    return path.stem.lower().endswith(_MASK)


def _as_held(paths: Sequence[Path]) -> int:
    """Return OpenCV's flag by which images are read as the camera was held, or as it sees them.

    The latter where EXIF says that it was held in several ways: on a stand it was not, whatever its
    sensor of gravity says when it looks down.
    """
    from PIL import Image

    held = set()
    for path in paths:
        if path.suffix.lower() in _TURNED:
            with suppress(OSError, ValueError, TypeError, SyntaxError), Image.open(path) as image:
                held.add(int(image.getexif().get(_ORIENTATION, 1)))
    ignored: int = vision_library("cv2").IMREAD_IGNORE_ORIENTATION
    return ignored if len(held) > 1 else 0


def in_order(name: str) -> tuple[list[tuple[int, str]], str]:
    """Return a key by which names stand in the order of their numbers: 2 before 10."""
    parts = re.findall(r"[0-9]+|[^0-9]+", name)
    return [(int(part), "") if part[0] in "0123456789" else (-1, part) for part in parts], name


def _check_numbers(folder: Path, names: Sequence[str]) -> None:
    """Raise UserError where frames that are numbered throughout have a gap."""
    digits = ["".join(filter(str.isdigit, Path(name).stem)) for name in names]
    if not all(digits):
        return
    numbers = sorted(map(int, digits))
    steps = np.diff(numbers)
    if len(steps) > 1 and (steps != steps[0]).any() and np.median(steps) == 1:
        first = numbers[int(np.argmax(steps != 1))] + 1
        if not (folder.parent / TIMES).exists() and not (folder / TIMES).exists():
            raise UserError(
                f"{folder}: frame {first} is missing; put it there, or give each frame's time in "
                f"{TIMES} (frame,time_s)"
            )


def _image(path: Path, flag: int = 0) -> NDArray[np.uint8]:
    """Return an image, grey unless OpenCV's flag of reading says otherwise."""
    cv2 = vision_library("cv2")
    coded = content(path)
    whole = coded and not _cut_off(coded)
    pixels = np.frombuffer(coded, dtype=np.uint8)
    image = cv2.imdecode(pixels, flag) if whole else None
    if image is None:
        raise UserError(f"{path}: not an image that can be read; it may be damaged")
    return np.asarray(image)


def _cut_off(content: bytes) -> bool:
    """Return whether a JPEG ends within its last scan, which decoders fill up with grey."""
    scan, end = (content.rfind(marker) for marker in (b"\xff\xda", b"\xff\xd9"))
    return content.startswith(b"\xff\xd8") and end < scan


def _alike(path: Path, flag: int, shape: tuple[int, ...], widest: int | None) -> NDArray[np.uint8]:
    """Return an image of the shape that all have, reduced to the widest."""
    image = _image(path, flag)
    if image.shape != shape:
        told = [f"{width} x {height}" for height, width in (image.shape, shape)]
        turned = "; turn it as the others are" if image.shape == shape[::-1] else ""
        raise UserError(f"{path}: {told[0]} pixels, the first image has {told[1]}{turned}")
    return _reduced(image, widest)


def _reduced(image: NDArray[np.uint8], widest: int | None) -> NDArray[np.uint8]:
    height, width = image.shape[:2]
    if widest is None or width <= widest:
        return image
    cv2 = vision_library("cv2")
    size = widest, max(1, round(height * widest / width))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA))


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


def _video(path: Path, widest: int | None) -> ImageSequence:
    cv2 = vision_library("cv2")
    video: Any = cv2.VideoCapture(str(path))
    frames, width = [], 0
    while video.isOpened():
        there, frame = video.read()
        if not there:
            break
        frames.append(_reduced(cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY), widest))
        width = frame.shape[1]
    rate, said = video.get(cv2.CAP_PROP_FPS), int(video.get(cv2.CAP_PROP_FRAME_COUNT))
    video.release()
    if not frames:
        raise UserError(f"{path}: not a video that can be read; it may be damaged")
    if len(frames) < 0.9 * said:
        raise UserError(
            f"{path}: {len(frames)} of {said} frames can be read; the video is damaged or cut off"
        )
    times = np.arange(len(frames)) / rate if rate > 0 else None
    shown = np.stack(frames)[:, None]
    return ImageSequence(str(path), ("camera",), shown, times, shown.shape[3] / width)
