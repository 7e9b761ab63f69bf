"""Plug-ins: Python files of the user's own, and installed modules (entry points).

What they hold is told by `contents`. The digest of a plug-in's source counts in the fingerprint of
its parts, so that a change of it re-runs what depends on them.
"""

import sys
import traceback
from collections.abc import Iterable, Sequence
from functools import cache
from hashlib import sha256
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from debrisest.catalog import CATALOG
from debrisest.errors import UserError
from debrisest.files import content
from debrisest.plugins.contents import parts_of, problems_in, quantities_of
from debrisest.vocabulary import VOCABULARY

GROUP = "debrisest.parts"
"""Entry points of this group name modules that hold parts."""


class Plugin(NamedTuple):
    """A file with parts; its source travels to other processes with the cases that use it."""

    path: str
    source: bytes

    @property
    def digest(self) -> str:
        """Return what tells this source from an earlier one."""
        return sha256(self.source).hexdigest()

    @property
    def module_name(self) -> str:
        """Return the name of its module, which no installed one can have."""
        return f"plug-in {self.path}"


_loaded: dict[str, Plugin] = {}
"""Every file whose parts are in the catalog, by its path."""


def read_plugins(paths: Iterable[Path]) -> tuple[Plugin, ...]:
    """Return the plug-ins in files, or raise UserError with every file that cannot be read."""
    found, problems = {}, []
    for path in paths:
        try:
            found[str(path.resolve())] = content(path)
        except OSError as error:
            problems.append(f"--plugin {path}: {error.strerror}; give a Python file with parts")
    if problems:
        raise UserError(problems)
    return tuple(Plugin(path, source) for path, source in found.items())


def load_plugins(plugins: Sequence[Plugin] = ()) -> tuple[Plugin, ...]:
    """Put the parts of installed plug-ins and of these files in the catalog, where they are not.

    Returns all files whose parts are there now. A file whose source changed takes the place of what
    it was. Raises UserError with file and line where a plug-in cannot be used; the catalog then has
    none of its parts.
    """
    _load_installed()
    for plugin in plugins:
        if _loaded.get(plugin.path) != plugin:
            _forget(plugin)
            _add(_executed(plugin), Path(plugin.path).name, plugin.digest)
            _loaded[plugin.path] = plugin
    return tuple(_loaded.values())


@cache
def _load_installed() -> None:
    for entry in entry_points(group=GROUP):
        module = _imported(entry)
        _add(module, entry.name, _package_digest(module))


def _imported(entry: EntryPoint) -> ModuleType:
    try:
        return import_module(entry.module)
    except Exception as error:
        raise UserError(
            f"installed plug-in {entry.name} = {entry.value}: {_said(error)}; "
            "mend it, or uninstall the package that brings it"
        ) from None


def _package_digest(module: ModuleType) -> str:
    """Return the digest of all source of the package that a module belongs to."""
    package = sys.modules[module.__name__.partition(".")[0]]
    folders = [Path(folder) for folder in getattr(package, "__path__", ())]
    files = [file for folder in folders for file in sorted(folder.rglob("*.py"))]
    sources = [file.read_bytes() for file in files or [Path(str(module.__file__))]]
    return sha256(b"".join(sources)).hexdigest()


def _executed(plugin: Plugin) -> ModuleType:
    """Return the module of a file, made from the very source that the digest is of."""
    module = ModuleType(plugin.module_name)
    module.__file__ = plugin.path
    sys.modules[module.__name__] = module
    try:
        exec(compile(plugin.source, plugin.path, "exec"), vars(module))
    except (Exception, SystemExit) as error:
        raise UserError(f"{_line(plugin.path, error)}: {_said(error)}") from None
    return module


def _line(path: str, error: BaseException) -> str:
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == path]
    if isinstance(error, SyntaxError) and error.filename == path:
        lines.append(error.lineno)
    return f"{path}:{lines[-1]}" if lines else path


def _said(error: BaseException) -> str:
    reason = error.msg if isinstance(error, SyntaxError) else str(error)
    first = reason.partition("\n")[0]
    return f"this plug-in cannot be loaded: {type(error).__name__}" + (first and f": {first}")


def _add(module: ModuleType, name: str, digest: str) -> None:
    if problems := list(problems_in(module)):
        raise UserError(problems)
    VOCABULARY.update(quantities_of(module))
    for part in parts_of(module):
        part.plugin = {f"plug-in {name}": digest[:16]}
        CATALOG[part.role] = [*CATALOG[part.role], part]


def _forget(plugin: Plugin) -> None:
    """Take out again what an earlier source of the same file added."""
    if _loaded.pop(plugin.path, None) is None:
        return
    module = sys.modules[plugin.module_name]
    gone = parts_of(module)
    for role, parts in CATALOG.items():
        CATALOG[role] = [part for part in parts if part not in gone]
    for name in quantities_of(module):
        VOCABULARY.pop(name, None)
