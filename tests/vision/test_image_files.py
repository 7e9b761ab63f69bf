"""Folders of images and videos: what is written is read, what is wrong is told in one sentence."""

from pathlib import Path

import numpy as np
import pytest

from debrisest.errors import UserError

cv2 = pytest.importorskip("cv2")

from debrisest.vision.image_files import (  # noqa: E402
    ImageSequence,
    read_images,
    write_images,
)
from debrisest.vision.videos import write_video  # noqa: E402


def sequence(cameras: tuple[str, ...] = ("left", "right"), frames: int = 5) -> ImageSequence:
    values = np.random.default_rng(1).integers(0, 255, (frames, len(cameras), 48, 64))
    return ImageSequence("", cameras, values.astype(np.uint8), np.arange(frames) * 0.5)


@pytest.mark.parametrize("cameras", [("left", "right"), ("camera",)])
def test_a_folder_is_read_as_it_was_written(tmp_path: Path, cameras: tuple[str, ...]) -> None:
    written = sequence(cameras)
    write_images(tmp_path, written)
    found = read_images(tmp_path)
    assert found.cameras == cameras
    assert (found.frames == written.frames).all()
    assert found.times is not None and written.times is not None
    assert (found.times == written.times).all()


def test_images_are_read_in_the_order_of_the_numbers_in_their_names(tmp_path: Path) -> None:
    for number in (10, 2, 1, 9):
        cv2.imwrite(str(tmp_path / f"turn{number}.png"), np.full((8, 8), number, np.uint8))
    (tmp_path / "._turn1.png").write_bytes(b"what some systems leave beside files")
    found = read_images(tmp_path, gaps=True)
    assert found.frames[:, 0, 0, 0].tolist() == [1, 2, 9, 10]
    assert found.names[0] == "turn1.png"
    with pytest.raises(UserError, match="frame 3 is missing"):
        read_images(tmp_path)


def test_wide_images_are_reduced_to_their_mean(tmp_path: Path) -> None:
    fine = np.random.default_rng(3).integers(0, 255, (48, 64)).astype(np.uint8)
    cv2.imwrite(str(tmp_path / "a.png"), fine)
    found = read_images(tmp_path, widest=32)
    assert found.frames.shape == (1, 1, 24, 32)
    assert found.reduced == 0.5
    blocks = fine.reshape(24, 2, 32, 2).mean(axis=(1, 3))
    assert np.abs(found.frames[0, 0] - blocks).max() <= 1
    assert (read_images(tmp_path, widest=64).frames[0, 0] == fine).all()


@pytest.mark.parametrize("suffix", [".avi", ".mp4"])
def test_a_video_is_read_with_its_rate(tmp_path: Path, suffix: str) -> None:
    column = np.linspace(40, 200, 64).astype(np.uint8)
    frames = np.stack([np.tile(np.roll(column, 3 * k), (48, 1)) for k in range(6)])
    write_video(tmp_path / f"film{suffix}", frames, 10.0)
    found = read_images(tmp_path / f"film{suffix}")
    assert found.frames.shape == (6, 1, 48, 64)
    assert np.abs(found.frames[:, 0].astype(float) - frames).mean() < 8
    np.testing.assert_allclose(found.times, np.arange(6) / 10.0)


def test_one_of_several_is_read_with_its_time(tmp_path: Path) -> None:
    write_images(tmp_path, sequence(frames=7))
    whole, some = read_images(tmp_path), read_images(tmp_path, every=3)
    assert (some.frames == whole.frames[::3]).all()
    assert some.names == whole.names[::3]
    assert whole.times is not None and some.times is not None
    assert (some.times == whole.times[::3]).all()
    film = np.stack([np.full((48, 64), 30 * k, np.uint8) for k in range(7)])
    write_video(tmp_path / "film.avi", film, 10.0)
    seen = read_images(tmp_path / "film.avi", every=3)
    np.testing.assert_allclose(seen.times, [0.0, 0.3, 0.6])
    assert np.abs(seen.frames.mean(axis=(1, 2, 3)) - [0, 90, 180]).max() < 4


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_the_opacity_of_images_is_kept(tmp_path: Path, kind: type[np.integer]) -> None:
    cut = np.full((48, 64, 4), np.iinfo(kind).max, kind)
    cut[:10, :, 3] = 0
    for number in range(3):
        cv2.imwrite(str(tmp_path / f"{number}.png"), cut)
    found = read_images(tmp_path, colours=True).opacity
    assert found is not None
    assert (found[:, 0] == np.where(np.arange(48) < 10, 0, 255)[:, None]).all()
    half = read_images(tmp_path, widest=32, colours=True).opacity
    assert half is not None and half.shape == (3, 1, 24, 32)
    cut[..., 3] = np.iinfo(kind).max
    for number in range(3):
        cv2.imwrite(str(tmp_path / f"{number}.png"), cut)
    assert read_images(tmp_path, colours=True).opacity is None


