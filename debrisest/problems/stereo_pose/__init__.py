"""Pose, motion and inertia ratios of an unknown target from two cameras."""
