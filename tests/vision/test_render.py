"""What is rendered lies where projection has it, is shaded as the sun has it, noisy as told."""

import numpy as np
import pytest

from debrisest.arrays import Data
from debrisest.attitude import quaternion
from debrisest.vision.camera import PinholeImage
from debrisest.vision.solids import box, joined
from debrisest.vision.texture import SolidNoise
from tests.vision.conftest import Scene

pytest.importorskip("embreex")

BRIGHT = {"sensors": {"camera": {"noise_grey": 0.0, "blur_px": 0.0, "ambient": 1.0}}}


def camera_of(data: Data, index: int) -> PinholeImage:
    size = data["measured_image"].shape[:-3:-1]
    named = ("camera_matrix", "lens_distortion", "rig_rotation", "rig_translation")
    return PinholeImage(size, *(data[name][0, index] for name in named))


@pytest.mark.parametrize("bent", [[0.0] * 5, [-0.25, 0.08, 0.001, -0.002, 0.0]])
def test_the_outline_is_that_of_the_projected_corners(scene: Scene, bent: list[float]) -> None:
    changes = BRIGHT | {"sensors": {"camera": BRIGHT["sensors"]["camera"] | {"distortion": bent}}}
    data = scene(changes)
    for epoch in (0, 5):
        q, place = data["true_q_ib"][0, epoch], data["true_position"][0, epoch]
        corners = quaternion.rotate(q, data["true_vertex_b"][0]) + place
        for index in range(2):
            shown = camera_of(data, index).project(corners)
            rows, columns = np.nonzero(data["measured_image"][0, epoch, index] > 10)
            found = np.array([[columns.min(), rows.min()], [columns.max(), rows.max()]])
            wanted = np.array([shown.min(axis=0), shown.max(axis=0)])
            np.testing.assert_allclose(found, wanted, atol=1.0)


def test_lenses_are_those_of_opencv() -> None:
    cv2 = pytest.importorskip("cv2")
    matrix = np.array([[500.0, 0, 160], [0, 510.0, 120], [0, 0, 1]])
    bent, points = np.array([-0.2, 0.05, 0.001, 0.002, 0.01]), np.random.default_rng(1)
    seen = points.normal(size=(20, 3)) * [0.3, 0.3, 0.3] + [0, 0, 3]
    camera = PinholeImage((320, 240), matrix, bent, translation=np.array([-0.4, 0.1, 0.0]))
    wanted = cv2.projectPoints(seen, np.zeros(3), camera.translation, matrix, bent)[0][:, 0]
    np.testing.assert_allclose(camera.project(seen), wanted, atol=1e-9)
    local = seen + camera.translation
    np.testing.assert_allclose(camera.slopes(wanted), local[:, :2] / local[:, 2:], atol=1e-9)


def test_a_shadow_lies_where_the_sun_has_it() -> None:
    from debrisest.vision.surface import Surface

    plate, cube = box((0, 0, -0.5), (20, 20, 1), 1.0), box((0, 0, 2.5), (1, 1, 1), 1.0)
    surface = Surface(joined(plate, cube), SolidNoise(1, 1.0))
    sun = np.array([1.0, 0.0, 1.0]) / np.sqrt(2.0)
    at = np.linspace(-4.97, 1.03, 121)
    rays = np.stack([at, np.full(at.shape, 0.1), np.full(at.shape, -1.0)], axis=-1)
    hits = surface.hits(np.array([0.0, 0.0, 1.0]), rays)
    lit = surface.lit(hits, sun)
    on_plate = hits.points[:, 2] < 0.1
    shadowed = (hits.points[:, 0] > -3.5) & (hits.points[:, 0] < -1.5)
    np.testing.assert_allclose(hits.points[on_plate, 2], 0.0, atol=1e-9)
    np.testing.assert_allclose(lit[shadowed & on_plate], 0.0)
    np.testing.assert_allclose(lit[~shadowed & on_plate], np.sqrt(0.5))
    assert (shadowed & on_plate).sum() > 20


def test_the_noise_has_its_sigma_and_the_run_its_own(scene: Scene) -> None:
    still = {"motion": {"rate_deg_s": [0.0, 0.0, 0.0]}, "duration_s": 6}
    images = scene(still | {"sensors": {"camera": {"noise_grey": 4.0}}})["measured_image"]
    bright = images[0, :, 0].mean(axis=0) > 40
    spread = images[0, :, 0].astype(float).std(axis=0, ddof=1)[bright]
    count = bright.sum() * 5
    rounding = 1.0 / 12.0
    assert np.sqrt(np.mean(spread**2)) == pytest.approx(
        np.sqrt(16.0 + rounding), abs=5 * 4.0 / np.sqrt(2 * count)
    )
    assert (scene(still)["measured_image"] == scene(still)["measured_image"]).all()


def test_an_exposure_blurs_what_moves_and_nothing_else(scene: Scene) -> None:
    long = scene(
        BRIGHT | {"sensors": {"camera": BRIGHT["sensors"]["camera"] | {"exposure_s": 1.0}}}
    )
    sharp = scene(BRIGHT)
    slope = [
        np.abs(np.diff(each["measured_image"][0, 3, 0].astype(float), axis=1)).max()
        for each in (sharp, long)
    ]
    assert slope[1] < 0.9 * slope[0]


def test_a_room_stands_still_behind_the_body(scene: Scene) -> None:
    images = scene(
        {"sensors": {"camera": {"background": "room", "room_m": 12.0, "noise_grey": 0.0}}}
    )["measured_image"][0]
    assert (images[:, 0, :20] == images[:1, 0, :20]).all()
    assert images[0, 0, :20].std() > 3.0
