"""How often 95 % intervals hold the truth, in Markdown: the percentile bootstrap, then ours.

Usage: python scripts/interval_coverage.py [TRIALS]    (600 take 20 s)

Samples of 5, 8, 20 and 100 runs are drawn from laws that errors of runs follow; both intervals are
made of the same samples. An end that a sample cannot give excludes nothing.
"""

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.box import MARKDOWN
from rich.console import Console
from rich.table import Table
from scipy import stats

from debrisest.assessment.intervals import with_interval

RUNS = (5, 8, 20, 100)
RESAMPLES = 1000
SEED = 20
LAWS: dict[str, Any] = {
    "half-normal": stats.halfnorm(),
    "chi (3)": stats.chi(3),
    "gamma (4)": stats.gamma(4),
    "lognormal (0.3)": stats.lognorm(0.3),
    "lognormal (0.6)": stats.lognorm(0.6),
    "exponential": stats.expon(),
}
"""Errors of one axis and of three at an instant, root mean squares over short and long windows,
and two laws with a tail."""


def truth(statistic: str, law: Any) -> float:
    """Return what a statistic over runs estimates."""
    if statistic == "rms":
        return float(np.sqrt(law.var() + law.mean() ** 2))
    return float(law.median() if statistic == "median" else law.mean())


def over_runs(statistic: str, figures: NDArray[Any]) -> NDArray[Any]:
    """Return a statistic over the last axis."""
    if statistic == "rms":
        return np.asarray(np.sqrt(np.mean(figures**2, axis=-1)))
    return np.asarray((np.median if statistic == "median" else np.mean)(figures, axis=-1))


def bootstrap(statistic: str, figures: NDArray[Any], rng: np.random.Generator) -> NDArray[Any]:
    """Return the ends of the percentile interval of one sample (run,)."""
    drawn = figures[rng.integers(len(figures), size=(RESAMPLES, len(figures)))]
    return np.asarray(np.quantile(over_runs(statistic, drawn), (0.025, 0.975)))


def coverage(
    statistic: str, law: Any, runs: int, trials: int, seed: int = SEED
) -> tuple[float, float]:
    """Return the shares of samples whose bootstrap, and whose interval, holds the truth."""
    rng = np.random.default_rng((seed, runs))
    samples = law.rvs(size=(trials, runs), random_state=rng)
    before = np.array([bootstrap(statistic, sample, rng) for sample in samples])
    name = {"mean": "rmse"}.get(statistic, statistic)
    after = np.array([with_interval(name, [sample])[1:] for sample in samples])
    value = truth(statistic, law)
    held = [~(ends[:, 0] > value) & ~(ends[:, 1] < value) for ends in (before, after)]
    return float(np.mean(held[0])), float(np.mean(held[1]))


def table(trials: int) -> Table:
    """Return a row for each statistic and law, with both shares in per cent."""
    heads = ("statistic", "law", *(f"{runs} runs" for runs in RUNS))
    shown = Table(*heads, box=MARKDOWN)
    for statistic in ("mean", "median", "rms"):
        for name, law in LAWS.items():
            pairs = (coverage(statistic, law, runs, trials) for runs in RUNS)
            cells = (f"{100 * before:.0f} → {100 * after:.0f}" for before, after in pairs)
            shown.add_row(statistic, name, *cells)
    return shown


if __name__ == "__main__":
    Console(width=110).print(table(int(sys.argv[1]) if len(sys.argv) > 1 else 600))
