"""What a file is, from its header or structure."""

from enum import Enum
from pathlib import Path

from debrisest.errors import UserError
from debrisest.tracks.colmap_files import FILES
from debrisest.tracks.rates import COLUMNS
from debrisest.tracks.rows import POINT
from debrisest.tracks.sheet import Sheet, open_sheet
from debrisest.tracks.text import read_text
from debrisest.tracks.wide import is_wide


class Kind(Enum):
    """Accepted kinds of measurements, in words."""

    LONG = "tracks, a row for each feature: time_s,feature with x_m,y_m,z_m, u_px,v_px or range_m"
    WIDE = "tracks, a row for each time: time_s,p1_x_m,p1_y_m,p1_z_m,p2_x_m,..."
    POSES = "poses: time_s,q0,q1,q2,q3 with x_m,y_m,z_m and sigma_deg if known"
    RATES = "rates in body axes: time_s,rate_x_deg_s,rate_y_deg_s,rate_z_deg_s (or rad_s)"
    POSE_LIST = "poses in JSON: a list of filename, q_vbs2tango, r_Vo2To_vbs"
    COLMAP = f"a folder with a COLMAP text model: {', '.join(FILES)}"


def recognise(path: Path) -> tuple[Kind, Sheet | None]:
    """Return what a file or folder is, with its cells if it is a table.

    Raises `UserError` with all that is accepted, if it is none of these.
    """
    if path.is_dir():
        if any((path / name).exists() for name in (*FILES, "images.bin")):
            return Kind.COLMAP, None
        raise UserError(_accepted(f"{path}: this folder holds no COLMAP text model"))
    if read_text(path).lstrip()[:1] in "[{":
        return Kind.POSE_LIST, None
    sheet = open_sheet(path)
    if set(sheet.names) == {"feature", *POINT}:
        message = "no time_s: points in body axes are the known geometry, not tracks"
        raise UserError(f"{path}:{sheet.line}: {message}; or name the column of times time_s")
    return _table(sheet), sheet


def _table(sheet: Sheet) -> Kind:
    names = {name.lower() for name in sheet.names}
    if names & {"feature", "features", "point", "u_px", "camera"}:
        return Kind.LONG
    if len(names & {"q0", "q1", "q2", "q3", "qw", "qx", "qy", "qz", "q_w", "q_x", "sigma_deg"}) > 1:
        return Kind.POSES
    if len(names & COLUMNS) > 1:
        return Kind.RATES
    if is_wide(sheet.names):
        return Kind.WIDE
    header = ", ".join(sheet.names)[:100]
    raise UserError(_accepted(f"{sheet.source}:{sheet.line}: not known from its header {header!r}"))


def _accepted(said: str) -> str:
    return "; accepted are\n  ".join([said, "\n  ".join(kind.value for kind in Kind)])
