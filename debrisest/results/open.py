"""Results opened from their folder alone, without the scenario's file or a plan."""

from pathlib import Path

from debrisest.errors import UserError, meant
from debrisest.results import store
from debrisest.results.address import Address
from debrisest.results.chunk import Chunk
from debrisest.results.results import Results

_MOST_TOLD = 3
"""Files that are left out, beyond which only their number is told."""


def open_results(folder: Path | str) -> Results:
    """Return the results of a scenario from its folder alone, such as ``results/first_steps``.

    Attributes are read at once, data when they are asked for. Raises UserError where there are no
    results.
    """
    results = find_results(Path(folder))
    if not results.chunks:
        beside = (path.name for path in Path(folder).parent.glob("*/"))
        near = "" if Path(folder).is_dir() else meant(Path(folder).name, beside)
        told = [f"{folder}: no results of a scenario there{near}", *_first_few(results.left_out)]
        inner = sorted({path.parent.parent.name for path in Path(folder).glob("*/*/*.h5")})
        hint = [f"open one of the folders in it: {', '.join(inner)}"] * bool(inner)
        raise UserError("; ".join([*told, *hint]))
    return results


def _first_few(sentences: list[str]) -> list[str]:
    more = len(sentences) - _MOST_TOLD
    return [*sentences[:_MOST_TOLD], *[f"and {more} more files like these"] * (more > 0)]


def find_results(folder: Path) -> Results:
    """Return what there is of a scenario's results in a folder, which may be nothing."""
    chunks: list[Chunk] = []
    left_out: list[str] = []
    for path in _files(folder):
        found, address = store.inspect(path, store.Depth.LABEL), Address.of(path)
        if found.condition is not store.Condition.WHOLE:
            left_out.append(f"{path} is {found.condition.value}")
        elif address is None:
            left_out.append(f"{path} is not named like a file of results")
        elif not store.fits(found.attributes, address.attributes):
            left_out.append(f"{path} is {store.Condition.ANOTHER.value}")
        else:
            runs = int(found.attributes.get("runs", 0))
            chunks.append(Chunk(address, path, runs, found.attributes, found.digest))
    return Results(folder, tuple(sorted(chunks, key=lambda one: one.address.order)), left_out)


def _files(folder: Path) -> list[Path]:
    """Return the files of all cases; raise OSError for a folder that cannot be read."""
    cases = [path for path in sorted(folder.iterdir()) if path.is_dir()] if folder.is_dir() else []
    return sorted(path for case in cases for path in case.iterdir() if path.suffix == ".h5")
