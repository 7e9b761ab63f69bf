"""Scenarios drawn from the catalog: any combination of parts, with values for their keys."""

import random
import re
from pathlib import Path
from typing import Any

import yaml

from debrisest.catalog import CATALOG, kind_of
from debrisest.errors import UserError
from debrisest.parts.truth.satellite import Satellite
from debrisest.roles import Part
from debrisest.scenario.load import LoadedScenario, load_scenario
from debrisest.vocabulary import VOCABULARY

QUANTITIES = [name for name, entry in VOCABULARY.items() if entry.table_unit]
ELEMENTS = {"semi_major_axis_km": [7493], "eccentricity": [0.1, 0.0], "inclination_deg": [20]} | {
    "raan_deg": [35], "argument_of_periapsis_deg": [70], "true_anomaly_deg": [8]
}  # fmt: skip
SATELLITE = ELEMENTS | {"semi_major_axis_km": [7500], "inclination_deg": [30]} | {
    "raan_deg": [10, 7], "argument_of_periapsis_deg": [90]
}  # fmt: skip
AIR = {"area_to_mass_m2_kg": 0.1, "density_kg_m3": 6e-12, "altitude_km": 366} | {
    "scale_height_km": 60
}  # fmt: skip
CORNERS = {
    "a": {"position_m": [1.0, 0.0, 0.5], "normal": [1, 0, 0]},
    "b": {"position_m": [0.0, 1.2, -0.4], "normal": [0, 1, 0]},
    "c": {"position_m": [-1.0, 0.0, 0.7], "normal": [-1, 0, 0]},
    "d": {"position_m": [0.3, -1.1, -0.2], "normal": [0, -1, 0]},
}
VARIANCES = {"q_ib": 1e-2, "q_bf": 0.1, "rate_rad2_s2": 2e-2, "moments": 0.02}
SPREAD = {"attitude_rad2": 1.0, "rate_rad2_s2": 0.1, "log_inertia": 0.16}
PURSUIT = {"attitude": ["triad", "wahba"], "penalty": [0.3], "iterations": [5]}
MEASURES = {"measures": [["pixels"], ["acceleration"], ["flow", "disparity"]]}
MEASURES |= {"score_delay_s": [0.0, 1e4], "pixel_noise_px": [None, 1e-4]}
KEYS: dict[str, dict[str, list[Any]]] = {
    "rigid_points": {"inertia_kg_m2": [[0.6, 0.7, 0.3], [1.0, 1.0, 2.0]], "points": [CORNERS]},
    "random_points": {"count": [5, 4], "half_size_m": [1.5], "inertia_ratios": [[-0.19, -0.08]]},
    "random_box": {"count": [4], "half_side_m": [[0.5, 1.0]]},
    "kepler": ELEMENTS,
    "perturbed": ELEMENTS
    | {"j2": [True, False], "acceleration_m_s2": [[0, 0, 0], [1e-6, 0, 0]]}
    | {"air": [None, AIR], "acceleration_noise_m_s2": [0.0, [0.1, 0.0, 0.2]]},
    "torque_free": {"rate_deg_s": [[7.2, 5.5, -1.6], [0, 0, 0], [100.0, 50.0, 30.0]]},
    "gravity_gradient": {"rate_deg_s": [[0.6, 0.4, 1.0], [0, 0, 0]]}
    | {"torque_n_m": [[0, 0, 0], [1e-4, 0, -1e-5]]},
    "random_tumble": {"rate_deg_s": [[1.0, 8.0]]},
    "seen_from_leader": {"position_m": [[10, 60, 10], [0.5, 4, 0.5]]}
    | {"velocity_m_s": [[0.01, -0.02, -0.01]], "rate_deg_s": [[-0.1, -0.1, 0.03], [20, 30, 5]]}
    | {"torque_deg_s2": [[0, 0, 0], [1e-3, 0, 1e-2]]},
    "hold": {"position_m": [[0, 30, 0]]},
    "drift": {"position_m": [[0, 30, 0]]},
    "closed_ellipse": {"position_m": [[0, 17.3, 5.9]], "velocity_m_s": [[9e-3, 0, -1e-3]]},
    "relative_orbit": {"position_m": [[0, 17.3, 5.9]]}
    | {"velocity_m_s": [[9e-3, 0, -1e-3], [0, 0.1, 0]]},
    "satellite": SATELLITE,
    "feature_points": {"noise_m": [1e-2, 0.0, 10.0], "visibility": ["all", "back_face"]}
    | {"missing_share": [0.0, 0.9], "outages_s": [[], [[1, 3], [2, 1e4]]]}
    | {"slow_s": [[], [{"span_s": [0, 5], "every_s": 3}]]}
    | {"attitude_noise_deg": [0.0, 1.0], "feature_error_m": [0.0, 0.1]},
    "stereo_camera": {"baseline_m": [1], "q_lc": [[1, 0, 0, 0], [0.8, 0, 0, 0.6]]}
    | {"pixel_noise_px": [1e-5, 1e-2], "from_s": [1.0, 1e3]}
    | {"flow_noise_px_s": [1e-5], "disparity_noise_px": [1e-5], "outlier_share": [0.0, 1.0]},
    "angular_acceleration": {"noise_rad_s2": [1e-5], "from_s": [1.0, 1e3]},
    "pinhole_camera": {"focal_px": [335], "half_size_px": [[240, 180]]},
    "pointing_control": {"inertia_kg_m2": [[[1e-3, 0, 0], [0, 1e-3, 0], [0, 0, 1e-3]]]}
    | {"control_step_s": [0.1], "inertia_error": [0.0, 0.2], "desired_px": [[0, 0], [9, -9]]},
    "attitude_sensor": {"noise_deg": [1.0], "missing_share": [0.0, 1.0]},
    "attitude_knowledge": {"bias_mrad": [0.0, 1.0]},
    "detections": {"missing_share": [0.0, 0.95], "pixel_noise_px": [1.0, 0.0]},
    "camera_range": {"missing_share": [0.0, 0.9, 1.0], "false_match_share": [0.0, 1.0]}
    | {"dark_s": [[], [[0, 1e5]]], "half_size_px": [[500, 500], [1, 1]]},
    "drawn_pose": {"position_sigma_m": [1], "velocity_sigma_m_s": [1, [1, 2, 0.5]]}
    | {"rate_sigma_deg_s": [1]}
    | {"q_sigma": [3e-3], "inertia_ratio_sigma": [0.7], "point_sigma_m": [1]}
    | {"bodies_only": [False, True]},
    "drawn_orbit": {"position_sigma_m": [100, [100, 50, 1]], "velocity_sigma_m_s": [100]},
    "drawn_shape": {"position_sigma_m": [2.0, [1.0, 3.0, 2.0]]},
    "basis_pursuit": PURSUIT
    | {"signs": [{}, {"keep_hypotheses": True}]}
    | {"exact_recovery": [False, True]},
    "direction_cosines": PURSUIT,
    "line_spectrum": {"attitude": ["triad", "wahba"], "most_lines": [30, 1]},
    "tumbling_attitude": {"integrator": ["rk4", "euler"], "measurement_noise": [1e-4]}
    | {"process_noise": [VARIANCES]},
    "tumbling_motion": {"measured": ["points", "attitudes"]},
    "stereo_pose": MEASURES,
    "stereo_pose_additive": MEASURES | {"transition": ["exact", "first_order"]},
    "camera_range_minimal": {"camera_attitude": ["known", "implied"]}
    | {"range_to": ["centre", "bias", "landmark"], "gauge_sigma_deg": [0.0, 5.0]},
    "camera_range_redundant": {"pixel_noise_px": [None, 3.0]}
    | {"process_noise": [{}, {"rate_rad_s": 1e-6}]},
    "orbit_from_pixels": {
        "acceleration_noise_m_s2": [0.1, 0.0, [0.1, 0.2, 0.0]],
        "tracks": ["debris", "all"],
    }
    | {"attitude_bias": [False, True], "detections": ["all", "own"]},
    "first_samples": {"samples": [5, 1000], "variance": [VARIANCES]},
    "first_points": {"samples": [5, 1000], "variance": [SPREAD]},
    "unscented": {"kappa": [0.0, -1.0], "redraw": [False, True]},
    "extended": {"iterations": [1, 10], "gate": [False, True]},
    "replay": {"smoother": [False, True], "gate": [False, True]},
    "efficient": {"smoother": [False, True]},
    "association": {"method": ["probabilistic", "nearest"], "linearised": ["estimate", "start"]}
    | {"gate_dimension": [None, 4], "process_noise": ["stated", "stated_or_more"]},
    "landmark_batch": {"windows_s": [[5.0, 10.0]], "spacing_s": [[1.0, 2.0]], "restarts": [0]}
    | {"batch_iterations": [3]},
}
"""Values of the keys, the usual one first; a kind that is not here goes by its defaults."""


