"""The whole motion at once through the parts: against the truth, and where torque-free fails."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.clock import Clock
from debrisest.parts.filters.batch import Batch
from debrisest.problems.tumbling.motion import TumblingMotion
from debrisest.roles import Given

RUNS = 12
POINTS = np.random.default_rng(1).uniform(-1.2, 1.2, (7, 3))
MOMENTS, NOISE = np.array([0.6, 0.9, 1.2]), 0.03


def flown(times, rate, torque=0.0):
    """Attitudes and body rates by small exact steps of Euler's equations, from the identity."""
    rate, turn = np.radians(rate), Rotation.identity()
    attitudes, rates, now = [], [], 0.0
    for time in times:
        steps = max(int(np.ceil((time - now) / 0.02)), 1)
        step = (time - now) / steps
        for _ in range(steps):
            k1 = (np.cross(MOMENTS * rate, rate) + torque) / MOMENTS
            middle = rate + 0.5 * step * k1
            k2 = (np.cross(MOMENTS * middle, middle) + torque) / MOMENTS
            turn, rate = turn * Rotation.from_rotvec(step * middle), rate + step * k2
        now = time
        attitudes.append(turn.as_quat(scalar_first=True))
        rates.append(rate)
    return np.array(attitudes), np.array(rates)


@pytest.fixture(scope="module")
def measured():
    """Points of one motion at uneven times, with noise of its own in each run."""
    rng = np.random.default_rng(4)
    times = np.cumsum(rng.uniform(0.5, 2.0, 180))
    q, rate = flown(times, [2.0, 0.7, 3.0])
    exact = np.einsum("kij,nj->kni", Rotation.from_quat(q, scalar_first=True).as_matrix(), POINTS)
    points = exact + NOISE * rng.normal(size=(RUNS, *exact.shape))
    points[rng.uniform(size=points.shape[:3]) < 0.3] = np.nan
    return {
        "run": np.arange(RUNS), "time_s": times, "measured_point": points,
        "point_noise": np.full(RUNS, NOISE), "known_point_f": np.tile(POINTS, (RUNS, 1, 1)),
        "true_q": q, "true_rate": rate,
    }  # fmt: skip


def estimated(data, **keys):
    """What the problem and the filter give, unpacked, and the record."""
    problem, clock = TumblingMotion(kind="tumbling_motion", **keys), Clock(data["time_s"])
    given = Given(np.empty(0), np.empty(0), problem.measurements(data), clock)
    part = Batch(kind="batch", keep_s=[float(data["time_s"][40])])
    record = part.run(problem.model(data, clock), given)
    return problem.unpack(record) | record.counts, record


def test_errors_of_all_blocks_are_as_large_as_the_covariance_says(measured) -> None:
    """Squares of eleven errors, two epochs: mean 11, five standard deviations of RUNS runs."""
    found, record = estimated(measured)
    assert record.kept.tolist() == [40, 179]
    tensor = np.diag(np.log(MOMENTS) - np.log(MOMENTS).mean())
    squares = np.empty((RUNS, 2))
    for run in range(RUNS):
        for slot, k in enumerate(record.kept):
            true = Rotation.from_quat(measured["true_q"][k], scalar_first=True)
            turn = Rotation.from_quat(found["q_if"][run, k], scalar_first=True) * true.inv()
            error = np.concatenate([
                turn.as_rotvec(), found["rate_f"][run, k] - measured["true_rate"][k],
                found["log_inertia_f"][run, k] - tensor[[0, 1, 0, 0, 1], [0, 1, 1, 2, 2]],
            ])  # fmt: skip
            squares[run, slot] = error @ np.linalg.solve(record.covariance[run, slot], error)
    spread = 5.0 * np.sqrt(2.0 * 11.0 / RUNS)
    np.testing.assert_allclose(squares.mean(axis=0), 11.0, atol=spread)
    assert np.all(found["accepted"] == 1) and np.all(found["lost_directions"] == 0)


def test_a_noise_that_is_told_too_small_must_show(measured) -> None:
    found, record = estimated(measured | {"point_noise": np.full(RUNS, NOISE / 3)})
    np.testing.assert_allclose(found["noise_found"], 3.0, rtol=0.1)
    assert all("larger than the given noise" in said for said in record.status)


