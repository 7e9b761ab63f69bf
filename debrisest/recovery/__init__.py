"""Recovery of a whole attitude signal from partial samples."""
