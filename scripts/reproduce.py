"""Reproduce all tables with their full number of runs, under several master seeds.

Usage: python scripts/reproduce.py [SEED ...]    (default: each scenario's own seed, and 2)

Results go to results/seed-N, in folders SCENARIO@seed=N. At the end stands, for each cell with a
published value, whether its verdict is the same under all seeds. The exit code is 1 where a verdict
is not as expected.
"""

import subprocess
import sys
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).resolve().parent.parent
CONFIGS = sorted((ROOT / "configs").glob("*.yaml"))
KEY = ["table", "case", "estimator", "quantity", "statistic", "window"]


def sweep(seed: str) -> tuple[Path, int]:
    """Run everything under one seed; return the folder of its results and the exit code.

    The code is 1 where a run failed or a verdict is not the expected one.
    """
    out = ROOT / "results" / f"seed-{seed}"
    chosen = [] if seed == "own" else ["--set", f"seed={seed}"]
    command = [sys.executable, "-m", "debrisest", "sweep", *map(str, CONFIGS), "--out", str(out)]
    code = subprocess.run([*command, *chosen, "--check"]).returncode
    if code not in (0, 1):
        raise SystemExit(code)
    return out, code


def _name(config: Path, seed: str) -> str:
    return config.stem if seed == "own" else f"{config.stem}@seed={seed}"


def main(seeds: list[str]) -> int:
    """Run all seeds, compare their verdicts, and return the largest exit code."""
    swept = {seed: sweep(seed) for seed in seeds}
    folders = {seed: folder for seed, (folder, _) in swept.items()}
    for config in CONFIGS:
        tables = {
            seed: pd.read_csv(folder / _name(config, seed) / "tables.csv").set_index(KEY)
            for seed, folder in folders.items()
        }
        verdicts = pd.DataFrame({seed: table["verdict"] for seed, table in tables.items()})
        measured = pd.DataFrame({seed: table["measured"] for seed, table in tables.items()})
        published = verdicts[(verdicts != "unpublished").any(axis=1)]
        differing = published[published.nunique(axis=1) > 1]
        print(f"{config.stem}: {len(published)} published cells, {len(differing)} differ by seed")
        if len(differing):
            print(differing.join(measured, rsuffix=" measured").to_string())
    return max(code for _, code in swept.values())


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:] or ["own", "2"]))
