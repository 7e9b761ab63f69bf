"""The command from images, a cloud or a mesh of a body to its mass properties."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from typer import Argument, Option

from debrisest.cli.estimate import relative_to, write_new
from debrisest.cli.exits import exit_if
from debrisest.cli.images_scenario import CALIBRATION, MOST, PLACES, masks_of, scenario_of, thinned
from debrisest.cli.inputs import load_all
from debrisest.cli.options import RESULTS, Force, Quiet, WidestPx
from debrisest.cli.stages import bring

if TYPE_CHECKING:
    from debrisest.arrays import Data
    from debrisest.scenario.load import LoadedScenario


def reconstruct(
    source: Annotated[
        Path | None,
        Argument(help="A folder of images, a video, a cloud or a mesh.", metavar="INPUT"),
    ] = None,
    mesh: Annotated[
        Path | None, Option("--mesh", help="A closed mesh: OBJ, STL or PLY, in metres.")
    ] = None,
    camera: Annotated[
        Path | None,
        Option(
            "--camera",
            help=f"Calibration, or places: a list, or a folder (default: {CALIBRATION}, or "
            f"{PLACES}, there).",
        ),
    ] = None,
    density_kg_m3: Annotated[float, Option("--density-kg-m3", help="Constant density.")] = 1000.0,
    mass_kg: Annotated[
        float | None, Option("--mass-kg", help="Mass, in the place of the density.")
    ] = None,
    known_length_m: Annotated[
        float | None,
        Option("--known-length-m", help="Longest distance between two points of the body."),
    ] = None,
    known_length_sigma_m: Annotated[
        float, Option("--known-length-sigma-m", help="Its 1-sigma.")
    ] = 0.0,
    field_of_view_deg: Annotated[
        float | None,
        Option("--field-of-view-deg", help="Across the longer side, where nothing is calibrated."),
    ] = None,
    widest_px: WidestPx = 1280,
    every: Annotated[
        int | None,
        Option("--every", min=1, help=f"Take one image of so many (default: {MOST} at most)."),
    ] = None,
    masks: Annotated[
        Path | None,
        Option(
            "--masks",
            help="Folder of masks, white: the body (default: one of that name, in or beside it).",
        ),
    ] = None,
    no_support: Annotated[
        bool, Option("--no-support", help="Do not look for a table under the body.")
    ] = False,
    reference: Annotated[
        Path | None, Option("--reference", help="A CAD mesh to lay the body onto, and to compare.")
    ] = None,
    out: Annotated[
        Path | None, Option("--out", help="Folder to write to (default: results/<stem>).")
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Find volume, centre of mass and inertia of a body of constant density.

    Images go through the stages of a scenario, which is written, like those of sweep.
    """
    from debrisest.errors import UserError
    from debrisest.reconstruction.mesh_files import SUFFIXES

    given = mesh or source
    if given is None or (mesh and source):
        raise UserError("give one thing to reconstruct: images, a video, a cloud, or a mesh")
    _require_positive(density_kg_m3=density_kg_m3, mass_kg=mass_kg, known_length_m=known_length_m)
    if mesh or given.suffix.lower() in SUFFIXES:
        data = _of_file(given, density_kg_m3, mass_kg)
        _tell(data)
        _compare(data, reference)
        return
    problem = {"density_kg_m3": density_kg_m3} if mass_kg is None else {"mass_kg": mass_kg}
    if known_length_m is not None:
        problem |= {
            "known_length_m": known_length_m,
            "known_length_sigma_m": known_length_sigma_m,
        }
    folder = out or RESULTS / given.resolve().stem
    keys: dict[str, Any] = {
        "every": every or thinned(given),
        "field_of_view_deg": field_of_view_deg,
        "widest_px": widest_px,
    }
    masks = masks or masks_of(given)
    if masks is not None:
        keys["masks"] = relative_to(folder, str(masks))
    text = scenario_of(given, camera, keys, problem, folder, no_support)
    config = write_new(folder / f"{folder.name}.yaml", text, force)
    (scenario,) = load_all([config], None, None)
    data = _run(scenario, folder, force, quiet)
    _tell(data)
    _compare(data, reference)
    for path in [config, *_files(scenario, folder, data)]:
        print(f"wrote {path}")
    exit_if(bool(data.get("failure")))


def _require_positive(**values: float | None) -> None:
    from debrisest.errors import UserError

    for name, value in values.items():
        if value is not None and not value > 0:
            raise UserError(f"--{name.replace('_', '-')} must be positive, not {value:g}")


def _of_file(path: Path, density: float, mass: float | None) -> "Data":
    """Return what a mesh, or the surface through a cloud, tells; UserError if it bounds no body."""
    from debrisest.errors import UserError
    from debrisest.reconstruction.mesh_data import mesh_data
    from debrisest.reconstruction.mesh_files import read_mesh

    try:
        return mesh_data(*read_mesh(path), density, mass)
    except ValueError as error:
        raise UserError(f"{path}: {error}") from None


def _tell(data: "Data") -> None:
    from debrisest.show.body_answer import body_answer

    print(*body_answer(data), sep="\n")


def _compare(data: "Data", reference: Path | None) -> None:
    """Print the body beside a reference onto which it is laid, in the reference's axes."""
    from debrisest.reconstruction.mesh_data import body_mesh, mesh_data
    from debrisest.reconstruction.mesh_files import read_mesh
    from debrisest.show.body_answer import comparison

    if reference is None or not data.get("body_mass", 0) > 0:
        return
    density = float(data["body_mass"] / data["volume"])
    known = mesh_data(*read_mesh(reference), density, None)
    print("", *comparison(data, known, *body_mesh(data), *body_mesh(known)), sep="\n")


def _run(scenario: "LoadedScenario", folder: Path, force: bool, quiet: bool) -> "Data":
    """Bring the stages up to date, in this process, and return what they found."""
    from debrisest.results.open import find_results
    from debrisest.results.status import up_to_date
    from debrisest.runner.plan import plan
    from debrisest.runner.selection import Selection
    from debrisest.runner.sweep import Machine

    machine = Machine(jobs=1, quiet=quiet)
    bring([scenario], folder.parent, Selection(force=force), machine, dry_run=False)
    results = up_to_date(find_results(folder), plan(scenario, folder.parent, Selection()))
    (case,), (estimator,) = scenario.cases, scenario.common.estimators
    return results.one_run(case, estimator, 0)


def _files(scenario: "LoadedScenario", folder: Path, data: "Data") -> list[Path]:
    """Write mesh, cloud, a start for the stereo filter and pictures; return their paths."""
    import numpy as np

    from debrisest.reconstruction.mesh_data import body_mesh, start_table
    from debrisest.reconstruction.mesh_files import write_mesh
    from debrisest.runner.plan import plan
    from debrisest.runner.selection import Selection
    from debrisest.show.plots.draw import draw_all

    paths = []
    if "cloud_point_r" in data:
        paths.append(folder / "cloud.ply")
        points = data["cloud_point_r"][np.isfinite(data["cloud_point_r"][:, 0])]
        write_mesh(paths[-1], points, np.empty((0, 3), dtype=np.int64))
    if "vertex_r" in data:
        paths.append(folder / "mesh.obj")
        write_mesh(paths[-1], *body_mesh(data))
        paths += draw_all(scenario, folder.parent, plan(scenario, folder.parent, Selection()))
        if np.isfinite(data["moment_ratios"]).all():
            paths.append(folder / "start.csv")
            start_table(paths[-1], data)
    return paths
