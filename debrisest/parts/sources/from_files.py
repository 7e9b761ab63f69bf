"""What sources of a single measured experiment share: files, times, the chaser's attitude."""

from collections.abc import Iterable
from hashlib import sha256
from pathlib import Path

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.errors import UserError
from debrisest.files import content
from debrisest.parts.sources.epochs import on_epochs, with_gaps
from debrisest.roles import Positive, SourcePart
from debrisest.tracks.attitude import attitude_at, read_attitude
from debrisest.tracks.colmap import ColmapModel
from debrisest.tracks.frames import read_times
from debrisest.tracks.read import read_measured
from debrisest.tracks.sheet import open_sheet
from debrisest.tracks.types import Poses, Rates, Tracks
from debrisest.vocabulary import VOCABULARY

_INERTIAL = "no attitude of the chaser is given: the axes measured in are taken for inertial ones"


class FromFile(SourcePart):
    """One run from text files; the paths count from the scenario's folder."""

    file: str
    """What was measured, from the scenario's folder."""

    @property
    def files(self) -> list[str]:
        """Return all files, and folders of files, that this very part reads."""
        return [self.file]

    def digest(self, folder: Path) -> str:
        """Return the SHA-256 of all files."""
        return sha256(
            b"".join(map(_checksum, _each(folder / name for name in self.files)))
        ).hexdigest()


class FromFiles(FromFile):
    """What is measured by a chaser, whose attitude may be given."""

    attitude: str | None = None
    """The chaser's attitude, `time_s,q0,q1,q2,q3`; without it the axes measured in are taken for
    inertial ones."""
    rate_hz: Positive | None = None
    """Frame rate of images that have no times."""
    image_times: str | None = None
    """Times of images that have none, CSV with `filename,time_s`."""

    @property
    def files(self) -> list[str]:
        """Return all files, and folders of files, that this very part reads."""
        return [name for name in (self.file, self.attitude, self.image_times) if name]

    def measured(self, folder: Path) -> Tracks | Poses | ColmapModel:
        """Return what the file holds, as the readers know it."""
        times = read_times(open_sheet(folder / self.image_times)) if self.image_times else None
        found = read_measured(folder / self.file, self.rate_hz, times)
        if isinstance(found, Rates):
            raise UserError(f"{found.source}: this file holds rates; use kind: rates")
        return found

    def attitude_of_chaser(
        self, folder: Path, times: Array
    ) -> tuple[Array | None, tuple[str, ...]]:
        """Return ``q_ic (time, 4)``, None where it is not given, and what is to be noted."""
        if self.attitude is None:
            return None, (_INERTIAL,)
        poses = read_attitude(open_sheet(folder / self.attitude))
        return attitude_at(poses, times), poses.notes


def one_run(source: str, times: Array, data: Data, notes: Iterable[str]) -> Data:
    """Return datasets (time, ...) and others as those of run 0, times since the first epoch.

    Raises `UserError` for a single epoch.
    """
    if len(times) < 2:
        raise UserError(f"{source}: one epoch; a motion needs at least two")
    told, epochs = list(dict.fromkeys(notes)), with_gaps(times)
    if added := len(epochs) - len(times):
        told.append(f"{added} epochs of the even grid have no row: nothing was seen then")
    if times[0] != 0.0:
        told.append(f"times count from the first epoch, {times[0]:.9g} s")
    shared: Data = {"run": np.zeros(1), "time_s": epochs - times[0]}
    shared |= {"notes": np.array(told)} if told else {}
    for name, value in data.items():
        timed = "time_s" in VOCABULARY[name].axes
        shared[name] = (on_epochs(value, times, epochs) if timed else value)[None]
    return shared


def _each(paths: Iterable[Path]) -> Iterable[Path]:
    for path in paths:
        yield from sorted(path.glob("*.txt")) if path.is_dir() else [path]


def _checksum(path: Path) -> bytes:
    return sha256(content(path)).digest()
