"""The one place where a ``kind`` in a scenario becomes code.

A new motion, sensor, problem or filter is a new file and a new line here.
"""

from typing import get_args

from debrisest.parts.filters.association import (
    AssociationFilter,
    JointAssociation,
    KnownAssociation,
    LinearisedAtTruth,
)
from debrisest.parts.filters.kalman import Extended, Unscented
from debrisest.parts.filters.landmarks import LandmarkBatch, LandmarkBound, LandmarkFilter
from debrisest.parts.filters.replay import Efficient, Replay
from debrisest.parts.recoveries.basis_pursuit import BasisPursuit
from debrisest.parts.recoveries.direction_cosines import DirectionCosines
from debrisest.parts.recoveries.line_spectrum import LineSpectrumRecovery
from debrisest.parts.sensors.camera_range import CameraRange
from debrisest.parts.sensors.detections import Detections
from debrisest.parts.sensors.feature_points import FeaturePoints
from debrisest.parts.sensors.pointing import PointingControl
from debrisest.parts.sensors.stereo_camera import AngularAcceleration, FirstGuess, StereoCamera
from debrisest.parts.sensors.tracking import AttitudeKnowledge, OrbitGuess, PinholeCamera
from debrisest.parts.starts.first_image import FirstImage
from debrisest.parts.starts.shape_guess import Guessed, ShapeGuess
from debrisest.parts.starts.starts import Drawn, FirstPoints, FirstSamples
from debrisest.parts.truth.leader_motion import SeenFromLeader
from debrisest.parts.truth.motions import GravityGradient, TorqueFree
from debrisest.parts.truth.observers import Drift, Hold
from debrisest.parts.truth.orbits import KeplerOrbit, PerturbedOrbit
from debrisest.parts.truth.random_box import RandomBox
from debrisest.parts.truth.random_target import RandomPoints
from debrisest.parts.truth.random_tumble import RandomTumble
from debrisest.parts.truth.relative_ellipse import ClosedEllipse
from debrisest.parts.truth.satellites import Satellite
from debrisest.parts.truth.targets import RigidPoints
from debrisest.problems.camera_range.minimal import CameraRangeMinimal
from debrisest.problems.camera_range.redundant import CameraRangeRedundant
from debrisest.problems.orbit_from_pixels.problem import OrbitFromPixels
from debrisest.problems.stereo_pose.problem import StereoPose, StereoPoseAdditive
from debrisest.problems.tumbling.attitude import TumblingAttitude
from debrisest.problems.tumbling.points import TumblingPoints
from debrisest.roles import Part


def kind_of(part: type[Part]) -> str:
    """Return the name that a scenario gives a part."""
    return str(get_args(part.model_fields["kind"].annotation)[0])


CATALOG: dict[str, list[type[Part]]] = {
    "target": [RigidPoints, RandomPoints, RandomBox],
    "orbit": [KeplerOrbit, PerturbedOrbit],
    "motion": [TorqueFree, GravityGradient, SeenFromLeader, RandomTumble],
    "observers": [Hold, Drift, Satellite, ClosedEllipse],
    "sensors": [
        FeaturePoints,
        StereoCamera,
        AngularAcceleration,
        FirstGuess,
        PinholeCamera,
        PointingControl,
        AttitudeKnowledge,
        Detections,
        OrbitGuess,
        CameraRange,
        ShapeGuess,
    ],
    "recovery": [BasisPursuit, DirectionCosines, LineSpectrumRecovery],
    "problem": [
        TumblingAttitude,
        TumblingPoints,
        StereoPoseAdditive,
        StereoPose,
        CameraRangeRedundant,
        CameraRangeMinimal,
        OrbitFromPixels,
    ],
    "start": [FirstSamples, FirstPoints, Drawn, Guessed, FirstImage],
    "filter": [
        Unscented,
        Extended,
        Replay,
        Efficient,
        AssociationFilter,
        JointAssociation,
        KnownAssociation,
        LinearisedAtTruth,
        LandmarkBatch,
        LandmarkFilter,
        LandmarkBound,
    ],
}
