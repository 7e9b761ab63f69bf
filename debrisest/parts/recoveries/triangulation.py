"""Points from the pixels of two or more cameras, whatever the body is."""

from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.outcome import Outcome, sentences
from debrisest.parts.recoveries.rig import NEEDS, slope_variance, slopes, to_inertial
from debrisest.recovery.triangulation import Triangulated, triangulate
from debrisest.roles import RecoveryPart


class PointStatus(Outcome):
    """Of what the pixels tell; `sentence` tells the user."""

    EVERY = 0, "every point that two cameras see has its place"
    SOME = 1, "some points are left out: their lines of sight do not meet before the cameras"


class Triangulation(RecoveryPart):
    """Points relative to the chaser, in inertial axes, with the noise of each coordinate."""

    needs = NEEDS
    gives = ("measured_point", "point_sigma")
    kind: Literal["triangulation"]

    def recover(self, data: Data, clock: Clock) -> Data:
        """Return points (run, time, feature, 3) and their sigma; NaN where one camera sees one."""
        shown = slopes(data)
        if shown.shape[2] < 2:
            raise ValueError("one camera does not tell how far points are; two or more are needed")
        rigs = zip(data["rig_rotation"], data["rig_translation"], shown)
        found = Triangulated(*map(np.stack, zip(*(triangulate(*rig) for rig in rigs))))
        if np.isnan(found.point).all():
            raise ValueError(
                "no point has a place: no two cameras see one, or their lines of sight do not meet "
                "ahead; are the cameras exchanged?"
            )
        turn = to_inertial(data)[:, :, None]
        variance = slope_variance(data, found.chi2, found.dof)[:, None, None, None, None]
        covariance = turn @ (variance * found.cofactor) @ np.swapaxes(turn, -1, -2)
        twice = np.isfinite(shown).all(axis=-1).sum(axis=2) >= 2
        lost = (twice & np.isnan(found.point[..., 0])).any(axis=(-2, -1))
        return {
            "measured_point": (turn @ found.point[..., None])[..., 0],
            "point_sigma": np.sqrt(np.diagonal(covariance, 0, -2, -1)),
            "status": sentences(np.where(lost, PointStatus.SOME, PointStatus.EVERY), PointStatus),
        }

    def assess(self, data: Data) -> Data:
        """Return the share of epochs with three points, from which an attitude follows."""
        points = np.isfinite(data["measured_point"][..., 0]).sum(axis=-1)
        return {"coverage": (points >= 3).mean(axis=-1)}
