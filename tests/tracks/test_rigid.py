"""What is told of points that are not one rigid body, or a mirrored one."""

import numpy as np
import pytest

from debrisest.arrays import Array
from debrisest.tracks.rigid import check_rigid
from debrisest.tracks.types import BodyPoints, Tracks
from tests.tracks.conftest import BODY, motion

NAMES = ("p1", "p2", "p3", "p4", "p5")
KNOWN = BodyPoints("body.csv", NAMES, BODY)


def tracks(points: Array) -> Tracks:
    epochs = len(points)
    return Tracks("F", 0.5 * np.arange(epochs), NAMES, 2 + 5 * np.arange(epochs), points)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("noise", [0.0, 1e-3, 0.05])
@pytest.mark.parametrize("epochs", [2, 3, 60])
def test_nothing_is_told_of_a_rigid_body(epochs: int, noise: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = motion(epochs, 0.0)[1]
    points += noise * rng.normal(size=points.shape)
    points[rng.random(points.shape[:2]) < 0.3] = np.nan
    assert check_rigid(tracks(points), KNOWN) == []


def test_a_feature_on_its_own_is_told() -> None:
    points = motion(40, 1e-3)[1]
    points[:, 2] += 0.5 * np.sin(np.arange(40))[:, None]
    (told,) = check_rigid(tracks(points))
    assert told.startswith("F: p3 is not rigid with the rest: its distances vary by")
    assert "it would be" not in told


def test_swapped_columns_of_a_feature_are_told() -> None:
    points = motion(40, 1e-3)[1]
    points[:, 2] = points[:, 2, [1, 0, 2]]
    (told,) = check_rigid(tracks(points))
    assert "p3 is not rigid" in told
    assert "with its columns in the order y_m, x_m, z_m it would be" in told


def test_a_mirrored_axis_of_a_feature_is_told() -> None:
    points = motion(40, 1e-3)[1]
    points[:, 4, 2] *= -1
    (told,) = check_rigid(tracks(points))
    assert "p5 is not rigid" in told and "with the sign of its z_m changed" in told


def test_a_few_wrong_rows_are_told_with_the_line() -> None:
    points = motion(40, 1e-3)[1]
    points[[7, 9], 1] = points[[7, 9], 1][:, [1, 0, 2]]
    (told,) = check_rigid(tracks(points))
    assert told.startswith("F:37: p2 is off the rest by") and told.endswith("in 1 further epochs")


def test_a_column_in_another_unit_is_told() -> None:
    points = motion(40, 1e-3)[1] * [1.0, 1e3, 1.0]
    told = check_rigid(tracks(points))
    assert "with y_m times 0.001 it would be: is its unit right?" in told[0]


def test_points_that_exchange_their_names_are_no_rigid_body() -> None:
    rng = np.random.default_rng(5)
    points = np.array([epoch[rng.permutation(5)] for epoch in motion(40, 1e-3)[1]])
    assert (
        "this is not one rigid body; is a column another quantity" in check_rigid(tracks(points))[0]
    )


@pytest.mark.parametrize("mirror", [np.diag([1.0, -1.0, 1.0]), np.eye(3)[[1, 0, 2]]])
def test_a_mirror_image_in_a_part_of_the_file_is_told(mirror: Array) -> None:
    points = motion(20, 1e-3)[1]
    points[12:] = points[12:] @ mirror
    (told,) = check_rigid(tracks(points))
    assert "1 neighbouring epochs match as mirror images only, first lines 57 and 62" in told


@pytest.mark.parametrize("mirror", [np.diag([1.0, -1.0, 1.0]), np.eye(3)[[1, 0, 2]]])
def test_a_mirror_image_of_the_whole_is_told_by_the_known_geometry_only(mirror: Array) -> None:
    points = motion(20, 1e-3)[1] @ mirror
    assert check_rigid(tracks(points)) == []
    (told,) = check_rigid(tracks(points), KNOWN)
    assert "match body.csv as a mirror image only" in told


def test_flat_bodies_have_no_mirror_image() -> None:
    rng = np.random.default_rng(2)
    points = motion(50, 0.0)[1]
    turn = np.linalg.qr(rng.normal(size=(50, 3, 3)))[0]
    points = (BODY * [1, 1, 0]) @ turn + 1e-3 * rng.normal(size=points.shape)
    assert check_rigid(tracks(points)) == []


def test_other_names_and_another_scale_than_the_known_geometry() -> None:
    other = BodyPoints("body.csv", ("p1", "p2", "p3", "p4", "q5"), BODY * 1e3)
    names, scale = check_rigid(tracks(motion(20)[1]), other)
    assert names == "F: p5 not in body.csv, which has p1, p2, p3, p4, q5"
    assert "lengths are 0.001 times those of body.csv" in scale
