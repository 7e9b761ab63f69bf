"""Texts below the keys of a class: whose they are, and what there is without a source."""

from debrisest.roles.docstrings import attribute_docstrings


class Base:
    """A class whose own text is no key's."""

    first: int = 1
    """A text
    on two lines."""
    bare: int = 2
    plain = 3
    """Of a name without a type."""


class Other(Base):
    second: int
    """Its own."""
    first: int = 4
    """Another text."""


def test_texts_are_those_below_the_keys_and_the_last_one_counts() -> None:
    assert attribute_docstrings(Base) == {"first": "A text on two lines."}
    assert attribute_docstrings(Other) == {"first": "Another text.", "second": "Its own."}


def test_a_class_without_a_source_has_no_texts() -> None:
    assert attribute_docstrings(type("Made", (), {"__module__": "nowhere"})) == {}
