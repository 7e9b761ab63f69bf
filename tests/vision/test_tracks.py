"""Tracks from rendered images against the truth, which the tracker never sees."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from typer.testing import CliRunner

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.cli import app
from debrisest.tracks.from_images import pixel_tracks
from debrisest.tracks.read import read_measured
from debrisest.tracks.types import Poses, Tracks
from debrisest.vision.image_files import read_images

pytest.importorskip("cv2")

RANGE = 5.9


def run(*arguments: object) -> tuple[int, str]:
    done = CliRunner().invoke(app, list(map(str, arguments)))
    return done.exit_code, done.output


@pytest.fixture(scope="module")
def tracked(rendered: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    out = tmp_path_factory.mktemp("tracked")
    code, said = run("track", rendered, "--out", out, "--quiet")
    assert code == 0, said
    return out, said


def in_body(rendered: Path, tracks: Tracks) -> Array:
    """Points (epoch, feature, 3), m, in the true body axes."""
    truth = read_measured(rendered.parent / "truth-000000" / "poses.csv")
    assert isinstance(truth, Poses) and truth.position is not None and tracks.points is not None
    back = quaternion.conjugate(truth.q)[:, None]
    return quaternion.rotate(back, tracks.points - truth.position[:, None])


def test_points_stay_where_they_are_on_the_body(rendered: Path, tracked: tuple[Path, str]) -> None:
    tracks = read_measured(tracked[0] / "tracks.csv")
    assert isinstance(tracks, Tracks) and tracks.point_sigma is not None
    body = in_body(rendered, tracks)
    off = body - np.nanmedian(body, axis=0)
    distance = np.linalg.norm(off, axis=-1)
    distance = distance[np.isfinite(distance)]
    assert len(tracks.features) >= 40
    assert np.median(distance) < 0.004 * RANGE
    assert np.mean(distance > 0.03 * RANGE) < 0.005
    surface = np.nanmax(np.abs(np.nanmedian(body, axis=0)) - [1.0, 0.8, 0.6], axis=-1)
    assert np.median(np.abs(surface)) < 0.004 * RANGE


def test_the_sigma_is_that_of_the_errors(rendered: Path, tracked: tuple[Path, str]) -> None:
    """Errors about each point's mean, in units of the sigma along the line of sight."""
    tracks = read_measured(tracked[0] / "tracks.csv")
    assert isinstance(tracks, Tracks) and tracks.point_sigma is not None
    assert tracks.points is not None
    truth = read_measured(rendered.parent / "truth-000000" / "poses.csv")
    assert isinstance(truth, Poses) and truth.position is not None
    body = in_body(rendered, tracks)
    mean = np.nanmean(body, axis=0)
    expected = quaternion.rotate(truth.q[:, None], mean) + truth.position[:, None]
    off = (tracks.points - expected)[..., 2] / tracks.point_sigma[..., 2]
    seen = np.isfinite(off).sum(axis=0)
    share = np.sqrt(np.nanmean(off**2 / (1.0 - 1.0 / seen)))
    assert 0.6 < share < 2.0


def test_what_was_found_and_left_out_is_told(tracked: tuple[Path, str]) -> None:
    out, said = tracked
    words = ("tracks ", "length ", "noise ", "left out ", "next: debrisest estimate")
    for word in (*words, "/tracks.csv --out "):
        assert word in said
    assert {"tracks.png", "tracks.svg", "strip.png"} <= {path.name for path in out.iterdir()}


def test_one_camera_gives_pixels_of_the_same_body(rendered: Path, tmp_path: Path) -> None:
    code, said = run("track", rendered / "left", "--rate-hz", 1, "--out", tmp_path, "--quiet")
    assert code == 0, said
    tracks = read_measured(tmp_path / "tracks.csv")
    assert isinstance(tracks, Tracks) and tracks.pixels is not None
    assert tracks.points is None and len(tracks.features) >= 20
    assert "no calibration was given" in said


