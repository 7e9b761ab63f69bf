"""The lens of a camera that was not calibrated, from structures made by COLMAP's own simulator.

Importing the library here would keep OpenCV from writing PNG later on, so a process of its own does
it.
"""

import json
import subprocess
import sys
from importlib.util import find_spec

import pytest

pytestmark = pytest.mark.skipif(not find_spec("pycolmap"), reason="needs the extra vision")
SCRIPT = """
import json, sys
import pycolmap as colmap
from debrisest.reconstruction.self_calibration import bent_as_told, lens_of

bending, points, seed = float(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
colmap.logging.minloglevel = 3
colmap.set_random_seed(seed)
model = colmap.synthesize_dataset(colmap.SyntheticDatasetOptions(
    num_rigs=1, num_frames_per_rig=12, num_points3D=points,
    camera_params=[1280.0, 512.0, 384.0, bending]))
colmap.synthesize_noise(colmap.SyntheticNoiseOptions(point2D_stddev=0.5), model)
(camera,) = model.cameras.values()
params = list(camera.params[:3])
camera.model, camera.params = colmap.CameraModelId.SIMPLE_PINHOLE, params
options = colmap.BundleAdjustmentOptions(refine_principal_point=False, print_summary=False)
colmap.bundle_adjustment(model, options)
straight = lens_of(colmap, model)
_, lens = bent_as_told(colmap, model, straight)
print(json.dumps([straight.matrix[0, 0], lens.matrix[0, 0], lens.focal_spread, lens.distortion[0],
                  lens.distortion_sigma]))
"""
FOCAL = 1280.0


def told(bending, points, seed):
    command = [sys.executable, "-c", SCRIPT, str(bending), str(points), str(seed)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.parametrize("seed", [1, 2])
def test_a_bent_lens_is_told_with_its_sigma(seed):
    _, focal, spread, k1, sigma = told(-0.1, 200, seed)
    assert 0.0 < sigma < 0.01
    assert abs(k1 + 0.1) < 4.0 * sigma
    assert abs(focal / FOCAL - 1.0) < 3.0 * spread


def test_a_straight_lens_stays_straight():
    straight, focal, _, k1, sigma = told(0.0, 200, 3)
    assert (k1, sigma) == (0.0, 0.0)
    assert focal == straight
    assert abs(focal / FOCAL - 1.0) < 0.01


def test_corners_are_drawn_out_no_farther_than_by_lenses():
    straight, focal, _, k1, _ = told(0.3, 200, 4)
    assert k1 == 0.0
    assert focal == straight
