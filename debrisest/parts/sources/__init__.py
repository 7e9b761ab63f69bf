"""Sources of measured data that a scenario can name."""