def test_pixels_are_those_of_the_images_before_they_were_reduced(rendered: Path) -> None:
    images = read_images(rendered / "left")
    whole, half = (
        pixel_tracks(each, np.arange(8.0)).tracks.pixels
        for each in (images, images._replace(reduced=0.5))
    )
    assert whole is not None and half is not None
    np.testing.assert_allclose(half + 0.5, 2.0 * (whole + 0.5))


def test_a_shadow_that_moves_on_a_coloured_backdrop_is_not_followed(rendered: Path) -> None:
    """The backdrop is as bright as the body, and blue; in a corner spots of shade move on it."""
    images = read_images(rendered / "left")
    frames, body = images.frames.copy(), images.frames > 12
    frames[~body] = 90
    spots = np.kron(np.random.default_rng(5).integers(60, 90, (6, 8)), np.ones((5, 5)))
    for epoch, frame in enumerate(frames[:, 0]):
        frame[2:32, 2 + 3 * epoch : 42 + 3 * epoch] = spots
    assert not body[:, 0, :35, :66].any()
    shade = np.where(body, 0.0, frames / 90.0)[..., None]
    chroma = np.rint(128 + shade * [-18, 37]).astype(np.uint8)

    cut_out = np.where(body, np.uint8(255), np.uint8(0))

    def in_the_corner(**told: NDArray[np.uint8]) -> int:
        shown = pixel_tracks(images._replace(frames=frames, **told), np.arange(8.0)).shown
        return int((np.nanmax(shown, axis=(0, 1)) < [66, 35]).all(axis=1).sum())

    assert in_the_corner() > 0
    assert in_the_corner(chroma=chroma) == 0
    assert in_the_corner(opacity=cut_out) == 0


def test_a_room_that_stands_still_is_left_out(config: Path, tmp_path: Path) -> None:
    room = ["sensors.camera.background=room", "sensors.camera.room_m=12"]
    options = [part for each in room for part in ("--set", each)]
    code, said = run("render", config, "--out", tmp_path, "--quiet", *options)
    assert code == 0, said
    images = next(tmp_path.glob("box@*")) / "nominal" / "images-000000"
    code, said = run("track", images, "--out", tmp_path / "tracks", "--quiet")
    assert code == 0, said
    tracks = read_measured(tmp_path / "tracks" / "tracks.csv")
    assert isinstance(tracks, Tracks)
    body = np.nanmedian(in_body(images, tracks), axis=0)
    assert np.mean(np.abs(body).max(axis=-1) > 1.3) < 0.02


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["left", "right", "--rate-hz", "1"], "a stereo pair needs its calibration"),
        (["left"], "when were these images taken"),
        (["left", "--rate-hz", "-1"], "when were these images taken"),
        ([".", "left"], "give one folder or video, or two"),
        (["none"], "no such folder or file"),
    ],
)
def test_what_is_missing_is_told(rendered: Path, arguments: list[str], said: str) -> None:
    paths = [a if a.startswith("-") or a[0] in "0123456789" else rendered / a for a in arguments]
    code, told = run("track", *paths, "--quiet")
    assert code == 2
    assert said in told and "Traceback" not in told


def test_images_without_a_body_are_refused(tmp_path: Path) -> None:
    from debrisest.vision.image_files import ImageSequence, write_images

    noise = np.random.default_rng(1).integers(0, 6, (5, 1, 120, 160)).astype(np.uint8)
    write_images(tmp_path, ImageSequence("", ("camera",), noise, np.arange(5.0)))
    code, told = run("track", tmp_path, "--quiet", "--out", tmp_path / "out")
    assert code == 2 and "nothing can be followed" in told


def test_without_its_libraries_the_command_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, config: Path
) -> None:
    from debrisest.errors import UserError
    from debrisest.vision import libraries

    def missing(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(libraries, "import_module", missing)
    with pytest.raises(
        UserError, match=r"opencv-python-headless.*pip install 'debrisest\[vision\]"
    ):
        libraries.vision_library("cv2")
    code, told = run("render", config)
    assert code == 2 and "pip install 'debrisest[vision]'" in told
