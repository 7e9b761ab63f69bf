"""Filters that a scenario can name."""
