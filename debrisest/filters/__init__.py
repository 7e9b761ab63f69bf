"""Filters: algorithms that are handed a model and know nothing of satellites."""
