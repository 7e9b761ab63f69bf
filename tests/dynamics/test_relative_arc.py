"""Arcs of relative rotation against integration step by step, and against differences."""

from itertools import pairwise

import numpy as np
import pytest

from debrisest.attitude import quaternion
from debrisest.dynamics.inertia_ratios import slopes
from debrisest.dynamics.relative_arc import rotation_arc
from debrisest.dynamics.relative_orbit import leader_orbit
from debrisest.dynamics.relative_rotation import rotation_step

RUNS = 3


def start(seed, speed):
    rng = np.random.default_rng(seed)
    q = quaternion.normalize(rng.normal(size=(RUNS, 4)))
    return q, speed * rng.normal(size=(RUNS, 3)), 0.4 * rng.normal(size=(RUNS, 2))


def orbit(times):
    return leader_orbit(times + 100.0, 7.17e6, 0.05, 0.3)


@pytest.mark.parametrize("times", [np.arange(8.0), -np.arange(8.0), np.array([0.0, 0.5, 2.0])])
def test_arcs_match_many_small_steps(times):
    q, rate, k = start(0, 0.3)
    found_q, found_rate, _ = rotation_arc(times, q, rate, k, orbit(times))
    fine = np.concatenate([np.linspace(a, b, 201)[:-1] for a, b in pairwise(times)] + [times[-1:]])
    for i in range(len(fine) - 1):
        ends = fine[i], 0.5 * (fine[i] + fine[i + 1]), fine[i + 1]
        leader = tuple(orbit(np.array(ends)).at(j) for j in range(3))
        rate, q = rotation_step(rate, q, slopes(k), leader, ends[2] - ends[0])
        epoch, left = divmod(i + 1, 200)
        if left == 0:
            assert np.abs(np.sum(q * found_q[:, epoch], -1)).min() > 1 - 1e-12
            np.testing.assert_allclose(rate, found_rate[:, epoch], atol=1e-9)


@pytest.mark.parametrize("speed", [0.02, 0.3, 1.5])
def test_sensitivities_match_differences(speed):
    """Of slow targets and of such as turn far from one epoch to the next."""
    times, small = np.arange(0.0, 6.0), 1e-6
    q, rate, k = start(1, speed)
    leader = orbit(times)
    centre, _, found = rotation_arc(times, q, rate, k, leader)
    for j in range(8):
        ends = []
        for sign in (1, -1):
            e = np.zeros(8)
            e[j] = sign * small
            moved = quaternion.multiply(quaternion.exp(e[3:6]), q)
            at, spin, _ = rotation_arc(times, moved, rate + e[:3], k + e[6:], leader)
            turn = quaternion.log(quaternion.multiply(at, quaternion.conjugate(centre)))
            ends.append(np.concatenate([spin, turn], axis=-1))
        difference = (ends[0] - ends[1]) / (2 * small)
        scale = np.abs(found[..., j]).max()
        np.testing.assert_allclose(found[..., j], difference, atol=2e-5 * scale)
