"""The one place where a ``kind`` in a scenario becomes code.

A new motion, sensor, problem or filter is a new file and a new line here.
"""

from typing import get_args

from debrisest.parts.association_filters import (
    AssociationFilter,
    JointAssociation,
    KnownAssociation,
    LinearisedAtTruth,
)
from debrisest.parts.camera_range_sensors import CameraRange
from debrisest.parts.detections import Detections
from debrisest.parts.filters import Extended, Unscented
from debrisest.parts.first_image import FirstImage
from debrisest.parts.landmark_filters import LandmarkBatch, LandmarkBound, LandmarkFilter
from debrisest.parts.leader_motion import SeenFromLeader
from debrisest.parts.motions import GravityGradient, TorqueFree
from debrisest.parts.observers import Drift, Hold
from debrisest.parts.orbits import KeplerOrbit, PerturbedOrbit
from debrisest.parts.pointing import PointingControl
from debrisest.parts.random_box import RandomBox
from debrisest.parts.random_target import RandomPoints
from debrisest.parts.random_tumble import RandomTumble
from debrisest.parts.recoveries import BasisPursuit
from debrisest.parts.relative_ellipse import ClosedEllipse
from debrisest.parts.replay_filters import Efficient, Replay
from debrisest.parts.satellites import Satellite
from debrisest.parts.sensors import FeaturePoints
from debrisest.parts.shape_guess import Guessed, ShapeGuess
from debrisest.parts.starts import Drawn, FirstPoints, FirstSamples
from debrisest.parts.stereo_sensors import AngularAcceleration, FirstGuess, StereoCamera
from debrisest.parts.targets import RigidPoints
from debrisest.parts.tracking_sensors import AttitudeKnowledge, OrbitGuess, PinholeCamera
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
    "recovery": [BasisPursuit],
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
