"""The width that tables for the terminal may take."""

import shutil

from rich.console import Console

WIDTH = 110
"""Columns where there is no terminal, such as in a file."""


def console() -> Console:
    """Return a console as wide as the terminal, or as the variable COLUMNS says."""
    return Console(width=shutil.get_terminal_size((WIDTH, 0)).columns)
