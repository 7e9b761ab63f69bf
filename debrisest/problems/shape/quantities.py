"""What is estimated of a body's shape, and the errors."""

from debrisest.quantity import RUN, RUN_VECTOR, Quantity, with_sigmas

_TENSOR = ("run", "row", "column")

_ESTIMATED = {
    "volume": Quantity(RUN, "m3", "volume of the body"),
    "centre_r": Quantity(RUN_VECTOR, "m", "centre of mass in the axes of the structure"),
    "body_inertia_r": Quantity(_TENSOR, "kg m2", "inertia about it, in the structure's axes"),
    "principal_moments": Quantity(RUN_VECTOR, "kg m2", "principal moments, ascending"),
    "moment_ratios": Quantity(("run", "ratio"), "1", "k1 = ln(I1/I2), k2 = ln(I2/I3), ascending"),
}
_COMPONENTS = ("xx", "yy", "zz", "xy", "xz", "yz")

QUANTITIES = {
    **with_sigmas(_ESTIMATED),
    "principal_axes_r": Quantity(_TENSOR, "1", "principal axes, as columns"),
    "body_mass": Quantity(RUN, "kg", "mass of the body"),
    "vertex_r": Quantity(("run", "vertex", "axis"), "m", "corners of the mesh, structure's axes"),
    "triangle_r": Quantity(("run", "triangle", "corner"), "1", "its triangles, counterclockwise"),
    "triangle_seen": Quantity(("run", "triangle"), "1", "whether an image shows the triangle"),
    "mesh_method": Quantity(RUN, "", "how the mesh was made, and why, in words"),
    "outline": Quantity(RUN, "", "what the body was taken to be in the images, in words"),
    "mended": Quantity(RUN, "", "what was wrong with the mesh, in words"),
    "cell": Quantity(RUN, "m", "side of the finer cells of the mesh"),
    "surface_seen": Quantity(RUN, "1", "share of the surface that the images show", "1"),
    "hull_volume": Quantity(RUN, "m3", "volume of the convex hull"),
    "silhouette_volume": Quantity(RUN, "m3", "volume of what all silhouettes share"),
    "scaled": Quantity(RUN, "1", "the scale is known", "1"),
    "confident": Quantity(RUN, "1", "the numbers of the body are told, and are no guess", "1"),
    "volume_error": Quantity(RUN, "1", "size of the relative error of the volume", "%"),
    **{
        f"inertia_{name}_error": Quantity(
            RUN, "1", f"size of the error of I{name} over sqrt(I{name[0]}{name[0]} "
            f"I{name[1]}{name[1]}), body axes", "%"
        )
        for name in _COMPONENTS
    },
    "within_bars": Quantity(
        RUN, "1", "share of volume and six components within two of their sigmas", "1"
    ),
    "surface_distance": Quantity(RUN, "m", "RMS distance of the surface to the true one", "m"),
}  # fmt: skip
