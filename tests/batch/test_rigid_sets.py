"""Which points keep their distances."""

import numpy as np
import pytest

from debrisest.batch.rigid_sets import largest_rigid_set, noise_of, odd_points, on_known_body, pairs
from debrisest.batch.tracks import tracks


def rigid(tumbling, seed, sigma=0.02):
    return tumbling.points(np.random.default_rng(seed), sigma)


def test_noise_is_found_without_a_model(tumbling) -> None:
    found = pairs(tracks(tumbling.times, rigid(tumbling, 0), 1.0))
    assert abs(noise_of(found) / 0.02 - 1.0) < 0.15


def test_a_drifting_point_is_not_of_the_body(tumbling) -> None:
    points = rigid(tumbling, 1)
    points[:, 3] += 0.005 * tumbling.times[:, None]
    found = pairs(tracks(tumbling.times, points, 0.02))
    assert largest_rigid_set(found, noise_of(found)).tolist() == [True] * 3 + [False] + [True] * 4


def test_distances_of_a_known_body_tell_a_point_elsewhere(tumbling, box) -> None:
    model = box.copy()
    model[2] += [0.0, 0.4, 0.4]
    found = pairs(tracks(tumbling.times, rigid(tumbling, 2), 0.02), model)
    assert np.flatnonzero(~largest_rigid_set(found, 0.02)).tolist() == [2]


@pytest.mark.parametrize(("moved", "second"), [(0.0, True), (0.5, False)])
def test_points_never_seen_with_the_others_are_of_a_known_body(
    tumbling, box, moved, second
) -> None:
    """Three in the first half and two in the second: only a model says that they are one body."""
    sigma, half = 0.02, len(tumbling.times) // 2
    turned = np.einsum("kij,cj->kci", tumbling.attitude.as_matrix(), box[:5])
    points = turned + sigma * np.random.default_rng(8).normal(size=turned.shape)
    points[half:, :3], points[:half, 3:] = np.nan, np.nan
    points[:, 4] += moved
    seen = tracks(tumbling.times, points, sigma)
    expected = [True] * 3 + [second] * 2
    assert on_known_body(pairs(seen, box[:5]), sigma).tolist() == expected
    assert largest_rigid_set(pairs(seen), sigma).tolist() == [True] * 3 + [False] * 2


def test_swapped_points_are_odd(tumbling) -> None:
    """The distance of a swapped pair is right; those to all others are not."""
    points = rigid(tumbling, 3)
    seen = np.isfinite(points[..., 0])
    several = np.flatnonzero(seen.sum(axis=1) >= 5)[::7]
    odd = np.zeros(seen.shape, dtype=bool)
    for k in several:
        first, second = np.flatnonzero(seen[k])[:2]
        points[k, [first, second]] = points[k, [second, first]]
        odd[k, [first, second]] = True
    tracked = tracks(tumbling.times, points, 0.02)
    assert np.array_equal(odd_points(tracked, pairs(tracked), 0.02), odd)


def test_many_points_of_two_bodies_are_told_apart_by_some_of_their_pairs(tumbling) -> None:
    """Of 120 points, 50 belong to a body that turns the other way; one is never seen."""
    rng = np.random.default_rng(4)
    model = rng.normal(size=(120, 3))
    axes = tumbling.attitude.as_matrix()
    points = np.einsum("kij,cj->kci", axes, model)
    points[:, :50] = np.einsum("kji,cj->kci", axes, model[:50])
    points += 0.02 * rng.normal(size=points.shape)
    points[rng.uniform(size=points.shape[:2]) < 0.5] = np.nan
    points[:, 60] = np.nan
    tracked = tracks(tumbling.times, points, 0.02)
    found = pairs(tracked)
    expected = (np.arange(120) >= 50) & (np.arange(120) != 60)
    assert np.array_equal(largest_rigid_set(found, 0.02), expected)
    assert np.isfinite(found.length).sum() < 60 * 120


def test_wrong_matches_among_many_points_are_odd(tumbling) -> None:
    rng = np.random.default_rng(5)
    points = np.einsum("kij,cj->kci", tumbling.attitude.as_matrix(), rng.normal(size=(90, 3)))
    points += 0.02 * rng.normal(size=points.shape)
    odd = rng.uniform(size=points.shape[:2]) < 0.02
    points[odd] += 1.0
    tracked = tracks(tumbling.times, points, 0.02)
    found = odd_points(tracked, pairs(tracked), 0.02)
    assert np.mean(found[odd]) > 0.99
    assert np.mean(found[~odd]) < 1e-3
