"""How often the batch estimate is right, and whether it knows it: random targets, a table.

    python scripts/batch_statistics.py [--runs 100] [--seed 0] [--cost] [SERIES ...]

A run is *right* where attitude and rate are within five of their own sigmas at all epochs (a
chi-square of three degrees of freedom), and *wrong* where the estimate is accepted and is not.
"""

import argparse
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import yaml

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.attitude.quaternion import conjugate
from debrisest.batch.descent import PRIOR_SIGMA
from debrisest.batch.estimate import estimate_from_points
from debrisest.batch.motion import Motion, Status
from debrisest.batch.observability import LOST, inertia_directions
from debrisest.dynamics import log_inertia
from debrisest.dynamics.torque_free import torque_free

FIVE_SIGMA = 31.8  # chi-square of three that a Gaussian exceeds as often as five sigma
ORBIT_RATE = 1.04e-3  # rad/s, at 800 km
SERIES = ("known", "unknown", "no sigma", "wrong matches", "biased")
CASES = "configs/biondi2017.yaml"


class Target(NamedTuple):
    """A tumbling body and what is seen of it; ``p`` are principal axes, ``f`` the points'."""

    times: Array
    q0: Array
    """``q_ip`` at time zero."""
    rate0_p: Array
    moments: Array
    q_pf: Array
    model: Array
    points: Array
    sigma: float
    kind: str

    def at(self, times: Array) -> tuple[Array, Array]:
        """Return the true ``q_if (time, 4)`` and rate in ``f (time, 3)``."""
        q, rate = torque_free(times, self.q0, self.rate0_p, self.moments)
        back = quaternion.conjugate(self.q_pf)
        return quaternion.multiply(q, self.q_pf), quaternion.rotate(back, rate)

    def inertia(self) -> Array:
        """Return the true inertia (3, 3) in ``f``."""
        axes = quaternion.to_matrix(self.q_pf)
        return axes.T @ np.diag(self.moments) @ axes

    @property
    def startable(self) -> bool:
        """Whether enough epochs ever show three points that are not in line."""
        seen = np.isfinite(self.points[..., 0])
        wide = 0
        for shown in seen[seen.sum(axis=1) >= 3]:
            spread = self.model[shown] - self.model[shown].mean(axis=0)
            wide += np.linalg.svd(spread, compute_uv=False)[1] > 2 * self.sigma
        return bool(wide >= 6)


def draw(rng: np.random.Generator) -> Target:
    """Return a body of random shape, spin, points and noise, on a hold point or drifting."""
    kind, moments = draw_moments(rng)
    times = np.arange(float(rng.integers(300, 1500)))
    rate0 = rng.normal(size=3)
    rate0 *= np.radians(np.exp(rng.uniform(np.log(0.2), np.log(20.0)))) / np.linalg.norm(rate0)
    if rng.uniform() < 0.1:
        kind, rate0 = "spin", np.linalg.norm(rate0) * rng.permutation(np.eye(3)[0])
    q0, q_pf = quaternion.normalize(rng.normal(size=(2, 4)))
    half = np.exp(rng.uniform(np.log(0.63), np.log(6.3), 3))
    model, normals = draw_points(rng, half)
    sigma = float(np.exp(rng.uniform(np.log(0.01), np.log(0.1))))
    target = Target(times, q0, rate0, moments, q_pf, model, np.empty(0), sigma, kind)
    observer = 30.0 * line_of_sight(times, bool(rng.integers(2)))
    return target._replace(points=seen_from(observer, target, normals, rng))


def draw_moments(rng: np.random.Generator) -> tuple[str, Array]:
    """Return moments of a general, nearly symmetric, axisymmetric or nearly spherical body."""
    x, y, z = rng.uniform(0.05, 1.0, 3)
    chance = rng.uniform()
    if chance < 0.6:
        kind = "general"
    elif chance < 0.8:
        kind, y = "near symmetric", x * (1.0 + 10.0 ** rng.uniform(-3.0, -1.0))
    elif chance < 0.95:
        kind, y = "axisymmetric", x
    else:
        kind, (x, y, z) = "sphere", 1.0 + 1e-3 * rng.normal(size=3)
    return kind, rng.permutation(np.array([y + z, z + x, x + y]))


