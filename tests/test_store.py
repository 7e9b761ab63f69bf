"""Checkpoints: whole or not there, readable by others, and never read when damaged or foreign."""

import errno
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray

from debrisest import files
from debrisest.errors import UserError
from debrisest.results import sealed, store, written
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
    [(written, "_write_data"), (sealed, "sha256"), (Path, "write_bytes"), (files, "_synchronise")],
)
def test_a_write_that_fails_leaves_the_old_file(
    module: object, moment: str, file: Path, monkeypatch: pytest.MonkeyPatch, same_data: Callable
) -> None:
    before, content = store.read(file), file.read_bytes()

    def fail(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(module, moment, fail)
        with pytest.raises(OSError, match="No space"):
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


def flipped(content: bytes, at: int, mask: int = 0x21) -> bytes:
    return content[:at] + bytes([content[at] ^ mask]) + content[at + 1 :]


def test_a_flipped_bit_anywhere_is_found(file: Path) -> None:
    content = file.read_bytes()
    for at in range(0, len(content), 41):
        file.write_bytes(flipped(content, at, 1 << at % 8))
        assert store.inspect(file).condition is Condition.DAMAGED, at
        with pytest.raises(UserError, match="truncated or damaged; a sweep computes it again"):
            store.read(file)


def test_a_page_that_is_lost_is_found(file: Path) -> None:
    """HDF5 alone hangs for ever on some of them."""
    content = file.read_bytes()
    pages = [bytes(4096), bytes([255]) * 4096, content[:4096], content[4096:8192]]
    for start in range(0, len(content), 4096):
        for page in pages:
            lost = (content[:start] + page + content[start + 4096 :])[: len(content)]
            if lost != content:
                file.write_bytes(lost)
                assert store.inspect(file).condition is Condition.DAMAGED, start


def test_a_file_of_zeros_is_damaged(file: Path) -> None:
    file.write_bytes(bytes(3_000_000))
    assert store.inspect(file).condition is Condition.DAMAGED
    file.write_bytes(bytes(3_000_000) + b"notes")
    assert store.inspect(file).condition is Condition.FOREIGN


def _edited(edit: Callable[[Any], object]) -> Callable[[Path], None]:
    def damage(path: Path) -> None:
        with h5py.File(path, "r+") as opened:
            edit(opened)

    return damage


def _external(opened: Any) -> None:
    del opened["true_q_ib"]
    opened["true_q_ib"] = h5py.ExternalLink("other.h5", "true_q_ib")


def _virtual(opened: Any) -> None:
    del opened["true_q_ib"]
    layout = h5py.VirtualLayout(shape=(3, 40, 4), dtype="f8")
    layout[:] = h5py.VirtualSource("other.h5", "true_q_ib", shape=(3, 40, 4))
    opened.create_virtual_dataset("true_q_ib", layout)


def _raw(opened: Any) -> None:
    del opened["true_q_ib"]
    place = [("numbers", 0, h5py.h5f.UNLIMITED)]
    opened.create_dataset("true_q_ib", (3, 40, 4), "f8", external=place)


def _units(opened: Any) -> None:
    opened["measured_point"].attrs["units"] = "km"


def _type(opened: Any) -> None:
    del opened["true_q_ib"]
    opened["true_q_ib"] = np.zeros((3, 40, 4), dtype="i4")


def _axis(opened: Any) -> None:
    del opened["true_q_ib"]
    opened["true_q_ib"] = np.zeros((3, 40, 5))


EDITS = [_external, _virtual, _raw, _units, _type, _axis]


@pytest.mark.parametrize("edit", [*EDITS, lambda opened: opened.pop("run")])
def test_an_edited_file_is_damaged(edit: Callable, file: Path) -> None:
    _edited(edit)(file)
    assert store.inspect(file).condition is Condition.DAMAGED


@pytest.mark.parametrize("edit", EDITS)
def test_what_is_no_dataset_of_ours_is_damage_even_under_a_seal(
    edit: Callable, file: Path, tmp_path: Path
) -> None:
    bare = tmp_path / "bare.h5"
    bare.write_bytes(written.image_of(example(), ATTRIBUTES, {}))
    label = store.inspect(file).attributes
    file.write_bytes(sealed.sealed(bare.read_bytes(), label))
    assert store.inspect(file).condition is Condition.WHOLE
    _edited(edit)(bare)
    file.write_bytes(sealed.sealed(bare.read_bytes(), label))
    assert store.inspect(file).condition is Condition.DAMAGED


@pytest.mark.parametrize(
    ("name", "value"),
    [("plugins", 5), ("inputs", "[" * 9999), ("datasets", None), ("runs", "3"), ("runs", 10**40),
     ("first_run", 1e6), ("scenario", {}), ("software", ["numpy"])],
)  # fmt: skip
def test_a_label_that_no_step_writes_is_damage_even_under_a_seal(
    name: str, value: object, swept: Path, reference: Path, small: Path, sweep: Callable, cli: Any
) -> None:
    path = swept / "small" / "slow" / "filter-wahba.000000.h5"
    with path.open("rb") as file:
        label = sealed.read_label(file)
        content = sealed.read_image(file, label)
    path.write_bytes(sealed.sealed(content, label.attributes | {name: value}))
    for command in ("status", "table"):
        assert cli(command, small, "--out", swept).exit_code == 0
    result = sweep(small, swept)
    assert result.exit_code == 0
    assert str(path) in result.stderr
    table = (swept / "small" / "tables.csv").read_bytes()
    assert table == (reference / "small" / "tables.csv").read_bytes()


@pytest.mark.parametrize("how", ["truncated", "flipped", "emptied"])
def test_a_damaged_file_is_computed_again_with_a_notice(
    how: str, swept: Path, reference: Path, small: Path, sweep: Callable
) -> None:
    path = swept / "small" / "slow" / "assess-triad.000000.h5"
    content = path.read_bytes()
    changed = {"truncated": content[:9000], "flipped": flipped(content, 9000), "emptied": b""}
    path.write_bytes(changed[how])
    result = sweep(small, swept)
    assert result.exit_code == 0
    assert f"{path} is truncated or damaged: it is computed again" in result.stderr
    assert "[1/1]" in result.stderr
    table = (swept / "small" / "tables.csv").read_bytes()
    assert table == (reference / "small" / "tables.csv").read_bytes()


def _with_a_seal(path: Path) -> None:
    label = store.inspect(path).attributes | {"schema_version": store.SCHEMA_VERSION - 1}
    path.write_bytes(sealed.sealed(path.read_bytes(), label))


def _without_a_seal(path: Path) -> None:
    """As up to version 2 of the layout."""
    with h5py.File(path, "w", libver="latest") as file:
        file.attrs.update({"format": "debrisest checkpoint", "text_checksum": "0" * 64})
        file["pitch"] = np.full((3, 60), 5.0)


older = {"sealed": _with_a_seal, "not sealed": _without_a_seal}


@pytest.mark.parametrize("how", older)
def test_an_older_file_is_computed_again_with_a_notice(
    how: str, swept: Path, reference: Path, small: Path, sweep: Callable
) -> None:
    path = swept / "small" / "slow" / "assess-triad.000000.h5"
    older[how](path)
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


@pytest.mark.parametrize("start", [b"", b"\x89HDF\r\n\x1a\n"])
def test_what_is_far_too_long_is_foreign_without_being_read(start: bytes, tmp_path: Path) -> None:
    """A terabyte, which takes no room on the disk."""
    path = tmp_path / "simulate.000000.h5"
    with path.open("wb") as file:
        file.write(start)
        file.truncate(2**40)
    assert store.inspect(path).condition is Condition.FOREIGN


def test_a_missing_file(tmp_path: Path) -> None:
    assert store.inspect(tmp_path / "none.h5").condition is Condition.MISSING


def test_a_copy_elsewhere_is_the_same(swept: Path, tmp_path: Path, same_data: Callable) -> None:
    path = swept / "small" / "slow" / "simulate.000000.h5"
    copy = Path(shutil.copy(path, tmp_path / "copy.h5"))
    assert store.inspect(copy).condition is Condition.WHOLE
    assert same_data(store.read(copy), store.read(path))
