"""What calibrated cameras see, without lens and focal length."""

from dataclasses import replace

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.errors import UserError
from debrisest.sensors.distortion import COEFFICIENTS, undistorted
from debrisest.tracks.types import Camera, Rig, Tracks


def views(tracks: Tracks, rig: Rig, noise_px: float | None) -> tuple[Data, tuple[str, ...]]:
    """Return slopes as pixels of focal length 1, their noise, the rig, and what is to be noted.

    Noise that is not given is NaN. Raises `UserError` for cameras or lenses that are not known.
    """
    assert tracks.pixels is not None
    rig, notes = _in_order(tracks, rig)
    pairs = zip(rig.cameras, np.moveaxis(tracks.pixels, 1, 0))
    pixels = np.stack([_slopes(camera, pixel) for camera, pixel in pairs], axis=1)
    lost = int((np.isnan(pixels) & ~np.isnan(tracks.pixels)).any(axis=-1).sum())
    if lost:
        notes += (f"{lost} pixels left out: outside of what the calibrated lens can show",)
    if noise_px is None:
        notes += ("no noise of pixels is given: it is taken from the residuals",)
    focal = np.sqrt(np.mean([camera.focal_px[0] * camera.focal_px[1] for camera in rig.cameras]))
    return {
        "measured_pixel": pixels,
        "focal_px": np.array(1.0),
        "pixel_noise": np.array(np.nan if noise_px is None else noise_px / focal),
        "rig_rotation": rig.rotation,
        "rig_translation": rig.translation,
    }, (*rig.notes, *notes)


def _in_order(tracks: Tracks, rig: Rig) -> tuple[Rig, tuple[str, ...]]:
    """Return the cameras of the tracks in their order: by name, else by their number."""
    names, shown = [camera.name for camera in rig.cameras], tracks.cameras
    if len(shown) > len(names):
        said = f"pixels of {len(shown)} cameras, {', '.join(shown)}"
        raise UserError(f"{tracks.source}: {said}; the calibration has {', '.join(names)}")
    if set(shown) <= set(names):
        return _chosen(rig, [names.index(name) for name in shown]), ()
    chosen = _chosen(rig, list(range(len(shown))))
    if len(names) == 1:
        return chosen, ()
    taken = f"{', '.join(shown)} are taken for {', '.join(names[: len(shown)])}"
    return chosen, (f"cameras {taken} of the calibration; name them so if the order is another",)


def _chosen(rig: Rig, index: list[int]) -> Rig:
    cameras = tuple(rig.cameras[number] for number in index)
    return replace(
        rig, cameras=cameras, rotation=rig.rotation[index], translation=rig.translation[index]
    )


def _slopes(camera: Camera, pixels: Array) -> Array:
    if any(camera.distortion[COEFFICIENTS:]):
        raise UserError(
            f"camera {camera.name}: a lens with more than {COEFFICIENTS} distortion coefficients; "
            "give k1, k2, p1, p2, k3 of a plain calibration, or undistort the pixels and leave out "
            "the distortion"
        )
    shown = (pixels - np.array(camera.centre_px)) / np.array(camera.focal_px)
    return undistorted(shown, camera.distortion[:COEFFICIENTS])
