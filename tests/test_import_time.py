"""The help answers at once, since nothing heavy is imported for it."""

import subprocess
import sys

HEAVY = ("numpy", "scipy", "pandas", "h5py", "matplotlib", "rich")
PROGRAM = """
import sys
from debrisest.cli import main
sys.argv = ["debrisest", *{arguments}]
try:
    main()
except SystemExit as stop:
    assert not stop.code, stop.code
print("heavy:", [name for name in {heavy} if name in sys.modules])
"""


def loaded(*arguments: str) -> str:
    code = PROGRAM.format(arguments=arguments, heavy=HEAVY)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "Usage" in done.stdout
    return done.stdout.splitlines()[-1]


def test_the_help_imports_nothing_heavy() -> None:
    assert loaded("--help") == "heavy: []"


def test_the_help_of_a_command_imports_nothing_heavy() -> None:
    assert loaded("sweep", "--help") == "heavy: []"


def test_signals_are_listened_to_before_anything_is_imported() -> None:
    """The module ``typing`` alone takes as long as the rest of Python's start."""
    code = "import sys, debrisest.interrupts; print('typing' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"
