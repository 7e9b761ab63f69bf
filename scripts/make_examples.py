"""Write the example tracks and poses of configs/examples, and their truth for the tests.

Usage: python scripts/make_examples.py

The motion is integrated here, by a general integrator and from Euler's equations, so that nothing
of what the estimators believe goes into what they are tested on. Both bodies, their motions and
their noise are none of the published cases.
"""

from pathlib import Path

import numpy as np
import pandas as pd
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

ROOT = Path(__file__).resolve().parent.parent
EXAMPLES = ROOT / "configs" / "examples"
TRUTH = ROOT / "tests" / "examples"

CORNERS = {
    "bus_1": [0.9, 0.6, 0.7], "bus_2": [-0.9, 0.6, 0.7], "bus_3": [-0.9, -0.6, 0.7],
    "bus_4": [0.9, -0.6, 0.7], "bus_5": [0.9, 0.6, -0.7], "bus_6": [-0.9, -0.6, -0.7],
    "panel_1": [0.1, 2.4, 0.3], "panel_2": [-0.4, 2.4, -0.2], "antenna": [0.2, -0.1, 1.5],
}  # fmt: skip
"""From the centre of mass, m; the surface at each faces away from the centre."""


def tumble(times, moments, rate, q_xyzw):
    """Return attitudes (body to inertial) and body rates of a torque-free body at the times."""

    def derivative(_, state):
        q, w = state[:4], state[4:]
        turn = np.array([*(q[3] * w + np.cross(q[:3], w)), -q[:3] @ w]) / 2
        return [*turn, *(np.cross(moments * w, w) / moments)]

    start = [*q_xyzw, *rate]
    found = solve_ivp(
        derivative, (0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-12
    ).y.T
    return Rotation.from_quat(found[:, :4]), found[:, 4:]


def uneven_times(rng, count, step, gap):
    """Return times with a jitter of a fifth of the step, and a gap (from, to) without any."""
    times = np.round(step * (np.arange(count) + 0.2 * rng.uniform(-1, 1, count)), 3)
    times = np.round(times - times[0], 3)
    return times[(times < gap[0]) | (times > gap[1])]


def tracks(rng):
    """Write points that come and go, at uneven times, with a gap and one wrong match."""
    times = uneven_times(rng, 260, 1.6, (150.0, 195.0))
    moments = np.array([1.0, 1.55, 2.05])
    attitude, rate = tumble(times, moments, np.radians([2.1, 0.8, 2.6]), [0.1, -0.4, 0.2, 0.889])
    names, points = list(CORNERS), np.array(list(CORNERS.values()))
    drift = np.array([1.0, 22.0, -2.0]) + times[:, None] * np.array([0.004, -0.002, 0.001])
    at = drift[:, None] + np.einsum("kij,nj->kni", attitude.as_matrix(), points)
    facing = ((at - drift[:, None]) * at).sum(-1) < 0.15 * np.linalg.norm(at, axis=-1)
    seen = facing & (rng.uniform(size=facing.shape) > 0.1)
    measured = np.round(at + 0.03 * rng.standard_normal(at.shape), 4)
    epoch, feature = np.nonzero(seen)
    rows = pd.DataFrame(measured[epoch, feature], columns=["x_m", "y_m", "z_m"])
    rows.insert(0, "time_s", times[epoch])
    rows.insert(1, "feature", np.array(names)[feature])
    wrong = int(np.flatnonzero((rows["feature"] == "bus_4") & (rows["time_s"] > 60))[0])
    rows.loc[wrong, ["x_m", "y_m", "z_m"]] = measured[epoch[wrong], names.index("bus_1")]
    rows["sigma_m"] = 0.03
    rows.to_csv(EXAMPLES / "tracks.csv", index=False, lineterminator="\n")
    write_truth("tracks", times, attitude, rate, moments)


def poses(rng):
    """Write attitudes and positions as a pose network gives them, 1.5 deg off, at uneven times."""
    times = uneven_times(rng, 320, 2.0, (300.0, 330.0))
    moments = np.array([0.8, 1.0, 1.35])
    attitude, rate = tumble(times, moments, np.radians([0.7, 2.4, 0.5]), [0.3, 0.1, -0.2, 0.927])
    sigma = 1.5
    off = Rotation.from_rotvec(np.radians(sigma) * rng.standard_normal((len(times), 3)))
    q = (attitude * off).as_quat(scalar_first=True)
    position = np.array([0.5, -0.3, 9.0]) + np.outer(times, [1e-3, 2e-3, -4e-3])
    position += 0.02 * rng.standard_normal(position.shape)
    columns = ["time_s", "q0", "q1", "q2", "q3", "x_m", "y_m", "z_m"]
    rows = pd.DataFrame(np.column_stack([times, np.round(q, 6), np.round(position, 4)]))
    rows.columns = columns
    rows["sigma_deg"] = sigma
    rows.to_csv(EXAMPLES / "poses.csv", index=False, lineterminator="\n")
    write_truth("poses", times, attitude, rate, moments)


def write_truth(name, times, attitude, rate, moments):
    """Write what the tests compare with: attitude, body rate, moments."""
    columns = np.column_stack([times, attitude.as_quat(scalar_first=True), rate])
    truth = pd.DataFrame(columns, columns=["time_s", "q0", "q1", "q2", "q3", "w1", "w2", "w3"])
    for axis, moment in enumerate(moments, 1):
        truth[f"moment_{axis}"] = moment
    TRUTH.mkdir(parents=True, exist_ok=True)
    truth.to_csv(TRUTH / f"{name}_truth.csv", index=False, lineterminator="\n", float_format="%.9g")


if __name__ == "__main__":
    EXAMPLES.mkdir(parents=True, exist_ok=True)
    tracks(np.random.default_rng(20))
    poses(np.random.default_rng(21))
