"""Calibrations as OpenCV writes them and as a person does."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.tracks.calibration import read_calibration
from tests.tracks.conftest import Write, refusal

TURN = Rotation.from_rotvec([0.01, -0.02, 0.005]).as_matrix()


def matrix(name: str, rows: int, columns: int, data: list[float]) -> str:
    numbers = ",\n       ".join(f"{x:.10e}" for x in data)
    head = f"{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n"
    return f"{head}   data: [ {numbers} ]\n"


def mounted(size: int, turn: list[float], shift: list[float]) -> str:
    return matrix("R", size, size, turn) + matrix("T", 3, 1, shift)


HEAD = "%YAML:1.0\n---\n"
ONE = (
    HEAD
    + 'calibration_time: "Mon"\nimage_width: 1920\nimage_height: 1200\nflags: 0\n'
    + matrix("camera_matrix", 3, 3, [2988.0, 0, 960, 0, 2987.0, 600, 0, 0, 1])
    + matrix("distortion_coefficients", 5, 1, [-0.22, 0.51, -6e-4, -2e-4, -0.13])
)
INTRINSICS = (
    HEAD
    + matrix("M1", 3, 3, [500, 0, 320, 0, 501, 240, 0, 0, 1])
    + matrix("D1", 1, 4, [0.1, 0, 0, 0])
    + matrix("M2", 3, 3, [502, 0, 321, 0, 503, 241, 0, 0, 1])
    + matrix("D2", 1, 4, [0.2, 0, 0, 0])
)
EXTRINSICS = (
    HEAD + matrix("R", 3, 3, TURN.ravel().tolist()) + matrix("T", 3, 1, [-0.24, 0.001, 0.002])
)


def test_one_camera(write: Write) -> None:
    (camera,) = read_calibration(write(ONE, "camera.yml")).cameras
    assert (camera.focal_px, camera.centre_px) == ((2988.0, 2987.0), (960.0, 600.0))
    assert camera.distortion == (-0.22, 0.51, -6e-4, -2e-4, -0.13)
    assert camera.size == (1920, 1200)


def test_a_stereo_pair_in_two_files(write: Write) -> None:
    rig = read_calibration(write(INTRINSICS, "in.yml"), write(EXTRINSICS, "ex.yml"))
    assert [camera.focal_px for camera in rig.cameras] == [(500.0, 501.0), (502.0, 503.0)]
    assert [camera.distortion[0] for camera in rig.cameras] == [0.1, 0.2]
    np.testing.assert_allclose(rig.rotation[1], TURN, atol=1e-9)
    np.testing.assert_allclose(rig.translation[1], [-0.24, 0.001, 0.002])
    np.testing.assert_allclose(rig.baselines, [0.0, np.linalg.norm([0.24, 0.001, 0.002])])


def test_the_base_from_a_projection(write: Write) -> None:
    projection = matrix("P2", 3, 4, [480, 0, 320, -480 * 0.12, 0, 480, 240, 0, 0, 0, 1, 0])
    rig = read_calibration(write(INTRINSICS + projection, "stereo.yml"))
    np.testing.assert_allclose(rig.translation[1], [-0.12, 0, 0])


def test_plain_keys(write: Write) -> None:
    text = "fx_px: 500\nfy_px: 5.01e2\ncx_px: 320\ncy_px: 240\ndistortion: [1e-3, 0, 0, 0]\n"
    (one,) = read_calibration(write(text, "camera.yaml")).cameras
    assert (one.focal_px, one.centre_px, one.distortion[0]) == ((500, 501), (320, 240), 1e-3)
    pair = read_calibration(write(f"{text}baseline_m: 0.5\n", "camera.yaml"))
    assert pair.cameras[0].focal_px == pair.cameras[1].focal_px
    point = np.array([0.0, 0.0, 4.0])  # on the first camera's axis: left of the right camera's
    np.testing.assert_allclose(pair.rotation[1] @ point + pair.translation[1], [-0.5, 0, 4])


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("fx_px: 500\nfy_px: 500\ncx_px: 320\n", "cy_px is missing"),
        ("fx_px: 500\nfocal: 2\n", "unknown key focal; allowed are fx_px"),
        ("fx_px: 500\nfy_px: 500\ncy_xp: 1\n", "unknown key cy_xp; did you mean cy_px?"),
        ("fx_px: -500\nfy_px: 500\ncx_px: 320\ncy_px: 240\n", "focal lengths must be positive"),
        ("fx_px: 500\nfx_px: 510\n", ":2:1: not a calibration: key fx_px is there twice"),
        ("fx_px: [1\n", ":2:1: not a calibration"),
        ("- 1\n", "expected keys such as fx_px"),
        ("a: 1\n", "no camera here; expected fx_px"),
        (ONE.replace("rows: 3", "rows: 4"), ":7:16: not a calibration: a matrix needs rows, cols"),
        (INTRINSICS, "two cameras, but neither R and T nor P2"),
        (INTRINSICS + mounted(3, [1, 0, 0, 0, 1, 0, 0, 0, -1], [1, 0, 0]),
         "R is not a rotation matrix"),
        (INTRINSICS + mounted(3, [1, 0, 0, 0, 1, 0, 0, 0, 1], [-120, 0, 0]),
         "a baseline of 120 m; T (or baseline_m) must be in metres, above zero, at most 10"),
        (INTRINSICS + mounted(2, [1, 0, 0, 1], [1, 0, 0]),
         "R: expected 3 x 3 numbers"),
    ],
)  # fmt: skip
def test_refused(write: Write, content: str, said: str) -> None:
    path = write(content, "camera.yml")
    refused = refusal(lambda: read_calibration(path))
    assert refused.startswith(str(path)) and said in refused
