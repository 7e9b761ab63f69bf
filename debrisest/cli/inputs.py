"""From arguments and options to what the runner takes."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from debrisest.runner.selection import Selection
    from debrisest.scenario.load import LoadedScenario


def load_all(
    configs: Sequence[Path],
    settings: Sequence[str] | None,
    plugins: Sequence[Path] | None,
    variant: str | None = None,
    keep: str | None = None,
) -> list["LoadedScenario"]:
    """Return all scenarios, or raise UserError with the problems of all of them at once.

    With settings each is a variant, by its given name or one derived from them.
    """
    from debrisest.errors import UserError
    from debrisest.files import alike
    from debrisest.plugins.load import load_plugins, read_plugins
    from debrisest.scenario.load import load_scenario
    from debrisest.scenario.variant import variant_called
    from debrisest.shipped import scenario_path
    from debrisest.show.tables.published import check_published

    name = variant_called(variant, settings or ())
    laid_on = [*(settings or ()), *([f"keep={keep}"] if keep else [])]
    own_parts = read_plugins(plugins or ())
    load_plugins(own_parts)
    scenarios, problems = [], []
    for config in configs:
        try:
            scenarios.append(load_scenario(scenario_path(config), laid_on, own_parts))
            check_published(scenarios[-1])
        except UserError as error:
            problems += error.problems
    stems = [alike(path.stem) for path in configs]
    problems += [
        f"{path}: another scenario is called {path.stem} too; results would be mixed"
        for path in configs
        if stems.count(alike(path.stem)) > 1
    ]
    if problems:
        raise UserError(problems)
    return [one.called(name) for one in scenarios] if name else scenarios


def computable(scenarios: Sequence["LoadedScenario"]) -> list["LoadedScenario"]:
    """Return the scenarios whose libraries are installed, and tell of the others.

    Raises UserError where none is left.
    """
    import sys

    from debrisest.errors import UserError

    able, problems = [], []
    for scenario in scenarios:
        if missing := scenario.missing_libraries:
            told = f"{scenario.path}: needs {', '.join(missing)}, which are not installed"
            problems.append(f"{told}: pip install 'debrisest[vision]'")
        else:
            able.append(scenario)
    if not able:
        raise UserError(problems)
    for problem in problems:
        print(f"{problem}; it is left out", file=sys.stderr)
    return able


def select(
    scenarios: Sequence["LoadedScenario"],
    runs: int | None,
    cases: Sequence[str] | None,
    estimators: Sequence[str] | None,
    last_stage: str = "assess",
    force: bool = False,
) -> "Selection":
    """Return what is asked for, or raise UserError where no scenario has it."""
    from debrisest.runner.selection import Selection, check_selection

    selection = Selection(runs, cases or None, estimators or None, last_stage, force)
    check_selection(scenarios, selection)
    return selection


def named(
    scenarios: Sequence["LoadedScenario"], out: Path, settings: Sequence[str]
) -> Iterator[str]:
    """Yield the arguments by which a command finds the results of these scenarios."""
    from debrisest.cli.options import RESULTS
    from debrisest.scenario.variant import variant_of
    from debrisest.shipped import is_shipped

    for one in scenarios:
        yield one.path.stem if is_shipped(one.path) else str(one.path)
    yield from (text for setting in settings for text in ("--set", setting))
    if (variant := scenarios[0].variant) != variant_of(settings):
        yield from ("--variant", variant)
    if out != RESULTS:
        yield from ("--out", str(out))
