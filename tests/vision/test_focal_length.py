"""A first focal length: what EXIF and a field of view tell, against lenses by hand."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from debrisest.vision.focal_length import first_focal

SIZE = (300, 200)
FOCAL_35MM = 0xA405


def photograph(path: Path, focal: object = None) -> Path:
    exif = Image.Exif()
    if focal is not None:
        exif.get_ifd(0x8769)[FOCAL_35MM] = focal
    Image.fromarray(np.zeros(SIZE[::-1], np.uint8)).save(path, exif=exif)
    return path


def test_the_focal_length_of_35_mm_film_scales_with_the_image(tmp_path: Path) -> None:
    found = first_focal(photograph(tmp_path / "a.jpg", 50), SIZE)
    assert found.px == pytest.approx(50 / 36 * 300)
    assert "EXIF (50 mm" in found.source
    matrix = found.matrix(SIZE)
    assert (matrix[0, 2], matrix[1, 2]) == (149.5, 99.5)


def test_a_field_of_view_goes_before_exif(tmp_path: Path) -> None:
    found = first_focal(photograph(tmp_path / "a.jpg", 50), SIZE, 90.0)
    assert found.px == pytest.approx(150.0)
    assert "as given" in found.source


@pytest.mark.parametrize("focal", [None, 0])
def test_without_either_a_usual_view_is_taken_and_said(tmp_path: Path, focal: object) -> None:
    found = first_focal(photograph(tmp_path / "a.jpg", focal), SIZE)
    assert found.px == pytest.approx(150 / np.tan(np.radians(25)))
    assert "nothing tells it" in found.source
    assert found.spread > first_focal(tmp_path / "a.jpg", SIZE, 50.0).spread


def test_a_file_that_is_no_photograph_tells_nothing(tmp_path: Path) -> None:
    (tmp_path / "film.mp4").write_bytes(b"no image")
    assert "nothing tells it" in first_focal(tmp_path / "film.mp4", SIZE).source
