"""Figures within a file of HTML."""

from base64 import b64encode
from collections.abc import Iterator, Sequence
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from PIL import Image

from debrisest.results.status import Wanted
from debrisest.scenario.load import LoadedScenario
from debrisest.show.plots.draw import draw, sources
from debrisest.show.plots.gather import Source
from debrisest.show.plots.kinds import FIGURES, Kind
from debrisest.show.plots.room import make_room
from debrisest.show.plots.style import (
    ESTIMATOR_COLOURS,
    GREY,
    GRID,
    INK,
    SHADE,
    collected_after,
    style,
)

_DPI, _TINTS = 90, 15
_EXACT = Image.Dither.NONE


class Picture(NamedTuple):
    """A figure: what it shows, and its PNG as a data address."""

    kind: str
    words: str
    address: str


def pictures(
    scenario: LoadedScenario, out: Path, wanted: Sequence[Wanted], every: bool = False
) -> Iterator[Picture]:
    """Yield every kind of figure of every estimator, each of the first case that has it.

    Of every case that is wanted, if that is asked for.
    """
    seen = set()
    for kind, source in sources(scenario, out, wanted):
        of = (kind, *(source.names if every else _told_apart(FIGURES[kind], source)))
        if of in seen:
            continue
        seen.add(of)
        with collected_after():
            address = _address(draw(kind, source), FIGURES[kind].shaded)
        yield Picture(kind, source.context, address)


def _told_apart(kind: Kind, source: Source) -> tuple[str, ...]:
    """Return what makes a figure another one than that of the first case: an estimator, a key."""
    if kind.of_simulation or kind.of_estimators:
        return ()
    return source.names if kind.of_tables else source.names[-1:]


def _address(figure: Figure, shaded: bool) -> str:
    """Return a figure as a PNG of few colours, which is a third as large."""
    with style():
        make_room(figure)
        figure.set_dpi(_DPI)
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
    drawn, small = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB"), BytesIO()
    few = drawn.quantize() if shaded else drawn.quantize(palette=_palette(), dither=_EXACT)
    few.save(small, "png", compress_level=7)
    return "data:image/png;base64," + b64encode(small.getvalue()).decode()


@cache
def _palette() -> Image.Image:
    """Return the colours of the style and their tints, which are faster found than fitting ones."""
    colours = [to_rgb(colour) for colour in ("white", GRID, SHADE, INK, GREY, *ESTIMATOR_COLOURS)]
    tints = [1 - weight * (1 - np.array(colours)) for weight in np.linspace(1, 0.08, _TINTS)]
    palette = Image.new("P", (1, 1))
    palette.putpalette(np.rint(255 * np.concatenate(tints)).astype(int).ravel().tolist())
    return palette
