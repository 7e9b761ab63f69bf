"""Tracks and poses of a body whose motion is known, in text files, as datasets."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.clock import Clock
from debrisest.errors import UserError
from debrisest.parts.recoveries.pixel_pose import PixelPose
from debrisest.parts.recoveries.triangulation import Triangulation
from debrisest.parts.sources.poses import MeasuredPoses
from debrisest.parts.sources.tracks import MeasuredTracks
from tests.measured_motion import (
    BASE,
    BODY,
    NAMES,
    TIMES,
    attitudes,
    cells,
    csv,
    seen_by_chaser,
    write_files,
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Points, pixels, poses, geometry, calibration and the chaser's attitude of one motion."""
    write_files(tmp_path)
    return tmp_path


def tracks(folder: Path, **keys: Any) -> dict[str, Any]:
    return MeasuredTracks(kind="tracks", **keys).read(folder)


def inertial_points() -> np.ndarray:
    return np.einsum("tij,tfj->tfi", attitudes()[1].as_matrix(), seen_by_chaser())


def off(q: np.ndarray, turn: Rotation) -> float:
    return float((Rotation.from_quat(q, scalar_first=True) * turn.inv()).magnitude().max())


def test_points_are_turned_to_inertial_axes(folder: Path) -> None:
    data = tracks(folder, file="points.csv", attitude="attitude.csv", noise_m=0.02)
    np.testing.assert_allclose(data["measured_point"][0], inertial_points(), atol=1e-9)
    np.testing.assert_allclose(data["point_sigma"], 0.02, rtol=1e-12)
    assert data["point_noise"] == pytest.approx([0.02])
    assert data["time_s"].tolist() == pytest.approx((TIMES - TIMES[0]).tolist())
    assert data["feature"].tolist() == NAMES and data["run"].tolist() == [0.0]
    assert "times count from the first epoch, 5 s" in data["notes"]


def test_noise_that_nobody_tells_is_not_known(folder: Path) -> None:
    data = tracks(folder, file="points.csv")
    assert np.isnan(data["point_sigma"]).all() and "point_noise" not in data
    assert any(note.startswith("no attitude of the chaser is given") for note in data["notes"])


def test_sigma_of_the_axes_turns_with_them(folder: Path) -> None:
    """A quarter turn about z exchanges the sigmas of x and y."""
    rows = ((t, n, *row, 0.1, 0.2, 0.3) for t, n, *row in cells(seen_by_chaser()))
    csv(folder / "sigma.csv", "time_s,feature,x_m,y_m,z_m,sigma_x_m,sigma_y_m,sigma_z_m", rows)
    half = float(np.sqrt(0.5))
    quarter = [(t, half, 0.0, 0.0, half) for t in (0.0, 100.0)]
    csv(folder / "quarter.csv", "time_s,q0,q1,q2,q3", quarter)
    data = tracks(folder, file="sigma.csv", attitude="quarter.csv")
    expected = np.broadcast_to([0.2, 0.1, 0.3], data["point_sigma"].shape)
    np.testing.assert_allclose(data["point_sigma"], expected, rtol=1e-9)
    assert data["point_noise"] == pytest.approx([np.sqrt(0.14 / 3)])


def test_features_have_the_order_of_the_geometry(folder: Path) -> None:
    lines = (folder / "body.csv").read_text().splitlines()
    (folder / "other.csv").write_text("\n".join([lines[0], *lines[:1:-1], "wing,1,2,3"]) + "\n")
    data = tracks(folder, file="points.csv", points="other.csv")
    assert data["feature"].tolist() == ["top", "tail", "right", "left"]
    np.testing.assert_allclose(data["known_point_f"][0], BODY[:0:-1], rtol=1e-12)
    np.testing.assert_allclose(data["measured_point"][0], seen_by_chaser()[:, :0:-1], rtol=1e-9)
    told = " ".join(data["notes"])
    assert "other.csv lacks them: bow" in told and "other.csv: wing" in told


def test_names_that_match_nothing_are_a_mistake(folder: Path) -> None:
    rows = ((name.capitalize(), *point) for name, point in zip(NAMES, BODY))
    csv(folder / "other.csv", "feature,x_m,y_m,z_m", rows)
    with pytest.raises(UserError, match=r"none of its features, bow.*mean Bow for bow, Left"):
        tracks(folder, file="points.csv", points="other.csv")


def test_two_bodies_and_a_mirrored_one_are_refused(folder: Path) -> None:
    points = seen_by_chaser()
    csv(folder / "mirror.csv", "time_s,feature,x_m,y_m,z_m", cells(points * [1, 1, -1]))
    with pytest.raises(UserError, match="as a mirror image only"):
        tracks(folder, file="mirror.csv", points="body.csv")
    points[..., 1] *= 5.0
    csv(folder / "bent.csv", "time_s,feature,x_m,y_m,z_m", cells(points))
    with pytest.raises(UserError, match="this is not one rigid body"):
        tracks(folder, file="bent.csv")


