"""The truth in the axes of the camera at time zero: what has no axes must not change."""

import numpy as np

from debrisest.arrays import Data
from debrisest.attitude import quaternion
from debrisest.dynamics import kepler
from debrisest.target.start_frame import attitude_in_hill, in_start_frame

RNG = np.random.default_rng(0)


def _data() -> Data:
    times = np.arange(0, 50.0, 5.0)
    position, velocity = kepler.propagate(
        *kepler.state_from_elements(7e6, 0, 1.0, 0.2, 0, 0), times
    )
    root = RNG.standard_normal((2, 3, 3))
    return {
        "orbit_position": np.stack([position] * 2),
        "orbit_velocity": np.stack([velocity] * 2),
        "true_q_ib": quaternion.normalize(RNG.standard_normal((2, len(times), 4))),
        "true_rate_b": RNG.standard_normal((2, len(times), 3)),
        "true_point_b": RNG.standard_normal((2, 7, 3)),
        "true_inertia_b": root @ np.swapaxes(root, -1, -2),
    }


def test_points_rates_and_energy_in_space_are_the_same() -> None:
    data = _data()
    q_hc = quaternion.normalize(RNG.standard_normal((2, 4)))
    found, q_hb = in_start_frame(data, q_hc), attitude_in_hill(data)
    for mine, own in ((found.rate, data["true_rate_b"]),):
        turned = quaternion.rotate(found.q_he, mine)
        assert np.allclose(turned, quaternion.rotate(q_hb, own))
    points = quaternion.rotate(found.q_he[..., None, :], found.point[:, None])
    assert np.allclose(points, quaternion.rotate(q_hb[..., None, :], data["true_point_b"][:, None]))
    energy = (found.rate[:, :, None] @ found.inertia[:, None] @ found.rate[..., None])[..., 0, 0]
    rate = data["true_rate_b"]
    own = (rate[:, :, None] @ data["true_inertia_b"][:, None] @ rate[..., None])[..., 0, 0]
    assert np.allclose(energy, own)


def test_at_time_zero_the_axes_are_the_cameras() -> None:
    data = _data()
    q_hc = quaternion.normalize(RNG.standard_normal((2, 4)))
    assert np.allclose(quaternion.angle_between(in_start_frame(data, q_hc).q_he[:, 0], q_hc), 0)
