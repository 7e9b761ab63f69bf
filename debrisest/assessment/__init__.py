"""Errors, relabeling of principal axes, and statistics over runs."""
