"""A thousand damaged files: a sentence with file and line, or a right reading, never a wrong one.

Each kind of damage knows what it may change: a reading that it lets pass is compared with the
undamaged one. A damage that leaves a valid file with other numbers must be told, by `check_rigid`
or by a note.
"""

import re
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from debrisest.errors import UserError
from debrisest.tracks.read import read_measured
from debrisest.tracks.rigid import check_rigid
from debrisest.tracks.types import BodyPoints, Tracks
from tests.tracks.conftest import BODY, long_text, motion

Random = np.random.Generator
TIMES, POINTS = motion()
TEXT = long_text(TIMES, POINTS)
HEADER, *ROWS = TEXT.splitlines()
KNOWN = BodyPoints("body.csv", ("p1", "p2", "p3", "p4", "p5"), BODY)
SAME, FEWER, TOLD, REFUSED = "same", "fewer", "told", "refused"
"""A reading must be the same; the same but for features not seen; told if it differs; none."""


def joined(header: str, rows: list[str]) -> str:
    return "\n".join([header, *rows]) + "\n"


def cells(change: Callable[[list[str]], list[str]], header: bool = True) -> str:
    """All rows (and the header) with their cells changed."""
    first = change(HEADER.split(",")) if header else HEADER.split(",")
    return joined(",".join(first), [",".join(change(row.split(","))) for row in ROWS])


def place(rng: Random) -> tuple[int, int]:
    return int(rng.integers(len(ROWS))), int(rng.integers(6))


def one_cell(rng: Random, column: int | None, change: Callable[[str], str]) -> str:
    row, drawn = place(rng)
    parts = ROWS[row].split(",")
    at = drawn if column is None else column
    parts[at] = change(parts[at])
    return joined(HEADER, [*ROWS[:row], ",".join(parts), *ROWS[row + 1 :]])


def dropped_rows(rng: Random) -> str:
    kept = rng.random(len(ROWS)) > 0.1
    return joined(HEADER, [row for row, keep in zip(ROWS, kept) if keep])


def doubled_rows(rng: Random) -> str:
    again = [ROWS[index] for index in rng.integers(len(ROWS), size=3)]
    return joined(HEADER, [*ROWS, *again])


def shuffled_rows(rng: Random) -> str:
    return joined(HEADER, [ROWS[index] for index in rng.permutation(len(ROWS))])


def ordered_columns(rng: Random) -> str:
    order = rng.permutation(6)
    return cells(lambda parts: [parts[index] for index in order])


def other_delimiter(rng: Random) -> str:
    return TEXT.replace(",", ";" if rng.random() < 0.5 else "\t")


def decimal_commas(rng: Random) -> str:
    return other_delimiter(rng).replace(".", ",")


def line_ends(rng: Random) -> str:
    return TEXT.replace("\n", "\r\n" if rng.random() < 0.5 else "\r")


def byte_order_mark(rng: Random) -> str:
    return "\ufeff" + TEXT


def comments(rng: Random) -> str:
    row = place(rng)[0]
    return joined(HEADER, [*ROWS[:row], "# a remark, with commas", "", *ROWS[row:]])


def quoted(rng: Random) -> str:
    return one_cell(rng, None, lambda cell: f'"{cell}"')


def decimal_commas_between_commas(rng: Random) -> str:
    return TEXT.replace(".", ",")


def one_decimal_comma(rng: Random) -> str:
    return one_cell(rng, int(rng.integers(2, 6)), lambda cell: cell.replace(".", ","))


def one_delimiter(rng: Random) -> str:
    row, at = place(rng)
    parts = ROWS[row].split(",")
    swapped = ";".join([",".join(parts[: at or 1]), ",".join(parts[at or 1 :])])
    return joined(HEADER, [*ROWS[:row], swapped, *ROWS[row + 1 :]])


def dropped_column(rng: Random) -> str:
    gone = int(rng.integers(5))
    return cells(lambda parts: parts[:gone] + parts[gone + 1 :])


