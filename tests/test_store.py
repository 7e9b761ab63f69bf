"""Checkpoints: whole or not there, readable by others, and never read when damaged or foreign."""

import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray

from debrisest import files
from debrisest.files import remove_leftovers
from debrisest.results import store
from debrisest.results.store import Condition
from debrisest.vocabulary import VOCABULARY


def example(runs: int = 3, epochs: int = 40) -> dict[str, Any]:
    rng = np.random.default_rng(4)
    measured = rng.standard_normal((runs, epochs, 2, 3))
    measured[:, 3:9, 1] = np.nan
    return {
        "run": np.arange(runs, dtype=float),
        "time_s": np.arange(epochs) * 0.5,
        "feature": np.array(["nozzle", "Flügel"]),
        "failure": np.array(["", "ValueError: no", ""][:runs]),
        "measured_point": measured,
        "true_q_ib": rng.standard_normal((runs, epochs, 4)),
        "repairs": np.array([0, 2, 1][:runs]),
        "solved": np.array([True, False, True][:runs]),
    }


ATTRIBUTES = {
    "stage": "simulate",
    "stage_key": "0123456789abcdef" * 4,
    "inputs": '{"noise_m": 0.05}',
    "runs": 3,
    "scenario": "title: x\n" * 50,
}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "case" / "simulate.000000.h5"
    store.write(path, example(), ATTRIBUTES)
    return path


def test_round_trip(file: Path, same_data: Callable) -> None:
    found = store.inspect(file)
    assert found.condition is Condition.WHOLE
    assert ATTRIBUTES.items() <= found.attributes.items()
    data, given = store.read(file), example()
    for name in ("repairs", "solved"):
        given[name] = given[name].astype(float)
    assert same_data(data, given)


def test_the_first_runs_alone(file: Path) -> None:
    data, given = store.read(file, 2), example()
    assert np.array_equal(data["measured_point"], given["measured_point"][:2], equal_nan=True)
    assert data["run"].tolist() == [0, 1]
    assert len(data["time_s"]) == 40
    assert data["feature"].tolist() == ["nozzle", "Flügel"]


def test_root_attributes_say_where_a_file_comes_from(reference: Path) -> None:
    with h5py.File(reference / "small/slow/filter-wahba.000000.h5", "r") as file:
        found = dict(file.attrs)
    assert found["schema_version"] == store.SCHEMA_VERSION
    assert found["seed"] == 7
    assert (found["case"], found["estimator"], found["stage"]) == ("slow", "wahba", "filter")
    assert len(found["stage_key"]) == 64
    assert "numpy" in found["software"]
    assert "noise_m: 0.01" in found["scenario"]
    assert found["created"].endswith("+00:00")


def test_every_dataset_is_a_double_or_a_text(reference: Path) -> None:
    for path in reference.rglob("*.h5"):
        with h5py.File(path, "r") as file:
            for dataset in file.values():
                text = h5py.check_string_dtype(dataset.dtype) is not None
                assert text or dataset.dtype == np.float64


@pytest.mark.parametrize("stage", ["simulate", "recover-triad", "filter-triad", "assess-triad"])
def test_others_can_read_the_files(stage: str, reference: Path) -> None:
    path = reference / "small" / "slow" / f"{stage}.000000.h5"
    data = store.read(path)
    with xarray.open_dataset(path, engine="h5netcdf") as opened:
        assert set(data) == {str(name) for name in opened.variables}
        assert {"run", "time_s"} <= set(opened.coords)
        assert (opened.sizes["run"], opened.sizes["time_s"]) == (3, 60)
        for name, values in data.items():
            variable, quantity = opened[name], VOCABULARY[name]
            assert variable.dims == quantity.axes
            assert variable.attrs["long_name"] == quantity.long_name
            if values.dtype.kind == "f":
                assert np.array_equal(variable.values, values, equal_nan=True)
            else:
                assert [str(text) for text in variable.values] == values.tolist()
            if quantity.unit != "s" or name == "convergence_time":
                assert variable.attrs.get("units", "s") == quantity.unit


def test_seconds_stay_numbers_for_xarray(file: Path) -> None:
    with xarray.open_dataset(file, engine="h5netcdf") as opened:
        assert opened["time_s"].dtype == np.float64
        assert opened["time_s"].values.tolist() == example()["time_s"].tolist()
        assert opened["measured_point"].sel(time_s=4.5).shape == (3, 2, 3)
        assert opened["feature"].values.tolist() == ["nozzle", "Flügel"]


def test_h5py_alone_finds_the_scales(file: Path) -> None:
    with h5py.File(file, "r") as opened:
        dims = opened["measured_point"].dims
        assert [dim[0].name for dim in dims] == ["/run", "/time_s", "/feature", "/axis"]
        assert opened["measured_point"].attrs["units"] == "m"


# interrupted writing


