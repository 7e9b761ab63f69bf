"""From rendered images to the motion of the body: render, track, estimate."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from debrisest.arrays import Array, Data
from debrisest.results.open import open_results


def inertial_rate(q_ib: Array, rate_b: Array) -> Array:
    return np.degrees(Rotation.from_quat(q_ib, scalar_first=True).apply(np.array(rate_b)))


def test_images_to_motion(rendered: Path, turning_box: Data, tmp_path: Path, cli: Callable) -> None:
    tracks, motion = tmp_path / "tracks", tmp_path / "motion"
    assert cli("track", rendered, "--out", tracks, "--quiet").exit_code == 0
    result = cli("estimate", tracks / "tracks.csv", "--out", motion, "--quiet")
    assert result.exit_code == 0, result.output
    found = open_results(motion).one_run("nominal", "batch", 0)
    true = inertial_rate(turning_box["true_q_ib"][0], turning_box["true_rate_b"][0])
    error = np.linalg.norm(inertial_rate(found["q_if"], found["rate_f"]) - true, axis=-1)
    assert error.max() < 0.2
