"""Names of files, and what they tell."""

from pathlib import Path

import pytest

from debrisest.results.address import Address

OUT = Path("out")


@pytest.mark.parametrize(
    ("address", "path"),
    [
        (Address("small", "slow", "simulate", "", 0), "small/slow/simulate.000000.h5"),
        (Address("a.b", "x=1,y", "filter", "my-own.2", 40), "a.b/x=1,y/filter-my-own.2.000040.h5"),
        (Address("s", "c", "assess", "e.000001", 10**6), "s/c/assess-e.000001.1000000.h5"),
    ],
)  # fmt: skip
def test_an_address_and_its_path(address: Address, path: str) -> None:
    assert address.path(OUT) == OUT / path
    assert Address.of(OUT / path) == address


@pytest.mark.parametrize(
    "name",
    ["simulate-triad.000000.h5", "filter.000000.h5", "filter-a.0.h5", "filter-a.h5", "notes.h5",
     "simulate.000000.h5.tmp", ".simulate.000000.h5", "track-a.000000.h5"],
)  # fmt: skip
def test_other_names_are_no_addresses(name: str) -> None:
    assert Address.of(OUT / "small" / "slow" / name) is None


def test_cases_are_sorted_as_people_count() -> None:
    names = ["noise=0.10", "noise=0.9", "2", "10", "1", "fig4"]
    addresses = [Address("s", case, "simulate", "", 0) for case in names]
    told = [address.case for address in sorted(addresses, key=lambda one: one.order)]
    assert told == ["1", "2", "10", "fig4", "noise=0.9", "noise=0.10"]


def test_what_is_computed_first_comes_first() -> None:
    stages = ["assess", "simulate", "filter", "recover"]
    addresses = [Address("s", "c", one, "e", run) for run in (20, 0) for one in stages]
    told = [(one.first_run, one.stage) for one in sorted(addresses, key=lambda one: one.order)]
    order = ["simulate", "recover", "filter", "assess"]
    assert told == [(run, stage) for run in (0, 20) for stage in order]
