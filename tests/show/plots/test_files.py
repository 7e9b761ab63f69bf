"""Figures on disk."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from debrisest.show.plots.files import write


def _figure() -> Figure:
    figure = Figure()
    figure.subplots().plot([0, 1], [2, 3])
    return figure


def test_png_and_svg_are_written_and_nothing_else(tmp_path: Path) -> None:
    folder = tmp_path / "results" / "plots"
    paths = list(write(_figure(), folder, "figure-a=0.1,b=2-best"))
    assert [path.name for path in paths] == [
        f"figure-a=0.1,b=2-best.{form}" for form in ("png", "svg")
    ]
    assert sorted(folder.iterdir()) == sorted(paths)
    assert paths[0].read_bytes().startswith(b"\x89PNG\r\n\x1a\n")
    assert paths[1].read_text().startswith("<?xml")


def test_same_figure_same_bytes(tmp_path: Path) -> None:
    once, twice = (list(write(_figure(), tmp_path / name, "figure")) for name in "ab")
    assert [path.read_bytes() for path in once] == [path.read_bytes() for path in twice]


def test_a_figure_that_cannot_be_drawn_leaves_what_was_there(tmp_path: Path) -> None:
    before = [path.read_bytes() for path in write(_figure(), tmp_path, "figure")]
    broken = _figure()
    broken.axes[0].set_title("$\\nothing$")
    with pytest.raises(ValueError, match="nothing"):
        list(write(broken, tmp_path, "figure"))
    assert [path.read_bytes() for path in sorted(tmp_path.iterdir())] == before


def test_long_series_make_small_drawings(tmp_path: Path) -> None:
    noise = np.random.default_rng(3).normal(0, 1, (2, 4000))
    figure = Figure(figsize=(3, 3))
    cloud, lines, band = figure.subplots(3)
    cloud.plot(noise.T, ".")
    lines.plot(noise.T)
    band.fill_between(np.arange(4000), noise[0], noise[1])
    _, drawing = write(figure, tmp_path, "noise")
    assert drawing.stat().st_size < 3e5


def test_short_series_stay_lines(tmp_path: Path) -> None:
    _, drawing = write(_figure(), tmp_path, "figure")
    assert "<image" not in drawing.read_text()


@pytest.mark.parametrize(
    "backend", ["module://matplotlib_inline.backend_inline", "nonsense", "tkagg", "svg"]
)
def test_the_backend_of_the_environment_plays_no_part(backend: str, tmp_path: Path) -> None:
    code = (
        "import sys; from pathlib import Path\n"
        "from debrisest.show.plots.files import write; from matplotlib.figure import Figure\n"
        "figure = Figure(); figure.subplots().plot([0, 1], [2, 3])\n"
        "list(write(figure, Path(sys.argv[1]), 'figure'))"
    )
    environment = os.environ | {"MPLBACKEND": backend}
    subprocess.run([sys.executable, "-c", code, tmp_path], env=environment, check=True)
    ours = {path.name: path.read_bytes() for path in write(_figure(), tmp_path / "own", "figure")}
    assert ours == {name: (tmp_path / name).read_bytes() for name in ours}


def test_a_solid_that_asks_for_it_is_drawn_as_an_image(tmp_path: Path) -> None:
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    corners = np.random.default_rng(1).random((3000, 3, 3))
    figure = Figure()
    axes = figure.add_subplot(projection="3d")
    axes.add_collection(Poly3DCollection(corners, rasterized=True))
    (path,) = write(figure, tmp_path, "solid", ("svg",))
    drawn = path.read_text()
    assert drawn.count("<path") < 200
    assert "<image" in drawn
