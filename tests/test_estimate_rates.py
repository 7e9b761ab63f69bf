"""From a file of body rates to the answer."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from debrisest.dynamics.torque_free import torque_free
from debrisest.results.open import open_results

MOMENTS, SIGMA = np.array([0.55, 0.8, 1.0]), 0.1


def rates() -> pd.DataFrame:
    """Rates of a tumbling body, deg/s, every second for 300 s, some of them missing."""
    times = np.delete(np.arange(300.0), [7, 8, 150])
    _, rate = torque_free(times, np.array([1.0, 0, 0, 0]), np.radians([4.0, -3.0, 5.0]), MOMENTS)
    seen = np.degrees(rate) + SIGMA * np.random.default_rng(3).normal(size=rate.shape)
    columns = [f"rate_{axis}_deg_s" for axis in "xyz"]
    return pd.DataFrame(seen, columns=columns).assign(time_s=times)


@pytest.mark.parametrize("unit", ["deg_s", "rad_s"])
def test_rates_show_the_ratios_of_the_inertia(tmp_path: Path, cli: Callable, unit: str) -> None:
    table = rates()
    if unit == "rad_s":
        table = table.rename(columns=lambda name: name.replace("deg_s", "rad_s"))
        table.iloc[:, :3] = np.radians(table.iloc[:, :3])
    table.to_csv(tmp_path / "gyro.csv", index=False)
    done = cli(
        *("estimate", tmp_path / "gyro.csv", "--sigma-deg-s", SIGMA),
        *("--out", tmp_path / "gyro", "--quiet"),
    )
    assert done.exit_code == 0, done.output
    assert "\naccepted: " in done.stdout
    found = open_results(tmp_path / "gyro").one_run("nominal", "batch", 0)
    error = found["moment_share"][:2] - MOMENTS[:2]
    assert np.all(np.abs(error) < 4.0 * found["moment_share_sigma"][:2])
    assert np.all(found["moment_share_sigma"][:2] < 0.01)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t: t.rename(columns={"rate_x_deg_s": "rate_x_rad_s"}), "column"),
        (lambda t: t.assign(sigma_deg_s=0.0), "sigma_deg_s: must be positive"),
        (lambda t: pd.concat([t, t.head(1).add([1, 1, 1, 0])]), "rate_x_deg_s"),
    ],
)
def test_files_of_rates_that_are_refused(
    tmp_path: Path, cli: Callable, change: Callable, said: str
) -> None:
    change(rates()).to_csv(tmp_path / "gyro.csv", index=False)
    done = cli("estimate", tmp_path / "gyro.csv", "--out", tmp_path / "gyro")
    assert done.exit_code == 2
    assert said in done.output
    assert "gyro.csv:" in done.output


def test_an_option_of_other_files_is_refused(tmp_path: Path, cli: Callable) -> None:
    rates().to_csv(tmp_path / "gyro.csv", index=False)
    done = cli("estimate", tmp_path / "gyro.csv", "--noise-m", 1, "--out", tmp_path / "gyro")
    assert done.exit_code == 2
    assert "it holds rates, for which --noise-m is of no use" in done.output