def test_what_is_no_folder_of_images_is_told(tmp_path: Path) -> None:
    (tmp_path / "IMG_1.HEIC").write_bytes(b"as a telephone keeps it")
    with pytest.raises(UserError, match="1 as cameras and phones keep images; export"):
        read_images(tmp_path)
    write_images(tmp_path / "above" / "images", sequence(("camera",)))
    with pytest.raises(UserError, match=r"no images there; are those in .*images meant\?"):
        read_images(tmp_path / "above")


def _empty(folder: Path) -> None:
    for path in folder.rglob("*.png"):
        path.unlink()


def _missing_right(folder: Path) -> None:
    (folder / "right" / "000002.png").unlink()


def _missing_both(folder: Path) -> None:
    for side in ("left", "right"):
        (folder / side / "000002.png").unlink()
    (folder / "times.csv").unlink()


def _small(folder: Path) -> None:
    cv2.imwrite(str(folder / "left" / "000003.png"), np.zeros((40, 64), np.uint8))


def _damaged(folder: Path) -> None:
    path = folder / "left" / "000001.png"
    path.write_bytes(path.read_bytes()[:40])


def _cut_off(folder: Path) -> None:
    for side in ("left", "right"):
        (folder / side / "000001.png").unlink()
        photograph = np.random.default_rng(2).integers(0, 255, (48, 64)).astype(np.uint8)
        content = cv2.imencode(".jpg", photograph)[1].tobytes()
        (folder / side / "000001.jpg").write_bytes(content[: len(content) // 2])


def _hollow(folder: Path) -> None:
    (folder / "left" / "000001.png").write_bytes(b"")


def _times_short(folder: Path) -> None:
    (folder / "times.csv").write_text("frame,time_s\n000000.png,0\n")


def _times_back(folder: Path) -> None:
    rows = [f"{k:06d}.png,{5 - k}\n" for k in range(5)]
    (folder / "times.csv").write_text("frame,time_s\n" + "".join(rows))


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (_empty, "no images there"),
        (_missing_right, "000002.png is not in both left and right"),
        (_missing_both, "frame 2 is missing"),
        (_cut_off, "000001.jpg: not an image that can be read"),
        (_small, "000003.png: 64 x 40 pixels, the first image has 64 x 48"),
        (_damaged, "000001.png: not an image that can be read"),
        (_hollow, "000001.png: not an image that can be read"),
        (_times_short, "no 000001.png there"),
        (_times_back, "the times must ascend"),
    ],
)
def test_what_is_wrong_with_a_folder_is_told(tmp_path: Path, damage: object, said: str) -> None:
    write_images(tmp_path, sequence())
    assert callable(damage)
    damage(tmp_path)
    with pytest.raises(UserError, match=said) as told:
        read_images(tmp_path)
    assert len(told.value.problems) == 1


def test_what_is_wrong_with_a_video_is_told(tmp_path: Path) -> None:
    frames = np.random.default_rng(1).integers(0, 255, (30, 48, 64)).astype(np.uint8)
    write_video(tmp_path / "film.avi", frames, 10.0)
    (tmp_path / "bad.avi").write_bytes((tmp_path / "film.avi").read_bytes()[:300])
    (tmp_path / "film.txt").write_text("no video")
    with pytest.raises(UserError, match="not a video that can be read"):
        read_images(tmp_path / "bad.avi")
    with pytest.raises(UserError, match="neither a folder of images nor a video"):
        read_images(tmp_path / "film.txt")
    with pytest.raises(UserError, match="no such folder or file"):
        read_images(tmp_path / "none.avi")
    with pytest.raises(UserError, match="videos are written as"):
        write_video(tmp_path / "film.gif", frames, 10.0)
