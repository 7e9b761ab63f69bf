"""One bad run is an outcome of that run, and of no other."""

import numpy as np
import pytest

from debrisest.filters.gate import Gate
from debrisest.filters.kalman.extended import extended
from debrisest.filters.model import Model
from debrisest.filters.status import FilterStatus

RUNS, EPOCHS, BAD = 5, 12, 2
GOOD = [run for run in range(RUNS) if run != BAD]
RULES = [{}, {"iterations": 8}, {"iterations": 8, "stop": "relative_norm", "tolerance": 1e-6}]


def per_run(estimates):
    fields = estimates._asdict()
    return {name: fields[name] for name in fields.keys() - {"kept", "counts"}} | estimates.counts


def cubic_model():
    """Grows without bound once |x| is large; a run whose second component exceeds 50 is blind."""
    return Model(
        process=lambda x, _: np.stack(
            [x[..., 0] * (1 + 0.01 * x[..., 0] ** 2), np.sin(x[..., 0]) + 0.9 * x[..., 1]], axis=-1
        ),
        measurement=lambda x, _: np.where(x[:, :1, 1:] > 50.0, 1.0, x[..., :1] + x[..., 1:] ** 2),
        process_noise=np.diag([1e-3, 1e-3]),
        measurement_noise=np.array([[0.0]]),
        error_names=("x", "y"),
    )


def problem():
    rng = np.random.default_rng(0)
    start = 0.3 * rng.normal(size=(RUNS, 2))
    covariance = np.stack([np.diag([0.1, 0.2])] * RUNS)
    y = 0.3 * rng.normal(size=(RUNS, EPOCHS, 1))
    y[:, 0] = np.nan
    return start, covariance, y


CAUSES = {
    "overflow": (0, (BAD, 0), 1e200, FilterStatus.DIVERGED, 1),
    "singular innovation covariance": (0, (BAD, 1), 60.0, FilterStatus.DIVERGED, 1),
    "infinite measurement": (2, (BAD, 7), np.inf, FilterStatus.DIVERGED, 7),
    "no start": (0, BAD, np.nan, FilterStatus.NO_START, 0),
    "no start covariance": (1, (BAD, 0, 1), np.inf, FilterStatus.NO_START, 0),
}


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("cause", CAUSES)
def test_divergence_stays_in_its_run(cause, rule):
    which, where, value, status, epoch = CAUSES[cause]
    given = problem()
    sound = extended(cubic_model(), *given, keep=[3, 8], **rule)
    given[which][where] = value
    history = extended(cubic_model(), *given, keep=[3, 8], **rule)

    for name, values in per_run(sound).items():
        assert np.array_equal(per_run(history)[name][GOOD], values[GOOD]), name
    assert (sound.status == FilterStatus.FINISHED.sentence).all()
    assert (sound.diverged_at == -1).all()
    assert history.status[BAD] == status.sentence
    assert history.diverged_at[BAD] == epoch
    for values in (history.state, history.sigma, history.nis):
        assert np.isfinite(values[BAD, :epoch]).all()
        assert np.isnan(values[BAD, epoch:]).all()
    for counts in (history.nis_dof, history.counts["updates"]):
        assert not counts[BAD, epoch:].any()
    assert np.array_equal(np.isnan(history.covariance[BAD, :, 0, 0]), history.kept >= epoch)


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
    together = extended(cubic_model(), start, covariance, y, **rule)
    assert "iterations" not in rule or np.ptp(together.counts["updates"], axis=0).any()
    assert "gate" not in rule or (
        together.counts["reopened"][3] > 0 and np.ptp(together.counts["reopened"]) > 0
    )
    for run in range(RUNS):
        one = slice(run, run + 1)
        alone = extended(cubic_model(), start[one], covariance[one], y[one], **rule)
        for name, values in per_run(together).items():
            assert np.array_equal(per_run(alone)[name][0], values[run]), name


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
    start, covariance, y = problem()
    with pytest.raises(ValueError, match="start covariance of shape"):
        extended(cubic_model(), start, covariance[:2], y)
    with pytest.raises(ValueError, match="kept epochs"):
        extended(cubic_model(), start, covariance, y, keep=[EPOCHS])
    for wrong in ({"iterations": 0}, {"tolerance": 0.0}, {"stop": "norm"}):
        with pytest.raises(ValueError, match="at least one iteration, a positive tolerance"):
            extended(cubic_model(), start, covariance, y, **wrong)
