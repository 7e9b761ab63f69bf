"""Starts that a scenario can name."""
