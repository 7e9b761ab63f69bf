"""One bad run is an outcome of that run, and of no other."""

from functools import partial

import numpy as np
import pytest

from debrisest.filters.gate import Gate
from debrisest.filters.kalman.extended import extended
from debrisest.filters.model import Model
from debrisest.filters.status import FilterStatus
from tests.filters.spoiled import (
    BAD,
    CAUSES,
    EPOCHS,
    RUNS,
    assert_divergence_stays_in_its_run,
    assert_no_run_depends_on_another,
    assert_wrong_shapes_are_refused,
    cubic_model,
    problem,
)

RULES = [{}, {"iterations": 8}, {"iterations": 8, "stop": "relative_norm", "tolerance": 1e-6}]


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("cause", CAUSES)
def test_divergence_stays_in_its_run(cause, rule):
    assert_divergence_stays_in_its_run(partial(extended, cubic_model(), **rule), cause)


def test_a_gate_keeps_an_infinite_measurement_out():
    start, covariance, y = problem()
    y[BAD, 7] = np.inf
    gate = Gate(lockout_epochs=EPOCHS)
    infinite = extended(cubic_model(), start, covariance, y, gate=gate)
    y[BAD, 7] = np.nan
    missing = extended(cubic_model(), start, covariance, y, gate=gate)
    assert np.array_equal(infinite.state, missing.state)
    assert (infinite.status == FilterStatus.FINISHED.sentence).all()
    assert infinite.counts["rejected"].sum() == missing.counts["rejected"].sum() + 1


@pytest.mark.parametrize("rule", [*RULES, {"iterations": 8, "gate": Gate(0.1, 0.5, 1)}])
def test_a_run_does_not_depend_on_its_neighbours(rule):
    start, covariance, y = problem()
    y[3, 5:] += 4.0
    filtered = partial(extended, cubic_model(), **rule)
    together = assert_no_run_depends_on_another(filtered, (start, covariance, y))
    assert "iterations" not in rule or np.ptp(together.counts["updates"], axis=0).any()
    assert "gate" not in rule or (
        together.counts["reopened"][3] > 0 and np.ptp(together.counts["reopened"]) > 0
    )


def test_a_model_of_some_runs_is_asked_for():
    """Each run has a sensor of its own, and runs stop iterating, or diverge, one by one."""
    rng = np.random.default_rng(0)
    place = rng.normal(5, 2, size=(RUNS, 1, 2))

    def model(place):
        return Model(
            process=lambda x, _: 0.9 * x,
            measurement=lambda x, _: np.linalg.norm(x - place, axis=-1, keepdims=True),
            process_noise=0.1 * np.eye(2),
            measurement_noise=0.01 * np.eye(1),
            error_names=("x", "y"),
            select=lambda runs: model(place[runs]),
        )

    start, covariance = np.zeros((RUNS, 2)), np.stack([np.eye(2)] * RUNS)
    y = rng.normal(6, 0.5, size=(RUNS, EPOCHS, 1))
    y[BAD, 5] = np.inf
    together = extended(model(place), start, covariance, y, iterations=8)
    for run in range(RUNS):
        one = slice(run, run + 1)
        alone = extended(model(place[one]), start[one], covariance[one], y[one], iterations=8)
        assert np.array_equal(alone.state[0], together.state[run], equal_nan=True)
        assert np.array_equal(alone.counts["updates"][0], together.counts["updates"][run])


def test_a_component_known_exactly_stays_so():
    """A zero variance is no reason to fail."""
    start, covariance, y = problem()
    covariance[:, 1] = covariance[:, :, 1] = 0.0
    model = cubic_model()._replace(
        process=lambda x, _: x, process_noise=np.diag([1e-3, 0.0]), measurement_noise=np.eye(1)
    )
    history = extended(model, start, covariance, y, iterations=8)
    assert (history.status == FilterStatus.FINISHED.sentence).all()
    assert np.array_equal(history.state[..., 1], np.repeat(start[:, 1:], EPOCHS, axis=1))
    assert not history.sigma[..., 1].any()


def test_wrong_arguments_are_refused():
    assert_wrong_shapes_are_refused(partial(extended, cubic_model()))
    for wrong in ({"iterations": 0}, {"tolerance": 0.0}, {"stop": "norm"}):
        with pytest.raises(ValueError, match="at least one iteration, a positive tolerance"):
            extended(cubic_model(), *problem(), **wrong)
