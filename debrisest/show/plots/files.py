"""Figures on disk, as PNG, SVG or PDF."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from debrisest.files import replacing
from debrisest.show.plots.png import png
from debrisest.show.plots.room import make_room
from debrisest.show.plots.style import style

DRAWN: dict[str, dict[str, Any]] = {
    "svg": {"dpi": 200, "metadata": {"Date": None}},
    "pdf": {"dpi": 300, "metadata": {"CreationDate": None}},
}
"""In an SVG or a PDF only what is dense has a resolution."""
_DPI = 150
"""Of a PNG."""
USUAL = ("png", "svg")
MOST_MARKERS, MOST_VERTICES = 300, 2000
"""What has more of them is drawn as an image, which keeps an SVG below about 1 MB."""

_NO_MARKER = (None, "None", "none", " ", "")


def write(
    figure: Figure, folder: Path, name: str, formats: Sequence[str] = USUAL, shaded: bool = False
) -> Iterator[Path]:
    """Write a figure as PNG, SVG or PDF, each in one step; yield the paths.

    ``shaded``: it has other colours than those of the style.
    """
    _rasterise_dense(figure)
    make_room(figure)
    for form in formats:
        path = folder / f"{name}.{form}"
        with replacing(path) as temporary:
            if form == "png":
                temporary.write_bytes(png(figure, _DPI, shaded))
            else:
                with style():
                    figure.savefig(temporary, format=form, **DRAWN[form])
        yield path


def _rasterise_dense(figure: Figure) -> None:
    """Draw what is dense as an image; solids have no paths until they are drawn, and say it."""
    for axis in figure.axes:
        for line in axis.lines:
            clouded = line.get_marker() not in _NO_MARKER
            most = MOST_MARKERS if clouded else MOST_VERTICES
            line.set_rasterized(np.size(line.get_xdata()) > most)
        for collection in axis.collections:
            vertices = sum(np.shape(path.vertices)[0] for path in collection.get_paths())
            dense = bool(collection.get_rasterized()) or vertices > MOST_VERTICES
            collection.set_rasterized(dense)
