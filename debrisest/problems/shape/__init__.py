"""Shape and mass properties of a body from images: what is estimated, and its errors."""
