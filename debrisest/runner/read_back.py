"""Whether a file that was computed elsewhere is there, whole, and the one that was asked for."""

import time

from debrisest.results import store
from debrisest.runner.step import Step

PATIENCE_S = 10.0
"""How long a shared disk may take to show a file."""


def not_read_back(step: Step) -> str:
    """Return why a step is not done although a worker says so; nothing where its file is there."""
    end = time.monotonic() + PATIENCE_S
    while not _is_there(step):
        if time.monotonic() > end:
            return (
                f"a worker computed it, but {step.path} is not there, or not whole, within "
                f"{PATIENCE_S:g} s: the folder of results must be shared with all workers, by the "
                "same path"
            )
        time.sleep(0.1)
    return ""


def _is_there(step: Step) -> bool:
    found = store.inspect(step.path)
    return (
        found.condition == store.Condition.WHOLE and found.attributes.get("stage_key") == step.key
    )
