"""What the two cameras, the acceleration and the first guess of a leader give."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Literal

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics.inertia_ratios import moments
from debrisest.parts.sensors.angular_acceleration import AngularAcceleration
from debrisest.parts.sensors.stereo_camera import StereoCamera
from debrisest.parts.starts.drawn_pose import DrawnPose
from debrisest.parts.truth.kepler_orbit import KeplerOrbit
from debrisest.parts.truth.random_points import RandomPoints
from debrisest.parts.truth.rigid_points import RigidPoints
from debrisest.parts.truth.seen_from_leader import SeenFromLeader
from debrisest.roles import SimulationPart
from debrisest.scenario.contracts import parts_that_do_not_fit
from debrisest.scenario.schema import Scenario

TINY, STEP = 1e-14, 0.01


def camera(**keys) -> StereoCamera:
    given = {
        "pixel_noise_px": TINY,
        "flow_noise_px_s": TINY,
        "disparity_noise_px": TINY,
        "from_s": 0.0,
    }
    return StereoCamera(kind="stereo_camera", **({"baseline_m": 1.0} | given | keys))


def guess(**keys) -> DrawnPose:
    return DrawnPose(
        kind="drawn_pose",
        position_sigma_m=1.0,
        velocity_sigma_m_s=0.5,
        rate_sigma_deg_s=2.0,
        q_sigma=1e-3,
        inertia_ratio_sigma=0.7,
        point_sigma_m=0.2,
        **keys,
    )


def test_a_start_of_bodies_only_leaves_out_what_no_body_can_have(simulated: Callable) -> None:
    """The kept draws are those of the others that obey the triangle inequality, no more."""
    shares = {}
    for only in (False, True):
        data = simulated(guess(bodies_only=only), runs=400)
        drawn = moments(data["start_inertia_ratio"])
        shares[only] = (2 * drawn.max(axis=-1) < drawn.sum(axis=-1)).mean()
        assert data["start_inertia_ratio"].shape == (400, 2)
    assert shares[True] == 1.0
    assert 0.4 < shares[False] < 0.75


def test_turned_cameras_see_what_is_before_them(simulated: Callable) -> None:
    """Cameras that look 10 deg to the side and are rolled, against scipy's rotations."""
    turn = Rotation.from_euler("ZY", [10.0, 35.0], degrees=True)
    q_lc = turn.as_quat(scalar_first=True)
    data = simulated(camera(q_lc=q_lc.tolist()))
    body = quaternion.rotate(data["true_q_lt"][..., None, :], data["true_point_b"][:, None])
    point = data["true_position"][..., None, :] + body
    x, y, z = np.moveaxis(point @ turn.as_matrix(), -1, 0)
    assert (y > 0).all()
    for number, offset in ((0, 0.0), (1, 1.0)):
        seen = data["measured_pixel"][:, :, number]
        assert seen[..., 0] == pytest.approx((x - offset) / y, abs=1e-6)
        assert seen[..., 1] == pytest.approx(z / y, abs=1e-6)
    assert data["camera_q_lc"] == pytest.approx(np.tile(q_lc, (4, 1)))
    assert "camera_q_lc" not in simulated(camera())


def test_both_cameras_project_the_points(simulated: Callable) -> None:
    data = simulated(camera())
    turned = quaternion.rotate(data["true_q_lt"][..., None, :], data["true_point_b"][:, None])
    x, y, z = np.moveaxis(data["true_position"][..., None, :] + turned, -1, 0)
    assert data["measured_pixel"].shape == (4, 10, 2, 5, 2)
    for number, offset in ((0, 0.0), (1, 1.0)):
        expected = np.stack([(x - offset) / y, z / y], axis=-1)
        assert data["measured_pixel"][:, :, number] == pytest.approx(expected, abs=1e-12)
    difference = data["measured_pixel"][:, :, 1, :, 0] - data["measured_pixel"][:, :, 0, :, 0]
    assert data["measured_disparity"] == pytest.approx(difference, abs=1e-12)


def test_flow_is_the_derivative_of_the_pixels(simulated: Callable) -> None:
    data = simulated(camera(), duration=1.0, step=STEP, rate=[-1.0, -1.0, 0.934])
    slope = np.gradient(data["measured_pixel"], STEP, axis=1)[:, 1:-1]
    assert slope == pytest.approx(data["measured_flow"][:, 1:-1], abs=1e-8)


def test_noise_is_as_large_as_it_is_said_to_be(simulated: Callable) -> None:
    noises = {"pixel_noise_px": 1e-3, "flow_noise_px_s": 2e-3, "disparity_noise_px": 3e-3}
    noisy, clean = simulated(camera(**noises), runs=20), simulated(camera(), runs=20)
    for name, noise, count in zip(("pixel", "flow", "disparity"), noises.values(), (4, 4, 1)):
        gap = noisy[f"measured_{name}"] - clean[f"measured_{name}"]
        assert gap.std() == pytest.approx(noise, rel=5 / np.sqrt(2 * 20 * 10 * 5 * count))
        assert np.all(noisy[f"{name}_noise"] == noise)


