"""The one place where a ``kind`` in a scenario becomes code.

A new motion, sensor, problem or filter is a new file and a new line here.
"""

from typing import get_args

from debrisest.parts.filters import Extended, Unscented
from debrisest.parts.leader_motion import SeenFromLeader
from debrisest.parts.motions import GravityGradient, TorqueFree
from debrisest.parts.observers import Drift, Hold
from debrisest.parts.orbits import KeplerOrbit
from debrisest.parts.random_target import RandomPoints
from debrisest.parts.recoveries import BasisPursuit
from debrisest.parts.replay_filters import Efficient, Replay
from debrisest.parts.sensors import FeaturePoints
from debrisest.parts.starts import Drawn, FirstSamples
from debrisest.parts.stereo_sensors import AngularAcceleration, FirstGuess, StereoCamera
from debrisest.parts.targets import RigidPoints
from debrisest.problems.stereo_pose import StereoPose, StereoPoseAdditive
from debrisest.problems.tumbling_attitude import TumblingAttitude
from debrisest.roles import Part


def kind_of(part: type[Part]) -> str:
    """Return the name that a scenario gives a part."""
    return str(get_args(part.model_fields["kind"].annotation)[0])


CATALOG: dict[str, list[type[Part]]] = {
    "target": [RigidPoints, RandomPoints],
    "orbit": [KeplerOrbit],
    "motion": [TorqueFree, GravityGradient, SeenFromLeader],
    "observers": [Hold, Drift],
    "sensors": [FeaturePoints, StereoCamera, AngularAcceleration, FirstGuess],
    "recovery": [BasisPursuit],
    "problem": [TumblingAttitude, StereoPoseAdditive, StereoPose],
    "start": [FirstSamples, Drawn],
    "filter": [Unscented, Extended, Replay, Efficient],
}
