"""Silhouettes before black sky and before a room."""

import numpy as np
import pytest

from debrisest.reconstruction.silhouettes import silhouettes

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


def test_nothing_there_is_said():
    rng = np.random.default_rng(3)
    frames = np.rint(np.abs(rng.normal(0, 1.5, (6, 1, *SHAPE)))).astype(np.uint8)
    with pytest.raises(ValueError, match="no body stands out"):
        silhouettes(frames)
