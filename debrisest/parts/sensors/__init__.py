"""Sensors that a scenario can name."""
