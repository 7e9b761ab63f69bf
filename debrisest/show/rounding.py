"""Figures with as many digits as their standard deviation leaves."""

import numpy as np

_MOST_PLACES = 9


def rounded(value: float, sigma: float) -> tuple[str, str]:
    """Return a value to the second digit of its standard deviation, and that to two digits.

    Where no sigma is known, or it is zero as of a given value, the value has six digits and the
    second text is empty; both are where the value is not finite.
    """
    if not np.isfinite(value):
        return "", ""
    if not (np.isfinite(sigma) and sigma > 0.0):
        return f"{value:.6g}", ""
    places = 1 - int(np.floor(np.log10(float(f"{sigma:.1e}"))))
    if places > _MOST_PLACES:
        return f"{value:.10g}", f"{sigma:.2g}"
    return tuple(f"{round(x, places):.{max(places, 0)}f}" for x in (value, sigma))  # type: ignore[return-value]


def told(value: float, sigma: float, unit: str = "") -> str:
    """Return both in one text with their unit, ``undefined`` where the value is not finite."""
    figure, spread = rounded(value, sigma)
    text = f"{figure} ± {spread}" if spread else figure or "undefined"
    return f"{text} {unit}".rstrip() if figure else text
