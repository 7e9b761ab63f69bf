"""Tracked features beside the known geometry: by their names, in the geometry's order."""

import difflib
from collections.abc import Iterable
from dataclasses import replace

from debrisest.errors import UserError
from debrisest.tracks.types import BodyPoints, Tracks


def match_geometry(tracks: Tracks, body: BodyPoints) -> tuple[Tracks, BodyPoints]:
    """Return both with the features that they share; what is left out is noted in the tracks.

    Raises `UserError` where no name is in both.
    """
    shared = [name for name in body.features if name in tracks.features]
    strange = [name for name in tracks.features if name not in shared]
    if not shared:
        said = f"none of its features, {_listed(strange)}, is in {body.source}"
        raise UserError(f"{tracks.source}: {said}, which has {_listed(body.features)}"
                        f"{_meant(strange, body.features)}")  # fmt: skip
    notes = []
    if strange:
        meant = _meant(strange, [name for name in body.features if name not in shared])
        notes.append(f"left out, since {body.source} lacks them: {_listed(strange)}{meant}")
    if unseen := [name for name in body.features if name not in shared]:
        notes.append(f"never seen of {body.source}: {_listed(unseen)}")
    known = [body.features.index(name) for name in shared]
    kept = replace(body, features=tuple(shared), points=body.points[known])
    return _of_features(tracks, tuple(shared), tuple(notes)), kept


def _of_features(tracks: Tracks, names: tuple[str, ...], notes: tuple[str, ...]) -> Tracks:
    index = [tracks.features.index(name) for name in names]
    ranges = tracks.ranges
    return replace(
        tracks,
        features=names,
        points=None if tracks.points is None else tracks.points[:, index],
        point_sigma=None if tracks.point_sigma is None else tracks.point_sigma[:, index],
        pixels=None if tracks.pixels is None else tracks.pixels[:, :, index],
        ranges=ranges if ranges is None or ranges.ndim == 1 else ranges[:, index],
        notes=tracks.notes + notes,
    )


def _listed(names: Iterable[str]) -> str:
    every = list(names)
    more = f" and {len(every) - 20} more" if len(every) > 20 else ""
    return ", ".join(every[:20]) + more


def _meant(names: Iterable[str], known: Iterable[str]) -> str:
    pairs = ((name, difflib.get_close_matches(name, list(known), n=1)) for name in names)
    close = [f"{near[0]} for {name}" for name, near in pairs if near]
    return f" (did you mean {', '.join(close[:5])}?)" if close else ""
