"""How a run of a filter can end; the codes of both kinds of filters agree."""

from debrisest.outcome import Outcome


class FilterStatus(Outcome):
    """Of a filter that goes from epoch to epoch."""

    FINISHED = 0, "finished"
    DIVERGED = (
        1,
        "diverged: the state or covariance is not finite; check the initial covariance, "
        "the process noise and the measurements before this epoch",
    )
    NO_START = (
        2,
        "not started: the initial state or covariance is not finite; "
        "the start needs more or better measurements",
    )


class ReplayStatus(Outcome):
    """Of an estimator of a motion that follows from its start."""

    CONVERGED = 0, "converged"
    DIVERGED = (
        1,
        "diverged: the state or its information is not finite; check the prior covariance and the "
        "measurements before this epoch",
    )
    NO_START = (
        2,
        "not started: the prior is not finite; the start needs more or better measurements",
    )
    NOT_CONVERGED = (
        3,
        "not converged: the last replay still promised a decrease of the cost when it was stopped; "
        "more iterations or a better start are needed",
    )
