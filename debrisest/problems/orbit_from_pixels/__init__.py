"""Orbit of a piece of debris from the pixels of several satellites."""
