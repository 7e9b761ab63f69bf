"""The commands that bring results up to date: simulate, recover, filter, sweep."""

import os
import shlex
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from debrisest.cli.exits import exit_if
from debrisest.cli.inputs import computable, load_all, select
from debrisest.cli.options import (
    RESULTS,
    CaseNames,
    Check,
    Cluster,
    Configs,
    DryRun,
    EstimatorNames,
    Force,
    Format,
    Jobs,
    Keep,
    Out,
    Plugins,
    Quiet,
    Report,
    RerunFailed,
    Runs,
    Settings,
    Variant,
)
from debrisest.cli.report import write_report
from debrisest.cli.show import show_tables

if TYPE_CHECKING:
    from debrisest.runner.selection import Selection
    from debrisest.runner.sweep import Machine
    from debrisest.scenario.load import LoadedScenario


_MOST_FAILURES = 20
"""Lines on failures, beyond which only their number is told."""


def _command(last_stage: str, help: str) -> Callable[..., None]:
    """Return the command that brings one stage, and what it needs before it, up to date."""

    def command(
        configs: Configs,
        out: Out = RESULTS,
        jobs: Jobs = None,
        runs: Runs = None,
        keep: Keep = None,
        case: CaseNames = None,
        estimator: EstimatorNames = None,
        settings: Settings = None,
        variant: Variant = None,
        plugins: Plugins = None,
        dry_run: DryRun = False,
        force: Force = False,
        rerun_failed: RerunFailed = False,
        cluster: Cluster = None,
        quiet: Quiet = False,
    ) -> None:
        scenarios = computable(load_all(configs, settings, plugins, variant, keep))
        selection = select(scenarios, runs, case, estimator, last_stage, force)
        selection = _with_lost(selection, scenarios, out) if rerun_failed else selection
        exit_if(bring(scenarios, out, selection, _machine(jobs, cluster, quiet), dry_run))

    command.__doc__ = help
    return command


simulate = _command("simulate", "Simulate truth and measurements.")
recover = _command("recover", "Recover attitude signals, simulating first where needed.")
filter = _command("assess", "Run the filters and assess them, doing what they need first.")


def sweep(
    configs: Configs,
    out: Out = RESULTS,
    jobs: Jobs = None,
    runs: Runs = None,
    keep: Keep = None,
    case: CaseNames = None,
    estimator: EstimatorNames = None,
    settings: Settings = None,
    variant: Variant = None,
    plugins: Plugins = None,
    dry_run: DryRun = False,
    force: Force = False,
    rerun_failed: RerunFailed = False,
    cluster: Cluster = None,
    quiet: Quiet = False,
    check: Check = False,
    report: Report = False,
) -> None:
    """Do everything for all cases, then write and print the tables."""
    if report:
        from debrisest.show.report.page import environment

        environment()
    scenarios = computable(load_all(configs, settings, plugins, variant, keep))
    selection = select(scenarios, runs, case, estimator, force=force)
    selection = _with_lost(selection, scenarios, out) if rerun_failed else selection
    failed = bring(scenarios, out, selection, _machine(jobs, cluster, quiet), dry_run)
    if not dry_run:
        wrong = show_tables(scenarios, out, selection, Format.RICH, check)
        if report:
            path = write_report(scenarios, out, selection, settings or (), jobs=jobs)
            print(f"report: {path}")
        elif sys.stderr.isatty() and not quiet:
            of_runs = ["--runs", str(runs)] if runs else []
            changed = [text for setting in settings or () for text in ("--set", setting)]
            changed += ["--variant", variant] if variant else []
            asked = [*map(str, configs), "--out", str(out), *of_runs, *changed]
            print(f"to look at it: {shlex.join(['debrisest', 'report', *asked])}", file=sys.stderr)
        exit_if(wrong or failed)


def _with_lost(
    selection: "Selection", scenarios: Sequence["LoadedScenario"], out: Path
) -> "Selection":
    """Return a selection that also runs again what has runs that failed or diverged."""
    from dataclasses import replace

    from debrisest.results.lost import lost
    from debrisest.results.open import find_results

    each = [lost(find_results(out / one.name), one.common.tables.diverged) for one in scenarios]
    return replace(selection, again=set().union(*each))


def _machine(jobs: int | None, cluster: str | None, quiet: bool) -> "Machine":
    from debrisest.runner.sweep import Machine

    return Machine(jobs or os.cpu_count() or 1, cluster, quiet)


def _tell_where(scenarios: Sequence["LoadedScenario"], out: Path) -> None:
    """Tell of variants where their results go."""
    first = scenarios[0]
    if first.variant:
        more = f" (and {len(scenarios) - 1} more)" if len(scenarios) > 1 else ""
        plain = "table without --set and --variant still shows the unchanged scenario"
        print(f"these results go to {out / first.name}{more}; {plain}", file=sys.stderr)


def bring(
    scenarios: Sequence["LoadedScenario"],
    out: Path,
    selection: "Selection",
    machine: "Machine",
    dry_run: bool,
) -> bool:
    """Run what has a reason to, or tell it; return whether a run gave no result."""
    from debrisest.errors import printable
    from debrisest.runner.plan import plan
    from debrisest.runner.sweep import bring_up_to_date

    _tell_where(scenarios, out)
    if dry_run:
        steps = [step for scenario in scenarios for step in plan(scenario, out, selection)]
        due = [step for step in steps if step.is_due]
        for step in due:
            print(f"{step.name}: {step.reason}")
        same = len([step for step in steps if step.same])
        linked = f", {same} are the same in another variant" if same else ""
        print(f"{len(due)} of {len(steps)} steps would run{linked}")
        return False
    failures = bring_up_to_date(scenarios, out, selection, machine)
    for name, why in [*failures.items()][:_MOST_FAILURES]:
        print(printable(f"{name} failed: {why}"), file=sys.stderr)
    if len(failures) > _MOST_FAILURES:
        more = len(failures) - _MOST_FAILURES
        print(f"and {more} more failed; debrisest status tells all", file=sys.stderr)
    return bool(failures)
