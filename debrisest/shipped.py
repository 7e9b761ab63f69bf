"""The scenarios that come with the package, each with its published values."""

from pathlib import Path

from debrisest.errors import UserError, allowed_names
from debrisest.files import replacing

_PACKAGE = Path(__file__).parent
_FOLDERS = (_PACKAGE / "configs", _PACKAGE.parent / "configs")
"""Where they lie in an installed package, and in a checkout."""
SCHEMA = "schema.json"
"""What the first line of every shipped scenario tells editors to look for beside it."""
STARTER = "first_steps"
"""The scenario to start from, in which every key is explained."""


def shipped_names() -> list[str]:
    """Return the names of the shipped scenarios."""
    return sorted(path.stem for path in _folder().glob("*.yaml"))


def is_shipped(path: Path) -> bool:
    """Return whether a file is that of a shipped scenario, which its name alone stands for."""
    return path.absolute() == (_folder() / path.name).absolute()


def scenario_path(config: Path) -> Path:
    """Return the file of a scenario that is given by its path or by its name.

    A file that exists wins: ``NAME`` itself, then ``NAME.yaml``, then the shipped scenario.
    Raises UserError where a bare name is none of them.
    """
    bare = config.suffix != ".yaml" and config.name == str(config) and not config.exists()
    if config.is_file() or not (bare or str(config) in shipped_names()):
        return config
    own = config.with_name(f"{config}.yaml")
    return own if own.is_file() else shipped_path(str(config))


def shipped_path(name: str) -> Path:
    """Return the file of a shipped scenario, or raise UserError with the names that there are."""
    if name not in shipped_names():
        raise UserError(
            f"{name}: neither a file nor a shipped scenario; give the path of a scenario file "
            f"(YAML), or a shipped one: {allowed_names(name, shipped_names())}; "
            "'debrisest init' writes a scenario to start from"
        )
    return _folder() / f"{name}.yaml"


def copy_shipped(name: str, folder: Path, force: bool = False) -> list[Path]:
    """Copy a shipped scenario and its published values into a folder; return the new files.

    Raises UserError, and writes nothing, where no shipped scenario has this name, or where a file
    is there already and ``force`` does not let it be replaced.
    """
    source = shipped_path(name)
    published = source.parent / "published" / f"{name}.csv"
    copies = {folder / f.relative_to(source.parent): f for f in (source, published) if f.is_file()}
    there = [f"{path}: this file is there already" for path in copies if path.exists()]
    if there and not force:
        raise UserError([*there, "nothing was written; --force replaces what is there"])
    for path, original in copies.items():
        with replacing(path) as temporary:
            temporary.write_bytes(original.read_bytes())
    return list(copies)


def _folder() -> Path:
    installed, checkout = _FOLDERS
    return installed if installed.is_dir() else checkout