def test_what_is_switched_off_changes_nothing_else(simulated: Callable) -> None:
    whole = simulated(camera(pixel_noise_px=1e-3))
    part = simulated(camera(pixel_noise_px=1e-3, flow_noise_px_s=None, disparity_noise_px=None))
    assert np.array_equal(whole["measured_pixel"], part["measured_pixel"])
    assert not {"measured_flow", "flow_noise", "measured_disparity"} & part.keys()
    with pytest.raises(ValidationError, match="measure nothing"):
        camera(pixel_noise_px=None, flow_noise_px_s=None, disparity_noise_px=None)


def test_missing_features_and_the_time_before_the_first(simulated: Callable) -> None:
    data = simulated(camera(missing_per_frame=2, from_s=3.0), runs=30)
    hidden = np.isnan(data["measured_disparity"])
    assert hidden[:, :3].all()
    assert np.all(hidden[:, 3:].sum(-1) == 2)
    assert hidden[:, 3:].mean((0, 1)) == pytest.approx([0.4] * 5, abs=0.17)
    assert np.array_equal(np.isnan(data["measured_pixel"]).all((2, 4)), hidden)
    assert np.array_equal(np.isnan(data["measured_flow"]).any((2, 4)), hidden)


class Box:
    """Puts the features on the faces of a cube; the cameras then stand nearer to it."""

    half, nearer = 1.5, 0.1

    def simulate(self, data, clock, draws):
        points, normals = data["true_point_b"], data["true_normal_b"]
        points = np.where(normals != 0, self.half * normals, points)
        return {"true_point_b": points, "true_position": self.nearer * data["true_position"]}


def inside(point, cube):
    return np.abs(point).max(-1) < cube


def test_occlusion_hides_what_lies_behind_the_body(simulated: Callable) -> None:
    """A feature of a box is hidden where the way to either camera begins inside the box."""
    turning = {"rate": [30.0, -20.0, 10.0], "runs": 20, "first": 3}
    parts = Box(), camera(visibility="back_face", baseline_m=4.0)
    data = simulated(*parts, **turning)
    hidden = np.isnan(data["measured_disparity"])
    point, expected = data["true_point_b"][:, None], np.zeros_like(hidden)
    axes = Rotation.from_quat(data["true_q_lt"].reshape(-1, 4), scalar_first=True)
    for place in ([0.0, 0.0, 0.0], [4.0, 0.0, 0.0]):
        camera_t = axes.inv().apply((place - data["true_position"]).reshape(-1, 3))
        way = camera_t.reshape(data["true_position"].shape)[:, :, None] - point
        expected |= inside(point + 1e-6 * way, Box.half)
    assert np.array_equal(hidden, expected)
    assert 0.3 < hidden.mean() < 0.8
    assert (hidden.any(1) & ~hidden.all(1)).any()
    open_ = simulated(Box(), camera(baseline_m=4.0), **turning)
    for name in ("measured_pixel", "measured_flow", "measured_disparity"):
        seen = ~np.isnan(data[name])
        assert np.array_equal(data[name][seen], open_[name][seen])
    assert not np.isnan(open_["measured_disparity"]).any()


def test_missing_features_come_on_top_of_hidden_ones(simulated: Callable) -> None:
    def hidden(**keys):
        return np.isnan(simulated(camera(**keys), runs=10)["measured_disparity"])

    both = hidden(visibility="back_face", missing_per_frame=2)
    assert np.array_equal(both, hidden(visibility="back_face") | hidden(missing_per_frame=2))


class Bare(SimulationPart):
    """A target whose surface nobody knows."""

    truths = ("true_point_b", "true_inertia_ratio")
    kind: Literal["bare"] = "bare"

    def simulate(self, data, clock, draws):
        raise NotImplementedError


@pytest.mark.parametrize("occlusion", [False, True])
@pytest.mark.parametrize("bare", [False, True])
def test_occlusion_needs_normals(occlusion: bool, bare: bool) -> None:
    drawn = RandomPoints(
        kind="random_points", count=5, half_size_m=1.5, inertia_ratios=[-0.186, -0.0797]
    )
    motion = SeenFromLeader(
        kind="seen_from_leader",
        position_m=[10.0, 60.0, 10.0],
        velocity_m_s=[0.0, 0.0, 0.0],
        rate_deg_s=[0.0, 0.0, 0.0],
    )
    scenario = Scenario(
        title="occlusion",
        seed=1,
        runs=1,
        duration_s=10.0,
        step_s=1.0,
        target=Bare() if bare else drawn,
        orbit=KeplerOrbit(kind="kepler", semi_major_axis_km=7170.0),
        motion=motion,
        sensors={"cameras": camera(visibility="back_face" if occlusion else "all")},
        estimators={},
    )
    case = SimpleNamespace(scenario=scenario, source=None, measured={}, estimators=[])
    problems = list(parts_that_do_not_fit(case))
    assert len(problems) == (occlusion and bare)
    for path, message in problems:
        assert path == ("sensors", "cameras")
        assert "stereo_camera needs true_normal_b, which no part before it gives" in message
        assert "target random_points" in message