@pytest.mark.parametrize(
    ("module", "moment"),
    [(store, "_write_data"), (store, "_write_attributes"), (files, "_synchronise")],
)
def test_a_write_that_fails_leaves_the_old_file(
    module: object, moment: str, file: Path, monkeypatch: pytest.MonkeyPatch, same_data: Callable
) -> None:
    before, content = store.read(file), file.read_bytes()

    def fail(*_: object) -> None:
        raise OSError("no space left on device")

    monkeypatch.setattr(module, moment, fail)
    with pytest.raises(OSError, match="no space"):
        store.write(file, example(1), ATTRIBUTES)
    assert file.read_bytes() == content
    assert same_data(store.read(file), before)
    assert list(file.parent.iterdir()) == [file]


def test_a_write_that_fails_halfway_through_the_data(file: Path) -> None:
    content = file.read_bytes()
    bad = example() | {"true_q_ib": np.zeros(3)}
    with pytest.raises(ValueError, match="true_q_ib"):
        store.write(file, bad, ATTRIBUTES)
    assert file.read_bytes() == content
    assert list(file.parent.iterdir()) == [file]


def dead_process() -> int:
    done = subprocess.Popen([sys.executable, "-c", ""])
    done.wait()
    return done.pid


def test_leftovers_of_dead_processes_are_removed(file: Path, tmp_path: Path) -> None:
    here, there = socket.gethostname(), "another-host"
    dead = file.with_name(f".{file.name}.{here}.{dead_process()}.tmp")
    alive = file.with_name(f".{file.name}.{here}.{os.getpid()}.tmp")
    foreign = file.with_name(f".{file.name}.{there}.{dead_process()}.tmp")
    own = file.with_name("notes.tmp")
    for path in (dead, alive, foreign, own):
        path.write_bytes(b"half")
    remove_leftovers(tmp_path)
    assert set(file.parent.iterdir()) == {file, alive, foreign, own}


def test_leftovers_of_a_host_whose_name_ends_alike_stay(file: Path, tmp_path: Path) -> None:
    other = file.with_name(f".{file.name}.big{socket.gethostname()}.{dead_process()}.tmp")
    other.write_bytes(b"half")
    remove_leftovers(tmp_path)
    assert other.exists()


def test_leftovers_of_zombies_are_removed(file: Path, tmp_path: Path) -> None:
    zombie = subprocess.Popen([sys.executable, "-c", ""], stdout=subprocess.PIPE)
    with zombie:
        zombie.stdout.read()
        stat = Path(f"/proc/{zombie.pid}/stat")
        while stat.read_text().rsplit(")", 1)[1].split()[0] != "Z":
            time.sleep(0.005)
        left = file.with_name(f".{file.name}.{socket.gethostname()}.{zombie.pid}.tmp")
        left.write_bytes(b"half")
        remove_leftovers(tmp_path)
    assert not left.exists()


def test_a_sweep_removes_leftovers(swept: Path, small: Path, sweep: Callable) -> None:
    folder = swept / "small" / "slow"
    left = folder / f".assess-x.000000.h5.{socket.gethostname()}.{dead_process()}.tmp"
    left.write_bytes(b"half")
    assert sweep(small, swept).exit_code == 0
    assert not left.exists()


# damage


def never_read(path: Path, original: dict[str, Any], same_data: Callable) -> Condition:
    """Return the condition of a damaged file, which may be whole only if its data are."""
    found = store.inspect(path).condition
    if found is Condition.WHOLE:
        assert same_data(store.read(path), original)
    return found


def test_a_truncated_file_is_never_read(file: Path) -> None:
    content = file.read_bytes()
    lengths = [*range(9), *np.linspace(9, len(content) - 1, 60, dtype=int).tolist()]
    for length in lengths:
        file.write_bytes(content[:length])
        assert store.inspect(file).condition in (Condition.DAMAGED, Condition.FOREIGN), length


def test_a_grown_file_is_whole_or_damaged(file: Path, same_data: Callable) -> None:
    original = store.read(file)
    with file.open("ab") as opened:
        opened.write(bytes(1000))
    never_read(file, original, same_data)


def test_flipped_bytes_of_numbers_are_found(file: Path) -> None:
    content = file.read_bytes()
    with h5py.File(file, "r") as opened:
        spans = []
        for name in ("measured_point", "true_q_ib", "time_s", "run", "repairs"):
            info = opened[name].id.get_chunk_info(0)
            spans.append((info.byte_offset, info.size))
    for start, size in spans:
        for at in np.linspace(start, start + size - 1, 8, dtype=int):
            damaged = bytearray(content)
            damaged[at] ^= 0x10
            file.write_bytes(damaged)
            assert store.inspect(file).condition is Condition.DAMAGED


def flipped_everywhere(file: Path, step: int) -> Any:
    content = file.read_bytes()
    for at in range(3, len(content), step):
        damaged = bytearray(content)
        damaged[at] ^= 0x21
        file.write_bytes(damaged)
        yield at


