"""Rotation of rigid bodies, orbits and relative motion."""
