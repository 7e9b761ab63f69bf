"""Recoveries without a search, from points to errors, on torque-free motion in closed form."""

import numpy as np
import pytest

from debrisest.arrays import Data
from debrisest.assessment.attitude import attitude_errors, true_feature_attitude
from debrisest.assessment.statistics import rms_where
from debrisest.attitude import quaternion
from debrisest.attitude.points import features_frame
from debrisest.clock import Clock
from debrisest.dynamics.torque_free import torque_free
from debrisest.parts.recoveries.direction_cosines import DirectionCosines
from debrisest.parts.recoveries.line_spectrum import LineSpectrumRecovery
from debrisest.roles import RecoveryPart

CLOCK = Clock.regular(500.0, 1.0)
HIDDEN = (np.arange(500) % 50 >= 40) & (np.arange(500) < 490)
PARTS = {
    "pursuit": DirectionCosines(kind="direction_cosines", attitude="wahba", penalty=0.5),
    "joint": DirectionCosines(kind="direction_cosines", attitude="wahba", penalty=1.0, joint=True),
    "lines": LineSpectrumRecovery(kind="line_spectrum", attitude="wahba"),
    "equal weights": LineSpectrumRecovery(kind="line_spectrum", attitude="triad", weights="equal"),
}


@pytest.fixture(scope="module")
def data() -> Data:
    """Two runs of six points, of which every 50 s only two are seen for 10 s."""
    rng = np.random.default_rng(1)
    point_b = rng.normal(size=(6, 3)) * [2.0, 2.0, 4.0]
    q_ib, _ = torque_free(
        CLOCK.times,
        np.array([1.0, 0, 0, 0]),
        np.array([0.10, 0.02, 0.03]),
        np.array([0.6, 0.7, 0.4]),
    )
    point = quaternion.rotate(q_ib[:, None], point_b) + rng.normal(size=(500, 1, 3))
    measured = point + 0.03 * rng.standard_normal((2, 500, 6, 3))
    measured[:, HIDDEN, 2:] = np.nan
    return {
        "true_q_ib": np.stack([q_ib, q_ib]),
        "true_point_b": np.stack([point_b, point_b]),
        "known_point_f": np.stack([point_b @ features_frame(point_b)] * 2),
        "measured_point": measured,
    }


def recovered(part: RecoveryPart, data: Data) -> Data:
    found = data | part.recover(data, CLOCK)
    return found | {"recover_status": found["status"]}


@pytest.mark.parametrize("name", PARTS)
def test_signs_are_right_without_a_search_and_errors_are_small_in_the_gaps(name, data) -> None:
    found = recovered(PARTS[name], data)
    told = PARTS[name].assess(found)
    assert told["signs_all_right"].all()
    assert told["solved"].all()
    assert (told["pieces"] == 10).all()
    assert told["coverage"] == pytest.approx(0.82)
    assert told["gap_attitude"].max() < np.radians(3.0)
    _, single = attitude_errors(found["raw_q_if"], true_feature_attitude(found))
    assert (told["observed_attitude"] < rms_where(~HIDDEN, single)).all()


def test_lines_are_nearer_than_the_grid_and_are_counted(data) -> None:
    grid, lines = (
        PARTS[name].assess(recovered(PARTS[name], data)) for name in ("pursuit", "lines")
    )
    assert (2 * lines["gap_attitude"] < grid["gap_attitude"]).all()
    assert (lines["lines"] >= 3).all()
    assert "lines" not in grid


@pytest.mark.parametrize("name", PARTS)
def test_errors_in_the_gaps_and_outside_make_up_the_whole(name, data) -> None:
    told = PARTS[name].assess(recovered(PARTS[name], data))
    for what in ("pitch", "attitude"):
        parts = 0.82 * told[f"observed_{what}"] ** 2 + 0.18 * told[f"gap_{what}"] ** 2
        np.testing.assert_allclose(np.mean(told[f"recovered_{what}"] ** 2, axis=-1), parts)


@pytest.mark.parametrize("name", PARTS)
def test_nothing_seen_is_told_and_has_no_errors(name, data) -> None:
    unseen = data | {"measured_point": np.full((2, 500, 6, 3), np.nan)}
    unseen["measured_point"][0] = data["measured_point"][0]
    found = recovered(PARTS[name], unseen)
    assert found["status"][1].startswith("no sample observed")
    assert np.isnan(found["q_if"][1]).all()
    told = PARTS[name].assess(found)
    assert np.isnan(told["gap_pitch"][1]) and np.isnan(told["observed_pitch"][1])
    assert told["signs_all_right"][0] and told["coverage"][1] == 0


def test_without_a_truth_there_are_no_errors(data) -> None:
    found = recovered(PARTS["lines"], data)
    told = PARTS["lines"].assess({name: v for name, v in found.items() if "true" not in name})
    assert told.keys() == {"coverage", "pieces", "solved", "lines"}
