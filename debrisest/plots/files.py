"""Figures on disk, as PNG and SVG."""

import os
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from debrisest.plots.style import style

FORMATS: dict[str, dict[str, Any]] = {
    "png": {"dpi": 150, "metadata": {"Software": None}},
    "svg": {"dpi": 300, "metadata": {"Date": None}},
}
"""In an SVG only clouds of points have a resolution."""


def write(figure: Figure, folder: Path, name: str) -> Iterator[Path]:
    """Write a figure in every format, each in one step; yield the paths."""
    folder.mkdir(parents=True, exist_ok=True)
    for form, options in FORMATS.items():
        path = folder / f"{name}.{form}"
        temporary = path.with_name(f".{path.name}.{socket.gethostname()}.{os.getpid()}.tmp")
        try:
            with style():
                figure.savefig(temporary, format=form, **options)
            figure.set_layout_engine("none")
            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)
        yield path
