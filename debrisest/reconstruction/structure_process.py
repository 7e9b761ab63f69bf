"""The process of its own in which COLMAP runs: ``python -m ... FOLDER``.

It ends with the one that started it.
"""

import ctypes
import os
import signal
import sys
from pathlib import Path

import numpy as np

from debrisest.reconstruction.structure import RESULT
from debrisest.reconstruction.structure_features import find_features, match_features
from debrisest.reconstruction.structure_job import job_of
from debrisest.reconstruction.structure_placing import model_and_lens
from debrisest.reconstruction.structure_result import result_of


def main(folder: Path) -> None:
    """Reconstruct what the folder holds, tell progress on standard output, write the result."""
    _end_with_parent()
    job = job_of(folder)
    find_features(job)
    match_features(job)
    result = result_of(*model_and_lens(job), job.rig, job.frames)
    partial = folder / f"partial-{RESULT}"
    np.savez(partial, **result)
    os.replace(partial, folder / RESULT)


def _end_with_parent() -> None:
    """Ask Linux to end this process with its parent; elsewhere it runs to its end."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
