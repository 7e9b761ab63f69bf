"""Measurements that nobody here made: what is told of them, and with which confidence.

Both bodies are turned by hand, so that torque-free motion must be refused and no inertia claimed.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from debrisest.results.open import open_results

DATA = Path(__file__).parent / "data"


@pytest.fixture
def estimated(tmp_path: Path, cli: Callable) -> Callable:
    """Import a file, sweep its scenario, and return run 0 of the default estimator."""

    def of(file: Path, *options: object) -> dict[str, np.ndarray]:
        assert cli("import", file, "--out", tmp_path, *options).exit_code == 0
        config = tmp_path / f"{file.stem}.yaml"
        assert cli("sweep", config, "--out", tmp_path / "out", "--jobs", "1").exit_code == 0
        return open_results(tmp_path / "out" / file.stem).one_run("nominal", "batch", 0)

    return of


def refused(found: dict[str, np.ndarray]) -> bool:
    return (
        found["accepted"] == 0
        and "no inertia is claimed" in str(found["status"])
        and np.isnan(found["moment_share"]).all()
        and np.isnan(found["log_inertia_f"]).all()
    )


def test_rates_from_optical_poses_are_those_of_a_gyro(estimated: Callable) -> None:
    """The gyro lags by 4 ms; plain central differences of these poses are 9 deg/s off."""
    found = estimated(DATA / "broad" / "poses.csv")
    assert refused(found)
    gyro = pd.read_csv(DATA / "broad" / "gyro.csv").to_numpy()
    times = found["time_s"] + gyro[0, 0] + 0.004
    shown = np.column_stack([np.interp(times, gyro[:, 0], gyro[:, 1 + i]) for i in range(3)])
    off = np.degrees(np.linalg.norm(found["rate_f"] - shown, axis=-1))
    assert np.median(off) < 9.0
    assert np.median(np.degrees(np.linalg.norm(shown, axis=-1))) > 300.0


def test_attitude_from_stereo_pixels_is_within_its_own_three_sigma(estimated: Callable) -> None:
    folder = DATA / "starry_night"
    found = estimated(
        *(folder / "tracks.csv", "--points", folder / "points.csv"),
        *("--camera", folder / "camera.yaml", "--noise-px", 8),
    )
    assert refused(found)
    truth = pd.read_csv(folder / "truth.csv").to_numpy()
    first = pd.read_csv(folder / "tracks.csv")["time_s"].min()
    nearest = np.abs(found["time_s"][:, None] + first - truth[:, 0]).argmin(axis=-1)
    told = np.isfinite(found["q_if"][:, 0])
    true = Rotation.from_quat(truth[nearest[told], 1:], scalar_first=True)
    error = (Rotation.from_quat(found["q_if"][told], scalar_first=True) * true.inv()).as_rotvec()
    sigma = 2.0 * np.linalg.norm(found["q_if_sigma"][told], axis=-1) / np.sqrt(3.0)
    assert np.mean((np.abs(error) < 3.0 * sigma[:, None]).all(axis=-1)) >= 0.95
    assert np.degrees(np.median(np.linalg.norm(error, axis=-1))) < 3.0
