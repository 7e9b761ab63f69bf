"""A sensor and a filter from outside the package are parts like the shipped ones."""

import json
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest

from debrisest.errors import UserError
from debrisest.plugins.load import load_plugins, read_plugins
from debrisest.results import store
from debrisest.runner.compute import compute
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.scenario.load import load_scenario


def replaced(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_a_sweep_by_two_processes(
    config: Path, options: tuple, tmp_path: Path, process: Callable, sweep: Callable
) -> None:
    out = tmp_path / "out"
    running = process("sweep", config, "--out", out, "--jobs", 2, "--runs", 2, *options)
    shown, told = running.communicate(timeout=120)
    assert running.returncode == 0, told
    assert "Table 1" in shown
    rows = pd.read_csv(out / "small" / "tables.csv")
    assert (rows["failed"] == 0).all()
    assert set(rows["estimator"]) >= {"triad", "wahba"}
    alone = sweep(config, tmp_path / "alone", "--runs", 2, *options)
    assert alone.exit_code == 0, alone.stderr
    tables = [folder / "small" / "tables.csv" for folder in (out, tmp_path / "alone")]
    assert tables[0].read_bytes() == tables[1].read_bytes()


def test_what_they_do_and_what_is_stored(
    config: Path, options: tuple, tmp_path: Path, sweep: Callable
) -> None:
    same = "estimators.triad.recovery.attitude=wahba"
    changed = ("--set", same, "--variant", "same")
    done = sweep(config, tmp_path / "out", *changed, "--case", "slow", *options)
    assert done.exit_code == 0, done.stderr
    folder = tmp_path / "out" / "small@same" / "slow"
    seen = store.read(folder / "simulate.000000.h5")
    lost = np.isnan(seen["measured_point"]).any(axis=-1).mean(axis=-1)
    assert np.array_equal(seen["fading"], lost)
    # a binomial share: within five standard deviations
    assert abs(lost.mean() - 0.03) < 5 * np.sqrt(0.03 * 0.97 / (4 * lost.size))
    ours, theirs = (store.read(folder / f"filter-{name}.000000.h5") for name in ("wahba", "triad"))
    assert (ours["rate_b_sigma"][:, 0] > theirs["rate_b_sigma"][:, 0]).all()
    with h5py.File(folder / "simulate.000000.h5") as file:
        assert file["fading"].attrs["long_name"] == "share of the features not seen"
        assert [Path(path).name for path in json.loads(file.attrs["plugins"])] == [
            *("fading_points.py", "cautious.py")
        ]


def test_a_change_of_the_source_runs_what_depends_on_it(
    config: Path, options: tuple, cautious: Path, sensor: Path, tmp_path: Path, sweep: Callable
) -> None:
    out, some = tmp_path / "out", ("--case", "slow", "--runs", 1, *options)
    assert sweep(config, out, *some).exit_code == 0
    assert sweep(config, out, *some, "--dry-run").stdout == "0 of 7 steps would run\n"
    replaced(cautious, "self.factor**2", "self.factor")
    told = sweep(config, out, *some, "--dry-run").stdout.splitlines()
    assert told == [
        "small slow: filter wahba, runs 0-0: filter: plug-in cautious.py changed",
        "small slow: assess wahba, runs 0-0: filter runs before it",
        "2 of 7 steps would run",
    ]
    replaced(sensor, "= 0.9", "= 0.8")
    told = sweep(config, out, *some, "--dry-run").stdout.splitlines()
    assert told[0].endswith("sensors.points: plug-in fading_points.py changed")
    assert told[-1] == "7 of 7 steps would run"


def test_a_worker_needs_no_file(config: Path, sensor: Path, cautious: Path, tmp_path: Path) -> None:
    """The source travels with the step, so that what runs is what the step's key was made of."""
    plugins = read_plugins([sensor, cautious])
    loaded = load_scenario(config, (), plugins)
    sensor.write_text("1 / 0")
    step = plan(loaded, tmp_path / "out", Selection(runs=1))[0]
    step.case.__dict__.pop("scenario", None)
    compute([step])
    assert "fading" in store.read(step.path)


def test_they_are_told_like_the_shipped_ones(config: Path, options: tuple, cli: Callable) -> None:
    assert cli("validate", config, *options).exit_code == 0
    schema = json.loads(cli("schema", *options).stdout)
    assert {"FadingPoints", "Cautious"} <= set(schema["$defs"])
    replaced(config, "kind: cautious, factor: 3", "kind: cautios, factor: 3")
    replaced(config, "seen: 0.97", "sen: 0.97")
    done = cli("validate", config, *options)
    assert done.exit_code == 2
    assert "did you mean cautious?" in done.stderr
    assert "sensors.points.sen: unknown key; allowed: kind, noise_m, seen" in done.stderr


def test_its_quantity_is_one_for_the_tables(config: Path, options: tuple, cli: Callable) -> None:
    replaced(config, "quantities: [pitch]", "quantities: [fading]")
    assert cli("validate", config, *options).exit_code == 0


def test_without_the_plug_in_its_kind_is_unknown(config: Path, cli: Callable) -> None:
    done = cli("validate", config)
    assert done.exit_code == 2
    assert "unknown kind 'fading_points'" in done.stderr


def test_a_part_that_was_renamed_is_gone(cautious: Path) -> None:
    from debrisest.catalog import CATALOG, kind_of

    load_plugins(read_plugins([cautious]))
    replaced(cautious, 'Literal["cautious"]', 'Literal["careful"]')
    load_plugins(read_plugins([cautious]))
    kinds = [kind_of(part) for part in CATALOG["filter"]]
    assert "careful" in kinds
    assert "cautious" not in kinds


def test_the_parts_of_an_installed_package(
    cautious: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from debrisest.catalog import CATALOG, kind_of

    site = installed(tmp_path / "site", cautious.read_text())
    monkeypatch.syspath_prepend(str(site))
    load_plugins()
    added = [part for part in CATALOG["filter"] if kind_of(part) == "cautious"]
    assert [list(part.plugin) for part in added] == [["plug-in ours"]]


def test_an_installed_package_that_is_broken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(installed(tmp_path / "site", "import nothing_of_that_name")))
    with pytest.raises(
        UserError, match=r"ours = our_broken_parts.*nothing_of_that_name.*uninstall"
    ):
        load_plugins()


def installed(site: Path, source: str) -> Path:
    """A folder of packages in which one has an entry point."""
    name = "our_broken_parts" if "nothing" in source else "our_parts"
    (site / f"{name}-1.dist-info").mkdir(parents=True)
    (site / f"{name}.py").write_text(source)
    (site / f"{name}-1.dist-info" / "METADATA").write_text(f"Name: {name}\nVersion: 1\n")
    (site / f"{name}-1.dist-info" / "entry_points.txt").write_text(
        f"[debrisest.parts]\nours = {name}\n"
    )
    return site
