"""What is written is read again, to the last bit."""

import tempfile
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from debrisest.arrays import Array
from debrisest.tracks.body_points import read_body_points
from debrisest.tracks.read import read_measured
from debrisest.tracks.sheet import open_sheet
from debrisest.tracks.types import BodyPoints, Poses, Tracks
from debrisest.tracks.write import (
    write_body_points,
    write_long,
    write_pose_list,
    write_poses,
    write_wide,
)

QUICK = settings(max_examples=40, deadline=None)
NAMES = st.text("abcxyz_-. 09é", min_size=1, max_size=6).filter(lambda name: name == name.strip())


@st.composite
def tracks(draw: st.DrawFn) -> Tracks:
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n, f = draw(st.integers(2, 6)), draw(st.integers(3, 5))
    measured = draw(st.sets(st.sampled_from(["points", "sigma", "pixels", "range", "ranges"])))
    measured |= {"points"} if not measured & {"points", "pixels"} else set()
    seen = rng.random((n, f)) < 0.8
    seen[:, :2] = True  # no epoch and no feature without anything
    seen[0] = True

    def masked(values: Array) -> Array:
        return np.where(seen.reshape(n, f, *[1] * (values.ndim - 2)), values, np.nan)

    points = masked(rng.normal(size=(n, f, 3))) if "points" in measured else None
    pixels = [masked(rng.normal(size=(n, f, 2))) for _ in range(draw(st.integers(1, 2)))]
    sigma = masked(rng.uniform(0.1, 1, (n, f, 3)))
    shape = (n,) if "range" in measured else (n, f)
    ranges = rng.uniform(1, 9, shape) if measured & {"range", "ranges"} else None
    return Tracks(
        "", np.cumsum(rng.uniform(0.5, 1.5, n)), tuple(f"p{k}" for k in range(f)),
        np.zeros(0, np.int64), points,
        sigma if {"points", "sigma"} <= measured else None,
        ("left", "right")[: len(pixels)] if "pixels" in measured else (),
        np.stack(pixels, 1) if "pixels" in measured else None, ranges,
    )  # fmt: skip


@st.composite
def poses(draw: st.DrawFn) -> Poses:
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n = draw(st.integers(1, 8))
    q = np.array([1.0, 0.2, -0.1, 0.3]) + 0.02 * np.cumsum(rng.normal(size=(n, 4)), axis=0)
    q /= np.linalg.norm(q, axis=-1, keepdims=True)
    return Poses(
        "", np.cumsum(rng.uniform(0.5, 1.5, n)), q, np.zeros(0, np.int64),
        rng.normal(size=(n, 3)) if draw(st.booleans()) else None,
        rng.uniform(0.01, 0.1, n) if draw(st.booleans()) else None,
    )  # fmt: skip


def same(found: object, expected: object, names: tuple[str, ...], atol: float = 0.0) -> None:
    for name in names:
        a, b = getattr(found, name), getattr(expected, name)
        assert (a is None) == (b is None), name
        if b is not None:
            np.testing.assert_allclose(a, b, rtol=0, atol=atol, err_msg=name)


@QUICK
@given(tracks(), st.sampled_from([write_long, write_wide]))
def test_tracks(expected, write) -> None:  # type: ignore[no-untyped-def]
    with tempfile.TemporaryDirectory() as folder:
        write(path := Path(folder) / "tracks.csv", expected)
        found = read_measured(path)
    assert (found.features, found.cameras) == (expected.features, expected.cameras)
    same(found, expected, ("times", "points", "point_sigma", "pixels", "ranges"))


@QUICK
@given(poses())
def test_poses(expected) -> None:  # type: ignore[no-untyped-def]
    with tempfile.TemporaryDirectory() as folder:
        write_poses(path := Path(folder) / "poses.csv", expected)
        same(read_measured(path), expected, ("times", "q", "position", "sigma_rad"), 1e-15)
        write_pose_list(path := Path(folder) / "poses.json", expected)
        same(read_measured(path), expected, ("times", "q", "position"), 1e-15)


@QUICK
@given(st.lists(NAMES, min_size=1, max_size=5, unique=True), st.integers(0, 2**32 - 1))
def test_body_points(names, seed) -> None:  # type: ignore[no-untyped-def]
    points = np.random.default_rng(seed).normal(size=(len(names), 3))
    with tempfile.TemporaryDirectory() as folder:
        write_body_points(path := Path(folder) / "body.csv", BodyPoints("", tuple(names), points))
        found = read_body_points(open_sheet(path))
    assert found.features == tuple(names)
    np.testing.assert_array_equal(found.points, points)
