"""Attitude: quaternions, Euler angles, attitude from points."""
