"""Geometry of the target: features and their visibility."""
