"""Targets, orbits, motions and observers that a scenario can name."""
