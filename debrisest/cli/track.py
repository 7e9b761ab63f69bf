"""The command from images to tracks."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Option

from debrisest.cli.measured import Cameras, RateHz
from debrisest.cli.options import RESULTS, Quiet, WidestPx

if TYPE_CHECKING:
    from debrisest.arrays import Array
    from debrisest.tracks.from_images import Tracked
    from debrisest.tracks.types import Rig
    from debrisest.vision.image_files import ImageSequence

_CALIBRATION = "calibration.yaml"


def track(
    images: Annotated[
        list[Path],
        Argument(help="A folder or a video; of a pair: left, right.", metavar="IMAGES..."),
    ],
    camera: Cameras = None,
    rate_hz: RateHz = None,
    widest_px: WidestPx = 1280,
    out: Annotated[
        Path | None, Option("--out", help="Folder to write to (default: results/<stem>).")
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Follow the features of a turning body through images, and write their tracks."""
    from debrisest.counted import heard_by
    from debrisest.errors import UserError
    from debrisest.runner.progress import progress
    from debrisest.tracks.from_images import pixel_tracks, stereo_tracks
    from debrisest.tracks.write import write_long
    from debrisest.vision.libraries import vision_library

    vision_library("cv2")
    sequence = _read(images, widest_px)
    times, rig = _times(sequence, rate_hz), _rig(images[0], camera)
    pair = len(sequence.cameras) > 1
    if pair and rig is None:
        raise UserError(
            f"{images[0]}: a stereo pair needs its calibration: give OpenCV's YAML with --camera, "
            f"or put it there as {_CALIBRATION}"
        )
    with progress(1, quiet) as teller, heard_by(teller.part):
        if pair and rig is not None:
            found = stereo_tracks(sequence, rig, times)
        else:
            found = pixel_tracks(sequence, times)
    folder = out or RESULTS / images[0].resolve().stem
    write_long(folder / "tracks.csv", found.tracks)
    _tell(found)
    written = [folder / "tracks.csv", *_drawn(folder, sequence, found, times)]
    for path in written:
        print(f"wrote {path}")
    _tell_next(folder / "tracks.csv", rig, pair)


def _read(paths: Sequence[Path], widest_px: int) -> "ImageSequence":
    """Return the images of one folder or video, or of one for each camera of a pair.

    Those of one camera are reduced to a width: from one to the next a feature may not move far.
    """
    import numpy as np

    from debrisest.errors import UserError
    from debrisest.vision.image_files import PAIR, read_images

    alone = len(paths) == 1 and not (paths[0] / PAIR[0]).is_dir()
    widest = widest_px if alone else None
    found = [read_images(path, widest, colours=True) for path in paths]
    if len(found) == 1:
        return found[0]
    if len(found) > len(PAIR) or any(len(one.cameras) > 1 for one in found):
        raise UserError("give one folder or video, or two: that of the left camera, then the right")
    first, second = found
    if first.frames.shape != second.frames.shape:
        told = [
            f"{len(one.frames)} of {one.frames.shape[3]} x {one.frames.shape[2]}" for one in found
        ]
        raise UserError(f"{paths[1]}: images: {told[1]} pixels, but {paths[0]} has {told[0]}")
    frames = np.concatenate([first.frames, second.frames], axis=1)
    chroma = None
    if first.chroma is not None and second.chroma is not None:
        chroma = np.concatenate([first.chroma, second.chroma], axis=1)
    return first._replace(cameras=PAIR, frames=frames, chroma=chroma)


def _times(images: "ImageSequence", rate_hz: float | None) -> "Array":
    import numpy as np

    from debrisest.errors import UserError

    if rate_hz is not None and rate_hz > 0:
        return np.arange(len(images.frames)) / rate_hz
    if images.times is None or rate_hz is not None:
        raise UserError(
            f"{images.source}: when were these images taken? Give --rate-hz, above zero, or a "
            "file times.csv (frame,time_s) beside them"
        )
    return images.times


def _rig(folder: Path, cameras: list[Path] | None) -> "Rig | None":
    from debrisest.tracks.calibration import read_calibration

    there = folder / _CALIBRATION
    files = cameras or ([there] if there.is_file() else [])
    return read_calibration(*files) if files else None


def _tell(found: "Tracked") -> None:
    """Print how many tracks there are, how long they are, and what was left out and why."""
    import numpy as np

    seen = np.isfinite(found.shown[:, 0, :, 0])
    length = seen.sum(axis=0)
    print(
        f"tracks         {len(length)}, {int((length >= 10).sum())} of them in ten images or more"
        f"\nlength         {int(np.median(length))} images in the median, {length.max()} at most"
        f"\nper image      {seen.sum(axis=1).mean():.0f} features in the mean, "
        f"{seen.sum(axis=1).min()} at least"
    )
    if blind := int((seen.sum(axis=1) < 3).sum()):
        print(f"note: {blind} images have fewer than three features: the body was lost there")
    if np.isfinite(found.noise_px):
        print(f"noise          {found.noise_px:.3f} px, from how the points fit to one rigid body")
    if found.known_again:
        print(f"known again    {found.known_again} points after they were lost")
    for reason, count in found.left_out.items():
        print(f"left out       {count}: {reason}")


def _drawn(folder: Path, images: "ImageSequence", found: "Tracked", times: "Array") -> list[Path]:
    import numpy as np

    from debrisest.show.plots.files import write
    from debrisest.show.plots.followed_features import strip, tracks_over_image

    first, shown = images.frames[:, 0], found.shown[:, 0]
    most = int(np.isfinite(shown[10:, :, 0]).sum(axis=1).argmax()) + 10 if len(shown) > 10 else -1
    over = tracks_over_image(first, shown, most % len(shown))
    return [
        *write(over, folder, "tracks", shaded=True),
        *write(strip(first, shown, times), folder, "strip", shaded=True),
    ]


def _tell_next(tracks: Path, rig: "Rig | None", pair: bool) -> None:
    if pair:
        file, folder = shlex.quote(str(tracks)), shlex.quote(str(tracks.parent))
        print(f"next: debrisest estimate {file} --out {folder}")
        return
    print("note: pixels of one camera: estimate needs the body's geometry (--points) beside them")
    if rig is None:
        print("note: no calibration was given; the pixels are as the lens shows them")
