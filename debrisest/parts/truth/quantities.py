"""What really happens, and what orbits and targets tell estimators."""

from debrisest.quantity import RUN, TIME, TIME_QUATERNION, TIME_VECTOR, Quantity

_TIME_OBSERVER = (*TIME, "observer")

QUANTITIES = {
    "orbit_position": Quantity(TIME_VECTOR, "m", "position on the orbit, Earth-centred inertial"),
    "orbit_velocity": Quantity(TIME_VECTOR, "m/s", "velocity on the orbit, Earth-centred inertial"),
    "observer": Quantity(("observer",), "", "name of the observing satellite"),
    "observer_position": Quantity(
        (*_TIME_OBSERVER, "axis"), "m", "position of the observers, Earth-centred inertial"
    ),
    "observer_velocity": Quantity(
        (*_TIME_OBSERVER, "axis"), "m/s", "velocity of the observers, Earth-centred inertial"
    ),
    "true_q_ib": Quantity(TIME_QUATERNION, "1", "attitude of the body, body to inertial axes"),
    "true_rate_b": Quantity(TIME_VECTOR, "rad/s", "angular rate of the body in body axes"),
    "true_inertia_b": Quantity(("run", "row", "column"), "kg m2", "inertia tensor in body axes"),
    "true_point_b": Quantity(("run", "feature", "axis"), "m", "features in body axes"),
    "true_normal_b": Quantity(("run", "feature", "axis"), "1", "outward normals at the features"),
    "true_vertex_b": Quantity(("run", "vertex", "axis"), "m", "corners of the body's mesh"),
    "true_triangle": Quantity(
        ("run", "triangle", "corner"), "1", "vertices of the triangles, counterclockwise"
    ),
    "true_albedo": Quantity(("run", "triangle"), "1", "part of the light that is sent back"),
    "true_texture": Quantity(
        ("run", "texture"), "1", "of the pattern on the body: width of its spots, m, and its seed"
    ),
    "true_volume": Quantity(RUN, "m3", "volume of the body"),
    "feature": Quantity(("feature",), "", "name of the feature of the target"),
    "known_point_f": Quantity(
        ("run", "feature", "axis"), "m", "features as the estimators know them, in their own frame"
    ),
    "true_position": Quantity(TIME_VECTOR, "m", "target relative to the chaser"),
    "true_velocity": Quantity(TIME_VECTOR, "m/s", "target's velocity relative to the chaser"),
    "true_q_lt": Quantity(TIME_QUATERNION, "1", "attitude, target to leader's orbital frame"),
    "true_rate_l": Quantity(TIME_VECTOR, "rad/s", "rate relative to leader's frame, in its axes"),
    "true_inertia_ratio": Quantity(("run", "ratio"), "1", "ln(Ix/Iy) and ln(Iy/Iz)"),
    "chaser_position_h": Quantity(TIME_VECTOR, "m", "chaser relative to target, Hill axes"),
    "chaser_velocity_h": Quantity(TIME_VECTOR, "m/s", "its velocity as seen in the Hill frame"),
}
