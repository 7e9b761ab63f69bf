"""One motion, seen by a chaser that turns, as the text files that people have of it."""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from debrisest.sensors.distortion import distorted

BODY = np.array(
    [[1.2, 0.1, -0.3], [-0.4, 0.9, 0.5], [0.2, -1.1, 0.7], [-0.8, -0.3, -0.6], [0.5, 0.6, 1.0]]
)
NAMES = ["bow", "left", "right", "tail", "top"]
TIMES = 5.0 + 0.5 * np.arange(30)
LENS = (-0.2, 0.1, 1e-3, -5e-4, 0.02)
FOCAL, CENTRE = np.array([800.0, 820.0]), np.array([320.0, 240.0])
BASE = 0.9
CENTRE_C = np.array([0.3, -0.2, 9.0])


def attitudes() -> tuple[Rotation, Rotation]:
    """Of the body to inertial axes, and of the chaser, which turns 1 deg/s."""
    body = Rotation.from_rotvec(np.radians(8.0) * np.outer(TIMES, [0.36, 0.48, 0.8]))
    return body, Rotation.from_rotvec(np.radians(1.0) * np.outer(TIMES, [0.6, 0.0, 0.8]))


def quaternions(turn: Rotation) -> np.ndarray:
    return turn.as_quat(scalar_first=True)


def seen_by_chaser() -> np.ndarray:
    """Points (time, feature, 3) in the chaser's axes, 9 m ahead of its camera."""
    body, chaser = attitudes()
    turned = np.einsum("tij,fj->tfi", (chaser.inv() * body).as_matrix(), BODY)
    return np.asarray(turned + CENTRE_C)


def csv(path: Path, header: str, rows: Any) -> Path:
    text = [",".join(f"{c:.12g}" if isinstance(c, float) else str(c) for c in row) for row in rows]
    path.write_text("\n".join([header, *text]) + "\n")
    return path


def cells(values: np.ndarray) -> Any:
    return ((time, name, *map(float, row)) for time, rows in zip(TIMES.tolist(), values)
            for name, row in zip(NAMES, rows))  # fmt: skip


def write_files(folder: Path) -> None:
    """Write points, pixels, poses, geometry, calibrations and the chaser's attitude."""
    body, chaser = attitudes()
    points = seen_by_chaser()
    csv(folder / "points.csv", "time_s,feature,x_m,y_m,z_m", cells(points))
    rows = []
    for camera, shift in (("left", 0.0), ("right", BASE)):
        local = points - [shift, 0.0, 0.0]
        pixel = CENTRE + FOCAL * distorted(local[..., :2] / local[..., 2:], LENS)
        rows += [(t, name, camera, u, v) for t, name, u, v in cells(pixel)]
    csv(folder / "pixels.csv", "time_s,feature,camera,u_px,v_px", rows)
    one = [row for row in rows if row[2] == "left"]
    csv(folder / "one.csv", "time_s,feature,camera,u_px,v_px", one)
    pose = quaternions(chaser.inv() * body)
    centre = [(0.3, -0.2, 9.0)] * len(TIMES)
    table = [(t, *q, *r) for t, q, r in zip(TIMES.tolist(), pose.tolist(), centre)]
    csv(folder / "poses.csv", "time_s,q0,q1,q2,q3,x_m,y_m,z_m", table)
    q_ic = zip(TIMES.tolist(), *quaternions(chaser).T.tolist())
    csv(folder / "attitude.csv", "time_s,q0,q1,q2,q3", q_ic)
    csv(folder / "body.csv", "feature,x_m,y_m,z_m", ((n, *p) for n, p in zip(NAMES, BODY)))
    keys = dict(zip(("fx_px", "fy_px", "cx_px", "cy_px"), (*FOCAL, *CENTRE)))
    keys |= {"distortion": list(LENS), "baseline_m": BASE}
    text = "".join(f"{key}: {value}\n" for key, value in keys.items())
    (folder / "stereo.yaml").write_text(text)
    (folder / "mono.yaml").write_text(text.replace(f"baseline_m: {BASE}\n", ""))
