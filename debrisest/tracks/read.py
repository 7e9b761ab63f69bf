"""One call for any file of measurements."""

from pathlib import Path

from debrisest.tracks.colmap import ColmapModel, read_colmap
from debrisest.tracks.frames import Times
from debrisest.tracks.points import read_long
from debrisest.tracks.pose_lists import read_pose_list
from debrisest.tracks.poses import read_poses
from debrisest.tracks.rates import read_rates
from debrisest.tracks.recognise import Kind, recognise
from debrisest.tracks.types import Poses, Rates, Tracks
from debrisest.tracks.wide import read_wide


def read_measured(
    path: Path, rate_hz: float | None = None, times: Times | None = None
) -> Tracks | Poses | Rates | ColmapModel:
    """Read tracks, poses or rates of any format; images need a frame rate, Hz, or times by name.

    Raises `UserError`: every problem with file, line and column, and what to do.
    """
    kind, sheet = recognise(path)
    if kind is Kind.COLMAP:
        return read_colmap(path, rate_hz, times)
    if sheet is None:
        return read_pose_list(path, rate_hz, times)
    if kind is Kind.POSES:
        return read_poses(sheet)
    if kind is Kind.RATES:
        return read_rates(sheet)
    return read_long(sheet) if kind is Kind.LONG else read_wide(sheet)
