"""The figures there are: how each is drawn, and from which data.

A new figure is a file with a function from data to a figure, and a line in ``FIGURES``.
"""

from collections.abc import Callable
from typing import NamedTuple

from matplotlib.figure import Figure

from debrisest.arrays import Data
from debrisest.show.plots import (
    body,
    covariance_trace,
    error_over_time,
    error_over_value,
    estimators_over_time,
    histograms,
    motion,
    nees_over_time,
    orbit_error,
    pixel_paths,
    pose_errors,
    rates,
    raw_quaternion,
    recovered_quaternion,
    relative_trajectory,
    scene,
    shape,
    sign_hypotheses,
    target,
    torques,
)
from debrisest.show.plots.gather import Beside


class Kind(NamedTuple):
    """A figure: how it is drawn, from which datasets, and whether of one run or of all runs.

    What it draws of further datasets, such as a truth, is up to the figure. One of all runs is
    given those in ``also`` if there are any, and is drawn of each case by itself if it may be, or
    if the scenario has no means over cases. One of the
    simulation is drawn once for each case, whatever the estimators.
    """

    draw: Callable[[Data, str], Figure]
    needs: tuple[str, ...]
    of_all_runs: bool = False
    of_each_case: bool = False
    of_simulation: bool = False
    also: tuple[str, ...] = ()
    of_estimators: bool = False
    """Of all estimators of a case that have these errors, each named ``quantity/estimator``."""
    of_tables: bool = False
    """Of cells of the tables, of cases that are alike but for one number."""
    beside: Callable[[Data, str, Beside], Figure] | None = None
    """How it is drawn with what the tables have beside its errors, if it shows that."""
    shaded: bool = False
    """Whether it has other colours than those of the style, and more of them."""

    @property
    def of_one_run(self) -> bool:
        """Return whether it shows what an estimator made of one run."""
        return not (self.of_all_runs or self.of_simulation or self.of_estimators or self.of_tables)


FIGURES: dict[str, Kind] = {
    "raw_quaternion": Kind(raw_quaternion.raw_quaternion, ("raw_q_if", "piece")),
    "recovered_quaternion": Kind(
        recovered_quaternion.recovered_quaternion, ("raw_q_if", "q_if", "piece", "sign")
    ),
    "cloud": Kind(body.cloud, body.CLOUD, shaded=True),
    "mesh": Kind(body.mesh, body.MESH, shaded=True),
    "coverage_map": Kind(body.coverage, body.MESH, shaded=True),
    "first_hypotheses": Kind(sign_hypotheses.first_hypotheses, sign_hypotheses.DATASETS),
    "hypothesis_scores": Kind(sign_hypotheses.hypothesis_scores, sign_hypotheses.DATASETS),
    "next_hypotheses": Kind(sign_hypotheses.next_hypotheses, sign_hypotheses.DATASETS),
    "rates": Kind(rates.rates, ("rate_b", "rate_b_sigma", "moments_b")),
    "motion": Kind(motion.motion, motion.DATASETS),
    "error_over_time": Kind(
        error_over_time.error_over_time, error_over_time.QUANTITIES, of_all_runs=True
    ),
    "pose_errors": Kind(pose_errors.pose_errors, pose_errors.DATASETS[:1]),
    "shape": Kind(shape.shape, shape.DATASETS),
    "relative_trajectory": Kind(
        relative_trajectory.relative_trajectory, relative_trajectory.DATASETS
    ),
    "orbit_error": Kind(orbit_error.orbit_error, orbit_error.DATASETS),
    "covariance_trace": Kind(covariance_trace.covariance_trace, ("covariance_trace", "section")),
    "pixel_paths": Kind(
        pixel_paths.pixel_paths,
        ("true_pixel", "section", "image_half_size", "observer"),
        of_simulation=True,
    ),
    "torques": Kind(torques.torques, ("torque", "section", "observer"), of_simulation=True),
    "histograms": Kind(
        histograms.histograms,
        histograms.QUANTITIES[:1],
        of_all_runs=True,
        of_each_case=True,
        also=histograms.QUANTITIES[1:],
        beside=histograms.histograms,
    ),
    "nees_over_time": Kind(
        nees_over_time.nees_over_time,
        ("nees",),
        of_all_runs=True,
        of_each_case=True,
        also=("nees_dof",),
    ),
    "estimators_over_time": Kind(
        estimators_over_time.estimators_over_time,
        estimators_over_time.QUANTITIES,
        of_estimators=True,
    ),
    "scene": Kind(scene.scene, scene.DATASETS, of_simulation=True),
    "error_over_value": Kind(
        error_over_value.error_over_value, error_over_value.COLUMNS, of_tables=True
    ),
    "target": Kind(target.target, target.DATASETS, of_simulation=True),
}
