"""Shape and mass properties of a body: from images to a cloud, to a mesh, to the inertia."""
