"""Points that are wrong, elsewhere, or not seen to the end."""

import numpy as np
import pytest

from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.parts.sensors.feature_points import BiasedFeature, FeaturePoints

RUNS, EPOCHS = 3, 400
POINTS = 10.0 * np.random.default_rng(1).normal(size=(6, 3))


def measured(position=(0.0, 0.0, 0.0), **keys):
    truth = {
        "feature": np.array([f"p{i}" for i in range(6)]),
        "true_point_b": np.tile(POINTS, (RUNS, 1, 1)),
        "true_normal_b": np.ones((RUNS, 6, 3)),
        "true_q_ib": np.tile([1.0, 0.0, 0.0, 0.0], (RUNS, EPOCHS, 1)),
        "true_position": np.tile(np.array(position), (RUNS, EPOCHS, 1)),
    }
    part = FeaturePoints(**{"kind": "feature_points", "noise_m": 1e-3, "visibility": "all"} | keys)
    draws = Draws(1, "case", list(range(RUNS)))
    return part.simulate(truth, Clock.regular(EPOCHS, 1.0), draws)


def test_wrong_matches_have_their_share_half_of_them_exchanged() -> None:
    points = measured(wrong_match_share=0.2)["measured_point"]
    off = np.linalg.norm(points - POINTS, axis=-1)
    count, spread = off.size, 5.0 / np.sqrt(off.size)
    assert abs(np.sum(off > 0.1) / count - 0.2) < spread
    places = np.linalg.norm(points[..., None, :] - POINTS, axis=-1)
    exchanged = (places.min(axis=-1) < 0.1) & (places.argmin(axis=-1) != np.arange(6))
    assert abs(np.sum(exchanged) / count - 0.1) < spread
    shifted = (off > 0.1) & ~exchanged
    assert off[shifted].min() > 0.9 and places.min(axis=-1)[shifted].max() < 5.1


def test_a_biased_feature_is_off_in_one_direction_of_each_run() -> None:
    points = measured(biased_feature=BiasedFeature(name="p2", by_m=0.2))["measured_point"]
    off = (points - POINTS).mean(axis=1)
    sizes = np.linalg.norm(off, axis=-1)
    assert np.all(np.abs(sizes[:, 2] - 0.2) < 1e-3)
    assert np.all(np.delete(sizes, 2, axis=1) < 1e-3)
    assert np.abs(off[0, 2] - off[1, 2]).max() > 0.01


def test_a_biased_feature_that_is_none_is_told() -> None:
    with pytest.raises(ValueError, match="no feature is called p9; there are p0, p1"):
        measured(biased_feature=BiasedFeature(name="p9", by_m=0.2))


def test_noise_and_the_last_epoch_are_drawn_for_each_run() -> None:
    data = measured(noise_m=[0.01, 0.1], seen_for_s=[100.0, 300.0])
    last = np.isfinite(data["measured_point"][..., 0, 0]).sum(axis=-1)
    assert np.all((last > 100) & (last <= 300)) and len(set(last)) == RUNS
    told = data["point_noise"]
    assert np.all((told >= 0.01) & (told <= 0.1)) and len(set(told)) == RUNS
    shown = np.nanstd(data["measured_point"] - POINTS, axis=(1, 2, 3))
    assert np.all(np.abs(shown / told - 1.0) < 5.0 / np.sqrt(2 * 100 * 18))


def test_outages_and_drop_outs_add_up() -> None:
    keys = {"outages_s": [[10, 20], [15, 30.5]], "missing_share": 0.25}
    seen = np.isfinite(measured(**keys)["measured_point"][..., 0])
    out = (np.arange(EPOCHS) >= 10) & (np.arange(EPOCHS) < 30.5)
    assert not seen[:, out].any()
    left = seen[:, ~out]
    assert abs(left.mean() - 0.75) < 5 * np.sqrt(0.25 * 0.75 / left.size)
    assert np.all(np.isfinite(measured()["measured_point"]))


def test_a_slow_window_shows_every_so_manyth_epoch_from_its_first_on() -> None:
    slow = [{"span_s": [100, 200], "every_s": 5}, {"span_s": [201, 211], "every_s": 3.2}]
    seen = np.isfinite(measured(slow_s=slow)["measured_point"]).all((0, 2, 3))
    fast = np.r_[0:100, 200, 211:EPOCHS]
    assert np.flatnonzero(seen).tolist() == sorted(
        [*fast, *range(100, 200, 5), *range(201, 211, 3)]
    )


def test_depth_is_noisier_than_what_lies_across() -> None:
    """Along (3, 0, 4) / 5 three times the noise, across it as it is given; told is the RMS."""
    position = np.array([30.0, 0.0, 40.0])
    data = measured(position, depth_noise_factor=3.0, noise_m=0.1)
    off = data["measured_point"] - POINTS - position
    axes = np.array([[0.6, 0.0, 0.8], [0.8, 0.0, -0.6], [0.0, 1.0, 0.0]])
    spread = np.sqrt(np.mean((off @ axes.T) ** 2, axis=(0, 1, 2)))
    np.testing.assert_allclose(spread, [0.3, 0.1, 0.1], rtol=5 / np.sqrt(2 * off[..., 0].size))
    np.testing.assert_allclose(data["point_noise"], np.sqrt((off**2).mean()), rtol=0.05)


def test_an_error_of_the_chasers_attitude_turns_all_points_of_an_epoch_about_it() -> None:
    position = np.array([0.0, 30.0, 0.0])
    points = measured(position, attitude_noise_deg=0.5, noise_m=1e-9)["measured_point"]
    right = POINTS + position
    distances = np.broadcast_to(np.linalg.norm(right, axis=-1), points.shape[:-1])
    np.testing.assert_allclose(np.linalg.norm(points, axis=-1), distances)
    off = (points - right)[..., [0, 2]].mean(axis=2) / right[:, 1].mean()
    np.testing.assert_allclose(np.degrees(off.std()), 0.5, rtol=0.1)
    assert np.abs(np.corrcoef(off[0, 1:, 0], off[0, :-1, 0])[0, 1]) < 0.25


def test_features_are_not_where_they_are_known_to_be() -> None:
    points = measured(feature_error_m=0.2, noise_m=1e-6)["measured_point"]
    off = points - POINTS
    assert np.abs(np.ptp(off, axis=1)).max() < 1e-4
    assert off[:, 0].std() == pytest.approx(0.2, rel=5 / np.sqrt(2 * off[:, 0].size))
