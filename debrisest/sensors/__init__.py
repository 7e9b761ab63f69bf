"""Sensors: what a camera, or a pair of them, shows of points in space."""
