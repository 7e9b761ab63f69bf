"""What the batch does when one descent is not enough: mirrors, restarts, longer windows."""

import numpy as np

from debrisest.filters.landmark_model import LandmarkModel
from debrisest.filters.landmarks.batch_start import Batch, batch_problem, batch_start
from debrisest.filters.landmarks.cost import Prior
from debrisest.filters.landmarks.growing_windows import Window, fit, fresh
from debrisest.filters.verdict import Verdict

SHORT = [Window(10, 1), Window(20, 1), Window(40, 1)]
RATE = slice(3, 6)


def largest_rate_sigma(started) -> np.ndarray:
    return np.sqrt(np.diagonal(started.covariance, 0, 1, 2)[:, RATE].max(-1))


def mirrored_onto_itself(model: LandmarkModel) -> LandmarkModel:
    """Model whose mirror is the solution itself, so that both fits are the same minimum."""
    return model._replace(
        mirror=lambda parameters, points: (parameters.copy(), points.copy()),
        of=lambda runs: mirrored_onto_itself(model.of(runs)),
    )


def test_a_target_that_does_not_turn_is_ambiguous(experiment) -> None:
    sensor = {"noise": 3.0, "pixel_sigma": 3.0, "range_sigma": 0.03}
    case = experiment(8, 42, 20, rate_deg_s=(0.01, 0.005, 0.0), guess=0.1, **sensor)
    started = case.batch(windows=SHORT, restarts=0)
    unclear = started.verdict == Verdict.AMBIGUOUS
    assert unclear.sum() >= 4
    assert all("depth reversed" in words for words in started.sentence[unclear])


def test_restarts_lower_the_cost(experiment) -> None:
    """From a wrong start with a wide prior; some steps lead to where nothing is finite."""
    case = experiment(4, 62, 5)
    parameters, wide = case.parameters.copy(), case.covariance.copy()
    parameters[:, :3] = np.radians([[-2.0, 2.0, -3.0]])
    wide[:, :3, :3] *= 25.0
    case = case._replace(parameters=parameters, covariance=wide)
    given = case.model, case.observed, parameters, wide
    with np.errstate(all="ignore"):
        once, again = (
            batch_start(batch_problem(*given, Batch(SHORT, mirrored=False, restarts=n)))
            for n in (0, 2)
        )
    costs = [found.best.found.value for found in (once, again)]
    assert (costs[1] <= costs[0]).all()
    assert (costs[1] < 0.9 * costs[0]).any()
    assert (again.restarts > 0).all()


def test_longer_windows_lower_the_sigma(experiment) -> None:
    case = experiment(2, 42, 21, rate_deg_s=(0.1, -0.06, 0.04), guess=0.2)
    short, long = (case.batch(windows=SHORT[:1], ends=ends) for ends in ((), (40,)))
    assert (long.last == 40).all()
    assert (largest_rate_sigma(long) < 0.5 * largest_rate_sigma(short)).all()


def test_a_fit_of_fewer_frames_does_not_win(experiment) -> None:
    """The mirror is the same minimum, and not extended: its lower cost is that of less data."""
    case = experiment(2, 42, 22, rate_deg_s=(0.1, -0.06, 0.04), guess=0.2)
    case = case._replace(model=mirrored_onto_itself(case.model))
    short, long = (case.batch(windows=SHORT[:1], ends=ends) for ends in ((), (40,)))
    assert (long.verdict <= Verdict.LARGER).all()
    assert (largest_rate_sigma(long) < 0.5 * largest_rate_sigma(short)).all()


def test_too_few_landmarks_are_no_start(experiment) -> None:
    case = experiment(2, 42, 23, guess=0.2)
    for count, status in ((3, Verdict.LOST), (5, Verdict.LARGER)):
        observed = case.observed._replace(seen=case.observed.seen.copy())
        observed.seen[:, :, count:] = False
        started = case.with_observed(observed).batch(windows=SHORT)
        assert (started.present.sum(-1) == count).all()
        assert (started.verdict == status).all()
        few = ["fewer than 4 landmarks" in words for words in started.sentence]
        assert few == [status == Verdict.LOST] * 2


def test_the_last_window_is_given_patience(experiment) -> None:
    """Few linearisations suffice on the way, but the last window must arrive."""
    case = experiment(3, 42, 24, guess=0.1)
    mean = np.concatenate([case.parameters, np.zeros((3, 33))], axis=-1)
    at, prior = fresh(case.model, case.parameters, Prior(mean, np.linalg.inv(case.covariance)))
    begin, costs = at.moved(np.zeros_like(mean)), []
    with np.errstate(all="ignore"):
        for most in (2, 60):
            found = fit(case.model, case.observed, begin, prior, SHORT, most, False)
            costs.append(found.found.value)
    assert (np.abs(costs[0] - costs[1]) < 10.0).all()
