"""Bring scenarios up to date: plan, run what has a reason to run, tell what happened."""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from debrisest.counted import heard_by
from debrisest.errors import UserError
from debrisest.files import remove_leftovers
from debrisest.interrupts import raised
from debrisest.locked import locked
from debrisest.results.address import STAGES
from debrisest.results.open import find_results
from debrisest.runner.execute import execute, trusted
from debrisest.runner.executors import executor, require_guarded
from debrisest.runner.pace import Pace
from debrisest.runner.plan import plan
from debrisest.runner.progress import Progress, progress
from debrisest.runner.read_back import not_read_back
from debrisest.runner.selection import Selection
from debrisest.runner.step import Step
from debrisest.runner.taken_over import take_over
from debrisest.scenario.load import LoadedScenario


@dataclass(frozen=True)
class Machine:
    """Where steps are computed."""

    jobs: int = 1
    cluster: str | None = None
    quiet: bool = False


def bring_up_to_date(
    scenarios: Sequence[LoadedScenario], out: Path, selection: Selection, machine: Machine
) -> dict[str, str]:
    """Run every step that has a reason to; return the runs that gave no result, with reasons."""
    require_guarded(machine.jobs)
    out = out.absolute() if machine.cluster else out
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"--out {out}: {error.strerror}; choose another folder") from None
    with ExitStack() as locks:
        for scenario in scenarios:
            locks.enter_context(locked(out / scenario.name))
            remove_leftovers(out / scenario.name)
        steps = [step for one in scenarios for step in plan(one, out, selection, STAGES)]
        errors = _run_due([*take_over(steps)], machine, [out / one.name for one in scenarios])
    for scenario in scenarios:
        results = find_results(out / scenario.name)
        written = {step.address: step.runs for step in steps if step.name not in errors}
        failed = results.limited(written).failures()
        errors |= {failure.name: failure.why for failure in failed}
    return errors


def _run_due(steps: list[Step], machine: Machine, folders: Sequence[Path]) -> dict[str, str]:
    """Run what is due, if anything is; return the steps that wrote no file, with reasons."""
    due = [step for step in steps if step.is_due]
    if not due:
        return {}
    pace = Pace(due, [chunk for folder in folders for chunk in find_results(folder).chunks])
    with raised() as check, progress(len(due), machine.quiet, pace.left) as told:
        for step in due:
            if step.notice:
                told.say(step.notice)
        return _run(steps, machine, pace, told, check)


def _run(
    steps: list[Step], machine: Machine, pace: Pace, told: Progress, check: Callable[[], None]
) -> dict[str, str]:
    """Run what is due; return the steps that wrote no file, with reasons."""
    errors: dict[str, str] = {}
    lacking = not_read_back if machine.cluster else trusted
    with heard_by(told.part), executor(machine.jobs, machine.cluster) as (pool, width):
        for outcome in execute(steps, pool, width, lacking, told.started):
            check()
            pace.done(outcome.step)
            told.done(outcome.step.name)
            if outcome.error:
                errors[outcome.step.name] = outcome.error
    return errors
