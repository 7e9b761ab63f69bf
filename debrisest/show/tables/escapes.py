"""Texts as they are, whatever signs they have: in Markdown and in LaTeX."""

import re

_LATEX = {ord(sign): f"\\{sign}" for sign in "&%$#_{}"} | {
    ord("\\"): r"\textbackslash{}",
    ord("^"): r"\^{}",
    ord("~"): r"\~{}",
    ord("<"): "$<$",
    ord(">"): "$>$",
    ord("|"): "$|$",
    ord("×"): r"$\times$",
    ord('"'): "{''}",
}
_MARKDOWN = re.compile(
    r"[\\`*|\[\]$]"  # signs that mean something wherever they stand
    r"|<(?=[A-Za-z/!?])|&(?=[A-Za-z#])"  # the start of a tag or of an entity
    r"|#$"  # the end of a heading
    r"|(?<![A-Za-z0-9])_|_(?![A-Za-z0-9])"  # emphasis begins and ends at words
)


def markdown(text: str) -> str:
    """Return a text of one line as Markdown that shows it, in a heading or a cell."""
    return _MARKDOWN.sub(lambda sign: f"\\{sign[0]}", text)


def paragraph(text: str) -> str:
    """Return the same for a paragraph, whose start could be that of a heading, a list, a rule."""
    return re.sub(r"^(\d{0,9})([-#+=>~.)])", r"\1\\\2", markdown(text))


def latex(text: str) -> str:
    """Return a text of one line as LaTeX that shows it."""
    return text.translate(_LATEX)
