"""Volume and inertia of a body of one density: units, scale, errors in the true body's axes."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from debrisest.filters.estimates import Estimates
from debrisest.problems.shape.problem import ConstantDensityShape
from debrisest.reconstruction.error_bars import packed
from debrisest.vision.polyhedron import mass_properties
from tests.reconstruction.solids import box

SIDES = (2.0, 1.6, 1.2)
TURN = Rotation.from_rotvec([0.4, -0.7, 1.1]).as_matrix()


def body(scale=1.0):
    points, faces = box(SIDES)
    return scale * points @ TURN.T + [1.0, 2.0, -3.0], faces


def estimates(properties, relative=0.01, scaled=1.0):
    state = packed(properties)[None, None]
    sigma = relative * np.abs(state)
    return Estimates(
        *(state, sigma, np.zeros((1, 1, 10, 10)), np.array([0])),
        *(np.full((1, 1), np.nan), np.zeros((1, 1), dtype=int), np.array(["closed"])),
        counts={"scaled": np.array([scaled])},
    )


def unpacked(scaled=1.0, **keys):
    problem = ConstantDensityShape(kind="constant_density_shape", **keys)
    return problem, problem.unpack(estimates(mass_properties(*body()), scaled=scaled))


def test_moments_axes_and_ratios_of_a_turned_box():
    _, found = unpacked(density_kg_m3=500.0)
    a, b, c = np.square(SIDES)
    moments = 500.0 * 3.84 / 12 * np.array([b + c, a + c, a + b])
    np.testing.assert_allclose(found["principal_moments"][0], moments, rtol=1e-12)
    np.testing.assert_allclose(np.abs(found["principal_axes_r"][0].T @ TURN), np.eye(3), atol=1e-9)
    np.testing.assert_allclose(
        found["moment_ratios"][0], np.log(moments[:2] / moments[1:]), rtol=1e-9
    )
    assert found["body_mass"][0] == pytest.approx(1920.0)


def test_a_known_mass_takes_the_place_of_the_density():
    _, found = unpacked(mass_kg=10.0)
    assert found["body_mass"][0] == pytest.approx(10.0)
    a, b, _ = np.square(SIDES)
    assert found["principal_moments"][0, 2] == pytest.approx(10.0 / 12 * (a + b))
    with pytest.raises(ValidationError, match="exclude each other"):
        unpacked(mass_kg=10.0, density_kg_m3=1000.0)


def test_without_a_scale_only_ratios_are_told():
    _, found = unpacked(scaled=0.0)
    for name in ("volume", "body_inertia_r", "principal_moments", "body_mass"):
        assert np.isnan(found[name]).all()
    assert np.isfinite(found["moment_ratios"]).all()
    assert np.isfinite(found["principal_axes_r"]).all()


def test_errors_are_those_of_a_scale_that_is_wrong_by_one_percent():
    problem = ConstantDensityShape(kind="constant_density_shape")
    vertices, faces = body(1.01)
    found = problem.unpack(estimates(mass_properties(vertices, faces), relative=0.02))
    points, true_faces = box(SIDES)
    data = found | {
        "run": np.zeros(1),
        "vertex_r": vertices[None],
        "triangle_r": faces[None].astype(float),
        "true_vertex_b": points[None],
        "true_triangle": true_faces[None].astype(float),
    }
    errors = problem.assess(data, (0.0, 1.0))
    assert errors["volume_error"][0] == pytest.approx(1.01**3 - 1, rel=1e-6)
    for name in ("xx", "yy", "zz"):
        assert errors[f"inertia_{name}_error"][0] == pytest.approx(1.01**5 - 1, abs=2e-3)
    for name in ("xy", "xz", "yz"):
        assert errors[f"inertia_{name}_error"][0] < 2e-3
    assert errors["within_bars"][0] > 0.5
