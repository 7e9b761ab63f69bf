"""A model of constants for the replay filter."""

import numpy as np

from debrisest.filters.replay_model import ReplayModel


def constants(rows, sigma, names, start=lambda prior, shown, epoch: prior, **more):
    """Constants that are measured at every epoch by ``rows``, with `more` fields of a model."""
    n = len(names)

    def identity(state):
        return np.broadcast_to(np.eye(n), (len(state), n, n))

    def trajectory(state, first, last):
        epochs = abs(last - first) + 1
        unity = np.broadcast_to(np.eye(n), (len(state), epochs, n, n))
        return np.repeat(state[:, None], epochs, 1), unity

    return ReplayModel(
        trajectory=trajectory,
        rows=rows,
        transition=lambda sensitivity, first, last: identity(sensitivity),
        rewind=lambda state, epoch: state,
        chart=identity,
        inverse_chart=identity,
        retract=lambda state, error: state + error,
        difference=lambda state, reference: state - reference,
        plain_difference=lambda state, reference: state - reference,
        start=start,
        sigma=sigma,
        error_names=names,
        **more,
    )
