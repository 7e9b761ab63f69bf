"""COLMAP text models, written by hand from projected points."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.arrays import Array
from debrisest.tracks.colmap import ColmapModel
from debrisest.tracks.read import read_measured
from tests.tracks.conftest import BODY, refusal

TURN = Rotation.from_rotvec(0.2 * np.outer(np.arange(4), [0.0, 0.6, 0.8]))
SHIFT = np.array([0.1, -0.2, 8.0])
FOCAL, CENTRE = 500.0, np.array([320.0, 240.0])


def pixels(image: int) -> Array:
    seen = TURN[image].apply(BODY) + SHIFT
    return FOCAL * seen[:, :2] / seen[:, 2:] + CENTRE


def write_model(folder: Path, change: Callable[[str, str], str] = lambda name, text: text) -> Path:
    images = ["# two lines of data per image"]
    for n, name in enumerate(("f010.png", "f011.png", "f013.png", "f014.png")):
        q, t = TURN[n].as_quat(scalar_first=True), SHIFT
        pose = " ".join(f"{x:.12g}" for x in (*q, *t))
        images.append(f"{n + 1} {pose} 1 {name}")
        seen = [f"{u:.6f} {v:.6f} {7 + f}" for f, (u, v) in enumerate(pixels(n)) if f != n]
        images.append(" ".join([*seen, "12.5 13.5 -1"]))
    points = [f"{7 + f} {x} {y} {z} 0 0 0 0.5 1 0 2 0" for f, (x, y, z) in enumerate(BODY)]
    files = {
        "cameras.txt": f"# cameras\n1 SIMPLE_RADIAL 640 480 {FOCAL} 320 240 -0.1\n",
        "images.txt": "\n".join(images) + "\n",
        "points3D.txt": "\n".join(points) + "\n",
    }
    for name, text in files.items():
        (folder / name).write_text(change(name, text))
    return folder


def test_images_are_epochs_points_features_and_poses_those_of_the_body(tmp_path: Path) -> None:
    model = read_measured(write_model(tmp_path), rate_hz=10.0)
    assert isinstance(model, ColmapModel)
    np.testing.assert_allclose(model.tracks.times, [0.0, 0.1, 0.3, 0.4])
    assert model.tracks.features == ("7", "8", "9", "10", "11")
    for n in range(4):
        expected = np.where(np.arange(5)[:, None] == n, np.nan, pixels(n))
        np.testing.assert_allclose(model.tracks.pixels[n, 0], expected, atol=1e-6)
    found = Rotation.from_quat(model.poses.q, scalar_first=True)
    assert (found.inv() * TURN).magnitude().max() < 1e-9
    np.testing.assert_allclose(model.poses.position, np.tile(SHIFT, (4, 1)))
    np.testing.assert_array_equal(model.body.points, BODY)
    (camera,) = model.cameras
    assert (camera.focal_px, camera.centre_px) == ((500.0, 500.0), (320.0, 240.0))
    assert (camera.distortion, camera.size) == ((-0.1, 0.0, 0.0, 0.0), (640, 480))


def test_an_image_that_sees_nothing_is_an_epoch_without_features(tmp_path: Path) -> None:
    def blank(name: str, text: str) -> str:
        lines = text.split("\n")
        return "\n".join([*lines[:4], "", *lines[5:]]) if name == "images.txt" else text

    model = read_measured(write_model(tmp_path, blank), rate_hz=10.0)
    assert isinstance(model, ColmapModel)
    np.testing.assert_allclose(model.tracks.times, [0.0, 0.3, 0.4])
    assert len(model.poses.times) == 4


def test_a_point_at_two_places_of_an_image_is_left_out_and_told(tmp_path: Path) -> None:
    twice = lambda name, text: text.replace(" -1\n2", " 9\n2")  # noqa: E731
    model = read_measured(write_model(tmp_path, twice), rate_hz=10.0)
    assert isinstance(model, ColmapModel)
    assert np.isnan(model.tracks.pixels[0, 0]).all(-1).tolist() == [True, False, True, False, False]
    assert any("2 pixels left out" in note for note in model.tracks.notes)


@pytest.mark.parametrize(
    ("file", "old", "new", "said"),
    [
        ("cameras.txt", "SIMPLE_RADIAL", "FISHEYE", ":2: expected CAMERA_ID MODEL WIDTH"),
        ("cameras.txt", " -0.1", "", ":2: SIMPLE_RADIAL has 4 parameters, not 3"),
        ("cameras.txt", "500.0", "abc", ":2: 'abc' is not a number"),
        ("images.txt", " 1 f011.png", " 2 f011.png", ":4: camera 2 is not in cameras.txt"),
        ("images.txt", "f011.png", "f010.png", ":4: image f010.png is there twice"),
        ("images.txt", " -1\n2", "\n2", ":3: expected triples X Y POINT3D_ID; is the line cut?"),
        ("images.txt", " -1\n2", " 99\n2", ":3: point 99 is not in points3D.txt"),
        ("images.txt", "# two lines of data per image\n", "1\n", ":1: expected IMAGE_ID QW"),
        ("points3D.txt", "\n8 ", "\n7 ", ":2: point 7 is there twice"),
        ("points3D.txt", " 0 0 0 0.5 1 0 2 0\n8", "\n8", ":1: expected POINT3D_ID"),
    ],
)
def test_damaged_models(tmp_path: Path, file: str, old: str, new: str, said: str) -> None:
    def change(name: str, text: str) -> str:
        assert name != file or old in text
        return text.replace(old, new, 1) if name == file else text

    write_model(tmp_path, change)
    refused = refusal(lambda: read_measured(tmp_path, rate_hz=1.0))
    assert f"{tmp_path / file}{said}" in refused


def test_a_folder_with_the_binary_form_or_half_of_the_files(tmp_path: Path) -> None:
    (tmp_path / "images.bin").write_bytes(b"\0")
    assert "model_converter" in refusal(lambda: read_measured(tmp_path, rate_hz=1.0))
    write_model(tmp_path)
    assert "frame rate" in refusal(lambda: read_measured(tmp_path))
