"""Bodies and torque-free motions that differ from run to run."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.parts.truth.random_rigid_body import RandomRigidBody
from debrisest.parts.truth.random_torque_free import RandomTorqueFree

RUNS = 400


@pytest.fixture(scope="module")
def drawn():
    clock, draws = Clock.regular(30.0, 10.0), Draws(1, "case", list(range(RUNS)))
    body = RandomRigidBody(kind="random_rigid_body", count=[4, 12], half_side_m=[0.5, 5.0])
    motion = RandomTorqueFree(kind="random_torque_free", rate_deg_s=[0.2, 20.0])
    data = body.simulate({}, clock, draws)
    return data | motion.simulate(data, clock, draws)


def test_a_body_can_have_each_inertia(drawn) -> None:
    moments = np.linalg.eigvalsh(drawn["true_inertia_b"])
    assert np.all(moments[:, 0] > 0.0)
    assert np.all(moments[:, 2] < moments[:, 0] + moments[:, 1])


def test_kinds_of_bodies_have_their_shares(drawn) -> None:
    moments = np.linalg.eigvalsh(drawn["true_inertia_b"])
    gaps = np.diff(moments) / moments[:, 1:]
    for share, found in (
        (0.05, np.all(gaps < 0.01, axis=-1)),
        (0.15, np.any(gaps < 1e-9, axis=-1)),
    ):
        assert abs(found.mean() - share) < 5 * np.sqrt(share * (1 - share) / RUNS)


def test_spare_points_face_nobody_and_the_others_lie_on_the_box(drawn) -> None:
    used = np.linalg.norm(drawn["true_normal_b"], axis=-1)
    assert set(np.unique(used)) == {0.0, 1.0}
    assert set(used.sum(axis=-1)) == set(range(4, 13))
    assert np.all(used[:, :-1] >= used[:, 1:])
    out = np.sum(drawn["true_normal_b"] * drawn["true_point_b"], axis=-1)
    assert np.all(out[used > 0] >= 0.5) and np.abs(drawn["true_point_b"]).max() <= 5.0


def test_angular_momentum_is_constant_in_inertial_axes(drawn) -> None:
    momentum = np.einsum("rij,rtj->rti", drawn["true_inertia_b"], drawn["true_rate_b"])
    for run in range(0, RUNS, 40):
        turned = Rotation.from_quat(drawn["true_q_ib"][run], scalar_first=True).apply(momentum[run])
        assert np.abs(turned - turned[0]).max() < 1e-9 * np.linalg.norm(turned[0])


def test_rates_are_even_in_their_logarithm(drawn) -> None:
    speed = np.degrees(np.linalg.norm(drawn["true_rate_b"][:, 0], axis=-1))
    place = np.log(speed / 0.2) / np.log(100.0)
    assert place.min() >= 0.0 and place.max() <= 1.0
    assert abs(place.mean() - 0.5) < 5.0 / np.sqrt(12.0 * RUNS)


def test_shares_above_the_whole_are_refused() -> None:
    with pytest.raises(ValidationError, match="at most 1"):
        RandomRigidBody(
            kind="random_rigid_body", count=[4, 5], half_side_m=[1.0, 1.0],
            nearly_symmetric_share=0.9,
        )  # fmt: skip
