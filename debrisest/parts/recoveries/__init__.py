"""Recoveries that a scenario can name."""
