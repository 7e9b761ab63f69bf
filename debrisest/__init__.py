"""Batch experiments on estimating the motion of tumbling space debris from vision."""

__version__ = "0.1.0"