def test_poses_are_turned_to_inertial_axes(folder: Path) -> None:
    part = MeasuredPoses(kind="poses", file="poses.csv", attitude="attitude.csv", sigma_deg=2.0)
    data = part.read(folder)
    body, chaser = attitudes()
    assert off(data["measured_q_if"][0], body) < 1e-9
    expected = chaser.apply([0.3, -0.2, 9.0])
    np.testing.assert_allclose(data["measured_position"][0], expected, atol=1e-9)
    np.testing.assert_allclose(data["q_if_noise"], np.radians(2.0))


@pytest.mark.parametrize("attitude", [None, "attitude.csv"])
@pytest.mark.parametrize("noise", [None, 0.5])
@pytest.mark.parametrize(("file", "camera"), [("pixels.csv", "stereo"), ("one.csv", "mono")])
def test_pixels_of_a_known_body_give_its_poses(
    folder: Path, file: str, camera: str, noise: float | None, attitude: str | None
) -> None:
    """Through the lens, two cameras and a chaser that turns, against the motion itself."""
    keys = {"points": "body.csv", "camera": f"{camera}.yaml", "noise_px": noise}
    data = tracks(folder, file=file, attitude=attitude, **keys)
    found = PixelPose(kind="pixel_pose").recover(data, Clock(data["time_s"]))
    body, chaser = attitudes()
    if attitude is None:
        body, chaser = chaser.inv() * body, Rotation.identity(len(TIMES))
    assert off(found["measured_q_if"][0], body) < 1e-6
    expected = chaser.apply([0.3, -0.2, 9.0])
    np.testing.assert_allclose(found["measured_position"][0], expected, atol=1e-5)
    sigma = np.sqrt(np.diagonal(found["measured_q_if_covariance"], 0, -2, -1))
    assert (sigma < 1e-6).all() if noise is None else (sigma > 1e-4).all()
    assert found["status"].tolist() == ["a pose at every epoch"]


def test_exchanged_cameras_are_suspected(folder: Path) -> None:
    data = tracks(folder, file="pixels.csv", camera="stereo.yaml")
    data["measured_pixel"] = data["measured_pixel"][:, :, ::-1]
    with pytest.raises(ValueError, match="are the cameras exchanged"):
        Triangulation(kind="triangulation").recover(data, Clock(data["time_s"]))


def test_two_known_points_tell_no_pose(folder: Path) -> None:
    lines = (folder / "body.csv").read_text().splitlines()
    (folder / "two.csv").write_text("\n".join(lines[:3]) + "\n")
    data = tracks(folder, file="one.csv", camera="mono.yaml", points="two.csv")
    with pytest.raises(ValueError, match="no epoch tells a pose: three points"):
        PixelPose(kind="pixel_pose").recover(data, Clock(data["time_s"]))


def test_pixels_of_two_cameras_give_points(folder: Path) -> None:
    keys = {"camera": "stereo.yaml", "attitude": "attitude.csv", "noise_px": 0.5}
    data = tracks(folder, file="pixels.csv", **keys)
    data["measured_pixel"][0, 3, 1, 2] = np.nan
    found = Triangulation(kind="triangulation").recover(data, Clock(data["time_s"]))
    expected = inertial_points()
    expected[3, 2] = np.nan
    np.testing.assert_allclose(found["measured_point"][0], expected, atol=1e-9)
    known = found["point_sigma"][0][np.isfinite(expected)]
    depth = np.sqrt(2) * 0.5 * 9.0**2 / (810.0 * BASE)  # of parallel cameras, first order
    assert 0.5 * depth < known.max() < 2.0 * depth
    assert Triangulation(kind="triangulation").assess(found)["coverage"].tolist() == [1.0]


def test_noise_of_pixels_is_found_in_the_residuals(folder: Path) -> None:
    """The sigma from residuals is that from the told noise, to a quarter, wrong pixels or not."""
    keys = {"camera": "stereo.yaml", "points": "body.csv"}
    told = tracks(folder, file="pixels.csv", noise_px=0.5, **keys)
    unknown = tracks(folder, file="pixels.csv", **keys)
    noise = np.random.default_rng(5).normal(size=told["measured_pixel"].shape)
    noise[0, ::10, 0, 0] += 30.0
    for part in (PixelPose(kind="pixel_pose"), Triangulation(kind="triangulation")):
        sizes = []
        for data in (told, unknown):
            moved = data["measured_pixel"] + 0.5 / np.sqrt(800 * 820) * noise
            found = part.recover(data | {"measured_pixel": moved}, Clock(data["time_s"]))
            sizes.append(np.median(found[part.gives[1]][..., 0]))
        power = 0.5 if part.gives[1].endswith("covariance") else 1.0
        assert (sizes[1] / sizes[0]) ** power == pytest.approx(1.0, abs=0.25)


