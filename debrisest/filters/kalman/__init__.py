"""Kalman filters of labelled measurements."""
