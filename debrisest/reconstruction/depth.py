"""Distances at the pixels of an image from a second one, by semi-global matching, refined.

Source: Hirschmueller 2008; `subpixel` does the last half pixel. Two cameras of a rig, or one camera
at two times, between which the body has turned, are treated alike: both images are turned about
their cameras until corresponding points lie in the same row, and cut to the body.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array, BoolArray
from debrisest.counted import counted
from debrisest.reconstruction.silhouettes import Frames
from debrisest.reconstruction.structure import Rig, Structure
from debrisest.reconstruction.subpixel import refined
from debrisest.vision.libraries import vision_library

_BLOCK = 5
_MARGIN_PX = 16
_WIDEST, _USUAL, _NARROWEST = np.radians([25.0, 8.0, 2.0])
"""Between the lines of sight of two times of one camera."""

_LARGEST = 4
"""Times the pixels of an image that a turned one may have."""

Depth = NDArray[np.float32]


class View(NamedTuple):
    """A camera and where it is."""

    matrix: Array
    """Camera matrix (3, 3), px."""
    rotation: Array
    """Axes r of the structure to those of the camera (3, 3)."""
    translation: Array
    """Origin of r in the camera's axes (3,)."""

    @property
    def position(self) -> Array:
        """Return where the camera is in axes r (3,)."""
        return np.asarray(-self.rotation.T @ self.translation)

    def seen(self, points: Array) -> Array:
        """Return points (..., 3) of axes r in the camera's."""
        return np.asarray(points @ self.rotation.T + self.translation)

    def from_camera(self, points: Array) -> Array:
        """Return points (..., 3) of the camera's axes in axes r."""
        return np.asarray((points - self.translation) @ self.rotation)


class DepthView(NamedTuple):
    """A depth image and from where it was taken."""

    view: View
    depth: Depth
    """Along the line of sight's z (row, column), m; NaN where it is not known."""
    pixel_m: float = np.nan
    """What a pixel of disparity makes, m, at the median depth."""


def depth_views(
    frames: Frames, masks: BoolArray, rig: Rig, structure: Structure
) -> list[DepthView]:
    """Return the depth of pairs of images (time, camera, row, column).

    A pair is that of the first two cameras, or where there is one, of a frame and the next. Of a
    camera that was not calibrated it is that of a frame and the one before too: each shows what is
    hidden from the other. With a known focal length volumes came out 3 to 4 % smaller that way.
    """
    found = []
    for frame, (first, second) in counted(list(_pairs(rig, structure)), "depth images"):
        points = structure.points[structure.seen[frame]]
        one, other = (_view(rig, structure, *each) for each in (first, second))
        pair = _Rectified(one, other, points) if len(points) > 3 else None
        if pair is not None and pair.pixels < _LARGEST * frames[first].size:
            found.append(pair.depth((frames[first], frames[second]), masks[first]))
    return found


_At = tuple[int, int]
"""Frame and camera."""


def _pairs(rig: Rig, structure: Structure) -> Iterator[tuple[int, tuple[_At, _At]]]:
    frames = structure.registered
    if len(rig.matrix) > 1:
        yield from ((int(frame), ((int(frame), 0), (int(frame), 1))) for frame in frames)
        return
    for place, one in enumerate(frames.tolist()):
        turned = structure.rotation[one] @ structure.rotation[frames].swapaxes(1, 2)
        trace = np.trace(turned, axis1=1, axis2=2)
        angle = np.arccos(np.clip((trace - 1.0) / 2.0, -1.0, 1.0))
        good = (angle > _NARROWEST) & (angle < _WIDEST)
        given = structure.lens is None
        sides = (place + 1,) if given else (place - 1, place + 1)
        beside = [near for near in sides if 0 <= near < len(frames) and good[near]]
        if not beside and good.any() and (not given or place + 1 < len(frames)):
            beside = [int(np.where(good, np.abs(angle - _USUAL), np.inf).argmin())]
        yield from ((one, ((one, 0), (int(frames[near]), 0))) for near in beside)


def _view(rig: Rig, structure: Structure, frame: int, camera: int) -> View:
    turn, shift = rig.rotation[camera], rig.translation[camera]
    rotation, translation = structure.rotation[frame], structure.translation[frame]
    return View(rig.matrix[camera], turn @ rotation, turn @ translation + shift)


