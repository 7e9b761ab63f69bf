"""Where the time of a sweep went, in Markdown: CPU seconds by stage and estimator, as files tell.

Usage: python scripts/shares.py FOLDER...    (each the results of a scenario, as results/biondi2017)

A step's time is that of its computation in the process that computed it, without reading, writing
and start-up. Steps below one per cent of all are added up.
"""

import sys
from collections import Counter
from pathlib import Path

from rich.box import MARKDOWN
from rich.console import Console
from rich.table import Table

from debrisest.results.open import find_results

LEAST = 0.01


def shares(folders: list[str]) -> Table:
    """Return a row for each scenario, estimator and stage, the largest share first."""
    seconds: Counter[tuple[str, str, str]] = Counter()
    runs: Counter[tuple[str, str, str]] = Counter()
    for folder in map(Path, folders):
        for chunk in find_results(folder).chunks:
            of = (folder.name, chunk.address.estimator or "-", chunk.address.stage)
            seconds[of] += chunk.attributes.get("cpu_s", 0.0)
            runs[of] += chunk.runs
    total = seconds.total() or 1.0
    columns = ("share", "scenario", "estimator", "stage", "CPU s", "ms per run")
    table = Table(*columns, box=MARKDOWN)
    large = [(of, spent) for of, spent in seconds.most_common() if spent >= LEAST * total]
    for of, spent in large:
        each = 1e3 * spent / runs[of]
        table.add_row(f"{100 * spent / total:.1f} %", *of, f"{spent:.1f}", f"{each:.1f}")
    rest = total - sum(spent for _, spent in large)
    table.add_row(f"{100 * rest / total:.1f} %", "all others", "", "", f"{rest:.1f}", "")
    table.add_row("", "together", "", "", f"{total:.1f}", "")
    return table


if __name__ == "__main__":
    Console(width=110).print(shares(sys.argv[1:]))