def draw_points(rng: np.random.Generator, half: Array) -> tuple[Array, Array]:
    """Return 4 to 12 points on the faces of a box, and outward normals."""
    count = int(rng.integers(4, 13))
    points = rng.uniform(-1.0, 1.0, (count, 3))
    normals = np.zeros((count, 3))
    face, side = rng.integers(3, size=count), rng.choice([-1.0, 1.0], count)
    normals[range(count), face] = points[range(count), face] = side
    return points * half, normals


def line_of_sight(times: Array, drift: bool) -> Array:
    """Return directions (time, 3) from the target to a chaser ahead of it, or on an ellipse."""
    turn = ORBIT_RATE * times
    ahead = np.stack([-np.sin(turn), np.cos(turn), 0.0 * turn], axis=-1)
    if drift:
        out = np.stack([np.cos(turn), np.sin(turn), 0.0 * turn], axis=-1)
        ahead = ahead + 0.2 * np.sin(turn)[:, None] * out + 0.1 * np.cos(turn)[:, None]
    return ahead / np.linalg.norm(ahead, axis=-1, keepdims=True)


def of_case(name: str, seed: int) -> Target:
    """Return the target of a case of the published scenario, seen from a hold point."""
    scenario = yaml.safe_load((Path(__file__).parents[1] / CASES).read_text())
    case = scenario["cases"][name]
    points = scenario["target"]["points"].values()
    model = np.array([point["position_m"] for point in points], dtype=float)
    normals = np.array([point["normal"] for point in points], dtype=float)
    moments = np.array(case["target"]["inertia_kg_m2"], dtype=float)
    target = Target(
        times=np.arange(float(scenario["duration_s"])),
        q0=np.array([1.0, 0.0, 0.0, 0.0]),
        rate0_p=np.radians(case["motion"]["rate_deg_s"]),
        moments=moments,
        q_pf=np.array([1.0, 0.0, 0.0, 0.0]),
        model=model,
        points=np.empty(0),
        sigma=scenario["sensors"]["points"]["noise_m"],
        kind=f"case {name}",
    )
    observer = 30.0 * line_of_sight(target.times, False)
    return target._replace(points=seen_from(observer, target, normals, seed))


def seen_from(
    observer: Array, target: Target, normals: Array, seed: int | np.random.Generator
) -> Array:
    """Return noisy points (time, feature, 3) relative to the observer, NaN where turned away."""
    q, _ = target.at(target.times)
    turned = quaternion.rotate(q[:, None], target.model)
    outward = quaternion.rotate(q[:, None], normals)
    seen = np.sum((observer[:, None] - turned) * outward, axis=-1) > 0.0
    noise = target.sigma * np.random.default_rng(seed).normal(size=turned.shape)
    return np.where(seen[..., None], turned - observer[:, None] + noise, np.nan)


def report_cases(seeds: int) -> None:
    """Print errors over sigmas of the ten published cases; the sigmas are the bound's."""
    for name in map(str, range(1, 11)):
        ratios, excess, squared, accepted = [], [], [], 0
        for seed in range(seeds):
            target = of_case(name, seed)
            motion = estimate(target, "known")
            accepted += motion.status.accepted
            q, rate = target.at(target.times)
            turn = quaternion.log(quaternion.multiply(motion.path.q, conjugate(q)))
            bound = np.trace(motion.path.turn_covariance, axis1=-2, axis2=-1).mean()
            ratios.append(np.sqrt(np.mean(np.sum(turn**2, axis=-1)) / bound))
            excess.append(motion.fit.excess if motion.fit else np.nan)
            middle = len(rate) // 2
            error = turn[middle], motion.path.rate[middle] - rate[middle]
            spreads = motion.path.turn_covariance[middle], motion.path.rate_covariance[middle]
            squared.append(sum(e @ np.linalg.solve(c, e) for e, c in zip(error, spreads)) / 6.0)
        print(
            f"case {name:>2s}  accepted {accepted}/{seeds}  attitude over bound "
            f"{np.mean(ratios):.2f}, at most {np.max(ratios):.2f}  chi2/dof {np.mean(excess):.3f}  "
            f"normalised square of attitude and rate {np.mean(squared):.2f}",
            flush=True,
        )