def test_outliers_come_with_their_share_and_size(simulated: Callable) -> None:
    hit = simulated(camera(pixel_noise_px=1e-5, outlier_share=0.02), runs=40)
    clean = simulated(camera(pixel_noise_px=1e-5), runs=40)
    gap = hit["measured_pixel"] - clean["measured_pixel"]
    struck = gap != 0
    assert struck.mean() == pytest.approx(0.02, abs=5 * np.sqrt(0.02 / struck.size))
    assert np.abs(gap[struck]) == pytest.approx(np.full(struck.sum(), 1e-3), rel=1e-6)
    assert 0.3 < (gap[struck] > 0).mean() < 0.7


def test_a_point_behind_the_cameras_is_not_seen(simulated: Callable) -> None:
    class Behind:
        def simulate(self, data, clock, draws):
            return {"true_position": data["true_position"] * [1, -1, 1]}

    assert np.isnan(simulated(Behind(), camera())["measured_pixel"]).all()


def test_acceleration_is_the_derivative_of_the_body_rate(simulated: Callable) -> None:
    sensor = AngularAcceleration(kind="angular_acceleration", noise_rad_s2=1e-16, from_s=0.0)
    data = simulated(sensor, runs=1, duration=1.0, step=STEP, rate=[-1.0, -1.0, 0.934])
    seen = data["measured_angular_acceleration"][0]
    position, velocity = data["orbit_position"][0], data["orbit_velocity"][0]
    orbit_rate = np.linalg.norm(np.cross(position, velocity), axis=-1) / (position**2).sum(-1)
    rate_l = data["true_rate_l"][0] + orbit_rate[:, None] * [0, 0, 1]
    rate_b = quaternion.rotate(quaternion.conjugate(data["true_q_lt"][0]), rate_l)
    assert seen[1:-1] == pytest.approx(np.gradient(rate_b, STEP, axis=0)[1:-1], abs=1e-9)
    assert np.abs(seen).max() > 1e-5


def test_the_first_guess_is_off_by_its_sigma(simulated: Callable) -> None:
    data, runs = simulated(guess(), runs=300), 300
    for name, sigma in (
        *(("position", 1.0), ("velocity", 0.5), ("rate_l", np.radians(2))),
        *(("inertia_ratio", 0.7), ("point_b", 0.2)),
    ):
        true = data[f"true_{name}"]
        true = true if name in ("inertia_ratio", "point_b") else true[:, 0]
        gap = data[f"start_{name}"] - true
        assert gap.std() == pytest.approx(sigma, rel=5 / np.sqrt(2 * gap.size))
        assert abs(gap.mean()) < 5 * sigma / np.sqrt(gap.size)
        assert np.all(data[f"start_{name}_sigma"] == sigma)
    q = data["start_q_lt"]
    assert np.linalg.norm(q, axis=-1) == pytest.approx(np.ones(runs), abs=1e-12)
    angle = quaternion.angle_between(q, data["true_q_lt"][:, 0])
    assert np.sqrt((angle**2).mean() / 3) == pytest.approx(2e-3, rel=0.2)


def test_a_body_along_its_principal_axes_gives_the_ratios_that_a_leader_needs() -> None:
    """A target of one's own points, in the place of random ones."""
    points = {
        name: {"position_m": position, "normal": position}
        for name, position in {"a": [1.0, 0, 0], "b": [0, 1.0, 0], "c": [0, 0.5, 1.0]}.items()
    }
    body = {"kind": "rigid_points", "points": points}
    along = RigidPoints(**body, inertia_kg_m2=[0.83, 1.0, 1.083])
    tilted = RigidPoints(**body, inertia_kg_m2=[[2.0, 0.1, 0], [0.1, 2.0, 0], [0, 0, 3.0]])
    for part in (along, tilted):
        given = part.simulate({}, Clock.regular(2, 1.0), Draws(1, "case", [0, 1]))
        assert set(given) - {"feature"} == set(part.given)
    ratios = along.simulate({}, Clock.regular(2, 1.0), Draws(1, "c", [0]))["true_inertia_ratio"]
    np.testing.assert_allclose(ratios, [[np.log(0.83), np.log(1 / 1.083)]])
    assert "true_inertia_ratio" not in tilted.given
