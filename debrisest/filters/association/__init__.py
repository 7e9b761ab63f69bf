"""Filters that are handed points without labels."""
