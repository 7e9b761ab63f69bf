"""The answer line by line, from data made by hand, for every way an estimate can end."""

from typing import Any

import numpy as np
import pytest

from debrisest.arrays import Data
from debrisest.batch.motion import Judged, Status
from debrisest.show.answer import answer

DEG = np.pi / 180
SAID = f"; {Judged.CHI_SQUARE_AND_BLOCKS.sentence}"


def made(status: Status = Status.ACCEPTED, **changes: Any) -> Data:
    """A motion of which everything is known, with some of it changed."""
    data = {
        "time_s": np.array([0.0, 50.0, 120.5]),
        "failure": np.array(""),
        "status": np.array(status.sentence + SAID),
        "accepted": float(status.accepted),
        "speed_end": 3.4567 * DEG,
        "speed_end_sigma": 0.0123 * DEG,
        "mean_speed": 3.2 * DEG,
        "mean_speed_sigma": 0.001 * DEG,
        "spin_axis_i": [0.6, 0.0, -0.8],
        "spin_axis_i_sigma": np.array([0.24, 0.1, 0.18]) * DEG,  # of length 0.316
        "momentum_axis_i": [0.0, 0.0, 1.0],
        "momentum_axis_i_sigma": np.array([0.03, 0.04, 0.0]) * DEG,
        "nutation_angle": 35.2 * DEG,
        "nutation_angle_sigma": 0.08 * DEG,
        "nutation_period": 261.52,
        "nutation_period_sigma": 0.14,
        "q_if": np.array([[1.0, 0, 0, 0], [1.0, 0, 0, 0], [0.5, -0.5, 0.5, 0.5]]),
        "q_if_sigma": np.full((3, 4), 0.1 * DEG * np.sqrt(3) / 4),
        "moment_share": np.array([0.48714, 0.75624, 1.0]),
        "moment_share_sigma": np.array([0.00096, 0.0083, 0.0]),
        "q_bf": np.array([[1.0, 0, 0, 0]] * 3),
        "point_f": np.array([[1.0, 0, 0], [0, 1.0, 0], [np.nan] * 3]),
        "point_f_sigma": np.array([[0.004] * 3, [0.006] * 3, [np.nan] * 3]),
        "feature": np.array(["horn", "fin", "flag"]),
        "rejected_share": 0.0123,
        "lost_directions": 0.0,
        "holds_from": 0.0,
        "holds_until": 120.5,
        "fit": 1.013,
    }
    return {name: np.asarray(value) for name, value in (data | changes).items()}


def lines(data: Data) -> dict[str, str]:
    """The lines after the first by their labels."""
    return {line[:15].strip(): line[15:] for line in answer(data)[1:]}


def test_all_that_is_known() -> None:
    assert answer(made()) == [
        "accepted: torque-free motion explains the data: attitude, rate and inertia ratios hold",
        "rate           3.457 ± 0.012 deg/s at 120.5 s, in the mean 3.2000 ± 0.0010 deg/s",
        "spin axis      (0.6000, 0.0000, -0.8000) ± 0.32 deg, inertial",
        "momentum axis  (0.00000, 0.00000, 1.00000) ± 0.050 deg, inertial",
        "nutation       angle 35.200 ± 0.080 deg, period 261.52 ± 0.14 s",
        "attitude       q_if = (0.50000, -0.50000, 0.50000, 0.50000) ± 0.10 deg per axis "
        "at 120.5 s",
        "inertia        0.48714 ± 0.00096 : 0.7562 ± 0.0083 : 1, principal moments over the "
        "largest",
        "points         2 of 3 found, 1 sigma 0.005 m per axis (largest 0.006 m); left out: flag",
        "rejected       1.2 % of the measurements",
        "torque-free    from 0 to 120.5 s of 120.5 s, chi-square 1.01 per degree of freedom",
        f"judged         {Judged.CHI_SQUARE_AND_BLOCKS.sentence}",
    ]


def test_a_second_body_is_told_by_its_points() -> None:
    found = lines(made(on_other_body=np.array([0.0, 0.0, 1.0])))
    assert found["points"].endswith(
        "left out: flag; a second rigid body, which is not estimated: flag"
    )


