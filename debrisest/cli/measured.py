"""The command about measured data: import."""

import shlex
from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from debrisest.cli.inputs import load_all
from debrisest.cli.options import Plugins

Measured = Annotated[
    Path, Argument(help="Tracks, poses or rates: CSV, JSON, a folder of COLMAP.", metavar="FILE")
]
Points = Annotated[Path | None, Option("--points", help="Known geometry: feature,x_m,y_m,z_m.")]
Cameras = Annotated[list[Path] | None, Option("--camera", help="Calibration (repeatable).")]
Attitude = Annotated[
    Path | None, Option("--attitude", help="The chaser's attitude: time_s,q0,q1,q2,q3.")
]
RateHz = Annotated[float | None, Option("--rate-hz", help="Of images that have no times.")]
ImageTimes = Annotated[Path | None, Option("--image-times", help="filename,time_s of images.")]
NoiseM = Annotated[float | None, Option("--noise-m", help="Of points, where the file has none.")]
NoisePx = Annotated[float | None, Option("--noise-px", help="Of pixels.")]
SigmaDeg = Annotated[float | None, Option("--sigma-deg", help="Of poses that have none.")]
SigmaDegS = Annotated[float | None, Option("--sigma-deg-s", help="Of rates that have none.")]


def import_(
    file: Measured,
    scenario: Annotated[
        Path | None,
        Option("--scenario", metavar="CONFIG", help="Whose estimators, tables and target to use."),
    ] = None,
    points: Points = None,
    camera: Cameras = None,
    attitude: Attitude = None,
    rate_hz: RateHz = None,
    image_times: ImageTimes = None,
    noise_m: NoiseM = None,
    noise_px: NoisePx = None,
    sigma_deg: SigmaDeg = None,
    sigma_deg_s: SigmaDegS = None,
    out: Annotated[
        Path | None, Option("--out", help="Folder to write to (default: that of the file).")
    ] = None,
    plugins: Plugins = None,
    force: Annotated[bool, Option("--force", help="Replace files that are there.")] = False,
) -> None:
    """Read measurements of your own, and write them as data and a scenario to edit."""
    from debrisest.measured.import_file import import_measured

    options = {
        "points": points,
        "camera": camera,
        "attitude": attitude,
        "rate_hz": rate_hz,
        "image_times": image_times,
        "noise_m": noise_m,
        "noise_px": noise_px,
        "sigma_deg": sigma_deg,
        "sigma_deg_s": sigma_deg_s,
    }
    like = load_all([scenario], None, plugins)[0] if scenario else None
    done = import_measured(file, options, like, out, force)
    for note in done.notes:
        print(f"note: {note}")
    print(f"wrote {done.data}\nwrote {done.scenario}")
    print(f"next: debrisest sweep {shlex.quote(str(done.scenario))}")
