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


def test_nothing_there_is_said():
    rng = np.random.default_rng(3)
    frames = np.rint(np.abs(rng.normal(0, 1.5, (6, 1, *SHAPE)))).astype(np.uint8)
    with pytest.raises(ValueError, match="no body stands out"):
        silhouettes(frames)
