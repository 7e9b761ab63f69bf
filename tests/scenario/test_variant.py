"""Names that settings give to a variant: readable, of one meaning, and such as folders can have."""

from itertools import combinations

import pytest
from pydantic import TypeAdapter

from debrisest.scenario.names import CaseName
from debrisest.scenario.variant import variant_of

NOISE = "sensors.points.noise_m=1e-2"


@pytest.mark.parametrize(
    ("settings", "name"),
    [
        ([], ""),
        (["seed=2"], "seed=2"),
        (["seed=1", "seed=2"], "seed=2"),
        (["seed=2", NOISE], "seed=2,sensors.points.noise_m=0.01"),
        ([NOISE, "seed=2"], "seed=2,sensors.points.noise_m=0.01"),
        (["estimators.best.filter.gate=false"], "estimators.best.filter.gate=false"),
        (["motion.rate_deg_s=[8, 1, -4]"], "motion.rate_deg_s=8,1,-4"),
        (["seed= 2 "], "seed=2"),
    ],
)
def test_a_name_says_what_was_set(settings: list[str], name: str) -> None:
    assert variant_of(settings) == name


def test_what_differs_has_another_name_that_a_folder_can_have() -> None:
    given = [
        *(["a=1"], ["a='1'"], ["a=[1]"], ["a=[[1]]"], ["a=1."], ["a='1.'"], ["a="], ["a=''"]),
        *(["a=[b, c]"], ["a='b,c'"], ["a=b c"], ["a=bc"], ["a=[[1, 2], 3]"], ["a=[1, 2, 3]"]),
        *(["a={kind: b, c: 3}"], ["a={c: 3, kind: b}"], ["a={kind: b, c: 4}"], ["a=[{kind: b}]"]),
        *(["a=/tmp/x"], ["a=tmpx"], ["a=b@c"], ["a=x."], ["a=x"], ["a=ü"], ["a={b: 1}", "a.b=2"]),
        *(["a.b=2", "a={b: 1}"], ["a=1", "b=1"], ["a='1,b=1'"]),
        *([f"a={'x' * letters}"] for letters in (98, 99, 100)),
    ]
    for one, other in combinations(given, 2):
        assert variant_of(one) != variant_of(other), (one, other)
    for one in given:
        assert TypeAdapter(CaseName).validate_python(variant_of(one))
        assert not variant_of(one).endswith(".")
