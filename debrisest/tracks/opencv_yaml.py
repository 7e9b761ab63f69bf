"""YAML as OpenCV's ``cv::FileStorage`` writes it, matrices included, and plain YAML alike."""

from pathlib import Path
from typing import Any

import numpy as np
import yaml

from debrisest.errors import UserError
from debrisest.tracks.text import read_text


class _Loader(yaml.SafeLoader):
    """YAML with OpenCV's matrices, in which a key is there once."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """Return a mapping; a key that is there twice is an error at its second place."""
        seen = set()
        for key, _ in node.value:
            if key.value in seen:
                problem = f"key {key.value} is there twice; keep one"
                raise yaml.MarkedYAMLError(problem=problem, problem_mark=key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep)


def _matrix(loader: yaml.SafeLoader, node: Any) -> Any:
    held = loader.construct_mapping(node, deep=True)
    try:
        shape = (int(held["rows"]), int(held["cols"]))
        return np.array(held["data"], dtype=float).reshape(shape)
    except (KeyError, TypeError, ValueError):
        message = "a matrix needs rows, cols and as many numbers in data"
        raise yaml.MarkedYAMLError(problem=message, problem_mark=node.start_mark) from None


_Loader.add_constructor("tag:yaml.org,2002:opencv-matrix", _matrix)


def load_mapping(path: Path) -> dict[str, Any]:
    """Return the keys of a YAML file; OpenCV's matrices are arrays. Raises `UserError`."""
    text = read_text(path)
    if text.startswith("%YAML:"):
        text = "#" + text  # OpenCV's own form of the directive
    try:
        value = yaml.load(text, _Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f"{path}:{mark.line + 1}:{mark.column + 1}" if mark else str(path)
        raise UserError(f"{place}: not a calibration: {error.problem}") from None
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise UserError(f"{path}: not a calibration: {str(error).splitlines()[0]}") from None
    if not isinstance(value, dict):
        raise UserError(f"{path}: expected keys such as fx_px, fy_px, or OpenCV's YAML")
    return {str(key): item for key, item in value.items()}