def test_flipped_bytes_anywhere_give_no_wrong_number(file: Path, same_data: Callable) -> None:
    original = {k: v for k, v in store.read(file).items() if v.dtype.kind == "f"}
    for at in flipped_everywhere(file, 97):
        if store.inspect(file).condition is Condition.WHOLE:
            data = {k: v for k, v in store.read(file).items() if v.dtype.kind == "f"}
            assert same_data(data, original), at


TEXTS = [b"nozzle", "Flügel".encode(), b"ValueError: no", b"0123456789abcdef", b'{"noise_m"']


@pytest.mark.parametrize("text", TEXTS)
@pytest.mark.parametrize("mask", [0x01, 0x80])
def test_flipped_bytes_of_texts_are_found(text: bytes, mask: int, file: Path) -> None:
    content = bytearray(file.read_bytes())
    content[content.index(text) + 1] ^= mask
    file.write_bytes(content)
    assert store.inspect(file).condition is Condition.DAMAGED


def test_a_damaged_attribute_gives_no_trace(swept: Path, small: Path, sweep: Callable) -> None:
    path = swept / "small" / "slow" / "filter-triad.000000.h5"
    content = path.read_bytes()
    path.write_bytes(content.replace(b'{"filter": {', b'["filter": {'))
    option = ("--set", "estimators.triad.filter.alpha=0.9")
    assert sweep(small, swept, *option, "--dry-run").exit_code == 0


@pytest.mark.parametrize("how", ["truncated", "flipped", "emptied"])
def test_a_damaged_file_is_computed_again_with_a_notice(
    how: str, swept: Path, reference: Path, small: Path, sweep: Callable
) -> None:
    path = swept / "small" / "slow" / "assess-triad.000000.h5"
    content = bytearray(path.read_bytes())
    if how == "flipped":
        with h5py.File(path, "r") as opened:
            content[opened["pitch"].id.get_chunk_info(0).byte_offset + 5] ^= 1
    path.write_bytes(content if how == "flipped" else content[: 9000 * (how == "truncated")])
    result = sweep(small, swept)
    assert result.exit_code == 0
    assert f"{path} is truncated or damaged: it is computed again" in result.stderr
    assert "[1/1]" in result.stderr
    table = (swept / "small" / "tables.csv").read_bytes()
    assert table == (reference / "small" / "tables.csv").read_bytes()


def test_an_older_file_is_computed_again_with_a_notice(
    swept: Path, reference: Path, small: Path, sweep: Callable
) -> None:
    path = swept / "small" / "slow" / "assess-triad.000000.h5"
    with h5py.File(path, "r+") as file:
        file.attrs["schema_version"] = store.SCHEMA_VERSION - 1
        file["pitch"][...] = 5.0
    assert store.inspect(path).condition is Condition.OTHER_VERSION
    result = sweep(small, swept)
    assert result.exit_code == 0
    assert f"{path} is of another version of debrisest: it is computed again" in result.stderr
    table = (swept / "small" / "tables.csv").read_bytes()
    assert table == (reference / "small" / "tables.csv").read_bytes()


# what is not ours


def other_hdf5(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file["measured_point"] = np.ones((2, 3))


def other_hdf5_with_format(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.attrs["format"] = ["a", "b"]


def other_hdf5_with_group(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.attrs["format"] = "keras"
        file.create_group("model")["weights"] = np.ones(4)


def text(path: Path) -> None:
    path.write_text("the only copy of my notes")


def picture(path: Path) -> None:
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(50))


def folder(path: Path) -> None:
    path.mkdir()
    (path / "notes").write_text("mine")


FOREIGN = {
    make.__name__: make
    for make in (
        *(other_hdf5, other_hdf5_with_format, other_hdf5_with_group),
        *(text, picture, folder),
    )
}


@pytest.mark.parametrize("name", FOREIGN)
def test_a_foreign_file_is_refused_and_left_alone(
    name: str, swept: Path, small: Path, sweep: Callable
) -> None:
    path = swept / "small" / "slow" / "recover-wahba.000000.h5"
    path.unlink()
    FOREIGN[name](path)
    content = path.read_bytes() if path.is_file() else None
    for options in ((), ("--dry-run",), ("--force",)):
        result = sweep(small, swept, *options)
        assert result.exit_code == 2
        assert result.stdout == ""
        assert len(result.stderr.splitlines()) == 1
        assert str(path) in result.stderr
        assert "--out" in result.stderr
    assert path.exists()
    assert content is None or path.read_bytes() == content


def test_a_missing_file(tmp_path: Path) -> None:
    assert store.inspect(tmp_path / "none.h5").condition is Condition.MISSING


def test_a_copy_elsewhere_is_the_same(swept: Path, tmp_path: Path, same_data: Callable) -> None:
    path = swept / "small" / "slow" / "simulate.000000.h5"
    copy = Path(shutil.copy(path, tmp_path / "copy.h5"))
    assert store.inspect(copy).condition is Condition.WHOLE
    assert same_data(store.read(copy), store.read(path))
