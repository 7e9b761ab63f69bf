"""The libraries of the extra ``vision``, without which everything else works."""

from importlib import import_module
from typing import Any

from debrisest.errors import UserError

_PACKAGES = {"cv2": "opencv-python-headless", "embreex": "embreex", "pycolmap": "pycolmap"}


def vision_library(module: str) -> Any:
    """Return a library, or raise UserError with what to install."""
    try:
        return import_module(module)
    except ImportError:
        package = _PACKAGES.get(module.partition(".")[0], module)
        raise UserError(
            f"images need {package}, which is not installed: pip install 'debrisest[vision]'"
        ) from None
