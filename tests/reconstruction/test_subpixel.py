"""Disparities of images whose shifts are known in closed form."""

import numpy as np
import pytest

pytest.importorskip("cv2")

from debrisest.reconstruction.subpixel import refined

SHAPE = (80, 120)
TILT, SHIFT = 0.08, 3.3


def texture(u, v):
    rng = np.random.default_rng(5)
    waves = rng.uniform(0.2, 0.9, size=(20, 2)) * rng.choice([-1, 1], size=(20, 2))
    phases = rng.uniform(0, 2 * np.pi, 20)
    grey = sum(np.cos(a * u + b * v + c) for (a, b), c in zip(waves, phases))
    return np.clip(128 + 14 * grey, 0, 255).astype(np.uint8)


def pair():
    """A tilted plane: what the left image shows at u, the right one shows at u - disparity."""
    v, u = np.indices(SHAPE).astype(float)
    return (
        texture(u, v),
        texture((u + SHIFT) / (1 - TILT), v),
        (SHIFT + TILT * u).astype(np.float32),
    )


def test_a_tilted_plane_is_found_to_a_fiftieth_of_a_pixel():
    left, right, true = pair()
    began = true + np.float32(0.4)
    known = np.ones(SHAPE, dtype=bool)
    found, sure = refined(left, right, began, known)
    inner = (slice(12, -12), slice(24, -24))
    assert sure[inner].mean() > 0.9
    error = (found - true)[inner][sure[inner]]
    assert abs(np.median(error)) < 0.01
    assert np.percentile(np.abs(error), 90) < 0.05


def test_where_there_is_no_texture_or_no_start_nothing_is_known():
    left, right, true = pair()
    known = np.zeros(SHAPE, dtype=bool)
    assert not refined(left, right, true, known)[1].any()
    grey = np.full(SHAPE, 90, dtype=np.uint8)
    assert not refined(grey, grey, true, ~known)[1].any()
