"""Attitude control that keeps a target in a camera's view. It sees pixels, never an estimate."""
