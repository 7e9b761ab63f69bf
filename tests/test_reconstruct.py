"""The command reconstruct: meshes, clouds and wrong input."""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from debrisest.cli.app import app
from tests.reconstruction.solids import box

pytestmark = pytest.mark.skipif(not find_spec("trimesh"), reason="needs the extra vision")
APOPHIS = Path(__file__).parent / "data" / "apophis" / "apophis.obj"


def said(*arguments):
    result = CliRunner().invoke(app, ["reconstruct", *map(str, arguments)])
    return result.exit_code, result.output


def written(path, points, faces):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces.tolist()]
    path.write_text("\n".join(lines) + "\n")
    return path


def number(output, label):
    (line,) = (line for line in output.splitlines() if line.startswith(f"{label} "))
    return float(line.removeprefix(label).split()[0])


def test_moments_of_apophis_over_the_largest():
    code, output = said("--mesh", APOPHIS)
    assert code == 0
    assert "over the largest 0.7304, 0.9474, 1.0000" in output


def test_a_box_of_known_mass(tmp_path):
    path = written(tmp_path / "box.obj", *box((2.0, 1.6, 1.2)))
    code, output = said(path, "--mass-kg", 12)
    assert code == 0
    assert number(output, "volume") == pytest.approx(3.84)
    assert number(output, "Ixx") == pytest.approx(1.6**2 + 1.2**2)
    assert number(output, "Izz") == pytest.approx(2.0**2 + 1.6**2)


def test_an_open_mesh_is_refused_in_a_sentence(tmp_path):
    points, faces = box()
    code, output = said(written(tmp_path / "open.obj", points, faces[1:]))
    assert code == 2
    assert "not closed: 3 edges" in output


def test_a_reference_is_compared_in_its_axes(tmp_path):
    path = written(tmp_path / "box.obj", *box((2.0, 1.6, 1.2)))
    other = written(tmp_path / "cad.obj", *box((1.2, 2.0, 1.6), (5.0, 0.0, 0.0)))
    code, output = said(path, "--reference", other)
    assert code == 0
    (row,) = (line for line in output.splitlines() if "Ixx kg m2" in line)
    assert float(row.split()[-2]) == pytest.approx(0.0, abs=0.1)


def test_a_cloud_becomes_a_surface(tmp_path):
    pytest.importorskip("pycolmap")
    rng = np.random.default_rng(5)
    points = rng.normal(size=(3000, 3))
    points *= [1.5, 1.0, 0.8] / np.linalg.norm(points, axis=1, keepdims=True)
    path = written(tmp_path / "cloud.obj", points, np.empty((0, 3), dtype=int))
    code, output = said(path)
    assert code == 0
    assert number(output, "volume") == pytest.approx(4 / 3 * np.pi * 1.2, rel=0.03)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "give one thing"),
        (("/nowhere.stl",), "no such file"),
        (("/nowhere",), "no such folder or file"),
        ((APOPHIS, "--density-kg-m3", -1), "must be positive"),
    ],
)
def test_wrong_input_is_told(arguments, words):
    code, output = said(*arguments)
    assert code == 2
    assert words in output
