"""The options of `plot`: which figure, of which run, in which format, and the film."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image
from scipy.spatial.transform import Rotation

from debrisest.results.open import open_results
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.scenario.load import load_scenario
from debrisest.show.plots.draw import Asked, sources
from debrisest.show.plots.tumble import FRAMES, places

ONE = ("--case", "slow", "--estimator", "wahba")


def test_one_figure_of_one_run_in_one_format(small: Path, swept: Path, cli: Callable) -> None:
    asked = ("--figure", "rates", "--run", 2, "--format", "pdf")
    done = cli("plot", small, "--out", swept, *ONE, *asked)
    path = swept / "small" / "plots" / "rates-slow-wahba-run_2.pdf"
    assert done.stdout == f"{path}\n"
    assert [*path.parent.iterdir()] == [path]
    assert path.read_bytes().startswith(b"%PDF")


def test_the_run_that_is_asked_for_is_the_one_drawn(small: Path, swept: Path) -> None:
    scenario = load_scenario(small)
    steps = plan(scenario, swept, Selection(None, ["slow"], ["wahba"]))
    drawn = {
        run: next(sources(scenario, swept, steps, Asked(["rates"], run)))[1] for run in (None, 0, 2)
    }
    stored = open_results(swept / "small").load("slow", "wahba", "filter")["rate_b"]
    assert np.array_equal(drawn[2].data["rate_b"], stored[2])
    assert np.array_equal(drawn[0].data["rate_b"], drawn[None].data["rate_b"])
    assert drawn[2].context.endswith("run 2")
    assert not list(sources(scenario, swept, steps, Asked(["rates"], 3)))


def test_a_figure_that_does_not_exist_is_told(small: Path, swept: Path, cli: Callable) -> None:
    done = cli("plot", small, "--out", swept, "--figure", "rate")
    assert done.exit_code == 2
    assert done.stderr.startswith("--figure rate: no such figure; allowed: ")
    assert "(did you mean rates?)" in done.stderr


def test_cases_that_have_no_mean_are_not_pooled(small: Path, swept: Path) -> None:
    asked = Asked(["error_over_time"])
    scenario = load_scenario(small)
    pooled = [
        s.names for _, s in sources(scenario, swept, plan(scenario, swept, Selection()), asked)
    ]
    assert pooled == [("triad",), ("wahba",)]
    text = small.read_text().replace("  means:\n    mean: [slow, fast]\n", "")
    small.write_text(text)
    scenario = load_scenario(small)
    single = [
        s.names for _, s in sources(scenario, swept, plan(scenario, swept, Selection()), asked)
    ]
    assert sorted(single) == [(c, e) for c in ("fast", "slow") for e in ("triad", "wahba")]


def test_a_film_turns_the_features_as_truth_and_estimate_say(
    small: Path, swept: Path, cli: Callable
) -> None:
    """By rotations of scipy; the estimate of the small scenario is within a few degrees."""
    data = open_results(swept / "small").one_run("slow", "wahba", 0)
    true, estimated = places(data)
    rotation = Rotation.from_quat(data["true_q_ib"], scalar_first=True)
    for feature, point in enumerate(data["true_point_b"]):
        assert np.allclose(true[:, feature], rotation.apply(point))
    off = np.linalg.norm(true - estimated, axis=-1)
    assert np.nanmedian(off) < 0.2
    assert np.allclose(np.linalg.norm(estimated, axis=-1), np.linalg.norm(true, axis=-1))
    done = cli("plot", small, "--out", swept, *ONE, "--figure", "tumble")
    with Image.open(done.stdout.strip()) as film:
        assert film.format == "GIF"
        assert film.n_frames == min(FRAMES, len(data["time_s"]))
