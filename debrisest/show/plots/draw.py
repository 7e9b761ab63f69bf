"""The figures there are, and how all that a scenario's results allow are written.

A new figure is a file with a function from data to a figure, and a line in ``FIGURES``.
"""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure

from debrisest.arrays import Data
from debrisest.errors import UserError
from debrisest.results.assessed import Assessed, assessed
from debrisest.results.open import find_results
from debrisest.results.status import Wanted, up_to_date
from debrisest.scenario.load import LoadedScenario
from debrisest.show.plots import (
    body,
    covariance_trace,
    error_over_time,
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
    shape,
    torques,
)
from debrisest.show.plots.files import write
from debrisest.show.plots.gather import Source, all_runs, simulations, single_runs


class Kind(NamedTuple):
    """A figure: how it is drawn, from which datasets, and whether of one run or of all runs.

    What it draws of further datasets, such as a truth, is up to the figure. One of all runs is
    given those in ``also`` if there are any, and may be drawn of each case by itself. One of the
    simulation is drawn once for each case, whatever the estimators.
    """

    draw: Callable[[Data, str], Figure]
    needs: tuple[str, ...]
    of_all_runs: bool = False
    of_each_case: bool = False
    of_simulation: bool = False
    also: tuple[str, ...] = ()


FIGURES: dict[str, Kind] = {
    "raw_quaternion": Kind(raw_quaternion.raw_quaternion, ("raw_q_if", "piece")),
    "recovered_quaternion": Kind(
        recovered_quaternion.recovered_quaternion, ("raw_q_if", "q_if", "piece", "sign")
    ),
    "cloud": Kind(body.cloud, body.CLOUD),
    "mesh": Kind(body.mesh, body.MESH),
    "coverage_map": Kind(body.coverage, body.MESH),
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
    ),
    "nees_over_time": Kind(
        nees_over_time.nees_over_time,
        ("nees",),
        of_all_runs=True,
        of_each_case=True,
        also=("nees_dof",),
    ),
}


def draw_all(scenario: LoadedScenario, out: Path, wanted: Sequence[Wanted]) -> Iterator[Path]:
    """Draw what the results that are up to date allow; yield each file once it is written."""
    folder = out / scenario.name / "plots"
    drawn = False
    for name, source in _sources(scenario, out, wanted):
        figure = FIGURES[name].draw(source.data, source.context)
        for path in write(figure, folder, "-".join((name, *source.names))):
            drawn = True
            yield path
    if not drawn:
        raise UserError(
            f"{scenario.name}: no results that are up to date to draw; "
            f"run: debrisest sweep {scenario.path}"
        )


def _sources(
    scenario: LoadedScenario, out: Path, wanted: Sequence[Wanted]
) -> Iterator[tuple[str, Source]]:
    """Return every figure that can be drawn, with its data."""
    there = find_results(out / scenario.name)
    results = up_to_date(there, wanted)
    errors = assessed(up_to_date(there, wanted, complete=True))
    of_one_run = {n: k for n, k in FIGURES.items() if not (k.of_all_runs or k.of_simulation)}
    of_simulation = {name: kind for name, kind in FIGURES.items() if kind.of_simulation}
    for source in single_runs(scenario, results, errors):
        yield from ((name, source) for name in _suiting(of_one_run, source))
    for source in simulations(scenario, results):
        yield from ((name, source) for name in _suiting(of_simulation, source))
    for name, kind in FIGURES.items():
        if kind.of_all_runs:
            yield from ((name, source) for source in _of_all_runs(scenario, errors, kind))


def _suiting(figures: dict[str, Kind], source: Source) -> list[str]:
    """Return the figures whose datasets are all there."""
    return [name for name, kind in figures.items() if set(kind.needs) <= set(source.data)]


def _of_all_runs(scenario: LoadedScenario, results: Assessed, kind: Kind) -> Iterator[Source]:
    """Return all runs of an estimator: of all cases, or of each case by itself."""
    if not kind.of_each_case:
        yield from all_runs(scenario, results, kind.needs)
        return
    for (case, estimator), result in results.items():
        quantities = [*kind.needs, *(name for name in kind.also if name in result.errors)]
        for source in all_runs(scenario, {(case, estimator): result}, quantities):
            context = source.context.replace("1 case,", f"case {case},", 1)
            yield source._replace(names=(case, estimator), context=context)
