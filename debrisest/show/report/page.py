"""Chapters as one file of HTML: styles, script and figures are in it, so that it opens anywhere."""

from collections.abc import Hashable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from debrisest.errors import UserError
from debrisest.show.plots.style import ESTIMATOR_COLOURS
from debrisest.show.report.chapter import Chapter
from debrisest.show.tables.verdict import Verdict

if TYPE_CHECKING:
    from jinja2 import Environment


def page(chapters: Sequence[Chapter]) -> str:
    """Return the report; raise UserError where jinja2 is not installed."""
    template = environment().get_template("page.html")
    return template.render(chapters=chapters, colours=ESTIMATOR_COLOURS, verdicts=list(Verdict))


def environment() -> "Environment":
    """Return what fills templates; raise UserError where jinja2 is not installed."""
    try:
        from jinja2 import Environment, PackageLoader, StrictUndefined
    except ImportError:
        raise UserError("a report needs jinja2: pip install 'debrisest[report]'") from None
    environment = Environment(
        loader=PackageLoader("debrisest.show.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["figure"] = _figure
    environment.filters["interval"] = _interval
    return environment


def _figure(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"


def _interval(cell: Mapping[Hashable, Any]) -> str:
    """Return the ends of a cell's interval, as far as its sample could give them."""
    low, high = _figure(cell["ci_low"]), _figure(cell["ci_high"])
    if low and high:
        return f"{low} to {high}"
    return f"from {low}" if low else f"up to {high}" if high else ""
