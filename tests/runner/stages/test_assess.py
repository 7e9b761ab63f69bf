"""What the tables are told of any filter, whatever its problem."""

import numpy as np
import pytest

from debrisest.runner.stages.assess import diagnostics
from debrisest.vocabulary import VOCABULARY

RUNS, EPOCHS = 2, 4
BLANK = np.full((RUNS, EPOCHS), np.nan)


@pytest.fixture
def data() -> dict[str, np.ndarray]:
    """Six components at each epoch from the second on."""
    used = np.tile([0, 6, 6, 6], (RUNS, 1))
    return {
        "nis": np.where(used > 0, 12.0, np.nan),
        "nis_dof": used,
        "error_name": np.array(["a", "b", "c", "d"]),
    }


def test_innovations_are_per_dimension(data: dict[str, np.ndarray]) -> None:
    told = diagnostics(data)
    assert told.keys() == {"nis", "nis_dof"}
    assert told["nis"][:, 1:] == pytest.approx(np.full((RUNS, 3), 2.0))
    assert np.isnan(told["nis"][:, 0]).all()


def test_a_filter_without_innovations_has_none(data: dict[str, np.ndarray]) -> None:
    assert diagnostics(data | {"nis": BLANK, "nis_dof": np.zeros((RUNS, EPOCHS))}) == {}


def test_what_a_filter_counts_is_handed_on(data: dict[str, np.ndarray]) -> None:
    counts = {
        "repairs": np.array([0, 3]),
        "reopened": np.array([1, 0]),
        "converged": np.array([1, 1]),
        "rejected": np.tile([0, 2, 0, 6], (RUNS, 1)),
    }
    told = diagnostics(data | counts)
    for name in ("repairs", "reopened", "converged"):
        assert told[name].tolist() == counts[name].tolist()
    assert told["rejected"][0, 1:] == pytest.approx([0.25, 0.0, 0.5])
    assert np.isnan(told["rejected"][0, 0])


def test_the_excess_cost_is_per_error_where_costs_were_kept(data: dict[str, np.ndarray]) -> None:
    cost, truth = BLANK.copy(), BLANK.copy()
    cost[:, [1, 3]], truth[:, 1], truth[0, 3] = 100.0, 106.0, 103.0
    told = diagnostics(data | {"cost": cost, "cost_of_truth": truth})
    assert told["w"][0, [1, 3]] == pytest.approx([1.5, 0.75])
    assert told["w_dof"].tolist() == [[0, 4, 0, 4], [0, 4, 0, 0]]
    assert "w" not in diagnostics(data | {"cost": cost})


@pytest.mark.parametrize("name", ["nis", "nees", "w"])
def test_a_square_says_where_its_freedom_is(name: str) -> None:
    law = VOCABULARY[name].chi_square
    assert law is not None
    assert VOCABULARY[law.freedom].axes == VOCABULARY[name].axes
