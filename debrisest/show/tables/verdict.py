"""Verdicts: how a measured figure stands to a published one, or to its own covariance."""

from enum import StrEnum

import numpy as np


class Verdict(StrEnum):
    """What is said of a cell: beside a published value, or of a consistency without one."""

    REPRODUCED = "reproduced"
    BETTER = "better"
    WORSE = "worse"
    NOT_REPRODUCED = "not reproduced"
    UNPUBLISHED = "unpublished"
    CONSISTENT = "consistent"
    OVER_CONFIDENT = "over-confident"
    OVER_CAUTIOUS = "over-cautious"
    NOT_THE_MINIMUM = "not the minimum"


CONSISTENCY = (
    *(Verdict.CONSISTENT, Verdict.OVER_CONFIDENT),
    *(Verdict.OVER_CAUTIOUS, Verdict.NOT_THE_MINIMUM),
)
SYMBOLS = {
    Verdict.REPRODUCED: "=",
    Verdict.BETTER: "<",
    Verdict.WORSE: ">",
    Verdict.NOT_REPRODUCED: "x",
    Verdict.UNPUBLISHED: "",
    **{said: str(said) for said in CONSISTENCY},
}
LEGEND = "= reproduced, < better, > worse than published, x not reproduced (most runs were lost)"
LEGEND_OF_LOST = "(n) runs that diverged or failed, left out: debrisest status says why"
LEGEND_OF_INTERVALS = "[low, high] 95 % interval over the runs"
LEGEND_OF_RATIOS = "×n times the bound"
LEGEND_OF_BELOW = (
    "×n? the interval lies below the bound: too few runs, or a bound with another prior or model "
    "than this estimator's"
)
LEGEND_OF_NO_BOUND = "without ×n: there is no bound of this estimator's own model"
LEGEND_OF_CONSISTENCY = (
    "consistent: within the 95 % chi-square interval of the runs used; over-confident: above it, "
    "the errors are larger than the covariance says; over-cautious: below it; not the minimum: the "
    "same of w, the truth fits the data better than a minimum of the cost can be worse by chance"
)


def verdict(measured: float, published: float, factor: float, lost: float) -> Verdict:
    """Return the verdict on an error; ``lost`` is the share of runs that diverged or failed."""
    if lost > 0.5 or not np.isfinite(measured):
        return Verdict.NOT_REPRODUCED
    if measured < published / factor:
        return Verdict.BETTER
    return Verdict.WORSE if measured > published * factor else Verdict.REPRODUCED


def consistency(
    measured: float, low: float, high: float, lost: float, of_costs: bool = False
) -> Verdict:
    """Return the verdict on a normalised square per dimension, ``low`` to ``high`` if consistent.

    Of a difference ``of_costs`` a small value is no caution: the estimate is not the minimum.

    Without a figure, or an interval to judge it by, there is nothing to say, nor is there of an
    estimator that lost most of its runs, of which those that are left are no sample.
    """
    if lost > 0.5 or not np.isfinite([measured, low, high]).all():
        return Verdict.UNPUBLISHED
    if measured > high:
        return Verdict.OVER_CONFIDENT
    if measured < low:
        return Verdict.NOT_THE_MINIMUM if of_costs else Verdict.OVER_CAUTIOUS
    return Verdict.CONSISTENT


def interval_agrees(
    expected: Verdict, interval: tuple[float, float], consistent: tuple[float, float]
) -> bool:
    """Return whether a confidence interval reaches to where an expected word of consistency is."""
    (low, high), (least, most) = interval, consistent
    return {
        Verdict.CONSISTENT: high >= least and low <= most,
        Verdict.OVER_CONFIDENT: high > most,
        Verdict.OVER_CAUTIOUS: low < least,
        Verdict.NOT_THE_MINIMUM: low < least,
    }.get(expected, False)


def interval_meets(
    expected: Verdict, low: float, high: float, published: float, factor: float
) -> bool:
    """Return whether a confidence interval reaches into the band of an expected verdict.

    An end that is NaN reaches nowhere: without an interval only the measured figure counts.
    """
    return {
        Verdict.REPRODUCED: high >= published / factor and low <= published * factor,
        Verdict.BETTER: low < published / factor,
        Verdict.WORSE: high > published * factor,
    }.get(expected, False)
