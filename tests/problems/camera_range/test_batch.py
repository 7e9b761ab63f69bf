"""The batch finds the truth, the right mirror and the false matches, or says that it did not."""

import numpy as np
from scipy.stats import chi2

from debrisest.filters.landmarks.growing_windows import Window
from debrisest.filters.verdict import Verdict

RATE = slice(3, 6)
SHORT = [Window(10, 1), Window(20, 1), Window(40, 1)]


def test_clean_data_give_the_truth(experiment) -> None:
    case = experiment(3, 102, 1, noise=0.0)
    started = case.batch()
    error = case.start_error(started)
    assert (started.verdict == Verdict.CONSISTENT).all()
    assert np.abs(error[:, 6:9]).max() < 2e-3  # m
    assert np.degrees(np.abs(error[:, RATE]).max()) < 2e-3
    assert np.abs(error[:, 17:]).max() < 5e-3  # m
    assert (started.ratio < 0.01).all()


def test_errors_are_as_large_as_the_information_says(nominal) -> None:
    case, started = nominal
    error = case.start_error(started)[:, 3:]
    covariance = started.covariance[:, 3:, 3:]
    squares = (error[:, None] @ np.linalg.solve(covariance, error[..., None]))[:, 0, 0]
    low, high = chi2.ppf([1e-4, 1 - 1e-4], error.size)
    assert low < squares.sum() < high
    assert np.abs(started.ratio - 1.0).max() < 5 * np.sqrt(2 / 2300)
    assert started.present.all()


def test_the_attitude_at_time_zero_is_exact_or_tied_to_the_position(nominal, experiment) -> None:
    _, started = nominal
    assert np.abs(started.covariance[:, :3]).max() == 0.0
    implied = experiment(2, 60, 2, attitude="implied")
    found = implied.batch(windows=SHORT)
    _, by_parameters = implied.model.start(implied.model.parameters(found.core))
    tied = by_parameters[:, :3, 3:6] @ found.covariance[:, 6:9]
    np.testing.assert_allclose(found.covariance[:, :3], tied, atol=1e-12)


def test_the_mirror_leads_out_of_the_wrong_minimum(experiment) -> None:
    case = experiment(3, 102, 3)
    wrong, _ = case.model.mirror(case.model.parameters(case.core[:, 0]), case.points)
    case = case._replace(parameters=wrong)
    alone = case.batch(mirrored=False, restarts=0)
    both = case.batch(restarts=0)
    assert (both.verdict == Verdict.CONSISTENT).all()
    assert np.degrees(np.abs(case.start_error(both)[:, RATE]).max()) < 0.05
    assert (both.ratio <= alone.ratio).all()


def test_a_hopeless_start_is_rejected_and_restarts_are_counted(experiment) -> None:
    case = experiment(2, 102, 4)
    parameters = case.parameters.copy()
    parameters[:, :3] = np.radians([[-2.0, 2.0, -3.0]])
    case = case._replace(parameters=parameters)
    once = case.batch(restarts=0, mirrored=False, windows=SHORT)
    assert (once.verdict == Verdict.LOST).all()
    assert once.restarts.tolist() == [0, 0]
    assert all("much worse than noise allows" in words for words in once.sentence)
    wide = case.covariance.copy()
    wide[:, :3, :3] *= 100.0
    again = case._replace(covariance=wide).batch(restarts=2, windows=SHORT[:2], mirrored=False)
    bad = again.verdict == Verdict.LOST
    assert (again.restarts[bad] == 2).all()
    assert (again.restarts <= 2).all()


def test_a_target_that_hardly_turns_is_called_ambiguous(experiment) -> None:
    case = experiment(3, 42, 5, rate_deg_s=(0.02, 0.01, 0.0), guess=0.1)
    started = case.batch(windows=SHORT)
    said = (started.verdict == Verdict.AMBIGUOUS) | (started.verdict == Verdict.LOST)
    depth = np.abs(case.start_error(started)[:, 17:]).reshape(3, -1, 3)[..., 2].max(-1)
    sigma = np.sqrt(np.diagonal(started.covariance, 0, 1, 2)[:, 17:].max(-1))
    assert (said | (depth < 5 * sigma)).all()


def test_windows_go_on_to_the_end(experiment) -> None:
    slow = experiment(2, 140, 6, rate_deg_s=(0.1, -0.06, 0.04))
    longer = slow.batch(windows=[Window(40, 2), Window(90, 3)], ends=(139,))
    assert (longer.last == 139).all()
    assert np.degrees(np.abs(slow.start_error(longer)[:, RATE]).max()) < 0.1


def test_false_matches(experiment) -> None:
    case = experiment(2, 102, 7, false_share=0.1)
    robust = case.batch(robust=True)
    assert (robust.verdict == Verdict.CONSISTENT).all()
    assert np.degrees(np.abs(case.start_error(robust)[:, RATE]).max()) < 0.05
    fooled = case.batch(restarts=0, mirrored=False, windows=SHORT)
    assert (fooled.verdict == Verdict.LOST).all()


def test_runs_do_not_depend_on_their_companions(experiment) -> None:
    case = experiment(3, 60, 9)
    alone = case._replace(
        model=case.model.of(np.array([1])),
        observed=case.observed.at(np.array([1])),
        parameters=case.parameters[1:2],
        covariance=case.covariance[1:2],
    )
    together = case.batch(windows=SHORT)
    found = alone.batch(windows=SHORT).core[0]
    np.testing.assert_allclose(found, together.core[1], rtol=1e-9, atol=1e-12)


def test_a_landmark_that_is_never_seen_is_absent(experiment) -> None:
    case = experiment(2, 60, 10)
    observed = case.observed._replace(seen=case.observed.seen.copy())
    observed.seen[:, :, 3] = False
    started = case.with_observed(observed).batch(windows=SHORT)
    assert not started.present[:, 3].any()
    assert np.delete(started.present, 3, axis=1).all()
    assert np.abs(started.covariance[:, 17 + 9 : 17 + 12]).max() == 0.0
