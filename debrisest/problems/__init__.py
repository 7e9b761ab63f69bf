"""Estimation problems, one file each: state, process, measurement."""
