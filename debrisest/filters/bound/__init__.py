"""Cramer-Rao bounds, as the errors of efficient estimators."""
