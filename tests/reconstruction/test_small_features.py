"""Large features lie inside of a rounded body, most at its outline: small ones tell the places.

COLMAP's own simulator makes the structure, in a process of its own (see test_self_calibration).
"""

import json
import subprocess
import sys
from importlib.util import find_spec

import numpy as np
import pytest
import scipy

needs_colmap = pytest.mark.skipif(not find_spec("pycolmap"), reason="needs the extra vision")
SCRIPT = """
import json, sys
from pathlib import Path
import numpy as np
import pycolmap as colmap
from debrisest.reconstruction.small_features import placed_by_small_features
from debrisest.reconstruction.structure import AS_GIVEN
from debrisest.reconstruction.structure_job import Job

folder, frames, inside = Path(sys.argv[1]), 12, 0.01
colmap.logging.minloglevel = 3
colmap.set_random_seed(1)
options = colmap.SyntheticDatasetOptions(
    num_rigs=1, num_frames_per_rig=frames, num_points3D=200,
    camera_model_id=colmap.CameraModelId.SIMPLE_PINHOLE, camera_params=[1280.0, 512.0, 384.0])
job = Job(folder, colmap, None, frames, AS_GIVEN)
with colmap.Database.open(job.database) as database:
    model = colmap.synthesize_dataset(options, database)
    for number, image in model.images.items():
        keypoints = np.zeros((image.num_points2D(), 6))
        middle = image.project_point(np.mean([p.xyz for p in model.points3D.values()], axis=0))
        away = [np.linalg.norm(point.xy - middle) for point in image.points2D]
        for place, point in enumerate(image.points2D):
            small = not point.has_point3D() or bool(point.point3D_id % 2)
            keypoints[place] = [*point.xy, 2.0 if small else 6.0, 0.0, 0.0, 2.0 if small else 6.0]
            if not small and away[place] > np.median(away):
                image.points2D[place].xy = point.xy - inside * (point.xy - middle)
        database.update_keypoints(number, keypoints.astype(np.float32))


def apart(model):
    cameras = np.array([image.projection_center() for image in model.images.values()])
    distance = np.linalg.norm(cameras[:, None] - cameras, axis=-1)
    return distance / distance.mean()


true = apart(model)
held = colmap.BundleAdjustmentOptions(
    refine_focal_length=False, refine_principal_point=False, print_summary=False)
colmap.bundle_adjustment(model, held)
off = [np.abs(apart(model) - true).max()]
off.append(np.abs(apart(placed_by_small_features(job, model)) - true).max())
print(json.dumps(off))
"""


@needs_colmap
def test_small_features_tell_places_that_large_ones_draw(tmp_path):
    command = [sys.executable, "-c", SCRIPT, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    before, after = json.loads(done.stdout.splitlines()[-1])
    assert before > 1e-4
    assert after < 0.01 * before


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.0])
def test_what_an_image_shows_of_a_round_area_is_inside_by_the_formula(angle):
    """The mean of sin(a + b) over an area that is seen under cos(a + b)."""
    width = 0.05

    def mean(seen):
        return scipy.integrate.quad(
            lambda b: seen(angle + b) * np.exp(-0.5 * (b / width) ** 2), -0.4, 0.4
        )[0]

    found = mean(lambda a: np.sin(a) * np.cos(a)) / mean(np.cos)
    assert found == pytest.approx(np.sin(angle) * (1.0 - 1.5 * width**2), abs=3e-5)
