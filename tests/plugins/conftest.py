"""The catalog as it was, after every test, and a scenario with parts from outside."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

HERE = Path(__file__).parent


@pytest.fixture(autouse=True)
def untouched(untouched_catalog: None) -> None:
    """Nothing that a test loads is there for the next one."""


@pytest.fixture
def sensor(tmp_path: Path) -> Path:
    return Path(shutil.copy(HERE / "fading_points.py", tmp_path))


@pytest.fixture
def cautious(tmp_path: Path) -> Path:
    return Path(shutil.copy(HERE / "cautious.py", tmp_path))


@pytest.fixture
def options(sensor: Path, cautious: Path) -> tuple[object, ...]:
    return ("--plugin", sensor, "--plugin", cautious)


@pytest.fixture
def config(small: Path) -> Path:
    """The small scenario with the sensor and, for one estimator, the filter of the plug-ins."""
    text = small.read_text()
    text = text.replace(
        "kind: feature_points, noise_m: 1e-2, visibility: all",
        "kind: fading_points, noise_m: 1e-2, seen: 0.97",
    )
    head, found, tail = text.rpartition("    filter: *filter\n")
    assert found
    small.write_text(head + "    filter: {kind: cautious, factor: 3}\n" + tail)
    return small


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str], Path]:
    """Write a plug-in."""

    def written(text: str) -> Path:
        path = tmp_path / "my.py"
        path.write_text(text)
        return path

    return written
