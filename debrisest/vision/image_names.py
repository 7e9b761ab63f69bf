"""Which images a folder holds, in the order of the numbers in their names; masks among them."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from debrisest.errors import UserError

SUFFIXES = (
    ".png",
    ".jpg",
    ".jpeg",
    ".tif",
    ".tiff",
    ".bmp",
    ".pgm",
    ".ppm",
    ".pnm",
    ".pbm",
    ".webp",
)
_RAW = (".heic", ".heif", ".dng", ".cr2", ".cr3", ".nef", ".arw", ".raf", ".orf", ".rw2")
TIMES = "times.csv"
_MASK = "mask"
"""How the names of masks end that lie among the images."""


def has_masks(folder: Path) -> bool:
    """Return whether names of images in a folder end in ``mask``, while others do not."""
    names = [one for one in folder.iterdir() if one.suffix.lower() in SUFFIXES]
    return 0 < sum(map(_is_mask, names)) < len(names)


def names_in(folder: Path, masks: bool = False) -> list[str]:
    """Return the names of the images in a folder, in the order of the numbers in them.

    Masks among them are left out, or chosen.
    """
    there = [one for one in folder.iterdir() if one.suffix.lower() in SUFFIXES]
    if has_masks(folder):
        there = [one for one in there if _is_mask(one) == masks]
    found = sorted((one.name for one in there if not one.name.startswith(".")), key=in_order)
    if not found:
        raise UserError(f"{folder}: {_nothing(folder)} ({', '.join(SUFFIXES)})")
    return found


def in_order(name: str) -> tuple[list[tuple[int, str]], str]:
    """Return a key by which names stand in the order of their numbers: 2 before 10."""
    parts = re.findall(r"[0-9]+|[^0-9]+", name)
    return [(int(part), "") if part[0] in "0123456789" else (-1, part) for part in parts], name


def check_numbers(folder: Path, names: Sequence[str]) -> None:
    """Raise UserError where frames that are numbered throughout have a gap."""
    digits = ["".join(filter(str.isdigit, Path(name).stem)) for name in names]
    if not all(digits):
        return
    numbers = sorted(map(int, digits))
    steps = np.diff(numbers)
    if len(steps) > 1 and (steps != steps[0]).any() and np.median(steps) == 1:
        first = numbers[int(np.argmax(steps != 1))] + 1
        if not (folder.parent / TIMES).exists() and not (folder / TIMES).exists():
            raise UserError(
                f"{folder}: frame {first} is missing; put it there, or give each frame's time in "
                f"{TIMES} (frame,time_s)"
            )


def _is_mask(path: Path) -> bool:
    return path.stem.lower().endswith(_MASK)


def _nothing(folder: Path) -> str:
    """Return in words why there is no image to read."""
    raw = sum(one.suffix.lower() in _RAW for one in folder.iterdir())
    if raw:
        return f"{raw} as cameras and phones keep images; export them to a kind that is read"
    inside = next((one for one in folder.iterdir() if one.is_dir() and _has_images(one)), None)
    return "no images there" if inside is None else f"no images there; are those in {inside} meant?"


def _has_images(folder: Path) -> bool:
    return any(one.suffix.lower() in SUFFIXES for one in folder.iterdir())
