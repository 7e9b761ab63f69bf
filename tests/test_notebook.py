"""The calls of a notebook: the guide's blocks, in order, and the same tables as the command's."""

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import debrisest
from debrisest.batch.estimate import estimate_from_attitudes
from debrisest.batch.motion import Status

GUIDE = (Path(__file__).parent.parent / "docs" / "python.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```", GUIDE, re.M | re.S)


def test_the_guide(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    untouched_catalog: None,
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for block in BLOCKS:
        exec(compile(block, "docs/python.md", "exec"), names)
    assert names["scenario"].common.motion.rate_deg_s == [2, 1, 3]
    assert set(names["rows"]["case"]) == {"noise_m=0.01", "noise_m=0.03"}
    assert names["motion"].status is Status.WITHOUT_INERTIA
    off = names["motion"].path.rate[-1] - np.radians([0, 0, 2])
    assert (np.abs(off) < 5 * names["motion"].path.rate_sigma[-1]).all()
    assert type(names["mine"].common.estimators["wahba"].filter).__name__ == "Cautious"
    told = capsys.readouterr().out
    assert told.startswith("--set run=2: run: unknown key; allowed: ")
    assert "(did you mean runs?)" in told


def test_the_tables_are_those_of_the_command(small: Path, tmp_path: Path, reference: Path) -> None:
    rows = debrisest.run(small, tmp_path / "out", estimators=["wahba"])
    assert set(rows["estimator"]) == {"wahba"}
    debrisest.run(debrisest.load(small), tmp_path / "out")
    ours, theirs = (out / "small" / "tables.csv" for out in (tmp_path / "out", reference))
    assert ours.read_bytes() == theirs.read_bytes()


def test_a_motion_from_arrays_is_that_of_the_estimator() -> None:
    times = np.arange(0.0, 60.0, 2.0)
    half = 0.02 * times / 2
    q = np.stack([np.cos(half), 0 * half, 0 * half, np.sin(half)], axis=-1)
    q = q + 1e-3 * np.random.default_rng(3).standard_normal(q.shape)
    found = debrisest.estimate(times.tolist(), q=q.tolist(), sigma=2e-3)
    expected = estimate_from_attitudes(times, q, 2e-3)
    np.testing.assert_array_equal(found.path.rate, expected.path.rate)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, "give one of points, q and rates, not nothing"),
        ({"q": np.ones((9, 4)), "rates": np.ones((9, 3))}, "not q, rates"),
        ({"q": np.ones((8, 4))}, r"q: shape \(8, 4\); needed: \(time, 4\) with 9 epochs"),
        ({"points": np.ones((9, 3))}, r"points: shape \(9, 3\); needed: \(time, feature, 3\)"),
        ({"rates": np.ones((9, 3)), "sigma": 0.0}, "sigma: must be finite and positive"),
        ({"rates": np.ones((9, 3)), "sigma": np.ones(8)}, r"sigma: shape \(8,\); needed"),
        ({"rates": np.ones((9, 3)), "model": np.ones((2, 3))}, "model: places of points are for"),
        (
            {"points": np.ones((9, 2, 3)), "model": np.ones((3, 3))},
            r"model: shape \(3, 3\); needed: \(2, 3\)",
        ),
        ({"q": np.ones((9, 4)), "times": np.arange(9)[::-1]}, "times: must be finite and increase"),
        ({"q": np.ones((9, 4)), "times": 3.0}, r"times: shape \(\); needed: \(time,\)"),
    ],
)
def test_arrays_that_do_not_fit(given: dict, words: str) -> None:
    times = given.pop("times", np.arange(9.0))
    with pytest.raises(debrisest.UserError, match=words):
        debrisest.estimate(times, **given)


def test_settings_are_python_values(small: Path) -> None:
    changed = debrisest.load(small, title="Ü: {a}", **{"motion.rate_deg_s": np.array([1e-7, 2, 3])})
    assert changed.common.title == "Ü: {a}"
    assert changed.common.motion.rate_deg_s == [1e-7, 2, 3]


def test_settings_make_a_variant_as_those_of_the_command_do(small: Path) -> None:
    assert debrisest.load(small).name == "small"
    assert debrisest.load(small, seed=8, runs=2).name == "small@runs=2,seed=8"
    assert debrisest.load(small, variant="mine", seed=8).name == "small@mine"
    with pytest.raises(debrisest.UserError, match="--variant a b: a name has letters"):
        debrisest.load(small, variant="a b")


def test_a_name_that_nothing_has(tmp_path: Path, small: Path) -> None:
    with pytest.raises(debrisest.UserError, match="did you mean first_steps"):
        debrisest.load("first_step")
    with pytest.raises(debrisest.UserError, match="did you mean wahba"):
        debrisest.run(small, tmp_path, estimators=["wabha"])
    with pytest.raises(AttributeError, match="no attribute 'swep'"):
        _ = debrisest.swep


def test_the_package_is_light() -> None:
    heavy = "numpy", "pydantic", "yaml", "typer"
    code = f"import sys, debrisest; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_what_the_package_lists_is_there(cli: Callable) -> None:
    assert set(debrisest.__all__) <= set(dir(debrisest))
    assert debrisest.version == debrisest.__version__
    assert debrisest.schema()["title"] == "ScenarioFile"


def test_plug_ins_stay_for_the_session(small: Path, tmp_path: Path) -> None:
    """In a process of its own, since the catalog of this one is that of all tests."""
    plugin = Path(__file__).parent / "plugins" / "cautious.py"
    text = small.read_text().replace("{kind: unscented", "{kind: cautious, factor: 2")
    small.write_text(text)
    code = (
        "import debrisest\n"
        "if __name__ == '__main__':\n"
        f"    debrisest.load({str(small)!r}, plugins=[{str(plugin)!r}])\n"
        f"    scenario = debrisest.load({str(small)!r})\n"
        "    rows = debrisest.run(scenario, runs=1, cases=['slow'], jobs=2)\n"
        "    print(rows['failed'].sum(), len(rows) > 0)\n"
    )
    (script := tmp_path / "script.py").write_text(code)
    done = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, cwd=tmp_path, check=False
    )
    assert (done.returncode, done.stdout) == (0, "0 True\n"), done.stderr
