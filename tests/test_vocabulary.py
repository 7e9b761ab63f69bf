"""Every stored dataset is declared, with its axes and its unit."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import h5py
import numpy as np
import pytest

from debrisest.quantity import RUN, TIME, Quantity
from debrisest.results import store
from debrisest.roles import SimulationPart
from debrisest.vocabulary import AXIS_LENGTH, COORDINATES, VOCABULARY, axes_of, table_scale

SCALES = {
    ("1", "%"): 100.0,
    ("rad", "deg"): 57.29577951308232,
    ("rad/s", "deg/s"): 57.29577951308232,
    ("m", "m"): 1.0,
    ("m", "km"): 0.001,
    ("m2", "km2"): 1e-6,
    ("rad", "mrad"): 1000.0,
    ("m/s", "m/s"): 1.0,
    ("1", "1"): 1.0,
    ("s", "s"): 1.0,
    ("px", "px"): 1.0,
    ("N m", "mN m"): 1000.0,
    ("kg m2", "kg m2"): 1.0,
}
ALONE = ("point_sigma",)
"""Noise of measurements, of other axes than what it is the noise of."""
TABLE_QUANTITIES = [name for name, quantity in VOCABULARY.items() if quantity.table_unit]


@pytest.mark.parametrize("name", TABLE_QUANTITIES)
def test_every_quantity_of_the_tables_has_a_known_scale(name: str) -> None:
    quantity = VOCABULARY[name]
    assert table_scale(name) == pytest.approx(SCALES[quantity.unit, quantity.table_unit], rel=1e-12)
    axes = (("run",), ("run", "time_s"))
    assert quantity.axes in axes or axes_of(name, len(quantity.axes) - 1) in axes


@pytest.mark.parametrize("name", VOCABULARY)
def test_every_quantity_says_what_it_is(name: str) -> None:
    quantity = VOCABULARY[name]
    assert quantity.long_name
    assert quantity.axes
    assert len(set(quantity.axes)) == len(quantity.axes)
    assert name in COORDINATES or quantity.axes[0] == "run"


@pytest.mark.parametrize("name", [n for n in VOCABULARY if n.endswith("_sigma") and n not in ALONE])
def test_a_sigma_has_the_axes_and_unit_of_its_quantity(name: str) -> None:
    estimate = VOCABULARY[name.removesuffix("_sigma")]
    assert (VOCABULARY[name].axes, VOCABULARY[name].unit) == (estimate.axes, estimate.unit)


def test_estimates_are_named_like_the_truth_with_its_unit() -> None:
    for name, quantity in VOCABULARY.items():
        own = name.removeprefix("true_")
        estimate = VOCABULARY.get(own) if f"{own}_sigma" in VOCABULARY else None
        if name.startswith("true_") and estimate is not None:
            assert estimate.unit == quantity.unit
            constant = tuple(axis for axis in estimate.axes if axis != "time_s")
            assert quantity.axes in (estimate.axes, constant)


def test_every_stored_dataset_is_declared_with_its_axes(reference: Path) -> None:
    seen: set[str] = set()
    for path in sorted(reference.rglob("*.h5")):
        lengths: dict[str, int] = {}
        with h5py.File(path, "r") as file:
            for name, dataset in file.items():
                if name not in VOCABULARY:
                    assert not np.any(dataset[()]), f"{name} holds data but is not declared"
                    continue
                axes = VOCABULARY[name].axes
                assert dataset.ndim == len(axes)
                for axis, length in zip(axes, dataset.shape):
                    assert lengths.setdefault(axis, length) == length
                    assert AXIS_LENGTH.get(axis, length) == length
                seen.add(name)
    assert {"true_q_ib", "measured_point", "q_if", "rate_b_sigma", "covariance", "pitch"} <= seen


def test_truth_and_measurements_have_the_declared_sizes(reference: Path) -> None:
    data = store.read(next(reference.rglob("slow/simulate.*.h5")))
    runs, epochs, features = 3, 60, 4
    assert data["true_q_ib"].shape == (runs, epochs, 4)
    assert data["true_rate_b"].shape == (runs, epochs, 3)
    assert data["true_inertia_b"].shape == (runs, 3, 3)
    assert data["true_point_b"].shape == (runs, features, 3)
    assert data["measured_point"].shape == (runs, epochs, features, 3)
    assert data["time_s"].tolist() == list(range(60))
    assert data["run"].tolist() == [0, 1, 2]
    assert data["feature"].tolist() == ["a", "b", "c", "d"]


def test_a_sensor_in_a_single_file_declares_its_own_dataset(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(VOCABULARY, "sun_angle", Quantity(RUN, "", "to be replaced"))

    class SunSensor(SimulationPart):
        declares = {"sun_angle": Quantity(TIME, "rad", "angle from the Sun", "deg")}
        measures = ("sun_angle",)
        kind: Literal["sun_sensor"]

    assert SunSensor.can_give() == ("sun_angle",)
    data = {"run": np.zeros(1), "time_s": np.arange(3.0), "sun_angle": np.ones((1, 3))}
    store.write(tmp_path / "sun.h5", data, {"stage": "simulate"})
    assert store.read(tmp_path / "sun.h5")["sun_angle"].tolist() == [[1, 1, 1]]
    with h5py.File(tmp_path / "sun.h5") as file:
        assert file["sun_angle"].attrs["units"] == "rad"
    assert table_scale("sun_angle") == pytest.approx(180 / np.pi)


def test_names_can_be_read_by_every_program() -> None:
    assert all(re.fullmatch(r"[a-z][a-z0-9_]*", name) for name in VOCABULARY)


def test_stored_values_are_si_and_radians(reference: Path, data_of: Callable) -> None:
    data = data_of(reference, "fast/simulate.*.h5")["small/fast/simulate.000000.h5"]
    first = data["true_rate_b"][:, 0]
    assert first == pytest.approx(np.radians([[7.2, 5.5, -1.6]] * 3), rel=1e-12)
    assert np.linalg.norm(data["orbit_position"], axis=-1) == pytest.approx(7178137.0, rel=1e-9)
    assert np.linalg.norm(data["true_position"], axis=-1) == pytest.approx(30.0, rel=1e-9)


def test_the_error_of_a_vector_is_its_norm() -> None:
    assert axes_of("position", 3) == ("run", "time_s", "axis")
    assert axes_of("position", 2) == ("run", "time_s")
    for name, dimensions in (("true_position", 2), ("position", 1), ("rate", 3)):
        with pytest.raises(ValueError, match=f"{name} has {dimensions} axes"):
            axes_of(name, dimensions)
