"""The command from a user's file to the answer."""

import os
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from typer import Option

from debrisest.cli.exits import exit_if
from debrisest.cli.inputs import load_all
from debrisest.cli.measured import (
    Attitude,
    Cameras,
    ImageTimes,
    Measured,
    NoiseM,
    NoisePx,
    Points,
    RateHz,
    SigmaDeg,
    SigmaDegS,
)
from debrisest.cli.options import RESULTS, Force, Quiet
from debrisest.cli.stages import bring

if TYPE_CHECKING:
    from debrisest.scenario.load import LoadedScenario

_PATHS = ("file", "points", "camera", "attitude", "image_times")


def estimate(
    file: Measured,
    points: Points = None,
    camera: Cameras = None,
    attitude: Attitude = None,
    rate_hz: RateHz = None,
    image_times: ImageTimes = None,
    noise_m: NoiseM = None,
    noise_px: NoisePx = None,
    sigma_deg: SigmaDeg = None,
    sigma_deg_s: SigmaDegS = None,
    out: Annotated[
        Path | None, Option("--out", help="Folder to write to (default: results/<stem>).")
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Estimate the motion of the body in a file of tracks, poses or rates, and print the answer.

    The scenario that is written with it does the same through sweep.
    """
    from debrisest.runner.selection import Selection
    from debrisest.runner.sweep import Machine

    options = {
        "points": points,
        "camera": camera,
        "attitude": attitude,
        "rate_hz": rate_hz,
        "image_times": image_times,
        "noise_m": noise_m,
        "noise_px": noise_px,
        "sigma_deg": sigma_deg,
        "sigma_deg_s": sigma_deg_s,
    }
    folder = out or RESULTS / (file.stem if file.is_file() else file.resolve().name)
    folder = folder if folder.name not in ("", "..") else folder.resolve()
    text, notes = _scenario(file, options, folder)
    config = write_new(folder / f"{folder.name}.yaml", text, force)
    for note in notes:
        print(f"note: {note}")
    (scenario,) = load_all([config], None, None)
    selection, machine = Selection(force=force), Machine(quiet=quiet)
    failed = bring([scenario], folder.parent, selection, machine, dry_run=False)
    _tell(scenario, folder)
    exit_if(failed)


def _scenario(file: Path, options: dict[str, Any], folder: Path) -> tuple[str, list[str]]:
    """Return a scenario for ``folder`` as YAML, and what the readers understood or doubt."""
    import yaml

    from debrisest.measured.default_scenario import default_scenario
    from debrisest.measured.import_file import measured_keys, source_of

    measured = measured_keys(file, options)
    data = source_of(measured, Path()).read(Path())
    kept = {k: relative_to(folder, v) if k in _PATHS else v for k, v in measured.items()}
    found = default_scenario(f"Motion of the body in {file.name}", kept, data)
    notes = [str(note) for note in data.get("notes", ())]
    return yaml.safe_dump(found, sort_keys=False, allow_unicode=True), notes


def relative_to(folder: Path, path: str | list[str]) -> str | list[str]:
    """Return a path, or some, as it counts from a folder, which links may lead to."""
    if isinstance(path, list):
        return [str(relative_to(folder, each)) for each in path]
    return Path(os.path.relpath(Path(path).resolve(), folder.resolve())).as_posix()


def write_new(path: Path, text: str, force: bool) -> Path:
    """Write a scenario, or raise UserError where another one is there."""
    from debrisest.errors import UserError
    from debrisest.files import content, replacing

    if path.exists() and content(path) != text.encode() and not force:
        again = shlex.join(["debrisest", "sweep", str(path), "--out", str(path.parent.parent)])
        raise UserError(
            f"{path}: another scenario is there already; run it with {again}, "
            "choose another folder with --out, or replace it with --force"
        )
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return path


def _tell(scenario: "LoadedScenario", folder: Path) -> None:
    """Write estimates and figures, and print the answer and the files in which it stands."""
    from debrisest.results.open import find_results
    from debrisest.results.status import up_to_date
    from debrisest.runner.plan import plan
    from debrisest.runner.selection import Selection
    from debrisest.show.answer import answer
    from debrisest.show.estimates import export
    from debrisest.show.plots.draw import draw_all

    steps = plan(scenario, folder.parent, Selection())
    results = up_to_date(find_results(folder), steps)
    (case,), (estimator,) = scenario.cases, scenario.common.estimators
    print("", *answer(results.one_run(case, estimator, 0)), "", sep="\n")
    written = [scenario.path, *(chunk.path for chunk in results.chunks)]
    if results.first_good_run(case, estimator) is not None:
        export(results, folder / "estimates.csv")
        written += [folder / "estimates.csv", *draw_all(scenario, folder.parent, steps)]
    for path in written:
        print(f"wrote {path}")
