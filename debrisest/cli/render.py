"""The command that renders image sequences: the images of a scenario's simulation, as files."""

from pathlib import Path
from typing import TYPE_CHECKING

from debrisest.cli.exits import exit_if
from debrisest.cli.inputs import load_all, select
from debrisest.cli.options import (
    RESULTS,
    CaseNames,
    Configs,
    Force,
    Jobs,
    Out,
    Plugins,
    Quiet,
    Runs,
    Settings,
)
from debrisest.cli.stages import bring

if TYPE_CHECKING:
    from debrisest.arrays import Data
    from debrisest.scenario.load import LoadedScenario
    from debrisest.tracks.types import Rig


def render(
    configs: Configs,
    out: Out = RESULTS,
    jobs: Jobs = None,
    runs: Runs = None,
    case: CaseNames = None,
    settings: Settings = None,
    plugins: Plugins = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Render image sequences of scenarios, and write them with their calibration.

    The truth is written into a folder of its own.
    """
    from debrisest.runner.sweep import Machine
    from debrisest.vision.libraries import vision_library

    for module in ("cv2", "embreex"):
        vision_library(module)
    scenarios = load_all(configs, settings, plugins)
    _check_images(scenarios)
    selection = select(scenarios, runs, case, None, "simulate", force)
    failed = bring(scenarios, out, selection, Machine(jobs or 1, None, quiet), dry_run=False)
    for scenario in scenarios:
        for name in scenario.cases if case is None else case:
            if name in scenario.cases:
                _write_case(scenario, name, out, runs)
    exit_if(failed)


def _check_images(scenarios: list["LoadedScenario"]) -> None:
    from debrisest.errors import UserError

    for scenario in scenarios:
        parts = [
            part for one in scenario.cases.values() for part in one.scenario.simulation.values()
        ]
        if not any("measured_image" in part.given for part in parts):
            raise UserError(f"{scenario.path}: no images to render; add a sensor of kind images")


def _write_case(scenario: "LoadedScenario", case: str, out: Path, runs: int | None) -> None:
    from debrisest.results.open import open_results

    results = open_results(out / scenario.name)
    for run in range(scenario.cases[case].runs(runs)):
        data = results.one_run(case, "", run)
        if "measured_image" in data:
            print(f"wrote {_write_run(data, out / scenario.name / case, run)}")


def _write_run(data: "Data", folder: Path, run: int) -> Path:
    """Write images and calibration of a run, and apart its truth; return the images' folder."""
    from debrisest.tracks.write_calibration import write_calibration
    from debrisest.vision.image_files import PAIR, ImageSequence, write_images

    images, truth = folder / f"images-{run:06d}", folder / f"truth-{run:06d}"
    frames = data["measured_image"]
    cameras = PAIR if frames.shape[1] > 1 else ("camera",)
    write_images(images, ImageSequence(str(images), cameras, frames, data["time_s"]))
    write_calibration(images / "calibration.yaml", _rig(data, cameras))
    _write_truth(truth, data)
    return images


def _rig(data: "Data", names: tuple[str, ...]) -> "Rig":
    from debrisest.tracks.types import Camera, Rig

    size = data["measured_image"].shape[:1:-1]
    cameras = [
        Camera(name, (m[0, 0], m[1, 1]), (m[0, 2], m[1, 2]), tuple(bent), size)
        for name, m, bent in zip(names, data["camera_matrix"], data["lens_distortion"])
    ]
    return Rig(tuple(cameras), data["rig_rotation"], data["rig_translation"])


def _write_truth(folder: Path, data: "Data") -> None:
    """Write the poses of the body, its mesh and its mass properties, body axes."""
    import numpy as np

    from debrisest.files import replacing
    from debrisest.tracks.types import Poses
    from debrisest.tracks.write import write_poses

    folder.mkdir(parents=True, exist_ok=True)
    times, q, place = data["time_s"], data["true_q_ib"], data["true_position"]
    write_poses(folder / "poses.csv", Poses(str(folder), times, q, np.arange(len(times)), place))
    corners = (f"v {x:.17g} {y:.17g} {z:.17g}\n" for x, y, z in data["true_vertex_b"])
    faces = (f"f {a:.0f} {b:.0f} {c:.0f}\n" for a, b, c in data["true_triangle"] + 1)
    with replacing(folder / "body.obj") as temporary:
        temporary.write_text("".join([*corners, *faces]), encoding="utf-8")
    names = ["volume_m3", *(f"inertia_{a}{b}_kg_m2" for a in "xyz" for b in "xyz")]
    values = [data["true_volume"], *data["true_inertia_b"].ravel()]
    with replacing(folder / "mass.csv") as temporary:
        line = ",".join(repr(float(value)) for value in values)
        temporary.write_text(f"{','.join(names)}\n{line}\n", encoding="utf-8")
