"""Scenarios of images without the libraries of the extra: told, and left out."""

from collections.abc import Callable
from pathlib import Path

import pytest

from debrisest.scenario import load


@pytest.fixture
def bare(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where only the core is installed."""
    known = load.find_spec
    extra = ("cv2", "embreex", "pycolmap", "skimage")
    monkeypatch.setattr(load, "find_spec", lambda name: None if name in extra else known(name))


@pytest.mark.usefixtures("bare")
def test_a_scenario_of_images_is_left_out_of_a_sweep(
    cli: Callable, shipped: Path, small: Path, tmp_path: Path
) -> None:
    images = shipped / "pesce2017-images.yaml"
    result = cli("sweep", images, small, "--jobs", 1, "--runs", 1, "--out", tmp_path / "out")
    assert result.exit_code == 0
    assert "needs cv2, embreex, pycolmap, skimage" in result.stderr
    assert "pip install 'debrisest[vision]'; it is left out" in result.stderr
    assert [path.name for path in (tmp_path / "out").iterdir() if path.is_dir()] == ["small"]


@pytest.mark.usefixtures("bare")
def test_by_itself_it_is_refused(cli: Callable, shipped: Path, tmp_path: Path) -> None:
    result = cli("sweep", shipped / "pesce2017-images.yaml", "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert "pip install 'debrisest[vision]'" in result.stderr
    assert not (tmp_path / "out").exists()
