"""Figures on disk, as PNG, SVG or PDF."""

from collections.abc import Iterator, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.transforms import offset_copy

from debrisest.files import replacing
from debrisest.show.plots.style import style

FORMATS: dict[str, dict[str, Any]] = {
    "png": {"dpi": 150, "metadata": {"Software": None}, "pil_kwargs": {"compress_level": 4}},
    "svg": {"dpi": 200, "metadata": {"Date": None}},
    "pdf": {"dpi": 300, "metadata": {"CreationDate": None}},
}
"""In an SVG or a PDF only what is dense has a resolution."""
USUAL = ("png", "svg")
MOST_MARKERS, MOST_VERTICES = 300, 2000
"""What has more of them is drawn as an image, which keeps an SVG below about 1 MB."""

_LAID_OUT: dict[Any, Any] = {"figure.constrained_layout.use": False}
_NO_MARKER = (None, "None", "none", " ", "")


def write(
    figure: Figure, folder: Path, name: str, formats: Sequence[str] = USUAL
) -> Iterator[Path]:
    """Write a figure in some FORMATS, each in one step; yield the paths."""
    _rasterise_dense(figure)
    lay_out(figure)
    for form in formats:
        path = folder / f"{name}.{form}"
        with replacing(path) as temporary:
            save(figure, temporary, form, **FORMATS[form])
        yield path


def lay_out(figure: Figure) -> None:
    """Lay a figure out, once and for all: matplotlib would draw it twice for every file."""
    engine = figure.get_layout_engine()
    if engine is not None:
        with style():
            _fix_labels(figure)
            engine.execute(figure)
        with mpl.rc_context(_LAID_OUT):
            figure.set_layout_engine(None)


def _fix_labels(figure: Figure) -> None:
    """Leave the labels of axes as far from them as their ticks, or aligned ones, ask for.

    Matplotlib would search all ticks for it whenever it lays out or draws, those of aligned axes
    for each of them, and for labels without a text as well.
    """
    for axes in figure.axes:
        if axes.name == "rectilinear":
            down, left = _pixels_away(axes.xaxis, 1), _pixels_away(axes.yaxis, 0)
            below = offset_copy(axes.transAxes, figure, 0.0, down / figure.dpi)
            beside = offset_copy(axes.transAxes, figure, left / figure.dpi, 0.0)
            axes.xaxis.set_label_coords(0.5, 0.0, below)
            axes.yaxis.set_label_coords(0.0, 0.5, beside)


def _pixels_away(axis: Axis, along: int) -> float:
    """Return how far a label lies from where its axes begin."""
    if not axis.get_label_text() or axis.get_tightbbox() is None:
        return 0.0
    return float(axis.label.get_position()[along] - axis.axes.bbox.p0[along])


def save(figure: Figure, target: Path | BytesIO, form: str, **options: Any) -> None:
    """Write a figure that is laid out."""
    with style(), mpl.rc_context(_LAID_OUT):
        figure.savefig(target, format=form, **options)


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
