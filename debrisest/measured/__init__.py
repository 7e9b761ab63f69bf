"""Measurements of a user's own: their scenario, and the files and arrays they come in."""
