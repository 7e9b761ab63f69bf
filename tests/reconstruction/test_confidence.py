"""Of which bodies numbers are told: much seen, some of it, little."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("cv2")

from debrisest.parts.filters.surface import Surface, SurfaceStatus
from debrisest.reconstruction.body import Body
from debrisest.reconstruction.closed_mesh import closed_mesh
from debrisest.vision.polyhedron import mass_properties
from debrisest.vision.solids import box


def body(coverage: float) -> Body:
    solid = box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0), 1.0)
    mesh = closed_mesh(solid.vertices, solid.triangles)
    return Body(
        mesh=mesh,
        properties=mass_properties(mesh.vertices, mesh.triangles),
        sigma=np.ones(10),
        method="fusion",
        cell=0.1,
        coverage=coverage,
        seen=np.ones(len(mesh.triangles), dtype=np.bool_),
        hull_volume=6.0,
        silhouette_volume=6.0,
        outline="",
        on_table=False,
        support_cut=False,
    )


@pytest.mark.parametrize("scaled", [True, False])
@pytest.mark.parametrize(
    ("coverage", "told", "confident"),
    [(0.81, True, True), (0.79, True, False), (0.5, False, False)],
)
def test_what_is_hardly_seen_is_a_guess_or_nothing(
    monkeypatch: pytest.MonkeyPatch, coverage: float, told: bool, confident: bool, scaled: bool
) -> None:
    monkeypatch.setattr(Surface, "_body", lambda *_: body(coverage))
    model: Any = SimpleNamespace(
        data={"scale_spread": np.array([0.01 if scaled else np.inf])}, known_length=None
    )
    given: Any = SimpleNamespace(measured=np.zeros((1, 4)))
    found = Surface(kind="surface").run(model, given)
    assert np.isfinite(found.state).all() == np.isfinite(found.sigma).all() == told
    assert found.counts["confident"].tolist() == [float(confident and scaled)]
    guess = str(found.status[0]).startswith("not confident")
    assert guess == (told and not confident)
    assert ("only ratios" in str(found.status[0])) == (told and not scaled)
    if not told:
        assert found.status[0] == SurfaceStatus.UNSEEN.sentence
