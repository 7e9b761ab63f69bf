"""Figures within a file of HTML."""

from base64 import b64encode
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from debrisest.results.status import Wanted
from debrisest.scenario.load import LoadedScenario
from debrisest.show.plots.draw import Asked, draw, sources
from debrisest.show.plots.kinds import FIGURES, Kind
from debrisest.show.plots.png import png
from debrisest.show.plots.room import make_room
from debrisest.show.plots.style import collected_after, style

_DPI = 90


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
    seen: set[tuple[str, ...]] = set()

    def of(kind: str, names: tuple[str, ...]) -> tuple[str, ...]:
        return (kind, *(names if every else _told_apart(FIGURES[kind], names)))

    asked = Asked(wants=lambda kind, names: of(kind, names) not in seen)
    for kind, source in sources(scenario, out, wanted, asked):
        if of(kind, source.names) in seen:
            continue
        seen.add(of(kind, source.names))
        with style(), collected_after():
            figure = draw(kind, source)
            make_room(figure)
            content = png(figure, _DPI, FIGURES[kind].shaded)
            del figure
        address = "data:image/png;base64," + b64encode(content).decode()
        yield Picture(kind, source.context, address)


def _told_apart(kind: Kind, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return what makes a figure another one than that of the first case: an estimator, a key."""
    if kind.of_simulation or kind.of_estimators:
        return ()
    return names if kind.of_tables else names[-1:]
