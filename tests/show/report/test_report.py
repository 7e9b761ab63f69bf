"""The report: one file that needs nothing else, with all cells, and with texts as they are."""

import base64
import re
import shutil
import sys
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest

from debrisest.show.report import page as page_module
from debrisest.show.report.overview import LEFT, PLOT, panels
from debrisest.show.tables.cells import COLUMNS

pytest.importorskip("jinja2")
EVIL = "A <script>alert('x')</script> & <b>bold</b> \"body\""
LEADING_OUT = {"src", "href", "srcset", "action", "data", "poster", "xlink:href", "formaction"}


class Links(HTMLParser):
    """Collects where a page leads, and its scripts and styles."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.tags: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.links += [value or "" for name, value in attrs if name in LEADING_OUT]
        assert not [name for name, _ in attrs if name.startswith("on")]


@pytest.fixture(scope="module")
def small_report(tmp_path_factory: pytest.TempPathFactory, cli: Callable, sweep: Callable) -> str:
    """The report of the small scenario under a title that means mischief."""
    folder = tmp_path_factory.mktemp("report")
    scenarios = Path(__file__).parents[2] / "scenarios"
    shutil.copy(scenarios / "small.csv", folder)
    text = (scenarios / "small.yaml").read_text()
    config = folder / "small.yaml"
    config.write_text(
        text.replace("A small tumbling body", f"'{EVIL.replace(chr(39), chr(39) * 2)}'")
    )
    assert sweep(config, folder / "results").exit_code == 0
    done = cli("report", config, "--out", folder / "results")
    path = folder / "results" / "small" / "report.html"
    assert (done.exit_code, done.stdout) == (0, f"wrote {path}\n")
    return path.read_text(encoding="utf-8")


def tree(text: str) -> ElementTree.Element:
    return ElementTree.fromstring(text.removeprefix("<!DOCTYPE html>"))


def words(element: ElementTree.Element) -> str:
    return " ".join("".join(element.itertext()).split())


def test_it_is_well_formed_and_leads_nowhere_else(small_report: str) -> None:
    tree(small_report)
    page = Links(small_report)
    away = [link for link in page.links if not link.startswith(("#", "data:image/png;base64,"))]
    assert not away
    assert not re.search(r"https?:|@import|url\(|fetch\(|XMLHttp", small_report)
    assert page.tags.count("script") == 1
    assert "link" not in page.tags and "iframe" not in page.tags


def test_a_title_is_shown_as_it_is(small_report: str) -> None:
    heads = [words(head) for head in tree(small_report).iter("h2")]
    assert heads == [f"small: {EVIL}"]


def test_every_cell_is_there_with_interval_and_verdict(small_report: str, reference: Path) -> None:
    cells = pd.read_csv(reference / "small" / "tables.csv")
    rows = [row for row in tree(small_report).iter("tr") if row.get("data-verdict")]
    assert len(rows) == len(cells)
    for row, cell in zip(rows, cells.to_dict("records")):
        told = [words(one) for one in row]
        assert told[0] == cell["case"] and told[1] == cell["estimator"]
        assert told[6] == f"{cell['measured']:.3g}"
        assert told[7] == f"{cell['ci_low']:.3g} to {cell['ci_high']:.3g}"
        assert row.get("data-verdict") == cell["verdict"]


def test_the_summary_counts_what_the_tables_say(small_report: str, reference: Path) -> None:
    cells = pd.read_csv(reference / "small" / "tables.csv")
    (row,) = [row for row in tree(small_report).iter("tr") if words(row[0]) == "small"]
    heads = [words(head) for head in next(iter(tree(small_report).iter("tr")))]
    for head, told in zip(heads[2:], row[2:]):
        assert words(told) == (str((cells["verdict"] == head).sum() or "")), head


def test_figures_are_in_the_file(small_report: str) -> None:
    images = [one.get("src", "") for one in tree(small_report).iter("img")]
    assert len(images) > 5
    for image in images:
        content = base64.b64decode(image.removeprefix("data:image/png;base64,"), validate=True)
        assert content.startswith(b"\x89PNG\r\n\x1a\n") and content.rstrip().endswith(
            b"IEND\xaeB`\x82"
        )


def test_figures_of_another_case_can_be_asked_for(
    small: Path, reference: Path, tmp_path: Path, cli: Callable
) -> None:
    to, asked = tmp_path / "page.html", ("--estimator", "triad", "--figures-of")
    assert cli("report", small, "--out", reference, "--to", to, *asked, "fast").exit_code == 0
    told = [one.get("alt", "") for one in tree(to.read_text(encoding="utf-8")).iter("img")]
    assert len(told) > 4 and not any("case slow" in words for words in told)
    command = f"debrisest report {small} --out {reference} --figures-of CASE"
    assert command in [words(one) for one in tree(to.read_text(encoding="utf-8")).iter("code")]
    done = cli("report", small, "--out", reference, *asked, "fats")
    assert done.exit_code == 2 and "(did you mean fast?)" in done.stderr


def test_chapters_made_by_workers_are_the_same(
    small: Path, reference: Path, tmp_path: Path, cli: Callable
) -> None:
    other = small.with_name("other.yaml")
    other.write_bytes(small.read_bytes())
    asked = ("report", small, other, "--out", reference, "--estimator", "triad", "--to")
    done = [cli(*asked, tmp_path / str(jobs), "--jobs", jobs) for jobs in (1, 2)]
    assert [one.exit_code for one in done] == [0, 0], done[1].output
    assert all("left out of the report: other: no results" in one.stderr for one in done)
    assert (tmp_path / "1").read_bytes() == (tmp_path / "2").read_bytes()


def test_the_provenance_is_told(small_report: str) -> None:
    told = {
        words(dt): words(dd) for dt, dd in zip(*(tree(small_report).iter(t) for t in ("dt", "dd")))
    }
    assert told["seed"] == "7"
    assert told["changed by --set"] == "nothing"
    assert told["software"].startswith("debrisest ")


def test_without_results_or_without_jinja_it_says_what_to_do(
    small: Path, swept: Path, cli: Callable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = cli("report", small, "--out", tmp_path / "nothing")
    assert done.exit_code == 2
    assert f"run: debrisest sweep {small}" in done.stderr
    monkeypatch.setitem(sys.modules, "jinja2", None)
    done = cli("report", small, "--out", swept, "--no-figures")
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr == "a report needs jinja2: pip install 'debrisest[report]'\n"


def made_up(**columns: object) -> pd.DataFrame:
    cell = {"table": "1", "case": "a", "estimator": "x", "quantity": "rate", "unit": "deg/s"}
    cell |= {"statistic": "rmse", "window": "end", "verdict": "unpublished"}
    rows = pd.DataFrame({**cell, **columns}, index=range(len(next(iter(columns.values())))))
    return rows.reindex(columns=COLUMNS)


def test_marks_lie_where_the_axis_says() -> None:
    """The logarithmic axis, read back from two of its ticks."""
    measured = [3.0, 8.0, 0.5]
    rows = made_up(
        case=["a", "b", "c"],
        measured=measured,
        ci_low=[2.0, 7.0, 0.4],
        ci_high=[4.0, 9.0, 0.6],
        bound=[1.0, 2.0, 0.5],
        published=[6.0, np.nan, np.nan],
    )
    (panel,) = panels(rows, ["x"])
    ticks = {float(text): x for x, text in panel.ticks}
    per_decade = (ticks[5.0] - ticks[1.0]) / np.log10(5.0)

    def read(x: float) -> float:
        return float(10 ** ((x - ticks[1.0]) / per_decade))

    assert panel.reference == "bound"
    assert [read(mark.x) for mark in panel.marks] == pytest.approx([3.0, 4.0, 1.0], rel=0.01)
    assert [read(mark.high) for mark in panel.marks] == pytest.approx([4.0, 4.5, 1.2], rel=0.01)
    ((x, top, bottom),) = panel.published
    assert read(x) == pytest.approx(6.0, rel=0.01)
    assert top < panel.marks[0].y < bottom < panel.marks[1].y
    assert all(LEFT <= mark.low <= mark.x <= mark.high <= LEFT + PLOT for mark in panel.marks)


def test_consistency_is_shown_as_it_is_and_what_cannot_be_compared_is_not() -> None:
    rows = made_up(
        quantity=["nees", "rate", "peak_torque"], measured=[2.0, 1.0, 1.0], bound=[5.0, np.nan, 1.0]
    )
    shown = list(panels(rows, ["x"]))
    assert (shown[0].title, shown[0].reference) == ("nees, rmse, end", "1")
    assert all("rate" not in panel.title for panel in shown)
    assert "2 x 1" in shown[0].marks[0].words


def test_a_sweep_can_end_with_the_path_of_its_report(
    small: Path, tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    some = ("--case", "slow", "--estimator", "wahba", "--runs", 1, "--report")
    done = sweep(small, tmp_path / "out", *some)
    path = tmp_path / "out" / "small" / "report.html"
    assert done.stdout.splitlines()[-1] == f"report: {path}"
    assert "data:image/png" in path.read_text(encoding="utf-8")
    monkeypatch.setitem(sys.modules, "jinja2", None)
    done = sweep(small, tmp_path / "other", *some)
    assert (done.exit_code, (tmp_path / "other").exists()) == (2, False)
    assert "pip install 'debrisest[report]'" in done.stderr


def test_an_end_that_the_sample_cannot_give_is_not_drawn() -> None:
    rows = made_up(
        measured=[3.0, 2.0], ci_low=[2.0, np.nan], ci_high=[np.nan, 4.0], bound=[1.0, 1.0]
    )
    (panel,) = panels(rows, ["x"])
    open_above, open_below = panel.marks
    assert open_above.low < open_above.x == open_above.high
    assert open_below.low == open_below.x < open_below.high
    assert page_module._interval({"ci_low": 2.0, "ci_high": None}) == "from 2"
    assert page_module._interval({"ci_low": None, "ci_high": 4.0}) == "up to 4"
    assert page_module._interval({"ci_low": 2.0, "ci_high": 4.0}) == "2 to 4"


def test_results_without_a_cell_are_told_in_words(
    small: Path, tmp_path: Path, cli: Callable
) -> None:
    out = ("--out", tmp_path / "out", "--runs", 1)
    assert cli("simulate", small, *out, "--jobs", 1).exit_code == 0
    done = cli("report", small, *out, "--to", tmp_path / "report.html")
    assert done.exit_code == 0, done.output
    assert "in 0 cells" in (tmp_path / "report.html").read_text(encoding="utf-8")
