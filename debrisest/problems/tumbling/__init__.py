"""Attitude, rate and inertia of a torque-free body, from recovered attitudes or from points."""