def spoiled(target: Target, series: str, rng: np.random.Generator) -> Target:
    """Return the target with wrong matches, or a wrong model, as the series says."""
    if series == "biased":
        step = rng.normal(size=3)
        model = target.model.copy()
        model[rng.integers(len(model))] += 0.2 * step / np.linalg.norm(step)
        return target._replace(model=model)
    if series != "wrong matches":
        return target
    points = target.points.copy()
    seen = np.isfinite(points[..., 0])
    shift = rng.uniform(1.0, 5.0, seen.shape)[..., None] * random_directions(rng, seen.shape)
    wrong = rng.uniform(size=seen.shape) < 0.05
    return target._replace(points=np.where(wrong[..., None], points + shift, points))


def random_directions(rng: np.random.Generator, shape: tuple[int, ...]) -> Array:
    """Return unit vectors (*shape, 3)."""
    vectors = rng.normal(size=(*shape, 3))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def estimate(target: Target, series: str) -> Motion:
    """Return the estimate with what the series makes known."""
    sigma = None if series == "no sigma" else target.sigma
    model = None if series == "unknown" else target.model
    return estimate_from_points(target.times, target.points, sigma, model)


class Verdict(NamedTuple):
    """What became of one target."""

    status: Status
    startable: bool
    largest: float
    """Largest normalised square of attitude and rate over all epochs, over `FIVE_SIGMA`."""
    inertia: float
    """Largest error of an observable direction of the inertia, over five sigma."""
    seconds: float
    kept: float
    """Share of the points."""

    @property
    def right(self) -> bool:
        """Whether everything is within five sigma."""
        return self.largest < 1.0 and self.inertia < 1.0


def verdict(target: Target, series: str) -> Verdict:
    """Return how the estimate of a target compares with the truth."""
    begin = time.process_time()
    motion = estimate(target, series)
    seconds = time.process_time() - begin
    turn = to_true_axes(motion, target)
    q, rate = target.at(target.times)
    path = motion.path
    error = quaternion.log(quaternion.multiply(quaternion.multiply(path.q, turn), conjugate(q)))
    rate_error = path.rate - quaternion.rotate(turn, rate)
    largest = max(
        np.nanmax(squares(error, path.turn_covariance), initial=0.0),
        np.nanmax(squares(rate_error, path.rate_covariance), initial=0.0),
    )
    startable = target.startable
    inertia = inertia_error(motion, target, turn)
    kept = float(np.mean(motion.kept))
    return Verdict(motion.status, startable, largest / FIVE_SIGMA, inertia, seconds, kept)


def to_true_axes(motion: Motion, target: Target) -> Array:
    """Return the turn from the true feature frame to the estimate's, exact at the arc's epoch."""
    if not (motion.evidence is not None and motion.evidence.unknowns_fixed):
        return np.array([1.0, 0.0, 0.0, 0.0])
    if motion.arc is None:
        return np.full(4, np.nan)
    q, _ = target.at(np.array([motion.arc.epoch]))
    return quaternion.multiply(conjugate(motion.arc.q), q[0])


