"""Runs of several files as one."""

import numpy as np

from debrisest.results.joined import joined


def test_runs_follow_each_other_and_coordinates_stay() -> None:
    parts = [
        {"run": np.arange(3.0) + 3 * part, "time_s": np.arange(4.0), "rate": np.full((3, 4), part)}
        for part in range(2)
    ]
    data = joined(parts, [3, 3])
    assert data["run"].tolist() == [0, 1, 2, 3, 4, 5]
    assert data["time_s"].tolist() == [0, 1, 2, 3]
    np.testing.assert_array_equal(data["rate"], np.repeat([0.0, 1.0], 3)[:, None] * np.ones(4))


def test_what_a_file_has_not_got_is_not_observed() -> None:
    """A file whose runs all failed has no dataset; a run with fewer pieces has fewer signs."""
    empty = {"run": np.array([0.0]), "failure": np.array(["no"])}
    short = {"run": np.array([1.0]), "failure": np.array([""]), "sign": np.array([[1.0]])}
    long = {
        "run": np.array([2.0]),
        "failure": np.array(["a longer sentence"]),
        "sign": np.array([[-1.0, 1.0]]),
        "status": np.array(["finished"]),
    }
    data = joined([empty, short, long], [1, 1, 1])
    nan = np.nan
    np.testing.assert_array_equal(data["sign"], [[nan, nan], [1, nan], [-1, 1]])
    assert data["failure"].tolist() == ["no", "", "a longer sentence"]
    assert data["status"].tolist() == ["", "", "finished"]