def test_figures_of_the_last_epoch_are_those_of_the_motion(measured) -> None:
    found, _ = estimated(measured)
    rate, q = measured["true_rate"][-1], measured["true_q"][-1]
    momentum = Rotation.from_quat(q, scalar_first=True).apply(MOMENTS * rate)
    speeds = np.linalg.norm(measured["true_rate"], axis=-1)
    for name, true in (
        ("speed_end", speeds[-1]), ("mean_speed", speeds.mean()),
        ("momentum_axis_i", momentum / np.linalg.norm(momentum)),
        ("spin_axis_i", Rotation.from_quat(q, scalar_first=True).apply(rate / speeds[-1])),
        ("moment_share", MOMENTS / MOMENTS[-1]),
    ):  # fmt: skip
        off = np.abs(found[name] - true)
        assert np.all(off <= 5.0 * found[f"{name}_sigma"] + 1e-12), name


def test_unknown_geometry_gives_the_same_body_in_axes_of_its_own(measured) -> None:
    found, _ = estimated(measured, geometry="unknown")
    assert np.all(found["accepted"] == 1)
    distance = np.linalg.norm(found["point_f"][:, :, None] - found["point_f"][:, None], axis=-1)
    true = np.linalg.norm(POINTS[:, None] - POINTS, axis=-1)
    assert np.abs(distance - true).max() < 6 * NOISE / np.sqrt(0.3 * 180)
    inertial = Rotation.from_quat(measured["true_q"][-1], scalar_first=True).apply(
        measured["true_rate"][-1]
    )
    turned = [
        Rotation.from_quat(q[-1], scalar_first=True).apply(w[-1])
        for q, w in zip(found["q_if"], found["rate_f"])
    ]
    sigma = np.linalg.norm(found["rate_f_sigma"][:, -1], axis=-1)
    assert np.all(np.linalg.norm(turned - inertial, axis=-1) < 6 * sigma)


def test_points_that_are_said_to_have_no_noise_are_refused(measured) -> None:
    with pytest.raises(ValueError, match="their noise must be positive"):
        estimated(measured | {"point_noise": np.zeros(RUNS)})


def test_points_that_do_not_count_are_counted(measured) -> None:
    points = measured["measured_point"].copy()
    spoilt = np.flatnonzero(np.isfinite(points[0, :, 2, 0]))[3:9]
    points[:, spoilt, 2] += 1.5
    found, _ = estimated(measured | {"measured_point": points})
    seen = np.isfinite(points[..., 0]).sum(axis=-1)
    counted = found["rejected"] + found["observations_used"]
    np.testing.assert_array_equal(counted, np.where(seen < 2, 0, seen))
    assert found["rejected"][0, spoilt].sum() == len(spoilt)
    assert np.all(found["rejected_share"] < 2 * len(spoilt) / seen.sum(axis=-1))


def test_a_torque_is_told_and_no_inertia_is_claimed(measured) -> None:
    times = measured["time_s"]
    q, rate = flown(times, [2.0, 0.7, 3.0], torque=np.array([0.0, 6e-5, 0.0]))
    rng = np.random.default_rng(8)
    off = Rotation.from_rotvec(np.radians(0.5) * rng.normal(size=(len(times), 3)))
    shown = (off * Rotation.from_quat(q, scalar_first=True)).as_quat(scalar_first=True)
    data = {
        "run": np.zeros(1), "time_s": times, "measured_q_if": shown[None],
        "q_if_noise": np.full((1, len(times)), np.radians(0.5)),
    }  # fmt: skip
    found, record = estimated(data, measured="attitudes")
    assert found["accepted"] == [0] and "no inertia is claimed" in record.status[0]
    assert np.isnan(found["log_inertia_f"]).all() and np.isnan(found["moment_share"]).all()
    gap = np.linalg.norm(found["rate_f"][0] - rate, axis=-1)
    sigma = np.linalg.norm(found["rate_f_sigma"][0], axis=-1)
    assert np.mean(gap < 3 * sigma) > 0.9


def test_rates_alone_give_inertia_and_no_attitude_of_their_own(measured) -> None:
    rng = np.random.default_rng(9)
    sigma = np.radians(0.05)
    rates = measured["true_rate"] + sigma * rng.normal(size=(3, *measured["true_rate"].shape))
    data = {
        "run": np.arange(3), "time_s": measured["time_s"], "measured_rate_f": rates,
        "rate_f_noise": np.full(rates.shape[:2], sigma),
    }  # fmt: skip
    found, _ = estimated(data, measured="rates")
    assert np.all(found["accepted"] == 1)
    off = np.abs(found["moment_share"] - MOMENTS / MOMENTS[-1])
    assert np.all(off <= 5 * found["moment_share_sigma"] + 1e-12)