def lost_cell(rng: Random) -> str:
    row, at = place(rng)
    parts = ROWS[row].split(",")
    return joined(HEADER, [*ROWS[:row], ",".join(parts[:at] + parts[at + 1 :]), *ROWS[row + 1 :]])


def misspelt_header(rng: Random) -> str:
    at = int(rng.integers(len(HEADER)))
    if HEADER[at] == ",":
        return joined(HEADER[:at] + "," + HEADER[at:], ROWS)
    return joined(HEADER[:at] + HEADER[at + 1 :], ROWS)


def no_header(rng: Random) -> str:
    return "\n".join(ROWS[int(rng.integers(3)) :]) + "\n"


def inserted_text(rng: Random) -> str:
    words = ("abc", "--", "1.2.3", "N/A", "é", "\u00a0", "1e", "0x10", "١", "\u2212")
    word = words[int(rng.integers(len(words)))]
    return one_cell(rng, int(rng.integers(2, 5)), lambda cell: cell[:2] + word + cell[2:])


def nul_bytes(rng: Random) -> str:
    at = int(rng.integers(len(TEXT)))
    return TEXT[:at] + "\0" + TEXT[at:]


def wrong_encoding(rng: Random) -> bytes:
    if rng.random() < 0.5:
        return TEXT.encode("utf-16")
    return TEXT.replace("p1", "pä").encode("latin-1")


def binary(rng: Random) -> bytes:
    return rng.bytes(200)


def huge_number(rng: Random) -> str:
    value = ("1e300", "-1e400", "inf", "9" * 40)[int(rng.integers(4))]
    return one_cell(rng, int(rng.integers(2, 6)), lambda _: value)


def zeros_for_not_seen(rng: Random) -> str:
    row = place(rng)[0]
    parts = ROWS[row].split(",")
    parts[2:5] = ["0", "0.0", "0.000"]
    return joined(HEADER, [*ROWS[:row], ",".join(parts), *ROWS[row + 1 :]])


def empty_cells(rng: Random) -> str:
    return one_cell(rng, int(rng.integers(6)), lambda _: "")


def negative_sigma(rng: Random) -> str:
    return one_cell(rng, 5, lambda cell: "-" + cell)


def contradicting_row(rng: Random) -> str:
    row = ROWS[place(rng)[0]].split(",")
    row[2] = f"{float(row[2]) + 0.1:.6f}"
    return joined(HEADER, [*ROWS, ",".join(row)])


def doubled_epoch(rng: Random) -> str:
    """An epoch under the time of the next one: all its rows contradict."""
    n = int(rng.integers(len(TIMES) - 1))
    return TEXT.replace(f"\n{TIMES[n]:.3f},", f"\n{TIMES[n + 1]:.3f},")


def scaled_column(rng: Random) -> str:
    at, factor = int(rng.integers(2, 5)), (1e3, 1e-3)[int(rng.integers(2))]
    scaled = lambda p: [*p[:at], f"{float(p[at]) * factor:.9f}", *p[at + 1 :]]  # noqa: E731
    return cells(scaled, header=False)


def swapped_names(rng: Random) -> str:
    a, b = sorted(rng.choice([0, 2, 3, 4, 5], 2, replace=False))
    names = HEADER.split(",")
    names[a], names[b] = names[b], names[a]
    return joined(",".join(names), ROWS)


def mirrored_axis(rng: Random) -> str:
    at = int(rng.integers(2, 5))
    flipped = lambda p: [*p[:at], f"{-float(p[at]):.6f}", *p[at + 1 :]]  # noqa: E731
    return cells(flipped, header=False)


def swapped_cells(rng: Random) -> str:
    row = place(rng)[0]
    a, b = sorted(rng.choice([0, 2, 3, 4], 2, replace=False))
    parts = ROWS[row].split(",")
    parts[a], parts[b] = parts[b], parts[a]
    return joined(HEADER, [*ROWS[:row], ",".join(parts), *ROWS[row + 1 :]])


