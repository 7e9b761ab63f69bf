"""Structure from motion of a small rendered box: scale, cloud, a kill in the middle."""

import signal
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import yaml

from debrisest.counted import heard_by
from debrisest.problems.shape.model import seen
from debrisest.reconstruction import structure
from debrisest.runner.stages.simulate import run
from debrisest.scenario.load import load_scenario

NEEDED = ("cv2", "pycolmap", "embreex")
pytestmark = pytest.mark.skipif(
    not all(find_spec(name) for name in NEEDED), reason="needs the extra vision"
)
FRAMES = 12
SCENE = {
    "title": "A box",
    "seed": 4,
    "runs": 1,
    "duration_s": FRAMES,
    "step_s": 1,
    "target": {"kind": "textured_body", "name": "box", "texture_m": 0.3},
    "motion": {"kind": "torque_free", "rate_deg_s": [3.0, 6.0, 3.0]},
    "observers": {"chaser": {"kind": "still", "target_m": [0.35, 0.0, 5.9]}},
    "sensors": {
        "camera": {"kind": "images", "width_px": 400, "height_px": 300, "focal_px": 640}
        | {"baseline_m": 0.7, "sun": [-0.3, -0.3, -1.0]}
    },
    "estimators": {},
}


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    path = tmp_path_factory.mktemp("box") / "box.yaml"
    path.write_text(yaml.safe_dump(SCENE))
    (case,) = load_scenario(path).cases.values()
    return run(case, "", {"run": np.zeros(1)})


@pytest.fixture(scope="module")
def killed(scene, tmp_path_factory):
    """A folder in which the process was killed as soon as it had found features."""
    folder = tmp_path_factory.mktemp("killed")
    structure._prepare(*seen(scene, 0), folder)
    command = [sys.executable, "-m", "debrisest.reconstruction.structure_process", str(folder)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    assert process.stdout is not None
    assert process.stdout.readline().endswith(b"images with features\n")
    process.send_signal(signal.SIGKILL)
    process.wait()
    process.stdout.close()
    return folder


def features(folder: Path) -> dict[str, bytes]:
    import sqlite3

    connection = sqlite3.connect(folder / "database.db")
    rows = connection.execute(
        "select name, data from images join keypoints on images.image_id = keypoints.image_id"
    ).fetchall()
    connection.close()
    return dict(rows)


@pytest.fixture(scope="module")
def found(scene, killed):
    """The structure after a second attempt in the folder, what was told, and what was kept."""
    before, told = features(killed), []
    with heard_by(told.append):
        result = structure.structure_from_motion(*seen(scene, 0), killed)
    return result, told, before, features(killed)


def test_a_second_attempt_goes_on_from_the_first_one(found):
    _, told, before, after = found
    assert before
    assert {name: after[name] for name in before} == before
    assert any(part.what == "images placed" for part in told)


def test_every_image_finds_its_place_with_the_scale_of_the_rig(scene, found):
    result = found[0]
    assert len(result.registered) == FRAMES
    true = scene["true_position"][0]
    distance = np.linalg.norm(
        result.translation + result.rotation @ np.median(result.points, axis=0), axis=1
    )
    np.testing.assert_allclose(distance.mean(), np.linalg.norm(true[0]), rtol=0.1)
    assert 0.0 < result.scale_sigma < 0.02


def test_turns_between_images_are_those_of_the_body(scene, found):
    from scipy.spatial.transform import Rotation

    true = Rotation.from_quat(scene["true_q_ib"][0], scalar_first=True).as_matrix()
    offset = np.swapaxes(found[0].rotation, 1, 2) @ true
    middle = Rotation.from_matrix(offset).mean()
    error = np.degrees((middle.inv() * Rotation.from_matrix(offset)).magnitude())
    assert error.max() < 2.0


def test_points_lie_on_the_box(scene, found):
    from scipy.spatial.transform import Rotation

    result = found[0]
    true = Rotation.from_quat(scene["true_q_ib"][0], scalar_first=True).as_matrix()
    turn = np.swapaxes(true[0], 0, 1) @ result.rotation[0]
    shift = true[0].T @ (result.translation[0] - scene["true_position"][0, 0])
    points = np.abs(result.points @ turn.T + shift) / [1.0, 0.8, 0.6]
    assert np.median(np.abs(points.max(axis=1) - 1.0)) < 0.05


def test_images_that_show_nothing_together_are_refused(tmp_path):
    rng = np.random.default_rng(0)
    frames = rng.integers(0, 255, (3, 1, 60, 80)).astype(np.uint8)
    rig = structure.Rig(
        np.array([[[80.0, 0, 40], [0, 80, 30], [0, 0, 1]]]), np.eye(3)[None], np.zeros((1, 3))
    )
    with pytest.raises(ValueError, match="fewer than half of the images"):
        structure.structure_from_motion(
            frames, np.ones(frames.shape, dtype=bool), rig, tmp_path / "work"
        )
