"""Verdicts: how a measured figure stands to a published one."""

from enum import StrEnum

import numpy as np


class Verdict(StrEnum):
    """What is said of a cell."""

    REPRODUCED = "reproduced"
    BETTER = "better"
    WORSE = "worse"
    NOT_REPRODUCED = "not reproduced"
    UNPUBLISHED = "unpublished"


SYMBOLS = {
    Verdict.REPRODUCED: "=",
    Verdict.BETTER: "<",
    Verdict.WORSE: ">",
    Verdict.NOT_REPRODUCED: "x",
    Verdict.UNPUBLISHED: "",
}
LEGEND = (
    "= reproduced, < better, > worse than published, x not reproduced (most runs were lost); "
    "(n) runs that diverged or failed, left out"
)


def verdict(measured: float, published: float | None, factor: float, lost: float) -> Verdict:
    """Return the verdict on an error; ``lost`` is the share of runs that diverged or failed."""
    if published is None:
        return Verdict.UNPUBLISHED
    if lost > 0.5 or not np.isfinite(measured):
        return Verdict.NOT_REPRODUCED
    if measured < published / factor:
        return Verdict.BETTER
    return Verdict.WORSE if measured > published * factor else Verdict.REPRODUCED


def interval_meets(
    expected: Verdict, low: float, high: float, published: float, factor: float
) -> bool:
    """Return whether a confidence interval reaches into the band of an expected verdict."""
    return {
        Verdict.REPRODUCED: high >= published / factor and low <= published * factor,
        Verdict.BETTER: low < published / factor,
        Verdict.WORSE: high > published * factor,
    }.get(expected, False)
