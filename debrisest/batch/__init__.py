"""Batch estimation of one tumbling body's motion from points, attitudes or rates."""
