"""What is said at the end of estimates on the way, beside two minima that are known exactly."""

import numpy as np

from debrisest.filters.replay.hindsight import with_hindsight
from debrisest.filters.replay.replay import replay
from debrisest.filters.rivals import DECISIVE
from debrisest.filters.verdict import Verdict
from tests.filters.test_replay_rival import EPOCHS, RUNS, data, least, square

KEPT = [2, 9, EPOCHS - 1]


def judged(known, doubt=0, off=0.0):
    """Estimates of a constant whose sign is hardly told, those of epoch 9 put off by sigmas."""
    model = square()
    found = replay(model, *known, keep=KEPT)
    found.state[:, 9] += off * found.sigma[:, 9]
    counts = found.counts | {"doubt": np.full(RUNS, doubt)}
    return found, with_hindsight(model, found._replace(counts=counts)).counts["doubt_at"]


def test_an_estimate_is_ambiguous_while_the_data_do_not_decide() -> None:
    """By how much the other sign costs more is found on a grid."""
    _, *known = data()
    _, code = judged(known)
    for k in KEPT:
        prior, covariance, measured = known
        gap = least(prior, covariance, measured[:, : k + 1])[1]
        sure = np.abs(gap - DECISIVE) > 1.0
        expected = gap < DECISIVE
        assert np.array_equal(code[sure, k] == Verdict.AMBIGUOUS, expected[sure])
        if k == KEPT[0]:
            assert expected[sure].any()
    assert not (code[:, -1] == Verdict.AMBIGUOUS).all()
    assert np.isnan(np.delete(code, KEPT, axis=1)).all()


def test_an_estimate_that_later_data_pass_by_was_wrong() -> None:
    _, *known = data(shown=3.0)
    found, right = judged(known)
    _, wrong = judged(known, off=9.0)
    assert (right[:, 9] != Verdict.LARGER).all(), "nothing was off"
    decided = ~(found.counts["rival_excess"][:, 9] < DECISIVE)
    assert decided.any()
    assert (wrong[decided, 9] == Verdict.LARGER).all()
    np.testing.assert_array_equal(wrong[:, [2, -1]], right[:, [2, -1]])


def test_a_run_that_doubts_its_end_doubts_everything() -> None:
    _, *known = data()
    _, code = judged(known, doubt=3)
    assert (code[:, KEPT] == Verdict.LOST).all()


def test_runs_without_an_end_are_as_doubtful_as_they_say() -> None:
    _, *known = data()
    model = square()
    found = replay(model, *known, keep=KEPT)
    found.state[0, -1] = np.nan
    doubt = np.where(np.arange(RUNS) == 0, 3, 0)
    found = found._replace(counts=found.counts | {"doubt": doubt})
    code = with_hindsight(model, found).counts["doubt_at"]
    assert (code[0, KEPT] == Verdict.LOST).all()
    assert (code[1:, KEPT] != Verdict.LOST).all()
