"""Silhouettes before black sky and before a room."""

from contextlib import suppress

import numpy as np
import pytest

from debrisest.reconstruction.silhouettes import readings, silhouettes

SHAPE = (90, 120)


def scene(behind, count=16):
    """A disc with a pattern that turns about its middle, and where it is."""
    rng = np.random.default_rng(2)
    v, u = np.indices(SHAPE)
    truth, frames = [], []
    for k in range(count):
        centre = (60 + 6 * np.cos(0.7 * k), 45 + 4 * np.sin(0.5 * k))
        inside = (u - centre[0]) ** 2 + (v - centre[1]) ** 2 < 25**2
        pattern = 120 + 60 * np.sin(u / 4 + 0.9 * k) * np.cos(v / 5 - 0.6 * k)
        image = np.where(inside, pattern, behind) + rng.normal(0, 1.5, SHAPE)
        truth.append(inside)
        frames.append(np.clip(np.rint(image), 0, 255).astype(np.uint8))
    return np.stack(frames)[:, None], np.stack(truth)[:, None]


@pytest.mark.parametrize("room", [False, True])
def test_the_body_is_told_from_what_is_behind_it(room):
    wall = 60 + 30 * np.sin(np.indices(SHAPE).sum(0) / 3)
    frames, truth = scene(wall if room else np.zeros(SHAPE))
    found = silhouettes(frames)
    assert (found != truth).sum() / truth.sum() < 0.1


def test_what_a_plain_backdrop_seldom_shows_is_no_body():
    """A square that turns about its middle hides its inner part always, its corners seldom."""
    v, u = np.indices(SHAPE) - np.array([45.0, 60.0])[:, None, None]
    rng, frames, truth = np.random.default_rng(4), [], []
    for angle in np.radians(np.arange(0, 90, 6)):
        x, y = np.cos(angle) * u + np.sin(angle) * v, np.cos(angle) * v - np.sin(angle) * u
        inside = np.maximum(np.abs(x), np.abs(y)) < 25.0
        image = np.where(inside, 60 + 20 * np.sin(x / 3) * np.cos(y / 4), 150 + 0.2 * u + 0.1 * v)
        frames.append(np.clip(np.rint(image + rng.normal(0, 1.5, SHAPE)), 0, 255))
        truth.append(inside)
    found = silhouettes(np.array(frames, dtype=np.uint8)[:, None])[:, 0]
    assert (found != truth).sum() / np.sum(truth) < 0.06


BLUE, TAN = np.array([50.0, 70, 150]), np.array([190.0, 160, 100])


def coloured(shade, count=18):
    """A tan square that turns before a blue backdrop, darker to one side, and where it is.

    ``shade (row, column)`` of the backdrop. Returns grey, Cr and Cb, as OpenCV has them.
    """
    v, u = np.indices(SHAPE) - np.array([45.0, 60.0])[:, None, None]
    rng, images, truth = np.random.default_rng(6), [], []
    for angle in np.radians(np.arange(count) * 90 / count):
        x, y = np.cos(angle) * u + np.sin(angle) * v, np.cos(angle) * v - np.sin(angle) * u
        inside = np.maximum(np.abs(x), np.abs(y)) < 25.0
        look = (0.55 + 0.1 * np.sin(x / 3) * np.cos(y / 4))[..., None] * TAN
        image = np.where(inside[..., None], look, shade[..., None] * BLUE)
        images.append(np.clip(np.rint(image + rng.normal(0, 1.5, image.shape)), 0, 255))
        truth.append(inside)
    red, green, blue = np.moveaxis(np.array(images), -1, 0)
    grey = 0.299 * red + 0.587 * green + 0.114 * blue
    chroma = np.stack([128 + 0.713 * (red - grey), 128 + 0.564 * (blue - grey)], axis=-1)
    frames, colours = (np.rint(each).astype(np.uint8)[:, None] for each in (grey, chroma))
    return frames, colours, np.stack(truth)


def wrong(found, truth):
    return (found[:, 0] != truth).sum() / truth.sum()


def test_a_body_as_bright_as_a_blue_backdrop_is_told_by_its_colour():
    v, u = np.indices(SHAPE) / np.array(SHAPE)[:, None, None]
    frames, chroma, truth = coloured(1.1 + 0.5 * np.sin(2 * u) - 0.6 * v * v)
    assert wrong(silhouettes(frames, chroma), truth) < 0.06
    with suppress(ValueError):
        assert wrong(silhouettes(frames), truth) > 0.1


def test_a_shadow_on_a_coloured_backdrop_is_the_backdrops():
    shade = np.ones(SHAPE)
    shade[40:50, 85:105] = 0.65
    frames, chroma, truth = coloured(shade)
    for epoch in range(0, len(frames), 3):
        frames[epoch], chroma[epoch] = (each[epoch] for each in coloured(np.ones(SHAPE))[:2])
    assert wrong(silhouettes(frames, chroma), truth) < 0.06


def test_a_plain_table_that_turns_is_left_out_by_one_of_the_readings():
    """A disc of one grey that never changes; the body on it has a pattern."""
    v, u = np.indices(SHAPE)
    wall = np.where((u - 60.0) ** 2 + 4.0 * (v - 55.0) ** 2 < 45.0**2, 60.0, 150.0)
    frames, truth = scene(wall, count=24)
    plain, moving = readings(frames)
    assert wrong(plain.masks, truth[:, 0]) > 0.3
    assert wrong(moving.masks, truth[:, 0]) < 0.15
    assert "a plain backdrop" in plain.said
    assert "most steadily" in moving.said


def test_waves_of_compression_beside_an_edge_are_no_body():
    import cv2

    frames, truth = scene(np.full(SHAPE, 30.0))
    coded = [cv2.imencode(".jpg", one[0], [cv2.IMWRITE_JPEG_QUALITY, 60])[1] for one in frames]
    lossy = np.stack([cv2.imdecode(one, 0) for one in coded])[:, None]
    assert wrong(silhouettes(lossy), truth[:, 0]) < 0.12


def test_nothing_there_is_said():
    rng = np.random.default_rng(3)
    frames = np.rint(np.abs(rng.normal(0, 1.5, (6, 1, *SHAPE)))).astype(np.uint8)
    with pytest.raises(ValueError, match="no body stands out"):
        silhouettes(frames)
