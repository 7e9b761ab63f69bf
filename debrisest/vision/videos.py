"""Videos: read whole, in grey; written with loss."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array
from debrisest.errors import UserError
from debrisest.vision.libraries import vision_library
from debrisest.vision.one_image import reduced

VIDEOS = (".mp4", ".avi", ".mov", ".mkv", ".m4v", ".webm")
_CODECS = {".mp4": "mp4v", ".avi": "MJPG"}
_WHOLE = 0.9
"""Of the frames that a video says to have, some writers count one too many."""


class Film(NamedTuple):
    """Grey frames of a video."""

    frames: NDArray[np.uint8]
    """(time, row, column)."""
    times: Array | None
    """Seconds (time,), where the file tells its rate."""
    reduced: float
    """Their width over that in the file."""


def count_frames(path: Path) -> int:
    """Return how many frames a video says that it has."""
    cv2 = vision_library("cv2")
    return max(0, int(cv2.VideoCapture(str(path)).get(cv2.CAP_PROP_FRAME_COUNT)))


def read_video(path: Path, widest: int | None = None, every: int = 1) -> Film:
    """Return one of ``every`` so many frames of a video, reduced to the widest.

    Raises `UserError` where none, or less than nine of ten, can be read.
    """
    cv2 = vision_library("cv2")
    video: Any = cv2.VideoCapture(str(path))
    frames, count, width = [], 0, 0
    while video.isOpened():
        there, frame = video.read()
        if not there:
            break
        if count % every == 0:
            frames.append(reduced(cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY), widest))
        count, width = count + 1, frame.shape[1]
    rate, said = video.get(cv2.CAP_PROP_FPS), int(video.get(cv2.CAP_PROP_FRAME_COUNT))
    video.release()
    if not frames:
        raise UserError(f"{path}: not a video that can be read; it may be damaged")
    if count < _WHOLE * said:
        raise UserError(
            f"{path}: {count} of {said} frames can be read; the video is damaged or cut off"
        )
    times = np.arange(0, count, every) / rate if rate > 0 else None
    return Film(np.stack(frames), times, frames[0].shape[1] / width)


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