class World:
    """A scenario drawn from the catalog: every sensor and start that can be, some estimators."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.there: set[str] = set()

    def part(self, kind: type[Part]) -> dict[str, Any]:
        usual = self.random.random() < 0.6
        keys = {
            key: values[0] if usual else self.random.choice(values)
            for key, values in KEYS.get(kind_of(kind), {}).items()
        }
        self.there.update(kind.can_give())
        return {"kind": kind_of(kind), **keys}

    def one(self, role: str, *without: str) -> dict[str, Any]:
        possible = [part for part in self.known(role) if set(part.needs) <= self.there]
        return self.part(self.random.choice([p for p in possible if kind_of(p) not in without]))

    def all(self, role: str) -> dict[str, Any]:
        found = {}
        for part in self.known(role):
            gives = set(part.can_give())
            fits = gives and not gives & self.there and set(part.needs) <= self.there
            if fits and self.random.random() < 0.9:
                found[kind_of(part)] = self.part(part)
        return found

    def known(self, role: str) -> list[Any]:
        """The parts of a role that need no key, or whose keys are told here."""
        return [
            part
            for part in CATALOG[role]
            if kind_of(part) in KEYS
            or not any(f.is_required() for name, f in part.model_fields.items() if name != "kind")
        ]

    def estimator(self) -> dict[str, Any]:
        recoveries = [part for part in self.known("recovery") if set(part.needs) <= self.there]
        there = self.there | {name for part in recoveries for name in part.can_give()}
        problem = self.random.choice([p for p in self.known("problem") if set(p.needs) <= there])
        scans = problem.model_kind == "scan_model"
        takes = {problem.model_kind, *(["tracks_model"] if scans else [])}
        algorithm = self.random.choice([f for f in self.known("filter") if f.takes in takes])
        found = {"problem": self.part(problem), "filter": self.part(algorithm)}
        if "q_if" in problem.needs:
            found["recovery"] = self.part(self.random.choice(recoveries))
        if not algorithm.makes_start:
            needed, starts = set(problem.start_needs), self.known("start")
            fitting = [part for part in starts if needed <= part.guessed(there)]
            found["start"] = self.part(self.random.choice(fitting or starts))
        return found

    def scenario(self, estimators: int) -> dict[str, Any]:
        step, epochs = self.random.choice([1, 0.5, 10]), self.random.choice([2, 10, 20])
        found: dict[str, Any] = {"title": "any", "seed": 1, "runs": 2}
        found |= {"duration_s": epochs * step, "step_s": step}
        found |= {"target": self.one("target"), "orbit": self.one("orbit")}
        ratios = found["target"]["kind"] == "random_points"
        found["motion"] = self.one("motion", *["gravity_gradient", "random_tumble"] * ratios)
        seen = found["motion"]["kind"] == "seen_from_leader"
        found["observers"] = {} if seen else {"chaser": self.one("observers", "satellite")}
        for number in range(2 * self.random.randint(0, 1)):
            found["observers"][f"s{number}"] = self.part(Satellite)
        found |= {"sensors": self.all("sensors"), "starts": self.all("starts")}
        found["estimators"] = {f"e{n}": self.estimator() for n in range(estimators)}
        table = {"table": "all", "title": "All", "stage": "filter", "quantities": QUANTITIES}
        table |= {"statistics": ["rmse", "p90"], "windows": ["end"]}
        return found | {"tables": {"layout": [table]}}


def loaded(path: Path, document: dict[str, Any]) -> LoadedScenario | None:
    """Write and load a scenario, without those estimators that are refused; None if all is."""
    for _ in range(3):
        path.write_text(yaml.safe_dump(document, sort_keys=False))
        try:
            return load_scenario(path)
        except UserError as error:
            told = [re.search(r": estimators\.(\w+)", problem) for problem in error.problems]
        refused = {match[1] for match in told if match}
        left = {name: one for name, one in document["estimators"].items() if name not in refused}
        if not refused or not left:
            return None
        document = document | {"estimators": left}
    return None
