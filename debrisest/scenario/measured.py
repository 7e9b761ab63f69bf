"""A scenario of measured data: what a simulation is told, the data tell."""

from pathlib import Path

from debrisest.clock import Clock
from debrisest.errors import UserError
from debrisest.scenario.document import Document, Problem
from debrisest.scenario.mistakes import validated
from debrisest.scenario.models import measured_model
from debrisest.scenario.names import check_path
from debrisest.scenario.schema import SIMULATED


def told_by_data(document: Document, folder: Path) -> tuple[Document, list[Problem]]:
    """Return a document with the keys that its data tell, and what is wrong with these."""
    if "measured" not in document.value:
        return document, []
    check_path(folder)
    asked = Document({"measured": document.value["measured"]}, document.places)
    found, problems = validated(asked, measured_model(), folder)
    problems += [
        Problem(document.place((key,)), f"{key}: measured data stand in its place; leave it out")
        for key in SIMULATED
        if key in document.value
    ]
    if problems:
        return _with(document, 1, 1.0), problems
    try:
        data = found.measured.read(folder)
    except UserError as error:
        place = document.place(("measured",))
        return _with(document, 1, 1.0), [Problem(place, f"measured: {w}") for w in error.problems]
    clock = Clock(data["time_s"])
    return _with(document, len(data["run"]), float(clock.times[-1] + clock.steps[-1])), []


def _with(document: Document, runs: int, duration: float) -> Document:
    told = {"seed": 0, "runs": runs, "duration_s": duration}
    return Document(told | document.value, document.places)
