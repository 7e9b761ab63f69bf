"""Whatever a title says, it stays a title: in Markdown, in LaTeX, on the terminal, in a figure."""

import html
import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from markdown_it import MarkdownIt
from matplotlib.figure import Figure

from debrisest.scenario.load import load_scenario
from debrisest.show.plots.axes import heading
from debrisest.show.tables.escapes import latex, markdown, paragraph

TITLES = [
    "=HYPERLINK(1)", "<img src=x onerror=y>", "a | b", "[red]x[/] :smile: [link](y)", "back\\",
    "$x_1^2$ & 5 % of #3 {y} ~ z", "_under_ snake_case *star* `tick`", "1. first", "# head",
    "> quote", "- item", "C #", "##", "&lt; <b>", "$\\frac$ and $",
]  # fmt: skip
LINES = st.text(st.characters(min_codepoint=33, max_codepoint=126) | st.just(" "), min_size=1)
READER = MarkdownIt("commonmark").enable("table")


def shown(source: str) -> str:
    return html.unescape(re.sub(r"<[^>]*>", "", READER.render(source))).strip()


@given(st.sampled_from(TITLES) | LINES)
def test_markdown_shows_the_text(text: str) -> None:
    text = " ".join(text.split())
    assert shown(f"## Table 1: {markdown(text)}") == f"Table 1: {text}".strip()
    assert shown(paragraph(text)) == text
    table = f"| case | b |\n| --- | --- |\n| {markdown(text)} | end |"
    assert text in shown(table)
    assert READER.render(table).count("<td>") == 2


@given(st.sampled_from(TITLES) | LINES)
def test_latex_shows_the_text(text: str) -> None:
    """Undone by hand: no sign with a meaning is left but in the commands themselves."""
    back = latex(text).replace(r"\textbackslash{}", "\0").replace("{''}", '"')
    back = back.replace(r"\^{}", "^").replace(r"\~{}", "~")
    back = re.sub(r"\$([<>|])\$", r"\1", back)
    assert not re.search(r"(?<!\\)[&%$#_{}]", back)
    undone = re.sub(r"\\([&%$#_{}])", r"\1", back)
    assert undone.replace("\0", "\\") == text.replace("{''}", '"')


@pytest.mark.parametrize("title", TITLES)
def test_every_form_and_the_terminal(title: str, small: Path, swept: Path, cli: Any) -> None:
    quoted = title.replace("'", "''")
    text = small.read_text().replace("title: A small tumbling body", f"title: '{quoted}'")
    text = text.replace("title: Errors after the filter", f"title: '{quoted}'")
    small.write_text(text.replace("source: made for the tests", f"source: '{quoted}'"))
    assert load_scenario(small).common.title == title
    terminal = cli("table", small, "--out", swept)
    assert f"Table 2: {title}" in terminal.stdout
    written = (swept / "small" / "tables.md").read_text()
    assert title in html.unescape(re.sub(r"</?[a-z]\w*>", "", READER.render(written)))
    assert "<img" not in READER.render(written)
    tex = (swept / "small" / "tables.tex").read_text().splitlines()
    assert tex[0] == f"% {title}"


@pytest.mark.parametrize("title", TITLES)
def test_figures_read_no_mathematics(title: str) -> None:
    figure = Figure()
    heading(figure.subplots(), "Title", title)
    figure.canvas.draw()


def test_a_second_line_of_a_title_stays_in_the_comment(small: Path, swept: Path, cli: Any) -> None:
    text = small.read_text().replace("title: A small", 'title: "One\\n\\\\input{x}\\nA small')
    small.write_text(text.replace("tumbling body\n", 'tumbling body"\n', 1))
    assert cli("table", small, "--out", swept).exit_code == 0
    first = (swept / "small" / "tables.tex").read_text().split("\n")[:2]
    assert first == ["% One \\input{x} A small tumbling body", first[1]]
    assert first[1].startswith("% = reproduced")


def test_a_file_of_the_user_is_kept(small: Path, swept: Path, cli: Any) -> None:
    own = swept / "small" / "tables.md"
    own.write_text("my own notes")
    result = cli("table", small, "--out", swept)
    assert result.exit_code == 0
    assert own.with_name("tables.md.old").read_text() == "my own notes"
    assert "is now tables.md.old" in result.stderr
    assert "written by debrisest" in own.read_text()
    assert cli("table", small, "--out", swept).stderr == ""
