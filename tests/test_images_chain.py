"""The long chain from images: to motion, and to the inertia tensor, kills included.

The shipped scenario with fewer and smaller images, and limits looser than what it is measured by.
"""

import os
import shutil
import signal
import subprocess
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import pandas as pd
import pytest

NEEDED = ("cv2", "pycolmap", "embreex", "skimage")
pytestmark = pytest.mark.skipif(
    not all(find_spec(name) for name in NEEDED), reason="needs the extra vision"
)
FEWER = ("width_px=640", "height_px=480", "focal_px=896")
MOMENTS = ("pairs of images matched", "images placed", "depth images fused")
"""What is told last before each kill."""


@pytest.fixture(scope="module")
def start(process: Callable, shipped: Path) -> Callable:
    """Start a sweep of the rocket stage whose results and cache lie in a folder."""

    def started(folder: Path) -> subprocess.Popen:
        settings = ["step_s=1.5", *(f"sensors.cameras.{each}" for each in FEWER)]
        options = [part for each in settings for part in ("--set", each)]
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
            config = shipped / "pesce2017-images.yaml"
            given = ("--case", "h10", "--out", folder / "out", "--jobs", 2, "--variant", "fewer")
            return process("sweep", config, *given, *options)

    return started


@pytest.fixture(scope="module")
def swept(start: Callable, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a sweep that nothing disturbed."""
    folder = tmp_path_factory.mktemp("swept")
    shown, said = start(folder).communicate()
    assert "Table section 7" in shown, said
    assert all(moment in said for moment in MOMENTS)
    return folder


def table(folder: Path) -> Path:
    return folder / "out" / "pesce2017-images@fewer" / "tables.csv"


def test_volume_and_inertia_of_the_stage(swept: Path) -> None:
    rows = pd.read_csv(table(swept)).set_index("quantity")["measured"]
    assert rows["confident"] == rows["within_bars"] == 1.0
    assert rows["volume_error"] < 10.0
    assert rows[rows.index.str.startswith("inertia_")].max() < 20.0


def killed_when_told(running: subprocess.Popen, moment: str) -> bool:
    """Kill all processes of a sweep at a moment; return whether it came."""
    came = any(moment in line for line in running.stderr)
    os.killpg(running.pid, signal.SIGKILL)
    running.communicate()
    return came


def test_killed_in_the_middle_of_structure_and_mesh(
    swept: Path, start: Callable, tmp_path: Path, data_of: Callable, same_data: Callable
) -> None:
    """The same command goes on, and gives the same in every bit."""
    simulated = Path("out", "pesce2017-images@fewer", "h10", "simulate.000000.h5")
    (tmp_path / simulated).parent.mkdir(parents=True)
    shutil.copy(swept / simulated, tmp_path / simulated)
    for moment in MOMENTS:
        assert killed_when_told(start(tmp_path), moment)
    _, said = start(tmp_path).communicate()
    assert "images placed" not in said
    one, two = (data_of(folder / "out") for folder in (swept, tmp_path))
    assert len(one) == 4 and one.keys() == two.keys()
    assert all(same_data(one[name], two[name]) for name in one)
    assert table(swept).read_bytes() == table(tmp_path).read_bytes()
    assert not list((tmp_path / "cache").rglob("*.db"))
