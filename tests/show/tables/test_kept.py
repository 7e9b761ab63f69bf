"""Cells are taken as they were made only where all that they follow from is the same."""

import json
import os
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

import pytest

from debrisest.results import store
from debrisest.show.tables import kept as module
from debrisest.show.tables.kept import NAME

FILES = ("tables.csv", "tables.md", "tables.tex")


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many cells were made, each time that any were."""
    counts: list[int] = []
    original = module.kept

    def kept(scenario: object, results: object, make: Callable[[], list]) -> list:
        def counted() -> list:
            rows = make()
            counts.append(len(rows))
            return rows

        return original(scenario, results, counted)

    monkeypatch.setattr("debrisest.show.tables.tabulate.kept", kept)
    return counts


def test_cells_are_made_once_and_shown_the_same(
    small: Path, swept: Path, cli: Callable, made: list[int]
) -> None:
    folder = swept / "small"
    (folder / NAME).unlink(missing_ok=True)
    first = cli("table", small, "--out", swept)
    before = [(folder / name).read_bytes() for name in FILES]
    for name in FILES:
        (folder / name).unlink()
    again = cli("table", small, "--out", swept)
    assert made == [len((folder / "tables.csv").read_text().splitlines()) - 1]
    assert again.stdout == first.stdout
    assert [(folder / name).read_bytes() for name in FILES] == before


@pytest.mark.parametrize(
    "change",
    [
        *("values", "seal", "cut", "empty", "other rows under a seal of their own"),
        *("folder", "pipe", "device", "nowhere", "bytes"),
    ],
)
def test_cells_that_were_changed_by_hand_or_by_a_disk_are_made_again(
    change: str, small: Path, swept: Path, cli: Callable, made: list[int]
) -> None:
    folder = swept / "small"
    cli("table", small, "--out", swept)
    before, path = (folder / "tables.csv").read_bytes(), folder / NAME
    seal, rows = path.read_text().split("\n")
    other = json.dumps([row | {"measured": 2 * row["measured"]} for row in json.loads(rows)])
    text = {
        "values": f"{seal}\n{other}",
        "seal": f"{seal[::-1]}\n{rows}",
        "cut": f"{seal}\n{rows[: len(rows) // 2]}",
        "empty": "",
        "other rows under a seal of their own": f"{sha256(rows.encode()).hexdigest()}\n{rows}",
    }.get(change)
    path.unlink()
    if text is not None:
        path.write_text(text)
    elif change == "folder":
        path.mkdir()
    elif change == "pipe":
        os.mkfifo(path)
    elif change in ("device", "nowhere"):
        path.symlink_to("/dev/zero" if change == "device" else "/none/there")
    else:
        path.write_bytes(bytes(range(128, 256)))
    made.clear()
    assert cli("table", small, "--out", swept).exit_code == 0
    assert len(made) == 1
    assert (folder / "tables.csv").read_bytes() == before


def test_another_file_with_the_same_name_size_and_times_is_seen(
    small: Path, swept: Path, cli: Callable, made: list[int]
) -> None:
    """The pitch errors of a file are halved under a new seal, and its times are set back."""
    folder = swept / "small"
    cli("table", small, "--out", swept)
    before, path = (folder / "tables.csv").read_text(), next(swept.rglob("assess-triad.*.h5"))
    state, told = path.stat(), store.inspect(path).attributes
    data = store.read(path)
    store.write(path, data | {"pitch": data["pitch"] / 2}, told)
    os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns))
    made.clear()
    cli("table", small, "--out", swept)
    assert len(made) == 1
    assert (folder / "tables.csv").read_text() != before


def test_a_damaged_file_shows_no_cells_although_they_were_kept(
    small: Path, swept: Path, cli: Callable
) -> None:
    folder = swept / "small"
    cli("table", small, "--out", swept)
    path = next(swept.rglob("slow/assess-triad.*.h5"))
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    shown = cli("table", small, "--out", swept)
    assert "left out of the tables: small slow: assess triad" in shown.stderr
    rows = (folder / "tables.csv").read_text().splitlines()
    assert not [row for row in rows if ",slow,triad," in row]


@pytest.mark.parametrize("what", ["published", "tables", "code", "runs"])
def test_what_cells_follow_from_beside_files_counts(
    what: str, small: Path, swept: Path, cli: Callable, made: list[int],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    cli("table", small, "--out", swept)
    made.clear()
    more: list[object] = []
    if what == "published":
        values = small.with_suffix(".csv")
        text = values.read_text().splitlines()
        values.write_text("\n".join([text[0], *text[2:]]) + "\n")
    elif what == "tables":
        text = small.read_text()
        assert "statistics: [" in text
        small.write_text(text.replace("statistics: [", "statistics: [p90, ", 1))
    elif what == "code":
        monkeypatch.setattr(module, "fingerprint", lambda: {"debrisest": "0"})
    else:
        more = ["--runs", 1]
    assert cli("table", small, "--out", swept, *more).exit_code == 0
    assert len(made) == 1


def test_results_that_cannot_be_written_to_show_their_tables(
    small: Path, swept: Path, cli: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = cli("table", small, "--out", swept)
    (swept / "small" / NAME).unlink()

    def refused(path: Path, content: bytes) -> None:
        raise OSError(30, "Read-only file system", str(path))

    monkeypatch.setattr(module, "put", refused)
    assert cli("table", small, "--out", swept).stdout == first.stdout
    assert not (swept / "small" / NAME).exists()


def test_rows_come_back_to_the_bit(small: Path, swept: Path, cli: Callable) -> None:
    cli("table", small, "--out", swept)
    rows = json.loads((swept / "small" / NAME).read_text().split("\n")[1])
    written = (swept / "small" / "tables.csv").read_text().splitlines()[1:]
    for row, line in zip(rows, written, strict=True):
        assert repr(row["measured"]).replace("nan", "") in line.split(",")


def test_no_cells_are_kept_where_there_are_no_results(small: Path, tmp_path: Path, cli: Callable):
    cli("table", small, "--out", tmp_path / "none")
    assert not list(tmp_path.rglob(NAME))
