"""Errors of volume and inertia against the true body, whose axes the mesh is laid onto.

Principal moments alone would hide exchanged axes. The true tensor is scaled to the density that
the estimate took.
"""

import numpy as np

from debrisest.arrays import Array, Data, IntArray
from debrisest.reconstruction.alignment import align
from debrisest.vision.polyhedron import mass_properties

_COMPONENTS = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}


def scores(data: Data) -> Data:
    """Return the errors of each run, NaN where no number is told; nothing without a truth."""
    runs = range(len(data["run"]))
    result: Data = {name: data[name] for name in ("surface_seen", "confident") if name in data}
    if "true_vertex_b" not in data:
        return result
    each = [_of_run(data, run) for run in runs]
    return result | {name: np.array([one[name] for one in each]) for name in each[0]}


def _of_run(data: Data, run: int) -> dict[str, float]:
    names = ["volume_error", *(f"inertia_{name}_error" for name in _COMPONENTS)]
    if not np.isfinite(data["volume"][run]):
        return dict.fromkeys([*names, "within_bars", "surface_distance"], np.nan)
    true = [data[name][run] for name in ("true_vertex_b", "true_triangle")]
    truth = mass_properties(true[0], true[1].astype(np.int64))
    found = align(*_mesh(data, run), true[0], true[1].astype(np.int64))
    density = data["body_mass"][run] / data["volume"][run]
    inertia = truth.inertia * density
    error = found.inertia(data["body_inertia_r"][run]) - inertia
    level = np.sqrt(np.outer(np.diag(inertia), np.diag(inertia)))
    errors = [data["volume"][run] / truth.volume - 1.0]
    errors += [float(error[place] / level[place]) for place in _COMPONENTS.values()]
    spread = relative_spread(data["body_inertia_r"][run], data["body_inertia_r_sigma"][run])
    bars = np.array([data["volume_sigma"][run] / truth.volume, *6 * [spread]])
    within = np.abs(errors) <= 2.0 * bars
    shown = dict(zip(names, np.abs(errors).tolist()))
    return {**shown, "within_bars": float(within.mean()), "surface_distance": found.distance}


def _mesh(data: Data, run: int) -> tuple[Array, IntArray]:
    vertices, triangles = data["vertex_r"][run], data["triangle_r"][run]
    kept = np.isfinite(triangles[:, 0])
    return vertices[np.isfinite(vertices[:, 0])], triangles[kept].astype(np.int64)


def relative_spread(inertia: Array, sigma: Array) -> Array:
    """Return the largest sigma of a diagonal component over it (...), in whatever axes it is told.

    Errors of scale, coverage and resolution go with the size of each component, so that this holds
    in other axes, where sigmas that are turned like independent ones would drown small moments.
    """
    diagonals = (np.diagonal(each, axis1=-2, axis2=-1) for each in (sigma, inertia))
    return np.asarray(np.divide(*diagonals).max(axis=-1))