class _Rectified:
    """Two views turned until corresponding points lie in the same row, cut to the body."""

    def __init__(self, one: View, other: View, points: Array) -> None:
        """``points (point, 3)`` of axes r are the body's that the first view sees."""
        self._cv2: Any = vision_library("cv2")
        baseline = other.position - one.position
        across = one.rotation @ baseline / np.linalg.norm(baseline)
        down = np.cross([0.0, 0.0, 1.0], across)
        turn = np.stack([across, down, np.zeros(3)])
        turn[1] /= np.linalg.norm(down)
        turn[2] = np.cross(turn[0], turn[1])
        focal = one.matrix[0, 0]
        self._one = View(np.eye(3), turn @ one.rotation, turn @ one.translation)
        second = self._one.rotation @ other.rotation.T
        self._other = View(np.eye(3), self._one.rotation, second @ other.translation)
        seen = [view.seen(points) for view in (self._one, self._other)]
        pixels = [focal * each[:, :2] / each[:, 2:] for each in seen]
        low = [np.floor(each.min(axis=0)) - _MARGIN_PX for each in pixels]
        low[1][1] = low[0][1]
        high = np.max([each.max(axis=0) - corner for each, corner in zip(pixels, low)], axis=0)
        self._size = tuple(int(side) for side in np.ceil(high) + _MARGIN_PX)
        self._matrix = [
            np.array([[focal, 0, -corner[0]], [0, focal, -corner[1]], [0, 0, 1]]) for corner in low
        ]
        self._offset = low[0][0] - low[1][0]
        self._span = focal * float(np.linalg.norm(baseline))
        self._distance = float(np.median(seen[0][:, 2]))
        disparity = pixels[0][:, 0] - pixels[1][:, 0] - self._offset
        self._bounds = disparity.min() - _MARGIN_PX, disparity.max() + _MARGIN_PX
        self._maps = [
            self._cv2.initUndistortRectifyMap(
                view.matrix, None, turned, matrix, self._size, self._cv2.CV_32FC1
            )
            for view, turned, matrix in zip((one, other), (turn, second), self._matrix)
        ]

    @property
    def pixels(self) -> int:
        """Return how many pixels the turned images have: too many for points that are misplaced."""
        return self._size[0] * self._size[1]

    def depth(self, pair: tuple[Frames, Frames], mask: BoolArray) -> DepthView:
        """Return the depth from the first view, in the silhouette (row, column)."""
        linear, cubic = self._cv2.INTER_LINEAR, self._cv2.INTER_CUBIC
        one, other = (self._cv2.remap(each, *maps, cubic) for each, maps in zip(pair, self._maps))
        inside = self._cv2.remap(mask.astype(np.uint8) * 255, *self._maps[0], linear) > 127
        found, known = refined(one, other, *self._matched([one, other], inside))
        disparity = np.where(known, found + self._offset, 1.0)
        depth = np.where(known & (disparity > 0), self._span / disparity, np.nan)
        view = self._one._replace(matrix=self._matrix[0])
        return DepthView(view, depth.astype(np.float32), self._distance**2 / self._span)

    def _matched(self, images: list[Frames], inside: BoolArray) -> tuple[Depth, BoolArray]:
        """Return the disparity (row, column), px, to a fraction of a pixel, where it is known."""
        least = int(np.floor(self._bounds[0]))
        count = 16 * int(np.ceil((self._bounds[1] - least) / 16.0))
        edge = [(0, 0), (max(0, least + count), max(0, -least))]
        matcher = self._cv2.StereoSGBM_create(
            minDisparity=least,
            numDisparities=count,
            blockSize=_BLOCK,
            P1=8 * _BLOCK**2,
            P2=32 * _BLOCK**2,
            disp12MaxDiff=1,
            uniquenessRatio=5,
            speckleWindowSize=60,
            speckleRange=2,
        )
        wide = [np.pad(image, edge) for image in images]
        found = matcher.compute(*wide).astype(np.float32) / 16.0
        found = found[:, edge[1][0] : edge[1][0] + inside.shape[1]]
        return found, inside & (found >= least)
