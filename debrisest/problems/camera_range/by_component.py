"""Errors by component, the size of the first ones, and when these have shrunk for good."""

from debrisest.arrays import Array, Data
from debrisest.assessment.convergence import convergence_time

_VECTORS = {
    "position": "position",
    "velocity": "velocity",
    "rate": "rate_b",
    "attitude": "attitude",
    "first_point": "first_point",
    "first_point_c": "first_point_c",
}
_ELEMENTS = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
_SHRUNK = 0.1  # of the first error: an order of magnitude


def by_component(errors: Data) -> Data:
    """Return the components (run, time) of the vectors and of the tensor that errors hold."""
    result = {
        f"{shown}_{axis + 1}": errors[f"{name}_error"][..., axis]
        for name, shown in _VECTORS.items()
        if f"{name}_error" in errors
        for axis in range(3)
    }
    if "inertia_error" in errors:
        result |= {
            f"tensor_{name}": errors["inertia_error"][..., row, column]
            for name, (row, column) in _ELEMENTS.items()
        }
    return result


def of_first_guess(guess: Data, errors: Data, times: Array) -> Data:
    """Return the sizes (run,) of the first errors, and from when those of position and velocity
    stay below a tenth of that, s; the end of the time span if they never do."""
    result = {f"guess_{name}": error for name, error in guess.items()}
    for name in ("position", "velocity"):
        part = errors[name] / guess[name][:, None]
        result[f"{name}_convergence"] = convergence_time(_SHRUNK, part, times)
    return result
