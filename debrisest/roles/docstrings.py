"""Texts that stand below the attributes of a class, as they describe the keys of a scenario."""

import ast
import inspect
import sys
from functools import cache
from itertools import pairwise


def attribute_docstrings(model: type) -> dict[str, str]:
    """Return the texts below the annotated names of a class and its bases, each on one line.

    They are read from the source, when they are asked for; a class without one has none.
    """
    found: dict[str, str] = {}
    for one in reversed(model.__mro__):
        found |= _of_module(one.__module__).get(one.__qualname__, {})
    return found


@cache
def _of_module(name: str) -> dict[str, dict[str, str]]:
    try:
        tree = ast.parse(inspect.getsource(sys.modules[name]))
    except (KeyError, OSError, TypeError):
        return {}
    classes = (node for node in tree.body if isinstance(node, ast.ClassDef))
    return {one.name: dict(_texts(one)) for one in classes}


def _texts(one: ast.ClassDef) -> list[tuple[str, str]]:
    return [
        (named.target.id, " ".join(below.value.value.split()))
        for named, below in pairwise(one.body)
        if isinstance(named, ast.AnnAssign)
        and isinstance(named.target, ast.Name)
        and isinstance(below, ast.Expr)
        and isinstance(below.value, ast.Constant)
        and isinstance(below.value.value, str)
    ]
