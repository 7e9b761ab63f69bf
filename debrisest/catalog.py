"""The one place where a ``kind`` in a scenario becomes code.

A new motion, sensor, problem or filter is a new file and a new line here.
"""

from typing import get_args

from debrisest.parts.filters.association import (
    AssociationFilter,
    JointAssociation,
    KnownAssociation,
)
from debrisest.parts.filters.batch import Batch
from debrisest.parts.filters.bound import Efficient, LandmarkBound, LinearisedAtTruth
from debrisest.parts.filters.kalman import Extended, Unscented
from debrisest.parts.filters.landmarks import LandmarkBatch, LandmarkFilter
from debrisest.parts.filters.replay import Replay
from debrisest.parts.filters.surface import Surface
from debrisest.parts.recoveries.basis_pursuit import BasisPursuit
from debrisest.parts.recoveries.direction_cosines import DirectionCosines
from debrisest.parts.recoveries.line_spectrum import LineSpectrumRecovery
from debrisest.parts.recoveries.pixel_pose import PixelPose
from debrisest.parts.recoveries.structure import StructureFromMotion
from debrisest.parts.recoveries.triangulation import Triangulation
from debrisest.parts.sensors.angular_acceleration import AngularAcceleration
from debrisest.parts.sensors.attitude_knowledge import AttitudeKnowledge
from debrisest.parts.sensors.attitude_sensor import AttitudeSensor
from debrisest.parts.sensors.camera_range import CameraRange
from debrisest.parts.sensors.detections import Detections
from debrisest.parts.sensors.feature_points import FeaturePoints
from debrisest.parts.sensors.images import Images
from debrisest.parts.sensors.pinhole_camera import PinholeCamera
from debrisest.parts.sensors.pointing_control import PointingControl
from debrisest.parts.sensors.stereo_camera import StereoCamera
from debrisest.parts.sources.datasets import Datasets
from debrisest.parts.sources.image_files import MeasuredImages
from debrisest.parts.sources.poses import MeasuredPoses
from debrisest.parts.sources.rates import MeasuredRates
from debrisest.parts.sources.tracks import MeasuredTracks
from debrisest.parts.starts.drawn_orbit import DrawnOrbit
from debrisest.parts.starts.drawn_pose import DrawnPose
from debrisest.parts.starts.drawn_shape import DrawnShape
from debrisest.parts.starts.first_image import FirstImage
from debrisest.parts.starts.first_points import FirstPoints
from debrisest.parts.starts.first_samples import FirstSamples
from debrisest.parts.starts.given import GivenGuess
from debrisest.parts.starts.guess import Guess
from debrisest.parts.truth.closed_ellipse import ClosedEllipse
from debrisest.parts.truth.drift import Drift
from debrisest.parts.truth.gravity_gradient import GravityGradient
from debrisest.parts.truth.hold import Hold
from debrisest.parts.truth.kepler_orbit import KeplerOrbit
from debrisest.parts.truth.perturbed_orbit import PerturbedOrbit
from debrisest.parts.truth.random_box import RandomBox
from debrisest.parts.truth.random_points import RandomPoints
from debrisest.parts.truth.random_rigid_body import RandomRigidBody
from debrisest.parts.truth.random_torque_free import RandomTorqueFree
from debrisest.parts.truth.random_tumble import RandomTumble
from debrisest.parts.truth.relative_orbit import RelativeOrbit
from debrisest.parts.truth.rigid_points import RigidPoints
from debrisest.parts.truth.satellite import Satellite
from debrisest.parts.truth.seen_from_leader import SeenFromLeader
from debrisest.parts.truth.still import Still
from debrisest.parts.truth.textured_body import TexturedBody
from debrisest.parts.truth.torque_free import TorqueFree
from debrisest.problems.camera_range.minimal import CameraRangeMinimal
from debrisest.problems.camera_range.redundant import CameraRangeRedundant
from debrisest.problems.orbit_from_pixels.problem import OrbitFromPixels
from debrisest.problems.shape.problem import ConstantDensityShape
from debrisest.problems.stereo_pose.problem import StereoPose, StereoPoseAdditive
from debrisest.problems.tumbling.attitude import TumblingAttitude
from debrisest.problems.tumbling.motion import TumblingMotion
from debrisest.problems.tumbling.points import TumblingPoints
from debrisest.roles import Part


def kind_of(part: type[Part]) -> str:
    """Return the name that a scenario gives a part."""
    return str(get_args(part.model_fields["kind"].annotation)[0])


def required_keys(kind: str) -> set[str]:
    """Return the keys that a scenario must give to the parts of a kind; none if there is none."""
    parts = [part for parts in CATALOG.values() for part in parts if kind_of(part) == kind]
    keys = (part.model_fields.items() for part in parts)
    return {name for fields in keys for name, field in fields if field.is_required()} - {"kind"}


CATALOG: dict[str, list[type[Part]]] = {
    "target": [RigidPoints, RandomPoints, RandomBox, RandomRigidBody, TexturedBody],
    "orbit": [KeplerOrbit, PerturbedOrbit],
    "motion": [TorqueFree, GravityGradient, SeenFromLeader, RandomTumble, RandomTorqueFree],
    "observers": [Hold, Drift, Satellite, ClosedEllipse, RelativeOrbit, Still],
    "sensors": [
        FeaturePoints,
        StereoCamera,
        AngularAcceleration,
        PinholeCamera,
        PointingControl,
        AttitudeKnowledge,
        AttitudeSensor,
        Detections,
        CameraRange,
        Images,
    ],
    "measured": [Datasets, MeasuredTracks, MeasuredPoses, MeasuredRates, MeasuredImages],
    "starts": [DrawnPose, DrawnOrbit, DrawnShape, GivenGuess],
    "recovery": [
        BasisPursuit,
        DirectionCosines,
        LineSpectrumRecovery,
        PixelPose,
        Triangulation,
        StructureFromMotion,
    ],
    "problem": [
        TumblingAttitude,
        TumblingPoints,
        TumblingMotion,
        StereoPoseAdditive,
        StereoPose,
        CameraRangeRedundant,
        CameraRangeMinimal,
        OrbitFromPixels,
        ConstantDensityShape,
    ],
    "start": [FirstSamples, FirstPoints, Guess, FirstImage],
    "filter": [
        Batch,
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
        Surface,
    ],
}
