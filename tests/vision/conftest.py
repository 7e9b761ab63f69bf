"""A box that turns before a small stereo pair, as a scenario, its data and its folder of images."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from debrisest.arrays import Data
from debrisest.runner.stages.simulate import run
from debrisest.scenario.load import load_scenario

SCENE: dict[str, Any] = {
    "title": "A box",
    "seed": 3,
    "runs": 1,
    "duration_s": 8,
    "step_s": 1,
    "target": {"kind": "textured_body", "name": "box", "texture_m": 0.3},
    "motion": {"kind": "torque_free", "rate_deg_s": [3.0, 5.0, 2.0]},
    "observers": {"chaser": {"kind": "still", "target_m": [0.35, 0.0, 5.9]}},
    "sensors": {
        "camera": {"kind": "images", "width_px": 320, "height_px": 240, "focal_px": 500}
        | {"baseline_m": 0.7}
    },
    "estimators": {},
}


def laid_on(base: dict[str, Any], over: dict[str, Any]) -> dict[str, Any]:
    inner = {
        key: laid_on(base[key], value)
        for key, value in over.items()
        if isinstance(value, dict) and isinstance(base.get(key), dict)
    }
    return base | over | inner


Scene = Callable[..., Data]


@pytest.fixture(scope="session")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    """Return the simulated data of the scene with changes."""
    pytest.importorskip("embreex")

    def simulated(changes: dict[str, Any] | None = None) -> Data:
        path = tmp_path_factory.mktemp("scene") / "box.yaml"
        path.write_text(yaml.safe_dump(laid_on(SCENE, changes or {})))
        return run(load_scenario(path).cases["nominal"], "", {"run": np.array([0.0])})

    return simulated


@pytest.fixture(scope="session")
def turning_box(scene: Scene) -> Data:
    return scene()


@pytest.fixture(scope="session")
def config(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scene") / "box.yaml"
    path.write_text(yaml.safe_dump(SCENE))
    return path


@pytest.fixture(scope="session")
def rendered(config: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of images that the command renders."""
    pytest.importorskip("embreex")
    pytest.importorskip("cv2")
    from typer.testing import CliRunner

    from debrisest.cli import app

    out = tmp_path_factory.mktemp("rendered")
    done = CliRunner().invoke(app, ["render", str(config), "--out", str(out), "--quiet"])
    assert done.exit_code == 0, done.output
    return out / "box" / "nominal" / "images-000000"
