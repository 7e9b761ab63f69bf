"""A run is wrong where it is accepted and off by more than five of its own sigmas."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.problems.tumbling.right_or_wrong import right_or_wrong

TIMES = np.arange(0.0, 40.0)
INERTIA = np.array([0.1, -0.2, 0.05, 0.0, 0.1])
SIGMA = np.repeat([1e-3, 2e-3, 0.01], (3, 3, 5))


def quaternions(rotation):
    return rotation.as_quat(scalar_first=True)


def runs(turn=(0.0, 0.0, 0.0), rate=(0.0, 0.0, 0.0), inertia=0.0, accepted=1.0, axes=None):
    """One run, its truth and what is off of it, in estimated axes that are turned."""
    axes = Rotation.identity() if axes is None else axes
    true = Rotation.from_rotvec(np.outer(TIMES, [0.0, 0.02, 0.01]))
    rates = np.tile([0.0, 0.02, 0.01], (40, 1))
    truth = np.concatenate([quaternions(true), rates, np.tile(INERTIA, (40, 1))], axis=-1)[None]
    estimated = Rotation.from_rotvec(turn) * true * axes.inv()
    logs = [[0, 2, 3], [2, 1, 4], [3, 4, 0]]
    tensor = INERTIA[logs]
    tensor[2, 2] = -INERTIA[0] - INERTIA[1]
    tensor = axes.as_matrix() @ tensor @ axes.as_matrix().T
    found = tensor[[0, 1, 0, 0, 1], [0, 1, 1, 2, 2]] + inertia
    points = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
    data = {
        "time_s": TIMES, "covariance_time_s": TIMES[[5, 20, 39]],
        "q_if": quaternions(estimated)[None], "q_if_sigma": np.full((1, 40, 4), 1e-3),
        "rate_f": (axes.apply(rates) + rate)[None],
        "log_inertia_f": np.tile(found, (1, 40, 1)),
        "covariance": np.tile(np.diag(SIGMA**2), (1, 3, 1, 1)),
        "accepted": np.array([accepted]), "point_noise": np.array([0.01]),
        "measured_point": np.tile(points, (1, 40, 1, 1)), "true_point_b": points[None],
        "observations_used": np.full((1, 40), 4.0), "rejected": np.zeros((1, 40)),
    }  # fmt: skip
    return data, truth


def outcome(data, truth, free=False):
    found = right_or_wrong(data, truth, free)
    return tuple(int(found[f"accepted_and_{word}"][0]) for word in ("right", "wrong"))


@pytest.mark.parametrize(("block", "size"), [("turn", 1e-3), ("rate", 2e-3)])
def test_five_sigma_is_the_limit(block: str, size: float) -> None:
    near, far = ({block: (0.0, 0.0, share * size)} for share in (4.5, 6.5))
    assert outcome(*runs(**near)) == (1, 0)
    assert outcome(*runs(**far)) == (0, 1)


def test_an_inertia_is_judged_where_it_shows() -> None:
    assert outcome(*runs(inertia=0.01)) == (1, 0)
    data, truth = runs(inertia=0.2)
    assert outcome(data, truth) == (0, 1)
    hidden = data["covariance"].copy()
    hidden[..., 6:, 6:] = 0.64 * np.eye(5)
    assert outcome(data | {"covariance": hidden}, truth) == (1, 0)


def test_what_is_not_accepted_is_missed_and_not_wrong() -> None:
    data, truth = runs(turn=(0.1, 0.0, 0.0), accepted=0.0)
    assert outcome(data, truth) == (0, 0)
    assert right_or_wrong(data, truth, False)["missed"][0] == 1
    few = np.full_like(data["measured_point"], np.nan)
    found = right_or_wrong(data | {"measured_point": few}, truth, False)
    assert found["startable"][0] == found["missed"][0] == 0


def test_axes_of_ones_own_are_no_error_and_a_wrong_rate_is() -> None:
    axes = Rotation.from_rotvec([0.4, -0.7, 0.2])
    data, truth = runs(axes=axes)
    surest = data["q_if_sigma"].copy()
    surest[:, 20] = 1e-12
    certain = data["covariance"].copy()
    certain[:, 1, :3, :3] *= 1e-16
    known = {"q_if_sigma": surest, "covariance": certain}
    assert outcome(data, truth) == (0, 1)
    assert outcome(data | known, truth, free=True) == (1, 0)
    off, truth = runs(axes=axes, rate=(0.02, 0.0, 0.0))
    assert outcome(off | known, truth, free=True) == (0, 1)


def test_epochs_after_the_last_measurement_do_not_count() -> None:
    data, truth = runs()
    q = data["q_if"].copy()
    q[:, 30:] = [0.0, 1.0, 0.0, 0.0]
    assert outcome(data | {"q_if": q}, truth) == (0, 1)
    unseen = np.where(TIMES < 30.0, 4.0, 0.0)[None]
    assert outcome(data | {"q_if": q, "observations_used": unseen}, truth) == (1, 0)