def test_epochs_of_a_grid_that_show_nothing_are_there(folder: Path) -> None:
    lines = (folder / "points.csv").read_text().splitlines()
    kept = [line for line in lines if not line.startswith(("8,", "8.5,"))]
    (folder / "gap.csv").write_text("\n".join(kept) + "\n")
    data = tracks(folder, file="gap.csv", attitude="attitude.csv")
    assert len(data["time_s"]) == len(TIMES) and Clock(data["time_s"]).jitter < 1e-9
    empty = np.isnan(data["measured_point"][0]).all(axis=(1, 2))
    assert np.flatnonzero(empty).tolist() == [6, 7]
    kept = [line for line in lines if not line.startswith("8.5,")]
    (folder / "odd.csv").write_text("\n".join(kept).replace("\n8,", "\n8.1,") + "\n")
    assert len(tracks(folder, file="odd.csv")["time_s"]) == len(TIMES) - 1


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """The body as a COLMAP text model has it, with images of two cameras, named by number."""
    folder = tmp_path / "model"
    folder.mkdir()
    cameras = ["1 PINHOLE 640 480 800 820 320 240", "2 PINHOLE 640 480 700 700 320 240"]
    (folder / "cameras.txt").write_text("\n".join(cameras) + "\n")
    points = seen_by_chaser()
    pixels = [320.0, 240.0] + np.array([800.0, 820.0]) * points[..., :2] / points[..., 2:]
    body, chaser = attitudes()
    poses = (chaser.inv() * body).as_quat(scalar_first=True)
    lines = []
    for n, (q, seen) in enumerate(zip(poses.tolist(), pixels.tolist())):
        camera = 2 if n in (3, 4) else 1
        lines.append(f"{n + 1} {' '.join(map(repr, q))} 0.3 -0.2 9.0 {camera} f{n:03d}.png")
        lines.append(" ".join(f"{u!r} {v!r} {k + 1}" for k, (u, v) in enumerate(seen)))
    (folder / "images.txt").write_text("\n".join(lines) + "\n")
    known = [f"{k + 1} {x!r} {y!r} {z!r} 0 0 0 0.1" for k, (x, y, z) in enumerate(BODY.tolist())]
    (folder / "points3D.txt").write_text("\n".join(known) + "\n")
    return folder


def test_a_colmap_model_tells_its_own_geometry_and_camera(model: Path) -> None:
    """Two images are of another camera: they are left out, and their epochs show nothing."""
    data = MeasuredTracks(kind="tracks", file="model", rate_hz=2.0).read(model.parent)
    assert any("only images of camera 1" in note for note in data["notes"])
    found = PixelPose(kind="pixel_pose").recover(data, Clock(data["time_s"]))
    body, chaser = attitudes()
    seen = np.isfinite(found["measured_q_if"][0, :, 0])
    assert np.flatnonzero(~seen).tolist() == [3, 4]
    assert off(found["measured_q_if"][0][seen], (chaser.inv() * body)[seen]) < 1e-6
    poses = MeasuredPoses(kind="poses", file="model", rate_hz=2.0).read(model.parent)
    assert off(poses["measured_q_if"][0][seen], (chaser.inv() * body)[seen]) < 1e-9


def test_a_change_of_any_file_is_noticed(folder: Path) -> None:
    keys = {"points": "body.csv", "camera": ["stereo.yaml"], "attitude": "attitude.csv"}
    part = MeasuredTracks(kind="tracks", file="pixels.csv", **keys)
    digests = {part.digest(folder)}
    for name in ("pixels.csv", "body.csv", "stereo.yaml", "attitude.csv"):
        with (folder / name).open("a") as file:
            file.write("# changed\n")
        digests.add(part.digest(folder))
    assert len(digests) == 5


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"file": "poses.csv"}, "holds poses, not tracks; use kind: poses"),
        ({"file": "one.csv"}, "pixels need the camera's calibration"),
        ({"file": "pixels.csv", "camera": "mono.yaml"}, "pixels of 2 cameras, left, right"),
        ({"file": "points.csv", "attitude": "late.csv"}, "covers 9 to 30 s, not 5 s"),
        ({"file": "short.csv"}, "one epoch; a motion needs at least two"),
        ({"file": "one.csv", "camera": "wide.yaml"}, "more than 5 distortion coefficients"),
    ],
)
def test_what_cannot_be_used_is_told(folder: Path, keys: dict[str, Any], words: str) -> None:
    csv(folder / "late.csv", "time_s,q0,q1,q2,q3", [(9.0, 1.0, 0, 0, 0), (30.0, 1.0, 0, 0, 0)])
    lines = (folder / "points.csv").read_text().splitlines()
    (folder / "short.csv").write_text("\n".join(lines[:6]) + "\n")
    wide = (folder / "mono.yaml").read_text().replace("0.02]", "0.02, 0.1, 0.1, 0.1]")
    (folder / "wide.yaml").write_text(wide)
    with pytest.raises(UserError, match=words):
        tracks(folder, **keys)


def test_ranges_are_of_the_target_or_of_its_nearest_feature(folder: Path) -> None:
    points = seen_by_chaser()
    far = np.linalg.norm(points, axis=-1)
    rows = ((*row, distance) for row, distance in zip(cells(points), far.ravel()))
    csv(folder / "ranges.csv", "time_s,feature,x_m,y_m,z_m,range_m", rows)
    data = tracks(folder, file="ranges.csv")
    np.testing.assert_allclose(data["landmark_range"][0], far.min(axis=1), rtol=1e-9)
    assert data["landmark"][0].tolist() == far.argmin(axis=1).tolist()
