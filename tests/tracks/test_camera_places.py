"""Lists of cameras: matrices, rotations and translations of images, or their projections."""

import os
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.tracks.camera_places import read_places
from tests.tracks.conftest import refusal

MATRIX = np.array([[1520.4, 0.0, 302.3], [0.0, 1525.9, 246.9], [0.0, 0.0, 1.0]])
TURNS = Rotation.from_rotvec([[0.1, 0.2, -0.3], [1.0, -2.0, 0.5]]).as_matrix()
SHIFTS = np.array([[0.01, -0.02, 0.6], [0.03, 0.0, 0.55]])
NAMES = ("t1.png", "t2.png")


def rows(values: list[np.ndarray]) -> list[str]:
    return [f"{name} {' '.join(map(repr, each.tolist()))}" for name, each in zip(NAMES, values)]


def factors() -> list[np.ndarray]:
    return [np.concatenate([MATRIX.ravel(), r.ravel(), t]) for r, t in zip(TURNS, SHIFTS)]


def projections(factor: float) -> list[np.ndarray]:
    parts = (np.concatenate([r, t[:, None]], axis=1) for r, t in zip(TURNS, SHIFTS))
    return [factor * (MATRIX @ part).ravel() for part in parts]


@pytest.mark.parametrize("values", [factors(), projections(1.0), projections(-0.02)])
@pytest.mark.parametrize("head", [[], ["2"], ["# of a gantry", "2"]])
def test_a_camera_and_its_places_are_read(
    tmp_path: Path, values: list[np.ndarray], head: list[str]
) -> None:
    path = tmp_path / "par.txt"
    path.write_text("\n".join([*head, *rows(values)]) + "\n")
    found = read_places(path, NAMES[::-1])
    np.testing.assert_allclose(found.matrix, MATRIX, atol=1e-8)
    np.testing.assert_allclose(found.rotation, TURNS[::-1], atol=1e-10)
    np.testing.assert_allclose(found.translation, SHIFTS[::-1], atol=1e-10)


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["t1.png 1 2 3"], "par.txt:1: 3 numbers; expected name K(9) R(9) t(3)"),
        (["t1.png 1 2 x"], "could not convert"),
        (rows(factors())[:1], "no camera for the image t2.png; it has t1.png"),
        (rows([-one for one in factors()]), "par.txt:1: no rotation, or no positive focal length"),
        (rows([factors()[0], factors()[1] * np.repeat([1.1, 1.0], [2, 19])]), "matrices differ"),
        (["2"], "it has nothing"),
        ([], "the file is empty"),
    ],
)
def test_what_is_no_list_of_places_is_told(tmp_path: Path, lines: list[str], words: str) -> None:
    path = tmp_path / "par.txt"
    path.write_text("\n".join(lines))
    assert words in refusal(lambda: read_places(path, NAMES))


def test_a_pipe_is_no_list_of_places(tmp_path: Path) -> None:
    os.mkfifo(path := tmp_path / "par.txt")
    assert "par.txt" in refusal(lambda: read_places(path, NAMES))


@pytest.mark.parametrize("head", ["", "CONTOUR\n"])
def test_a_file_for_each_image_is_read(tmp_path: Path, head: str) -> None:
    for number, values in enumerate(projections(-0.02), start=1):
        rows = "\n".join(" ".join(map(repr, row.tolist())) for row in values.reshape(3, 4))
        (tmp_path / f"pos_{number:03d}.txt").write_text(f"{head}{rows}\n")
    found = read_places(tmp_path, ["rect_002_3_r5000.png", "rect_001_3_r5000.png"])
    np.testing.assert_allclose(found.matrix, MATRIX, atol=1e-8)
    np.testing.assert_allclose(found.rotation, TURNS[::-1], atol=1e-10)
    lacking = refusal(lambda: read_places(tmp_path, ["rect_003.png"]))
    assert "no camera for the image rect_003.png; it has 1, 2" in lacking
