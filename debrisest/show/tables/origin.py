"""Where tables come from, in a file beside them: settings, seed, software, commit and dates."""

import json
from pathlib import Path
from typing import Any

import pandas as pd

from debrisest.results.open import find_results
from debrisest.results.status import difference
from debrisest.scenario.load import LoadedScenario
from debrisest.scenario.resolved import settings

NAME = "tables.origin.json"


def origin(scenario: LoadedScenario, out: Path, rows: pd.DataFrame) -> dict[str, Any]:
    """Return what made the cells: the first case's resolved scenario, and what files say."""
    shown = set(zip(rows["case"], rows["estimator"]))
    chunks = find_results(out / scenario.name).chunks
    told = [one.attributes for one in chunks if (one.address.case, one.address.estimator) in shown]
    created = sorted(str(each["created"]) for each in told)
    case = next(iter(scenario.cases.values()))
    runs = rows["runs"][rows["case"].isin(list(scenario.cases))]
    return {
        "settings": settings(case) | {"runs": int(runs.max())},
        "software": sorted({str(each.get("software")) for each in told}),
        "commit": sorted({str(each.get("commit")) for each in told}),
        "computed": [created[0], created[-1]] if created else [],
    }


def replaced(path: Path, now: dict[str, Any]) -> str:
    """Return a sentence where a file tells of tables of other settings than those of ``now``."""
    if not path.is_file():
        return ""
    try:
        before = json.loads(path.read_text(encoding="utf-8"))["settings"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return ""
    if not isinstance(before, dict) or before == json.loads(json.dumps(now["settings"])):
        return ""
    changed = difference(before, now["settings"])
    return f"{path.parent}: these tables replace others ({changed}); --variant NAME keeps both"
