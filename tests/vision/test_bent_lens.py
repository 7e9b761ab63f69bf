"""Lenses that bend, from OpenCV's YAML: images of a pair to its cloud, by the command."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from debrisest.attitude import quaternion
from debrisest.cli import app
from debrisest.results.open import open_results
from debrisest.tracks.read import read_measured
from debrisest.tracks.types import Poses
from tests.vision.conftest import SCENE, laid_on

for library in ("cv2", "pycolmap", "skimage", "embreex"):
    pytest.importorskip(library)

BENT = [-0.5, 0.1, 0.002, -0.001, 0.0]
HALF_M = np.array([1.0, 0.8, 0.6])


def said(*arguments: object) -> str:
    done = CliRunner().invoke(app, [*map(str, arguments), "--quiet"])
    assert done.exit_code == 0, done.output
    return done.output


@pytest.fixture(scope="module")
def images(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Rendered images with the calibration that `render` writes beside them."""
    folder = tmp_path_factory.mktemp("bent")
    changes = {"sensors": {"camera": {"distortion": BENT}}}
    (folder / "box.yaml").write_text(yaml.safe_dump(laid_on(SCENE, changes)))
    said("render", folder / "box.yaml", "--out", folder)
    return folder / "box" / "nominal" / "images-000000"


def off_the_box(images: Path, out: Path, *options: object) -> float:
    """Return how far points of the cloud lie off the true box, m, in the median."""
    said("reconstruct", images, "--out", out, *options)
    found = open_results(out).one_run("nominal", "shape", 0)
    truth = read_measured(images.parent / "truth-000000" / "poses.csv")
    assert isinstance(truth, Poses) and truth.position is not None
    true = quaternion.to_matrix(truth.q)
    placed = np.flatnonzero(np.isfinite(found["view_translation"][:, 0]))
    turns, shifts = (found[f"view_{name}"][placed] for name in ("rotation", "translation"))
    points = np.einsum("tij,pj->tpi", turns, found["cloud_point_r"]) + shifts[:, None]
    body = np.einsum("tji,tpj->tpi", true[placed], points - truth.position[placed, None])
    return float(np.nanmedian(np.abs((np.abs(body) - HALF_M).max(axis=-1))))


def test_lenses_that_bend_are_those_of_their_calibration(
    images: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("debrisest.reconstruction.body._CELLS", (24, 40))
    calibration = (images / "calibration.yaml").read_text()
    coefficients = ", ".join(map(repr, BENT))
    assert calibration.count(f"data: [ {coefficients} ]") == 2
    bent = off_the_box(images, tmp_path / "bent")
    assert bent < 0.01
    straight = tmp_path / "straight.yaml"
    straight.write_text(calibration.replace(coefficients, "0.0, 0.0, 0.0, 0.0, 0.0"))
    assert off_the_box(images, tmp_path / "straight", "--camera", straight) > 2.0 * bent
