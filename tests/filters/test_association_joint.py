"""Joint association against the list of all assignments."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from debrisest.filters.association.joint import MOST_TRACKS, exclusive, joint
from debrisest.filters.association.weights import Validation, probabilistic
from debrisest.parts.sensors.detections import MOST_COMPANIONS

RULE = Validation(gate=9.0, detection_probability=0.8)


def enumerated(present, absent):
    """Marginals of one run, assignment by assignment; -1 is no detection."""
    tracks, detections = present.shape
    sums, total = np.zeros((tracks, detections)), 0.0
    for chosen in product(range(-1, detections), repeat=tracks):
        own = [i for i in chosen if i >= 0]
        if len(set(own)) < len(own):
            continue
        weight = np.prod([absent[t] if i < 0 else present[t, i] for t, i in enumerate(chosen)])
        total += weight
        for t, i in enumerate(chosen):
            if i >= 0:
                sums[t, i] += weight
    return sums / total


@given(st.integers(1, 4), st.integers(0, 5), st.floats(0.0, 1.0), st.integers(0))
def test_marginals_are_those_of_all_assignments(tracks, detections, share, seed):
    rng = np.random.default_rng(seed)
    present = np.exp(rng.uniform(-8, 4, size=(3, tracks, detections)))
    present[rng.random(present.shape) < share] = 0.0
    absent = np.exp(rng.uniform(-8, 4, size=(3, tracks)))
    found = exclusive(present, absent)
    expected = np.stack([enumerated(p, a) for p, a in zip(present, absent)])
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-15)


def distances(rng, *shape):
    squared = rng.uniform(0, 12, size=shape)
    return np.where(squared <= RULE.gate, squared, np.inf)


@given(st.integers(0, 6), st.integers(0))
def test_one_track_is_associated_as_alone(detections, seed):
    distance = distances(np.random.default_rng(seed), 5, 1, detections)
    np.testing.assert_allclose(joint(distance, RULE, 2), probabilistic(distance, RULE, 2))


@given(st.integers(0))
def test_tracks_with_nothing_in_common_are_associated_as_alone(seed):
    distance = distances(np.random.default_rng(seed), 4, 3, 6)
    for track in range(3):
        distance[:, track, np.arange(6) // 2 != track] = np.inf
    expected = probabilistic(distance, RULE, 2)
    np.testing.assert_allclose(joint(distance, RULE, 2), expected, rtol=1e-12, atol=1e-15)


@given(st.integers(0))
def test_the_order_of_tracks_and_detections_does_not_matter(seed):
    rng = np.random.default_rng(seed)
    distance = distances(rng, 4, 3, 5)
    tracks, detections = rng.permutation(3), rng.permutation(5)
    expected = joint(distance, RULE, 2)[:, tracks][:, :, detections]
    found = joint(distance[:, tracks][:, :, detections], RULE, 2)
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-15)


def test_a_neighbour_takes_its_own_detection_away() -> None:
    """The target is nearer to the neighbour's detection, which is the neighbour's only one."""
    distance = np.array([[[2.0, 1.0], [np.inf, 0.0]]])
    alone = probabilistic(distance, RULE, 2)[0, 0]
    together = joint(distance, RULE, 2)[0, 0]
    assert alone[1] > alone[0]
    assert together[0] > together[1]


@pytest.mark.parametrize("tracks", range(1, MOST_TRACKS + 1))
def test_tracks_that_cannot_miss_share_their_only_detection_fairly(tracks) -> None:
    found = joint(np.zeros((1, tracks, 1)), Validation(np.inf, 1.0), 2)
    assert found == pytest.approx(np.full((1, tracks, 1), 1.0 / tracks))


def test_the_debris_and_its_companions_are_not_too_many_tracks() -> None:
    assert MOST_COMPANIONS + 1 == MOST_TRACKS
    with pytest.raises(ValueError, match="at most 8 tracks"):
        joint(np.zeros((1, 9, 1)), RULE, 2)