def misspelt_feature(rng: Random) -> str:
    return one_cell(rng, 1, lambda cell: cell.upper() + "x")


def cut(rng: Random) -> str:
    return TEXT[: int(rng.integers(1, len(TEXT)))]


KINDS: dict[Callable[[Random], str | bytes], str] = {
    dropped_rows: FEWER, doubled_rows: SAME, shuffled_rows: SAME, ordered_columns: SAME,
    other_delimiter: SAME, decimal_commas: SAME, line_ends: SAME, byte_order_mark: SAME,
    comments: SAME, quoted: SAME, decimal_commas_between_commas: REFUSED,
    one_decimal_comma: REFUSED, one_delimiter: REFUSED, dropped_column: REFUSED,
    lost_cell: REFUSED, misspelt_header: REFUSED, no_header: REFUSED, inserted_text: REFUSED,
    nul_bytes: REFUSED, wrong_encoding: REFUSED, binary: REFUSED, huge_number: REFUSED,
    zeros_for_not_seen: REFUSED, empty_cells: REFUSED, negative_sigma: REFUSED,
    contradicting_row: REFUSED, doubled_epoch: REFUSED, scaled_column: TOLD,
    swapped_names: TOLD, mirrored_axis: TOLD, swapped_cells: TOLD, misspelt_feature: TOLD,
    cut: TOLD,
}  # fmt: skip
EACH = -(-1000 // len(KINDS))
UNDAMAGED = 2  # notes of a plain file: its delimiter and decimal mark


def same_but_for_gaps(tracks: Tracks, gaps: bool) -> bool:
    """Whether a reading holds the undamaged points; all of them, if there may be no gaps."""
    if not set(tracks.features) <= set(KNOWN.features) or not np.isin(tracks.times, TIMES).all():
        return False
    expected = np.round(POINTS, 6)[np.isin(TIMES, tracks.times)]
    expected = expected[:, np.isin(KNOWN.features, tracks.features)]
    assert tracks.points is not None and tracks.point_sigma is not None
    sigma = tracks.point_sigma[~np.isnan(tracks.points)]
    missing = np.isnan(tracks.points)
    whole = tracks.points.shape == POINTS.shape and not missing.any()
    return (
        (whole or gaps)
        and (sigma == 0.01).all()
        and np.array_equal(np.where(missing, expected, tracks.points), expected)
    )


def told(tracks: Tracks) -> bool:
    odd = (
        "cut there",
        "seen in one row only",
        "one epoch only",
        "one feature only",
        "less than a thousandth",
    )
    return bool(check_rigid(tracks, KNOWN)) or any(o in n for o in odd for n in tracks.notes)


@pytest.mark.parametrize("damage", KINDS, ids=lambda kind: kind.__name__)
def test_damaged_tracks(damage: Callable[[Random], str | bytes], tmp_path: Path) -> None:
    seen: Counter[str] = Counter()
    for seed in range(EACH):
        content = damage(np.random.default_rng(seed))
        path = tmp_path / f"{seed}.csv"
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        seen[outcome(path, KINDS[damage])] += 1
    assert set(seen) <= {KINDS[damage], REFUSED} if KINDS[damage] == TOLD else {KINDS[damage]}, seen


def outcome(path: Path, expected: str) -> str:
    """What became of a file; every refusal has the file and a line, or is of the file itself."""
    try:
        tracks = read_measured(path)
    except UserError as error:
        for problem in error.problems:
            whole = rf"{re.escape(str(path))}: (and|the file is empty|the file holds|not JSON)"
            assert re.match(rf"{re.escape(str(path))}:\d+: |{whole}", problem), problem
        return REFUSED
    assert isinstance(tracks, Tracks)
    if same_but_for_gaps(tracks, gaps=expected != SAME):
        return SAME if expected == SAME else FEWER if expected == FEWER else TOLD
    return TOLD if told(tracks) else "wrong and silent"
