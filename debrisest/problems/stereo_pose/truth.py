"""True states and first guesses of the stereo pose problem without a scenario.

For tests and benchmarks of the model; a scenario has `debrisest.parts.truth.seen_from_leader` and
`debrisest.parts.starts.drawn_pose`.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.dynamics import kepler
from debrisest.dynamics.relative_orbit import leader_orbit
from debrisest.dynamics.relative_pose import exact_rotation, exact_translation
from debrisest.problems.stereo_pose.model import POSITION, RATE, VELOCITY, K, Q


def simulate_truth(
    times: Array,
    start: Array,
    semi_major_axis: float,
    eccentricity: float,
    true_anomaly: float,
) -> Array:
    """Return the true states ``(run, time, n)`` from those at time zero ``(run, n)``, in SI units.

    Closed forms throughout (see `debrisest.dynamics.relative_pose`); ``true_anomaly``, rad, is the
    leader's at time zero. The paper does not print it; zero (the perigee) is what turns its
    initial rates into round rates of the target about its own axes.
    """
    orbit = (semi_major_axis, eccentricity)
    leader = leader_orbit(times, *orbit, true_anomaly)
    leader_state = kepler.state_from_elements(*orbit, 0.0, 0.0, 0.0, true_anomaly)
    states = np.repeat(start[:, None], len(times), axis=1)
    states[..., POSITION], states[..., VELOCITY] = exact_translation(
        times, start[:, POSITION], start[:, VELOCITY], leader_state
    )
    states[..., Q], states[..., RATE] = exact_rotation(
        times, start[:, Q], start[:, RATE], start[:, K], leader
    )
    return states


def draw_guess(start: Array, variance: Array, normal: Array) -> Array:
    """Return first guesses ``(run, n)``: the true states plus Gaussian errors.

    ``variance`` and the standard normal draws ``normal`` are ``(..., n)``, additive in every
    component; the quaternion is then scaled to unit norm, which leaves an attitude error of four
    times the variance per axis, rad^2.
    """
    guess = start + np.sqrt(variance) * normal
    guess[..., Q] = quaternion.normalize(guess[..., Q])
    return np.asarray(guess)
