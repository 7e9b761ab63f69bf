"""What COLMAP is to do, in a folder that holds all that is kept."""

import os
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from debrisest.reconstruction.structure import How, Rig
from debrisest.vision.libraries import vision_library


class Job(NamedTuple):
    """A folder, the library, and what was written there for it."""

    folder: Path
    colmap: Any
    rig: Rig
    frames: int
    how: How

    @property
    def database(self) -> Path:
        """Return where features and matches are kept."""
        return self.folder / "database.db"

    @property
    def images(self) -> Path:
        """Return the folder of the images."""
        return self.folder / "images"


def job_of(folder: Path) -> Job:
    """Return the job that a folder holds."""
    vision_library("cv2")
    colmap = vision_library("pycolmap")
    colmap.logging.minloglevel = 1
    with np.load(folder / "rig.npz") as kept:
        rig = Rig(kept["matrix"], kept["rotation"], kept["translation"])
        how = How(bool(kept["calibrate"]), bool(kept["leave_out_still"]))
        return Job(folder, colmap, rig, int(kept["frames"]), how)


def tell(what: str, done: int, total: int) -> None:
    """Tell the process that started this one how far it is."""
    sys.stdout.write(f"{done} {total} {what}\n")
    sys.stdout.flush()


def threads() -> int:
    """Return how many threads the library may use."""
    return int(os.environ.get("OMP_NUM_THREADS", "1") or 1)
