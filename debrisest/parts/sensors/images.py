"""Cameras that give images: one, or a stereo pair, of a textured body in sunlight."""

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.counted import counted
from debrisest.draws import Draws, Stream
from debrisest.roles import NonNegative, Positive, SimulationPart, Vector3
from debrisest.vision.camera import PinholeImage
from debrisest.vision.image_files import read_images
from debrisest.vision.render import SAMPLES, Light, Pose, Renderer, grey_levels
from debrisest.vision.room import Room
from debrisest.vision.solids import Solid
from debrisest.vision.surface import Surface
from debrisest.vision.texture import SolidNoise
from debrisest.vision.videos import write_video

Size = Annotated[int, Field(ge=16, le=8192)]


class Images(SimulationPart):
    """Grey images; the axes of the first camera are the inertial ones, z ahead and y down.

    A second camera looks the same way from a baseline to the right. All images of an epoch are
    exposed at once, about its time.
    """

    needs = (
        "true_vertex_b", "true_triangle", "true_albedo", "true_texture", "true_q_ib",
        "true_rate_b", "true_position",
    )  # fmt: skip
    knows = ("camera_matrix", "lens_distortion", "rig_rotation", "rig_translation")
    measures = ("measured_image",)
    libraries = ("cv2", "embreex")
    runs_together = 20
    kind: Literal["images"]
    width_px: Size = 640
    """Columns."""
    height_px: Size = 480
    """Rows."""
    focal_px: Positive
    """Focal length in pixels; the principal point is the middle."""
    baseline_m: Positive | None = None
    """Distance of the second camera, to the right; without it there is one."""
    distortion: Annotated[list[float], Field(min_length=5, max_length=5)] = [0.0] * 5
    """Coefficients k1, k2, p1, p2, k3 of both lenses, as OpenCV has them."""
    sun: Vector3 = [-0.5, -0.6, -0.6]
    """Direction towards the sun, camera axes."""
    ambient: Annotated[float, Field(ge=0, le=1)] = 0.12
    """Share of the light that comes from everywhere."""
    noise_grey: NonNegative = 1.5
    """Standard deviation of a pixel, of 256 grey levels."""
    blur_px: NonNegative = 0.5
    """Sigma of the lens."""
    exposure_s: NonNegative = 0.0
    """Exposure about the time of the image, in which the body turns."""
    background: Literal["black", "room"] = "black"
    """What is behind the body: nothing, or patterned walls that do not turn."""
    room_m: Positive = 60.0
    """Half a side of the room about the first camera."""

    video: bool = False
    """Let the images pass through a compressed video file."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return images (run, time, camera, row, column) and what is known of the cameras."""
        cameras = self._cameras()
        runs = [list(self._renderers(data, run, cameras)) for run in range(len(draws.runs))]
        frames = [
            self._frame(data, runs, cameras, epoch, draws)
            for epoch in counted(range(len(clock.times)), "images rendered")
        ]
        known = {
            "camera_matrix": [camera.matrix for camera in cameras],
            "lens_distortion": [camera.distortion for camera in cameras],
            "rig_rotation": [camera.rotation for camera in cameras],
            "rig_translation": [camera.translation for camera in cameras],
        }
        each = {name: np.array([values] * len(runs)) for name, values in known.items()}
        images = np.stack(frames, axis=1)
        return each | {"measured_image": _through_video(images) if self.video else images}

    def _cameras(self) -> list[PinholeImage]:
        centre = 0.5 * (self.width_px - 1), 0.5 * (self.height_px - 1)
        matrix = np.array([[self.focal_px, 0, centre[0]], [0, self.focal_px, centre[1]], [0, 0, 1]])
        one = PinholeImage((self.width_px, self.height_px), matrix, np.array(self.distortion))
        if self.baseline_m is None:
            return [one]
        return [one, one._replace(translation=np.array([-self.baseline_m, 0.0, 0.0]))]

    def _renderers(self, data: Data, run: int, cameras: list[PinholeImage]) -> Iterator[Renderer]:
        grain, seed = data["true_texture"][run]
        solid = Solid(
            data["true_vertex_b"][run],
            data["true_triangle"][run].astype(int),
            data["true_albedo"][run],
        )
        surface = Surface(solid, SolidNoise(int(seed), float(grain)))
        light = Light(np.array(self.sun) / np.linalg.norm(self.sun), self.ambient)
        walls = SolidNoise(int(seed) + 1, self.room_m / 10)
        room = Room(self.room_m, walls) if self.background == "room" else None
        for camera in cameras:
            yield Renderer(camera, surface, light, room)

    def _frame(
        self, data: Data, runs: Any, cameras: list[PinholeImage], epoch: int, draws: Draws
    ) -> Array:
        """Return the images (run, camera, row, column) of an epoch."""
        shape = (len(cameras), self.height_px, self.width_px)
        noise = self.noise_grey * draws.normal(Stream.MEASUREMENT_NOISE, shape)
        exact = [
            [renderer.image(self._pose(data, run, epoch), self.blur_px) for renderer in renderers]
            for run, renderers in enumerate(runs)
        ]
        return grey_levels(np.array(exact), noise)

    def _pose(self, data: Data, run: int, epoch: int) -> Pose:
        """Return where the body is while the samples of a pixel are exposed."""
        count = len(SAMPLES)
        when = self.exposure_s * ((np.arange(count) + 0.5) / count - 0.5)
        turn = quaternion.exp(when[:, None] * data["true_rate_b"][run, epoch])
        q = quaternion.multiply(data["true_q_ib"][run, epoch], turn)
        return Pose(q, np.broadcast_to(data["true_position"][run, epoch], (count, 3)))


def _through_video(images: Any) -> Any:
    """Return images (run, time, camera, row, column) as they come back from MP4 files."""
    shown = np.empty_like(images)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "video.mp4"
        for run, camera in np.ndindex(images.shape[0], images.shape[2]):
            write_video(path, images[run, :, camera], 25.0)
            shown[run, :, camera] = read_images(path).frames[:, 0]
    return shown
