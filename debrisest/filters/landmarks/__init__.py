"""Batch start and filter with landmarks that come and go."""
