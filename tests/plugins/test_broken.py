"""A plug-in that cannot be used is told in a sentence with its place, and adds nothing."""

from collections.abc import Callable
from pathlib import Path

import pytest

from debrisest.catalog import CATALOG
from debrisest.vocabulary import VOCABULARY

PART = """from typing import Literal
from debrisest.roles import SimulationPart

class Mine(SimulationPart):
    kind: Literal["mine"]

    def simulate(self, data, clock, draws):
        return {}
"""
# source, line (empty: none), words
BROKEN = {
    "syntax": ("\nx = (\n", ":2: ", ["SyntaxError"]),
    "indentation": ("if 1:\nx = 2\n", ":2: ", ["IndentationError"]),
    "name": ("import math\n\nmath.pie\n", ":3: ", ["AttributeError", "pie"]),
    "deep": ("def f():\n    1 / 0\n\nf()\n", ":2: ", ["ZeroDivisionError"]),
    "exit": ("raise SystemExit(3)\n", ":1: ", ["SystemExit: 3"]),
    "no_module": ("import no_such_module\n", ":1: ", ["no_such_module"]),
    "no_text": ("x = '\0'\n", "", ["null bytes"]),
    "empty": ("", ": ", ["no parts here", "kind: Literal"]),
    "no_kind": (
        PART.replace('    kind: Literal["mine"]\n', "") + "\nPARTS = [Mine]\n",
        ":4: ", ["Mine", 'kind: Literal["its_name"]'],
    ),
    "kind_of_two_names": (PART.replace('"mine"', '"a", "b"'), ":4: ", ["its own name"]),
    "no_part": ("PARTS = [5]\n", ": ", ["5", "not a subclass of a role"]),
    "no_list": (PART + "\nPARTS = Mine\n", ": ", ["PARTS must be a list"]),
    "no_mapping": (PART + "\nQUANTITIES = ['glare']\n", ": ", ["QUANTITIES must be a dict"]),
    "abstract": (PART.replace("simulate", "simulat"), ":4: ", ["Mine", "lacks simulate"]),
    "role": (
        PART.replace('    kind: L', '    role = "sensor"\n    kind: L'),
        ":4: ", ["unknown role 'sensor'", "sensors"],
    ),
    "shipped": (
        PART.replace('"mine"', '"feature_points"'),
        ":4: ", ["feature_points", "exists already", "parts/sensors/feature_points.py:"],
    ),
    "twice": (
        PART + PART.partition("\n\n")[2].replace("class Mine", "class Other"),
        ":9: ", ["Other: kind 'mine' of sensors exists already", "my.py:4"],
    ),
    "quantity": (PART + "\nQUANTITIES = {'rate_b': 1}\n", ": ", ["rate_b exists already"]),
    "undeclared": (
        PART.replace("    kind: L", '    measures = ("glare",)\n    kind: L'),
        ":4: ", ["Mine: QUANTITIES must declare glare"],
    ),
    "no_quantity": (PART + "\nQUANTITIES = {'glare': 1}\n", ": ", ["glare must be", "Quantity"]),
    "annotation": (PART.replace('Literal["mine"]', "Litteral"), ":5: ", ["NameError", "Litteral"]),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_plug_in(name: str, small: Path, write: Callable, cli: Callable) -> None:
    source, line, words = BROKEN[name]
    before, known = {role: list(parts) for role, parts in CATALOG.items()}, set(VOCABULARY)
    done = cli("validate", small, "--plugin", path := write(source))
    assert done.exit_code == 2
    assert done.stderr.startswith(f"{path}{line}"), done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert all(word in done.stderr for word in words), done.stderr
    assert before == CATALOG
    assert known == set(VOCABULARY)


def test_files_that_are_not_there(small: Path, tmp_path: Path, cli: Callable) -> None:
    done = cli("validate", small, "--plugin", tmp_path / "none.py", "--plugin", tmp_path)
    assert done.exit_code == 2
    assert [line.startswith(f"--plugin {tmp_path}") for line in done.stderr.splitlines()] == [
        *(True, True)
    ]


def test_a_dataset_that_nobody_declared(
    small: Path, write: Callable, tmp_path: Path, sweep: Callable
) -> None:
    path = write(PART.replace("return {}", 'return {"glare": data["time_s"]}'))
    text = small.read_text()
    small.write_text(text.replace("sensors:\n", "sensors:\n  other: {kind: mine}\n"))
    done = sweep(small, tmp_path / "out", "--runs", 1, "--case", "slow", "--plugin", path)
    assert done.exit_code == 1
    assert "no quantity is called glare; a plug-in declares its own QUANTITIES" in done.stderr
