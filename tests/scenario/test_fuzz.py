"""A damaged scenario file is loaded or refused in words, never with a trace."""

import tempfile
from pathlib import Path

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from debrisest.errors import UserError
from debrisest.scenario.load import load_scenario

SMALL = (Path(__file__).parent.parent / "scenarios" / "small.yaml").read_text()
LINES = SMALL.splitlines(keepends=True)
TOKENS = [
    "null", "~", "true", "-1", "0", "1e400", ".inf", "[]", "{}", "''", '"', "[1]", "{a: 1}", "?",
    "- ", ": ", "#", "|", ">", "&x", "*x", "%", "@", "`", "\t", "---",
    "...", "\ufeff", "\u0085", "\x00", "é", "kind", "unscented", "x" * 300,
]  # fmt: skip


def check(raw: bytes) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "small.yaml"
        path.write_bytes(raw)
        try:
            assert load_scenario(path).cases
        except UserError as error:
            assert error.problems
            assert all(problem.startswith(str(path)) for problem in error.problems)


positions = st.integers(0, len(SMALL))
QUIET = settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow])


@QUIET
@given(positions, st.integers(0, 30), st.text(max_size=4) | st.sampled_from(TOKENS))
def test_replaced_characters(at: int, length: int, text: str) -> None:
    damaged = SMALL[:at] + text + SMALL[at + length :]
    check(damaged.encode("utf-8", "surrogatepass"))


@QUIET
@given(st.lists(st.integers(0, len(LINES) - 1), min_size=1, max_size=4), st.randoms())
def test_deleted_duplicated_and_moved_lines(chosen: list[int], random) -> None:  # type: ignore[no-untyped-def]
    lines = list(LINES)
    for index in chosen:
        index = min(index, len(lines) - 1)
        how = random.choice(("delete", "double", "move", "indent"))
        line = lines[index]
        if how in ("delete", "move"):
            del lines[index]
        if how in ("double", "move"):
            lines.insert(random.randint(0, len(lines)), line)
        if how == "indent":
            lines[index] = " " * random.randint(1, 5) + line
    check("".join(lines).encode())


@QUIET
@given(st.integers(0, len(SMALL) - 1), st.binary(min_size=1, max_size=8))
def test_random_bytes(at: int, raw: bytes) -> None:
    encoded = SMALL.encode()
    check(encoded[:at] + raw + encoded[at + len(raw) :])


@QUIET
@given(st.data())
def test_values_replaced_by_other_values(data) -> None:  # type: ignore[no-untyped-def]
    lines = list(LINES)
    index = data.draw(st.sampled_from([i for i, line in enumerate(lines) if ":" in line]))
    key = lines[index].split(":")[0]
    lines[index] = f"{key}: {data.draw(st.sampled_from(TOKENS))}\n"
    check("".join(lines).encode())


@QUIET
@given(st.binary(max_size=60))
def test_any_bytes(raw: bytes) -> None:
    check(raw)
