"""reconstruct on photographs as people have them: JPEG, no calibration, a plain backdrop."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from typer.testing import CliRunner

from debrisest.arrays import Data
from debrisest.attitude import quaternion
from debrisest.cli.app import app
from debrisest.cli.images_scenario import thinned
from debrisest.errors import UserError
from debrisest.reconstruction.mesh_files import read_mesh
from debrisest.vision.image_files import read_images
from debrisest.vision.image_names import has_masks
from debrisest.vision.masks import read_masks
from tests.vision.conftest import Scene

pytest.importorskip("cv2")
pytest.importorskip("pycolmap")
pytest.importorskip("skimage")

FOCAL_35MM, FOCAL_PX, WIDTH, HEIGHT = 0xA405, 500.0, 320, 240
Photographs = Sequence[NDArray[np.uint8]]


@pytest.fixture(scope="module")
def box(scene: Scene) -> Data:
    """A box of 2 m x 1.6 m x 1.2 m that turns."""
    return scene(
        {
            "duration_s": 14,
            "motion": {"rate_deg_s": [4.0, 8.0, 3.0]},
            "observers": {"chaser": {"target_m": [0.0, 0.0, 5.4]}},
            "sensors": {"camera": {"baseline_m": None, "ambient": 0.6, "noise_grey": 0.5}},
        }
    )


@pytest.fixture(scope="module")
def photographs(box: Data) -> Photographs:
    """Images of it before a backdrop with details that stand still."""
    frames = box["measured_image"][0, :, 0].astype(np.uint8)
    spots = np.random.default_rng(7).integers(120, 200, (HEIGHT // 8, WIDTH // 8))
    backdrop = np.kron(spots, np.ones((8, 8))).astype(np.uint8)
    return [np.where(frame > 12, frame, backdrop) for frame in frames]


def put(folder: Path, photographs: Photographs, focal_mm: int | None = None) -> Path:
    """Write photographs with names that are not padded, and EXIF if a focal length is given."""
    folder.mkdir()
    exif = Image.Exif()
    if focal_mm is not None:
        exif.get_ifd(0x8769)[FOCAL_35MM] = focal_mm
    for number, pixels in enumerate(photographs):
        Image.fromarray(pixels).save(folder / f"p{number + 1}.jpg", exif=exif, quality=95)
    return folder


def said(folder: Path, *options: object) -> tuple[int, str]:
    out = folder.parent / "out" / folder.name
    arguments = ["reconstruct", str(folder), "--out", str(out), "--quiet", *map(str, options)]
    result = CliRunner().invoke(app, arguments)
    assert "Traceback" not in result.output
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result.exit_code, result.output


def line(output: str, label: str) -> str:
    (found,) = (each for each in output.splitlines() if each.startswith(f"{label} "))
    return found.removeprefix(label).strip()


def test_photographs_without_a_calibration(
    tmp_path: Path, photographs: Photographs, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("debrisest.reconstruction.body._CELLS", (24, 40))
    focal_mm = round(FOCAL_PX * 1.1 / np.hypot(WIDTH, HEIGHT) * np.hypot(36, 24))
    folder = put(tmp_path / "box", photographs, focal_mm)
    code, output = said(folder)
    assert code == 0
    placed, _, of = line(output, "images").split()[:3]
    assert int(placed) >= 0.9 * int(of)
    told = line(output, "focal length")
    assert f"begun with EXIF ({focal_mm} mm" in told
    focal, _, sigma = told.split()[:3]
    assert abs(float(focal) - FOCAL_PX) < max(3.0 * float(sigma), 0.02 * FOCAL_PX)
    assert "without a scale: only ratios" in output or "no number is told" in output
    assert "volume " not in output
    assert (tmp_path / "out" / "box" / "mesh.obj").is_file()


def test_places_that_are_given_tell_scale_and_axes(
    tmp_path: Path, box: Data, photographs: Photographs, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("debrisest.reconstruction.body._CELLS", (24, 40))
    folder = put(tmp_path / "box", photographs)
    turns = quaternion.to_matrix(box["true_q_ib"][0])
    shifts = np.broadcast_to(box["true_position"][0], (len(turns), 3))
    known = [box["camera_matrix"][0, 0].ravel(), turns.reshape(-1, 9), shifts]
    lines = [
        f"p{number + 1}.jpg {' '.join(map(repr, np.concatenate(each).tolist()))}"
        for number, each in enumerate(zip(np.tile(known[0], (len(turns), 1)), *known[1:]))
    ]
    (folder / "box_par.txt").write_text("\n".join([str(len(lines)), *lines]))
    code, output = said(folder)
    assert code == 0
    assert "px, from the places box_par.txt" in line(output, "focal length")
    points, _ = read_mesh(tmp_path / "out" / "box" / "cloud.ply")
    outside = (np.abs(points) - [1.0, 0.8, 0.6]).max(axis=1)
    assert np.quantile(np.abs(outside), 0.7) < 0.05


def test_masks_in_a_folder_of_their_own_tell_the_body(
    tmp_path: Path, box: Data, photographs: Photographs, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("debrisest.reconstruction.body._CELLS", (24, 40))
    folder = put(tmp_path / "box", photographs)
    (folder / "masks").mkdir()
    for number, frame in enumerate(box["measured_image"][0, :, 0]):
        drawn = Image.fromarray(np.where(frame > 12, np.uint8(255), np.uint8(0)))
        drawn.save(folder / "masks" / f"p{number + 1}.png")
    code, output = said(folder)
    assert code == 0
    assert f"note: the masks in {folder / 'masks'} tell the body" in output
    assert line(output, "outline") == "the masks that were given"


def test_the_opacity_of_cut_out_images_is_their_mask(
    tmp_path: Path, box: Data, photographs: Photographs, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("debrisest.reconstruction.body._CELLS", (24, 40))
    folder = tmp_path / "box"
    folder.mkdir()
    for number, (frame, shown) in enumerate(zip(box["measured_image"][0, :, 0], photographs)):
        opaque = np.where(frame > 12, np.uint8(255), np.uint8(0))
        Image.fromarray(np.dstack([shown, opaque])).save(folder / f"p{number + 1}.png")
    code, output = said(folder)
    assert code == 0
    assert line(output, "outline") == "the masks that were given"


def test_masks_among_images_and_masks_of_the_ground_are_known(tmp_path: Path) -> None:
    ground = np.full((40, 60), 255, np.uint8)
    ground[10:30, 20:40] = 0
    for number in (1, 2, 10):
        Image.fromarray(np.full((40, 60), number, np.uint8)).save(tmp_path / f"{number}.png")
        Image.fromarray(ground).save(tmp_path / f"{number}_mask.png")
    images = read_images(tmp_path)
    assert images.names == ("1.png", "2.png", "10.png")
    assert has_masks(tmp_path)
    np.testing.assert_array_equal(read_masks(tmp_path, images)[:, 0], [255 - ground] * 3)


def test_masks_that_do_not_fit_are_told(tmp_path: Path) -> None:
    for place, count in (("images", 4), ("masks", 3)):
        put(tmp_path / place, noise(count))
    with pytest.raises(UserError, match="masks: 3 of 64 x 48 pixels, but images: 4 of 64 x 48"):
        read_masks(tmp_path / "masks", read_images(tmp_path / "images"))
    _, output = said(tmp_path / "images")
    assert "has not a mask for each image, and is not taken" in output


def test_images_are_read_as_the_camera_sees_them_where_it_was_held_in_several_ways(
    tmp_path: Path,
) -> None:
    shown = np.zeros((40, 60), np.uint8)
    shown[:20, :30] = 200
    for number, held in enumerate((1, 6, 6)):
        exif = Image.Exif()
        exif[0x0112] = held
        Image.fromarray(shown).save(tmp_path / f"p{number}.jpg", exif=exif)
    frames = read_images(tmp_path).frames[:, 0]
    assert np.abs(frames.astype(int) - shown).mean() < 3.0
    (tmp_path / "p0.jpg").unlink()
    assert read_images(tmp_path).frames.shape == (2, 1, 60, 40)


def test_who_knows_that_there_is_no_support_says_so(tmp_path: Path) -> None:
    said(put(tmp_path / "free", blank(5)), "--no-support")
    assert "support: none" in (tmp_path / "out" / "free" / "free.yaml").read_text()


def noise(count: int, height: int = 48) -> Photographs:
    return list(np.random.default_rng(1).integers(0, 255, (count, height, 64)).astype(np.uint8))


def blank(count: int) -> Photographs:
    return [np.full((48, 64), 128, np.uint8)] * count


@pytest.mark.parametrize(
    ("shown", "code", "words"),
    [
        (noise(1), 2, "one image; a body that turns needs 3"),
        (noise(2), 2, "2 images; a body that turns needs 3"),
        (blank(5), 1, "find a place in one structure"),
        (noise(1) * 5, 1, "find a place in one structure"),
        (noise(5), 1, "find a place in one structure"),
        ([*noise(4), *noise(1, height=40)], 2, "p5.jpg: 64 x 40 pixels, the first image has"),
        ([*noise(3), noise(1)[0].T], 2, "64 x 48; turn it as the others are"),
    ],
    ids=["one", "two", "blank", "background", "noise", "sizes", "turned"],
)
def test_what_cannot_be_reconstructed_is_told(
    tmp_path: Path, shown: Photographs, code: int, words: str
) -> None:
    found, output = said(put(tmp_path / "photographs", shown))
    assert (found, words in output) == (code, True), output


def test_a_pair_without_its_calibration_is_refused(tmp_path: Path) -> None:
    for side in ("left", "right"):
        (tmp_path / "pair").mkdir(exist_ok=True)
        put(tmp_path / "pair" / side, noise(4))
    code, output = said(tmp_path / "pair")
    assert code == 2
    assert "a stereo pair needs its calibration" in output


def test_a_calibration_of_another_size_is_refused(tmp_path: Path) -> None:
    folder = put(tmp_path / "photographs", noise(4))
    keys = {"fx_px": 90, "fy_px": 90, "cx_px": 64, "cy_px": 48, "width_px": 128, "height_px": 96}
    calibration = tmp_path / "calibration.yaml"
    calibration.write_text("".join(f"{key}: {value}\n" for key, value in keys.items()))
    code, output = said(folder)
    assert code == 2
    assert "128 pixels wide" in output


def test_of_many_images_one_of_several_is_taken_and_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for number in range(151):
        (tmp_path / f"viff.{number:03d}.ppm").write_bytes(b"")
    assert thinned(tmp_path) == 3
    assert "one of 3 of the 151 images is taken; --every 1" in capsys.readouterr().out
    (tmp_path / "viff.150.ppm").unlink()
    assert thinned(tmp_path) == 2


@pytest.mark.parametrize("suffix", ["ppm", "pgm", "tif", "webp"])
def test_kinds_of_files_and_their_colours(tmp_path: Path, suffix: str) -> None:
    shown = np.zeros((40, 60, 3), np.uint8)
    shown[:] = (40, 70, 150)
    shown[:, 30:] = 128
    for number in (9, 10, 1):
        Image.fromarray(shown).convert("L" if suffix == "pgm" else "RGB").save(
            tmp_path / f"img_{number}.{suffix}"
        )
    found = read_images(tmp_path, colours=True, gaps=True)
    assert found.names == tuple(f"img_{number}.{suffix}" for number in (1, 9, 10))
    if suffix == "pgm":
        assert found.chroma is None
        return
    assert found.chroma is not None
    red, blue = np.moveaxis(found.chroma[0, 0], -1, 0)
    assert abs(int(red[5, 5]) - 105) < 4  # 128 + 0.713 (40 - 70)
    assert abs(int(blue[5, 5]) - 173) < 4
    assert abs(int(red[5, 50]) - 128) < 3