def inertia_error(motion: Motion, target: Target, turn: Array) -> float:
    """Return the largest error of the inertia in observable directions, over five sigma."""
    if motion.arc is None:
        return 0.0
    axes = quaternion.to_matrix(turn)
    true = log_inertia.log_ratios(axes @ target.inertia() @ axes.T)
    sigma, directions = inertia_directions(motion.claimed)
    error = np.abs(directions.T @ (motion.arc.log_inertia - true)) / sigma
    shown = sigma < LOST * PRIOR_SIGMA
    return float(error.max(initial=0.0, where=shown)) / 5.0


def squares(error: Array, covariance: Array) -> Array:
    """Return normalised squares (time,), with a floor for directions that are exact."""
    floor = 1e-9 * np.trace(covariance, axis1=-2, axis2=-1)[:, None, None] + 1e-16
    known = np.isfinite(covariance[:, 0, 0])
    result = np.full(len(error), np.nan)
    spread = (covariance + floor * np.eye(3))[known]
    solved = np.linalg.solve(spread, error[known, :, None])[..., 0]
    result[known] = np.sum(solved * error[known], axis=-1)
    return result


def report(series: str, runs: int, seed: int) -> None:
    """Print one line of the table, and a line for each run that is accepted and wrong."""
    found = []
    for run in range(runs):
        rng = np.random.default_rng([seed, run])
        target = spoiled(draw(rng), series, rng)
        one = verdict(target, series)
        found.append(one)
        if one.status.accepted and not one.right:
            print(
                f"  run {run}: {one.status.name}, {target.kind}, {len(target.model)} points, "
                f"attitude and rate {one.largest:.2f}, inertia {one.inertia:.2f} of the limit"
            )
        elif one.startable and not one.status.accepted:
            print(f"  run {run}: {one.status.name}, {target.kind}, {len(target.model)} points")
    able = [one for one in found if one.startable]
    right = sum(one.status.accepted and one.right for one in able)
    wrong = sum(one.status.accepted and not one.right for one in found)
    dishonest = sum(not one.status.accepted and not one.right for one in found)
    seconds = np.array([one.seconds for one in found])
    print(
        f"{series:14s} startable {len(able):4d}  accepted and right {right:4d} "
        f"({100 * right / max(len(able), 1):5.1f} %)  accepted and wrong {wrong:3d}  "
        f"not accepted, outside its sigmas {dishonest:3d}  "
        f"CPU {seconds.mean():.2f} s, at most {seconds.max():.1f} s",
        flush=True,
    )


def of_size(epochs: int, count: int) -> Target:
    """Return the first published case with so many epochs and points, on a sphere of 2 m."""
    rng = np.random.default_rng(0)
    normals = random_directions(rng, (count,))
    target = of_case("1", 0)._replace(times=np.arange(float(epochs)), model=2.0 * normals)
    observer = 30.0 * line_of_sight(target.times, False)
    return target._replace(points=seen_from(observer, target, normals, 0))


def report_cost() -> None:
    """Print CPU seconds over numbers of epochs and of points."""
    sizes = [(n, 8) for n in (100, 300, 1000, 3000, 10000)]
    for epochs, count in [*sizes, *((1500, c) for c in (6, 20, 60, 200, 500))]:
        target, spent = of_size(epochs, count), []
        for series in ("known", "unknown"):
            begin = time.process_time()
            status = estimate(target, series).status
            spent.append(f"{series} {time.process_time() - begin:.2f} s ({status.name})")
        print(f"{epochs:6d} epochs, {count:4d} points: CPU {', '.join(spent)}", flush=True)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("series", nargs="*", default=SERIES)
    parser.add_argument("--runs", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--cases", type=int, default=2, help="seeds of each published case")
    parser.add_argument("--cost", action="store_true", help="CPU over epochs and points, no more")
    given = parser.parse_args()
    if given.cost:
        report_cost()
        return
    if given.cases:
        report_cases(given.cases)
    for series in given.series:
        report(series, given.runs, given.seed)


if __name__ == "__main__":
    main()
