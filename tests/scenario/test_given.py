"""First guesses that are written down."""

from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.parts.starts.drawn_pose import DrawnPose
from debrisest.parts.starts.given import GivenGuess
from debrisest.reconstruction.mesh_data import start_table

CSV = "name,component,value,sigma\nrate_b,2,0.2,0.02\nrate_b,1,0.1,0.01\nrate_b,3,0.3,0.03\n"


def given(folder: Path = Path(), **keys) -> GivenGuess:
    return GivenGuess.model_validate({"kind": "given", **keys}, context={"folder": folder})


def simulated(part: GivenGuess):
    return part.simulate({}, Clock.regular(2, 1), Draws(0, "", [0, 1]))


def test_values_are_the_same_in_all_runs_and_in_si() -> None:
    part = given(quantities={"rate_b": {"value": [1.0, 2.0, 3.0], "sigma": 0.5, "unit": "deg/s"}})
    data = simulated(part)
    assert part.given == ("start_rate_b",)
    np.testing.assert_allclose(data["start_rate_b"], np.radians([[1, 2, 3]] * 2))
    np.testing.assert_allclose(data["start_rate_b_sigma"], np.radians(np.full((2, 3), 0.5)))


def test_a_table_is_the_same_as_what_it_says(tmp_path: Path) -> None:
    (tmp_path / "guess.csv").write_text(CSV + "".join(f"point_b,{k + 1},{k},1\n" for k in range(6)))
    part = given(tmp_path, file="guess.csv")
    data = simulated(part)
    assert data["start_rate_b"].tolist() == [[0.1, 0.2, 0.3]] * 2
    assert data["start_rate_b_sigma"].tolist() == [[0.01, 0.02, 0.03]] * 2
    assert data["start_point_b"][0].tolist() == [[0, 1, 2], [3, 4, 5]]
    assert given(**part.model_dump(exclude={"kind", "file"})).quantities == part.quantities


@pytest.mark.parametrize(
    ("quantities", "words"),
    [
        ({"ratee_b": {"value": 1.0, "sigma": 1.0}}, "no estimator starts from 'ratee_b'; allowed"),
        (
            {"rate_b": {"value": [1.0, 2.0], "sigma": 1.0}},
            r"needs axis \(3\) values, found 2",
        ),
        ({"rate_b": {"value": [1.0, 2.0, 3.0], "sigma": [1.0]}}, "sigma is one number"),
        ({"rate_b": {"value": [1.0, 2.0, 3.0], "sigma": 1.0, "unit": "m"}}, "cannot be in 'm'"),
        ({"point_b": {"value": [[1.0], [1.0, 2.0]], "sigma": 1.0}}, "all rows need as many"),
        ({}, "nothing is given"),
    ],
)
def test_what_is_wrong_is_told(quantities, words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        given(quantities=quantities)


def test_a_guess_of_other_features_is_told() -> None:
    part = given(quantities={"point_b": {"value": [[1.0, 2.0, 3.0]], "sigma": 1.0}})
    data = {"feature": np.array(["a", "b"])}
    with pytest.raises(ValueError, match="point_b is given for 1 features, but there are 2"):
        part.simulate(data, Clock.regular(2, 1), Draws(0, "", [0]))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (None, "No such file"),
        ("name,value\na,1\n", "columns must be name,component,value,sigma"),
        (CSV.replace("rate_b,3", "rate_b,4"), "components of rate_b must be 1 to 3"),
    ],
)
def test_a_table_that_is_wrong_is_told(tmp_path: Path, text: str | None, words: str) -> None:
    if text is not None:
        (tmp_path / "guess.csv").write_text(text)
    with pytest.raises(ValidationError, match=words):
        given(tmp_path, file="guess.csv")


def test_ratios_of_a_reconstructed_body_take_the_place_of_drawn_ones(tmp_path: Path) -> None:
    ratios = {"moment_ratios": np.array([0.2, -0.1]), "moment_ratios_sigma": np.array([0.03, 0.02])}
    start_table(tmp_path / "start.csv", ratios)
    guess = {"kind": "drawn_pose", "position_sigma_m": 1, "velocity_sigma_m_s": 1, "q_sigma": 0.01}
    guess |= {"rate_sigma_deg_s": 1, "inertia_ratio_sigma": None, "point_sigma_m": 1}
    drawn = DrawnPose.model_validate(guess)
    assert "start_inertia_ratio" not in drawn.given
    truth = {
        "true_position": np.zeros((2, 1, 3)),
        "true_velocity": np.zeros((2, 1, 3)),
        "true_rate_l": np.zeros((2, 1, 3)),
        "true_q_lt": np.tile([1.0, 0, 0, 0], (2, 1, 1)),
        "true_inertia_ratio": np.zeros((2, 2)),
        "true_point_b": np.zeros((2, 6, 3)),
    }
    data = drawn.simulate(truth, Clock.regular(2, 1), Draws(0, "", [0, 1]))
    assert set(drawn.given) <= set(data)
    data |= simulated(given(tmp_path, file="start.csv"))
    np.testing.assert_array_equal(data["start_inertia_ratio"], [[0.2, -0.1]] * 2)
    np.testing.assert_array_equal(data["start_inertia_ratio_sigma"], [[0.03, 0.02]] * 2)
