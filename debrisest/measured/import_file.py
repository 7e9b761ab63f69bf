"""A user's files of measurements to a file of the stage simulate and a scenario to edit."""

from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import yaml

from debrisest.arrays import Data
from debrisest.catalog import kind_of
from debrisest.errors import UserError
from debrisest.files import replacing
from debrisest.measured.default_scenario import Text, default_scenario
from debrisest.measured.scenario_like import known_geometry, scenario_like
from debrisest.parts.sources.from_files import FromFile
from debrisest.parts.sources.poses import MeasuredPoses
from debrisest.parts.sources.rates import MeasuredRates
from debrisest.parts.sources.tracks import MeasuredTracks
from debrisest.results import store
from debrisest.roles import SourcePart
from debrisest.scenario.document import Document
from debrisest.scenario.load import LoadedScenario
from debrisest.scenario.mistakes import validated
from debrisest.scenario.models import measured_model
from debrisest.scenario.names import check_path
from debrisest.tracks.recognise import Kind, recognise

_PARTS: dict[Kind, type[FromFile]] = {
    Kind.POSES: MeasuredPoses,
    Kind.POSE_LIST: MeasuredPoses,
    Kind.RATES: MeasuredRates,
}
_HEAD = """\
# Measured data of {source}, as debrisest import has read them; {estimators}.
#   debrisest sweep {name}
# docs/scenario.md has all keys, docs/measured.md is about data of your own.
"""


class Imported(NamedTuple):
    """What an import has written, and what is to be told of it."""

    data: Path
    scenario: Path
    notes: list[str]


def measured_keys(file: Path, options: Mapping[str, Any]) -> Text:
    """Return the part that reads a file, by what the file is, as it stands in YAML.

    ``options`` are its further keys; those without a value are left out, paths stay as they are.
    Raises `UserError` for a file that is not known, and for keys of no use for it.
    """
    given = {key: value for key, value in options.items() if value not in (None, [])}
    for path in (file, *(value for value in given.values() if isinstance(value, Path))):
        check_path(path)
    part = _PARTS.get(recognise(file)[0], MeasuredTracks)
    kind = kind_of(part)
    if useless := [key for key in given if key not in part.model_fields]:
        names = ", ".join(f"--{key.replace('_', '-')}" for key in useless)
        raise UserError(f"{file}: it holds {kind}, for which {names} is of no use; leave it out")
    return {"kind": kind, "file": _plain(file)} | {key: _plain(v) for key, v in given.items()}


def source_of(measured: Text, folder: Path) -> SourcePart:
    """Return the part of the key ``measured``; raise `UserError` for keys that are wrong."""
    found, wrong = validated(Document({"measured": measured}), measured_model(), folder)
    if found is None:
        raise UserError(problem.message for problem in wrong)
    source: SourcePart = found.measured
    return source


def import_measured(
    file: Path,
    options: Mapping[str, Any],
    like: LoadedScenario | None = None,
    out: Path | None = None,
    force: bool = False,
) -> Imported:
    """Write ``STEM.h5`` and ``STEM.yaml`` beside a file, or into a folder.

    Raises `UserError`, and writes nothing, where the files are wrong, where they serve no
    estimator, or where something is there already and ``force`` does not let it be replaced.
    """
    folder, stem = out or file.absolute().parent, file.stem if file.is_file() else file.name
    paths = folder / f"{stem}.h5", folder / f"{stem}.yaml"
    _require_free(file, like.path if like else None, paths, force)
    data = _read(source_of(measured_keys(file, options), Path()), like)
    text, told = _scenario(paths[0].name, f"Measured: {stem}", data, like)
    head = _head(file, paths[1], like)
    _write(paths[0], data, file)
    with replacing(paths[1]) as temporary:
        content = head + yaml.safe_dump(text, sort_keys=False, allow_unicode=True)
        temporary.write_text(content, encoding="utf-8")
    return Imported(*paths, [*data.get("notes", []), *told])


def _read(source: SourcePart, like: LoadedScenario | None) -> Data:
    if isinstance(source, MeasuredTracks):
        return source.read_known(Path(), known_geometry(like) if like else None)
    return source.read(Path())


def _scenario(
    name: str, title: str, data: Data, like: LoadedScenario | None
) -> tuple[Text, list[str]]:
    measured = {"kind": "datasets", "file": name}
    if like is None:
        return default_scenario(title, measured, data), []
    with TemporaryDirectory() as folder:
        _write(Path(folder) / name, data, Path(name))
        return scenario_like(like, measured, Path(folder), data)


def _write(path: Path, data: Data, file: Path) -> None:
    store.write(path, data, {"stage": "simulate", "imported_from": file.name})


def _plain(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return str(value) if isinstance(value, Path) else value


def _head(file: Path, path: Path, like: LoadedScenario | None) -> str:
    estimators = f"estimators of {like.name}" if like else "the default estimator"
    return _HEAD.format(source=file.name, estimators=estimators, name=path.name)


def _require_free(file: Path, like: Path | None, paths: tuple[Path, ...], force: bool) -> None:
    for read in (file, like):
        if read and read.exists() and any(p.exists() and p.samefile(read) for p in paths):
            raise UserError(f"{read}: what is written would take its place; give another --out")
    there = [f"{path}: this file is there already" for path in paths if path.exists()]
    if there and not force:
        raise UserError([*there, "nothing was written; --force replaces what is there"])
