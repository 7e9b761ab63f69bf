"""Pose, shape and inertia of an unknown target from one camera and a range."""
