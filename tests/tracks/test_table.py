"""The strict reader of tables: delimiters, decimal marks, encodings, and where errors are."""

import numpy as np
import pytest

from debrisest.tracks.columns import Layout
from debrisest.tracks.sheet import open_sheet
from debrisest.tracks.table import Table, read_table
from tests.tracks.conftest import Write, refusal

LAYOUT = Layout(("time_s", "name", "x_m"), ("y_m",), frozenset(("name",)), frozenset(("y_m",)))
PLAIN = "time_s,name,x_m,y_m\n0,a,1.5,2\n1,b,-2e-3,\n"


def read(path) -> Table:  # type: ignore[no-untyped-def]
    return read_table(open_sheet(path), LAYOUT)


def refused(path) -> str:  # type: ignore[no-untyped-def]
    return refusal(lambda: read(path)).replace(str(path), "F")


def same(table: Table) -> None:
    np.testing.assert_array_equal(table.numbers["time_s"], [0.0, 1.0])
    np.testing.assert_array_equal(table.numbers["x_m"], [1.5, -0.002])
    np.testing.assert_array_equal(table.numbers["y_m"], [2.0, np.nan])
    assert table.texts["name"] == ["a", "b"]


@pytest.mark.parametrize(
    "content",
    [
        PLAIN,
        "\ufeff" + PLAIN,
        PLAIN.replace("\n", "\r\n"),
        PLAIN.replace("\n", "\r"),
        "# made by hand\n\n" + PLAIN.replace("1,b", "# a gap, then\n \n1,b"),
        PLAIN.replace(",", ", "),
        PLAIN.replace(",", ";"),
        PLAIN.replace(",", ";").replace(".", ","),
        PLAIN.replace(",", "\t").replace(".", ","),
        PLAIN.replace(",a,", ',"a",').replace("name", '"name"').replace(",1.5", ',"1.5"'),
        "x_m,y_m,name,time_s\n1.5,2,a,0\n-2e-3,NaN,b,1\n",
        PLAIN.rstrip("\n"),
    ],
)
def test_the_same_table_in_many_forms(write: Write, content: str) -> None:
    same(read(write(content)))


def test_what_was_understood_is_told(write: Write) -> None:
    told = read(write(PLAIN.replace(",", ";").replace(".", ","))).notes
    assert told[0] == "columns separated by semicolons"
    assert told[1] == "decimal commas: 1,5 is read as 1.5"
    assert "cut" in read(write(PLAIN.rstrip("\n"))).notes[1]


def test_lines_are_those_of_the_file(write: Write) -> None:
    content = "# one\n\n" + PLAIN.replace("1,b", "# five\n\n1,b")
    np.testing.assert_array_equal(read(write(content)).lines, [4, 7])


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "F: the file is empty"),
        ("\ufeff\n", "F: the file is empty"),
        ("# nothing\n", "F: the file holds comments only"),
        ("time_s,name,x_m\n", "F:1: there is a header, but no row"),
        ("time_s name x_m\n1 a 2\n", "F:1: the header 'time_s name x_m' has one column only"),
        ("time_s;name,x_m\n1;a,2\n", "F:1: the header has commas and semicolons"),
        ("0,a,1.5\n1,b,2\n", "F:1: 0 where a column's name should be: the header is missing"),
        ("time_s,name,x_m,x_m\n0,a,1,2\n", "F:1: column 'x_m' is there twice"),
        ("time_s,name\n0,a\n", "F:1: column x_m is missing; the header has time_s, name"),
        ("time_s,name,x_m,\n0,a,1,\n", "F:1: a column has no name"),
        (
            "time_ms,name,x_m\n0,a,1\n",
            "F:1: unknown column time_ms: the unit is in the name; conve",
        ),
        ("time_s,name,x\n0,a,1\n", "convert the values to x_m"),
        ("time_s,nmae,x_m\n0,a,1\n", "F:1: unknown column 'nmae'; did you mean name?"),
        ("time_s,name,x_m\n0,a,1,5\n", "F:2: 4 fields, the header has 3; decimal commas need semi"),
        ("time_s,name,x_m\n0,a\n", "F:2: 2 fields, the header has 3; leave a cell empty"),
        ("time_s,name,x_m\n0;a;1\n", "F:2: 1 fields, the header has 3: it is separated by commas"),
        ('time_s,name,x_m\n0,a,"1,5"\n', "F:2: x_m: '1,5' is not a number; decimal commas"),
        ("time_s;name;x_m\n0;a;1,5\n1;a;1.5\n", "F:2: decimal comma (1,5), but a point in line 3"),
        ("time_s,name,x_m\n0,a,1.234.567\n", "F:2: x_m: '1.234.567' is not a number; write it wit"),
        ("time_s,name,x_m\n0,a,1_000\n", "F:2: x_m: '1_000' is not a number"),
        ("time_s,name,x_m\n0,a,inf\n", "F:2: x_m: 'inf' is not a number"),
        ("time_s,name,x_m\n0,a,1e300\n", "F:2: x_m: '1e300' is beyond 1e+12"),
        ("time_s,name,x_m\n0,a,1e999\n", "F:2: x_m: '1e999' is beyond 1e+12"),
        ("time_s,name,x_m\n0,a,\n", "F:2: x_m: empty; every row needs it"),
        ("time_s,name,x_m\n0,,1\n", "F:2: name: empty; every row needs it"),
        ('time_s,name,x_m\n0,"a,1\n', "F:2: a quotation mark is not closed"),
        ("time_s,name,x_m\n0,a\u200b,1\n", "F:2: name: 'a\\u200b' is not a name"),
        (b"time_s,name,x_m\n0,\0,1\n", "F:2: a NUL byte: the file is binary or damaged"),
        ("time_s,name,x_m\n0,é,1\n".encode("latin-1"), "F:2: byte 0xe9 is not UTF-8 text"),
        (PLAIN.encode("utf-16"), "F:1: this text is in UTF-16; save it as UTF-8"),
    ],
)
def test_refused_with_the_line_and_what_to_do(
    write: Write, content: str | bytes, said: str
) -> None:
    assert said in refused(write(content))


def test_folders_and_files_that_are_not_there(tmp_path) -> None:  # type: ignore[no-untyped-def]
    assert refused(tmp_path) == "F: this is a folder; give a file"
    assert refused(tmp_path / "none.csv") == "F: there is no such file"


def test_all_problems_at_once_and_then_a_count(write: Write) -> None:
    body = "".join(f"{n},a,x{n}\n" for n in range(50))
    lines = refused(write("time_s,name,x_m\n" + body)).splitlines()
    assert [line.split(":")[1] for line in lines[:20]] == [str(n) for n in range(2, 22)]
    assert lines[20:] == ["F: and 30 more"]
