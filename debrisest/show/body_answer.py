"""The answer about a body's shape: volume, centre of mass, inertia and ratios, in a few lines.

A pure function of the stored datasets of a run of the filter `surface`, or of a mesh, without their
run axis.
"""

import numpy as np

from debrisest.arrays import Array, Data, IntArray
from debrisest.reconstruction.alignment import align
from debrisest.show.rounding import told

_LABEL = 17
_NAMES = ("xx", "yy", "zz", "xy", "xz", "yz")
_PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def body_answer(data: Data) -> list[str]:
    """Return the answer line by line, values ± 1 sigma; what is not told has no line."""
    if failure := str(data.get("failure", "")):
        return [*_laid_out(_images(data)), f"NO RESULT: {failure}"]
    if "volume" not in data:
        return [f"NO RESULT: {data.get('status', 'nothing was estimated')}"]
    lines = {
        **_images(data),
        "status": str(data.get("status", "")),
        "outline": str(data.get("outline", "")),
        "mesh": str(data.get("mesh_method", "")),
        "mended": str(data.get("mended", "")),
        "seen": _seen(data),
        **_numbers(data),
        "cross-check": _hulls(data),
    }
    return _laid_out(lines)


def _laid_out(lines: dict[str, str]) -> list[str]:
    return [f"{label:{_LABEL}}{text}" for label, text in lines.items() if text]


def _images(data: Data) -> dict[str, str]:
    """Return the lines of how many images were placed, and of where the calibration came from."""
    if "found_camera_matrix" not in data:
        return {}
    placed = np.isfinite(data["view_translation"][:, 0])
    points = np.isfinite(data["cloud_point_r"][:, 0]).sum()
    lines = {
        "images": f"{placed.sum()} of {len(placed)} placed, {points} points, "
        f"{float(data['reprojection']):.2f} px off in the mean"
    }
    spread, source = float(data["found_focal_spread"]), str(data.get("focal_source", ""))
    focal = float(data["found_camera_matrix"][0, 0, 0])
    if np.isinf(spread):
        lines["focal length"] = f"{focal:.6g} px, which the images do not tell"
    elif spread > 0.0:
        found = told(focal, spread * focal, "px")
        lines["focal length"] = f"{found}, from the images, begun with {source}"
        lines["distortion"] = _distortion(data)
    elif source:
        lines["focal length"] = f"{focal:.6g} px, from {source}"
    return lines


def _distortion(data: Data) -> str:
    bent = float(data["found_lens_distortion"][0, 0])
    sigma = float(data["found_distortion_spread"])
    if sigma > 0.0:
        return f"{told(bent, sigma, '')}, OpenCV's k1, from the images"
    return "none told by the images; a lens that bends visibly needs a calibration"


def _seen(data: Data) -> str:
    """Return the share of the surface that is seen, not rounded up, as to a limit it misses."""
    if "surface_seen" not in data:
        return ""
    return f"{np.floor(1e3 * data['surface_seen']) / 10.0:.3g}% of the surface"


def _numbers(data: Data) -> dict[str, str]:
    """Return the lines of what is told: everything, ratios only, or nothing."""
    if not np.isfinite(data["moment_ratios"]).all():
        return {}
    ratios = {
        name: _told(data, "moment_ratios", "", index) for index, name in enumerate(("k1", "k2"))
    }
    moments = data["principal_moments"]
    if not np.isfinite(moments).all():
        return ratios
    tensor = {
        f"I{name}": _told(data, "body_inertia_r", "kg m2", *place)
        for name, place in zip(_NAMES, _PLACES)
    }
    axes = data["principal_axes_r"]
    principal = {
        f"moment {index + 1}": f"{_told(data, 'principal_moments', 'kg m2', index)} about "
        f"({', '.join(f'{value:.4f}' for value in axes[:, index])})"
        for index in range(3)
    }
    centre = ", ".join(_told(data, "centre_r", "", index) for index in range(3))
    share = ", ".join(f"{value:.4f}" for value in moments / moments[-1])
    return {
        "volume": _told(data, "volume", "m3"),
        "mass": f"{float(data['body_mass']):.6g} kg",
        "centre of mass": f"{centre} m",
        **tensor,
        **principal,
        "over the largest": share,
        **ratios,
    }


def _told(data: Data, name: str, unit: str, *place: int) -> str:
    sigma = data.get(f"{name}_sigma")
    spread = np.nan if sigma is None else float(sigma[place])
    return told(float(data[name][place]), spread, unit)


def _hulls(data: Data) -> str:
    if not np.isfinite(data.get("volume", np.nan)) or "hull_volume" not in data:
        return ""
    return (
        f"convex hull {data['hull_volume']:.6g} m3, what all silhouettes share "
        f"{data['silhouette_volume']:.6g} m3; the volume is no larger than these"
    )


def comparison(
    data: Data,
    known: Data,
    vertices: Array,
    triangles: IntArray,
    reference: Array,
    reference_triangles: IntArray,
) -> list[str]:
    """Return lines that compare a body with a reference, onto whose mesh its own one is laid.

    Errors of the tensor are relative to the root of the product of the two moments.
    """
    found = align(vertices, triangles, reference, reference_triangles)
    tensor, true = found.inertia(data["body_inertia_r"]), known["body_inertia_r"]
    level = np.sqrt(np.outer(np.diag(true), np.diag(true)))
    rows = [("volume m3", data["volume"], known["volume"], known["volume"])]
    rows += [
        (f"I{name} kg m2", tensor[place], true[place], level[place])
        for name, place in zip(_NAMES, _PLACES)
    ]
    lines = [
        f"{label:{_LABEL}}{float(value):>14.6g}{float(truth):>14.6g}"
        f"{100.0 * float((value - truth) / scale):>+9.2f} %"
        for label, value, truth, scale in rows
    ]
    return [
        f"beside the reference, in its axes (RMS distance of the surfaces {found.distance:.4g} m)",
        f"{'':{_LABEL}}{'this body':>14}{'reference':>14}{'error':>11}",
        *lines,
    ]
