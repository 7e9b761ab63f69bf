"""Whether the parts of a case fit together: data, first guesses, models, truth."""

from collections.abc import Collection, Iterator

from debrisest.catalog import CATALOG, kind_of
from debrisest.roles import FilterPart, Part, ProblemPart, StartPart
from debrisest.scenario.case import Case
from debrisest.scenario.document import KeyPath
from debrisest.scenario.schema import Estimator

Found = Iterator[tuple[KeyPath, str]]


def parts_that_do_not_fit(case: Case) -> Found:
    """Yield what a part of a case needs and is not given, with what would give it."""
    given = set(case.measured)
    for name, part in case.scenario.simulation.items():
        yield from _lacks(case, tuple(name.split(".", 1)), part, given)
    for name in case.estimators:
        yield from _estimator(case, name, case.scenario.estimators[name], set(given))


def _estimator(case: Case, name: str, chosen: Estimator, given: set[str]) -> Found:
    path = ("estimators", name)
    if chosen.recovery is not None:
        yield from _lacks(case, (*path, "recovery"), chosen.recovery, given)
    problem, start, algorithm = chosen.problem, chosen.start, chosen.filter
    if problem is None or algorithm is None:
        return
    if start is not None:
        yield from _lacks(case, (*path, "start"), start, given)
    yield from _lacks(case, (*path, "problem"), problem, given)
    if start is not None:
        yield from _start_that_does_not_fit((*path, "start"), start, problem, given)
    yield from _filter_that_does_not_fit((*path, "filter"), algorithm, problem, given)


def _lacks(case: Case, path: KeyPath, part: Part, given: set[str]) -> Found:
    """Yield what a part lacks or gives for the second time; add to what is given."""
    missing = [name for name in part.needed if name not in given]
    if missing:
        givers = ", ".join(_givers(missing))
        where = (
            f"which the measured data lack; it comes from: {givers}"
            if case.source
            else f"which no part before it gives; add one of: {givers}"
        )
        yield path, f"{kind_of(type(part))} needs {', '.join(missing)}, {where}"
    for name in sorted((set(part.given) - set(part.extends)) & given):
        yield path, f"{name} is given by an earlier part already; only one part may give it"
    given.update(part.given)


def _givers(names: Collection[str]) -> list[str]:
    return sorted(
        f"{role} {kind_of(giver)}"
        for role, parts in CATALOG.items()
        for giver in parts
        if set(names) & set(giver.can_give())
    )


def _start_that_does_not_fit(
    path: KeyPath, start: StartPart, problem: ProblemPart, given: set[str]
) -> Found:
    needed, guessed = problem.start_needed, start.guessed(given)
    missing = [name for name in needed if name not in guessed]
    if not missing:
        return
    starts = [part for part in CATALOG["start"] if issubclass(part, StartPart)]
    fitting = [kind_of(part) for part in starts if set(needed) <= part.guessed(given)]
    givers = ["starts given", *_givers([f"start_{name}" for name in missing])]
    told = f"a start that fits: {', '.join(fitting)}" if fitting else ""
    yield (
        path,
        f"{kind_of(type(problem))} needs a first guess of {', '.join(missing)}, which "
        f"{kind_of(type(start))} does not give here; "
        f"{told or 'start guess has it with one of: ' + ', '.join(givers)}",
    )


def _filter_that_does_not_fit(
    path: KeyPath, algorithm: FilterPart, problem: ProblemPart, given: set[str]
) -> Found:
    kind, needs = kind_of(type(algorithm)), kind_of(type(problem))
    if algorithm.takes != problem.gives_model:
        filters = [part for part in CATALOG["filter"] if issubclass(part, FilterPart)]
        fitting = [kind_of(part) for part in filters if part.takes == problem.gives_model]
        problems = [part for part in CATALOG["problem"] if issubclass(part, ProblemPart)]
        others = [kind_of(part) for part in problems if part.model_kind == algorithm.takes]
        yield (
            path,
            f"{kind} takes a {_words(algorithm.takes)}, but {needs} is a "
            f"{_words(problem.gives_model)} here; filters that fit: {', '.join(fitting)}"
            + (f"; problems that fit {kind}: {', '.join(others)}" if others else ""),
        )
    elif algorithm.uses_truth:
        missing = [name for name in problem.truth_needed if name not in given]
        if missing:
            yield (
                path,
                f"{kind} is linearised at the truth, but {', '.join(missing)} is not there; "
                "only a simulation has it",
            )


def _words(model_kind: str) -> str:
    return model_kind.replace("_", " ")