@pytest.mark.parametrize("status", Status)
@pytest.mark.parametrize("flag", [0.0, 1.0, np.nan])
def test_the_first_line_says_whether_it_is_accepted(status: Status, flag: float) -> None:
    """Only if both status and flag say so, and with the whole sentence."""
    first = answer(made(status, accepted=flag))[0]
    fine = status.accepted and flag == 1.0
    assert first == f"{'accepted' if fine else 'NOT ACCEPTED'}: {status.sentence}"


def test_an_end_that_nobody_knows_is_not_accepted() -> None:
    first = answer(made(accepted=0.0) | {"status": np.array("")})[0]
    assert first == "NOT ACCEPTED: the file does not say how the estimate ended"
    told = answer(made(accepted=0.0) | {"status": np.array("diverged: not finite")})[0]
    assert told == "NOT ACCEPTED: diverged: not finite"


def test_a_run_that_failed_is_one_line() -> None:
    assert answer(made(failure="ValueError: no axes")) == ["NO RESULT: ValueError: no axes"]


def undefined(*names: str) -> Data:
    return {name: np.full(np.shape(made()[name]), np.nan) for name in names}


INERTIA = ("moment_share", "nutation_angle", "nutation_period", "q_bf")


def test_of_a_steady_spin_the_inertia_is_not_shown() -> None:
    found = lines(made(Status.WITHOUT_INERTIA, **undefined(*INERTIA)))
    assert found["inertia"] == "the motion does not show them: it turns steadily about one axis"
    assert found["nutation"] == f"undefined: {found['inertia']}"
    assert "axes" not in found


def test_a_part_of_the_inertia() -> None:
    found = lines(made(Status.ACCEPTED_IN_PART, lost_directions=2.0, **undefined(*INERTIA)))
    assert found["inertia"] == "the motion shows 3 of the 5 numbers of the inertia only"


def test_equal_moments_leave_transverse_axes_undefined() -> None:
    shares = {"moment_share": np.array([0.5, 0.999, 1.0]), "moment_share_sigma": np.full(3, 0.01)}
    found = lines(made(**shares, **undefined("q_bf")))
    assert found["inertia"].startswith("0.500 ± 0.010 : 0.999 ± 0.010 : 1")
    expected = "two moments are equal as far as the data tell: transverse axes undefined"
    assert found["axes"] == expected


@pytest.mark.parametrize(
    ("begin", "end", "words"),
    [
        (0.0, 61.25, "torque-free motion fails from 61.25 s"),
        (10.0, 61.25, "torque-free motion fails before 10 s and from 61.25 s"),
        (np.nan, np.nan, "torque-free motion explains no stretch of the data"),
        (0.0, 0.0, "torque-free motion explains no stretch of the data"),
    ],
)
def test_where_torque_free_motion_fails(begin: float, end: float, words: str) -> None:
    nothing = undefined(*INERTIA, "spin_axis_i", "momentum_axis_i")
    data = made(Status.NOT_TORQUE_FREE, holds_from=begin, holds_until=end, **nothing)
    found = lines(data)
    assert found["inertia"] == f"no inertia: {words}"
    assert found["rate"].startswith("3.457 ± 0.012 deg/s")
    assert found["spin axis"] == "undefined: may be off by 0.32 deg"
    assert ("torque-free" in found) == (end > begin)


def test_too_few_data_leave_nothing() -> None:
    every = [name for name, value in made().items() if value.dtype.kind == "f"]
    every.remove("time_s")
    data = made(Status.TOO_FEW) | undefined(*every) | {"accepted": np.asarray(0.0)}
    found = lines(data)
    assert answer(data)[0].startswith("NOT ACCEPTED: too few data for a motion")
    assert found["inertia"] == "too few data"
    assert found["rate"] == "undefined at 120.5 s, in the mean undefined"
    assert found["attitude"] == "undefined at 120.5 s"
    assert found["spin axis"] == "undefined"
    assert found["points"] == "0 of 3 found; left out: horn, fin, flag"
    assert "rejected" not in found
    assert "nan" not in " ".join(answer(data))


def test_what_is_not_there_has_no_line() -> None:
    few = ("time_s", "status", "accepted", "failure", "rejected_share", "speed_end")
    data = {name: made()[name] for name in few} | {"rejected_share": np.asarray(0.0)}
    assert list(lines(data)) == ["rate", "rejected", "judged"]
    assert lines(data)["rejected"] == "no measurement"


def test_points_that_are_given() -> None:
    found = lines(made(point_f_sigma=np.zeros((3, 3)), point_f=np.zeros((3, 3))))
    assert found["points"] == "3 of 3 found, places given"
