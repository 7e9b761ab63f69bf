"""Figures within a file of HTML."""

from base64 import b64encode
from collections.abc import Iterator, Sequence
from io import BytesIO
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure

from debrisest.results.status import Wanted
from debrisest.scenario.load import LoadedScenario
from debrisest.show.plots.draw import draw, sources
from debrisest.show.plots.files import lay_out, save
from debrisest.show.plots.gather import Source
from debrisest.show.plots.kinds import FIGURES, Kind

_DPI, _COLOURS = 90, 64


class Picture(NamedTuple):
    """A figure: what it shows, and its PNG as a data address."""

    kind: str
    words: str
    address: str


def pictures(scenario: LoadedScenario, out: Path, wanted: Sequence[Wanted]) -> Iterator[Picture]:
    """Yield every kind of figure of every estimator, each of the first case that has it."""
    seen = set()
    for kind, source in sources(scenario, out, wanted):
        of = (kind, *_told_apart(FIGURES[kind], source))
        if of in seen:
            continue
        seen.add(of)
        figure = draw(kind, source)
        yield Picture(kind, source.context, _address(figure))


def _told_apart(kind: Kind, source: Source) -> tuple[str, ...]:
    """Return what makes a figure another one than that of the first case: an estimator, a key."""
    if kind.of_simulation or kind.of_estimators:
        return ()
    return source.names if kind.of_tables else source.names[-1:]


def _address(figure: Figure) -> str:
    """Return a figure as a PNG of few colours, which is a third as large."""
    from PIL import Image

    drawn, small = BytesIO(), BytesIO()
    lay_out(figure)
    save(figure, drawn, "png", dpi=_DPI, metadata={"Software": None})
    Image.open(drawn).convert("RGB").quantize(_COLOURS).save(small, "png", optimize=True)
    return "data:image/png;base64," + b64encode(small.getvalue()).decode()
