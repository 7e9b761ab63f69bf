"""A scenario for a user's own images, with the files that lie beside them and go with them."""

from pathlib import Path
from typing import Any

from debrisest.cli.estimate import relative_to

CALIBRATION = "calibration.yaml"
PLACES = "*_par.txt"
_MASKS = ("masks", "mask", "silhouettes", "silhouette")
MOST = 75
"""Images that are taken where nothing else is said: more cost hours and tell little more."""


def thinned(images: Path) -> int:
    """Return of how many images one is to be taken, and say it where it is not each."""
    from debrisest.vision.image_files import count_images

    count = count_images(images)
    every = -(-count // MOST)
    if every > 1:
        print(f"note: one of {every} of the {count} images is taken; --every 1 takes them all")
    return max(every, 1)


def masks_of(images: Path) -> Path | None:
    """Return where masks of images are, and say it; None where there are none."""
    from debrisest.vision.image_files import count_images
    from debrisest.vision.image_names import has_masks

    if not images.is_dir():
        return None
    places = [place / name for place in (images, images.parent) for name in _MASKS]
    there = [place for place in places if place.is_dir() and place.resolve() != images.resolve()]
    alike = [place for place in there if count_images(place) == count_images(images)]
    found = images if has_masks(images) else next(iter(alike), None)
    if found is not None:
        print(f"note: the masks in {found} tell the body from what is behind it")
    elif there:
        print(f"note: {there[0]} has not a mask for each image, and is not taken")
    return found


def scenario_of(
    images: Path,
    camera: Path | None,
    keys: dict[str, Any],
    problem: dict[str, Any],
    folder: Path,
    no_support: bool,
) -> str:
    """Return a scenario for ``folder`` as YAML."""
    import yaml

    from debrisest.errors import UserError

    if not images.exists():
        raise UserError(f"{images}: no such folder or file")
    there = [place / CALIBRATION for place in (images, images.parent)]
    there += sorted(images.glob(PLACES))
    calibration = camera or next((path for path in there if path.is_file()), None)
    measured = {"kind": "image_files", "folder": relative_to(folder, str(images))}
    measured |= {key: value for key, value in keys.items() if value is not None}
    if calibration is not None:
        measured["camera"] = relative_to(folder, str(calibration))
    surface = {"kind": "surface", "outline": "either"}
    scenario = {
        "title": f"Shape of the body in {images.name}",
        "measured": measured,
        "estimators": {
            "shape": {
                "recovery": {"kind": "structure_from_motion", "leave_out": "still_features"},
                "problem": {"kind": "constant_density_shape", **problem},
                "filter": surface | ({"support": "none"} if no_support else {}),
            }
        },
    }
    return yaml.safe_dump(scenario, sort_keys=False, allow_unicode=True)
